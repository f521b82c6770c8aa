"""Pairs of links that an SRDF file disables."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from fpbm_cpp.urdf.srdf import read_disabled_pairs, read_group_states


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        file = tmp_path / "arm.srdf"
        file.write_text(text)
        return file

    return write


def test_pairs_are_ordered_and_unique(write) -> None:
    file = write(
        '<?xml version="1.0"?><robot name="r"><group name="arm"><chain base_link="a" tip_link="b"/></group>'
        '<disable_collisions link1="b" link2="a" reason="Adjacent"/><disable_default_collisions link="a"/>'
        '<disable_collisions link1="a" link2="b"/><group><disable_collisions link1="x" link2="y"/></group>'
        '<disable_collisions link1="a" link2="c" reason="Never"/></robot>'
    )
    assert read_disabled_pairs(file) == [("a", "b"), ("a", "c")]
    assert read_disabled_pairs(write("<robot/>")) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot>\n<disable_collisions link1='a'/></robot>", "line 2: <disable_collisions> of 'a' and '': must be two"),
        ("<robot><disable_collisions link1='a' link2='a'/></robot>", "line 1: <disable_collisions> of 'a' and 'a'"),
        ("<robot><disable_collisions link1='${p}a' link2='a'/></robot>", "run xacro on the file first"),
        ("<!DOCTYPE r [<!ENTITY e 'a'>]><robot>&e;</robot>", "line 1: has a DOCTYPE: must have none"),
        ("<robot>" + "<a>" * 100, "XML elements are nested more than 64 deep"),
        ("<robot>", "line 1: invalid XML: no element found"),
        ("<srdf/>", "line 1: the root is <srdf>: must be <robot>, as in a URDF or SRDF file"),
    ],
)
def test_invalid_srdf_is_rejected(text: str, message: str, write) -> None:
    file = write(text)
    with pytest.raises(ValueError, match=f"^{re.escape(str(file))}: .*{re.escape(message)}"):
        read_disabled_pairs(file)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_disabled_pairs(tmp_path / "nowhere.srdf")


def test_group_states(write) -> None:
    file = write(
        "<robot><group_state name='home' group='arm'><joint name='a' value='0.5'/><joint name='b' value='-1'/>"
        "</group_state><group_state name='floating' group='base'><joint name='c' value='0 0 1'/></group_state></robot>"
    )
    assert read_group_states(file) == [{"a": 0.5, "b": -1.0}]
    assert read_group_states(write("<robot/>")) == []
    message = "group state 'home': joint value = 'x': must be 1 finite number"
    with pytest.raises(ValueError, match=re.escape(message)):
        read_group_states(write("<robot><group_state name='home'><joint name='a' value='x'/></group_state></robot>"))
