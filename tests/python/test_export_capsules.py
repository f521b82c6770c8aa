"""fpbm-cpp export-capsules: parameters of the ROS 2 controller with the capsules of a URDF file."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("click")
pytest.importorskip("matplotlib")
from click.testing import CliRunner, Result

import fpbm_cpp as fp
from fpbm_cpp.cli import command

BALL = '<collision><origin xyz="0 0 0.1"/><geometry><sphere radius="0.05"/></geometry></collision>'
ROD = '<collision><geometry><cylinder radius="0.03" length="0.4"/></geometry></collision>'
URDF = f"""<robot name="r"><link name="root"/><link name="base">{BALL}</link><link name="arm">{ROD}</link>
<link name="hand">{BALL}</link><link name="tip"/>
<joint name="fixed" type="fixed"><parent link="root"/><child link="base"/><origin xyz="0 0 1"/></joint>
<joint name="a" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0.3 0 0"/>
<limit lower="-1" upper="1" velocity="1"/></joint>
<joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0 0.5 0" rpy="1.5 0 0"/></joint>
<joint name="b" type="continuous"><parent link="hand"/><child link="tip"/></joint></robot>
"""


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(command, ["export-capsules", *map(str, arguments)])


def lists(text: str) -> dict[str, Any]:
    """The lists of a parameter file, which are also JSON."""
    head = "# Written by fpbm-cpp export-capsules from arm.urdf. Each capsule: both ends and the radius [m].\n"
    assert text.startswith(f"{head}/**:\n  ros__parameters:\n    clearance:\n      links: [")
    return {name: json.loads(value) for name, value in re.findall(r"^ {6}(\w+): (\[.*?\])$", text, re.M | re.S)}


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    file = tmp_path / "arm.urdf"
    file.write_text(URDF)
    return file


def test_capsules_are_in_the_frames_of_their_links(arm: Path, tmp_path: Path) -> None:
    out = tmp_path / "capsules.yaml"
    for base in (), ("--base", "base"):
        assert call(arm, "--tip", "tip", *base, "-o", out).exit_code == 0
        given = lists(out.read_text())
        assert given.keys() == {"links", "capsules"}
        shapes = dict(zip(given["links"], np.reshape(given["capsules"], (-1, 7))))
        assert shapes.keys() == {"base", "arm", "hand"}
        for ball in "base", "hand":
            np.testing.assert_allclose(shapes[ball], [0, 0, 0.1, 0, 0, 0.1, 0.05], atol=1e-5)
            assert shapes[ball][6] > 0.05
        np.testing.assert_allclose(shapes["arm"][[0, 1, 3, 4]], 0, atol=1e-5)
        assert abs(shapes["arm"][2]) > 0.15
        assert shapes["arm"][6] > 0.03


def test_disabled_pairs_of_an_srdf_file(arm: Path, tmp_path: Path) -> None:
    srdf = tmp_path / "arm.srdf"
    srdf.write_text('<robot name="r"><disable_collisions link1="base" link2="hand" reason="Never"/></robot>')
    result = call(arm, "--tip", "tip", "--srdf", srdf, "-o", "-")
    given = lists(result.stdout)
    assert given["allowed"] == ["base", "hand"]


def test_several_tips(arm: Path) -> None:
    result = call(arm, "--tip", "tip", "--tip", "hand", "-o", "-")
    given = lists(result.stdout)
    names = {each.name for each in fp.Clearance.from_urdf(arm, tips=["tip", "hand"]).capsules}
    assert set(given["links"]) == names == {"base", "arm", "hand"}


def test_errors_name_the_file(arm: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare.urdf"
    bare.write_text(URDF.replace(BALL, "").replace(ROD, ""))
    for file, tip, named in (
        (tmp_path / "none.urdf", "tip", "none.urdf"),
        (arm, "nowhere", "nowhere"),
        (bare, "tip", "bare.urdf: has no <collision> geometry"),
    ):
        result = call(file, "--tip", tip, "-o", "-")
        assert result.exit_code == 1
        assert named in result.output
