"""The command inverse: postures for a pose of the tip."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

pytest.importorskip("click")
pytest.importorskip("matplotlib")
pytest.importorskip("tomlkit")

from click.testing import CliRunner, Result

from fpbm_cpp.cli import command
from fpbm_cpp.cli.inverse import rotation_matrix

PANDA = fp.SerialArm.preset("panda")
DOWN = np.array([[1, 0, 0, 0.5], [0, -1, 0, 0], [0, 0, -1, 0.4], [0, 0, 0, 1]])


def call(*arguments: str) -> Result:
    return CliRunner().invoke(command, ["inverse", *arguments])


def postures(result: Result) -> np.ndarray:
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.output.splitlines()[2:]]
    return np.array(rows, dtype=float)[:, 1:-2]


@pytest.mark.parametrize(
    "rotation",
    ["1 0 0 0", "1,0,0,0", "3.141592653589793 0 0", "1 0 0 0 -1 0 0 0 -1", "-2,0,0,0"],
    ids=["quaternion", "commas", "rpy", "matrix", "any length"],
)
def test_all_forms_of_a_rotation(rotation: str) -> None:
    found = postures(call("panda", "--position", "0.5", "0", "0.4", "--rotation", *rotation.split(" ")))
    assert len(found) == 8
    for q in found:
        assert PANDA.forward(q) == pytest.approx(DOWN, abs=5e-4)  # Four decimals of each joint.


def test_roll_pitch_yaw_are_about_fixed_axes() -> None:
    roll, pitch, yaw = 0.3, -0.4, 1.1
    turns = [fp.rotation([roll, 0, 0]), fp.rotation([0, pitch, 0]), fp.rotation([0, 0, yaw])]
    assert rotation_matrix(np.array([roll, pitch, yaw])) == pytest.approx(turns[2] @ turns[1] @ turns[0])


def test_without_a_rotation_the_orientation_is_free() -> None:
    for q in postures(call("ur5e", "--position", "-0.4,0.1,0.3", "--count", "3")):
        assert fp.SerialArm.preset("ur5e").forward(q)[:3, 3] == pytest.approx([-0.4, 0.1, 0.3], abs=5e-4)


def test_postures_near_a_start() -> None:
    start = [0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785]
    position = PANDA.forward(start)[:3, 3]
    arguments = ["--position", *map(str, position), "--start", *map(str, start), "--count", "1"]
    assert postures(call("panda", *arguments))[0] == pytest.approx(start, abs=1e-3)


@pytest.mark.parametrize("rank", ["distance", "manipulability", "ranges"])
def test_rank(rank: Any) -> None:
    result = call("panda", "--position", "0.5,0,0.4", "--rotation", "1,0,0,0", "--count", "3", "--rank", rank)
    expected = PANDA.inverse_all(DOWN, count=3, rank=rank)
    assert postures(result) == pytest.approx(np.array([each.q for each in expected]), abs=1e-4)
    values = [float(line.split()[-2]) for line in result.output.splitlines()[2:]]
    assert values == pytest.approx([each.rank_value for each in expected], abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message", "status"),
    [
        (["panda", "--position", "3", "0", "0"], "no posture found: .* 2.16 m or rad from the pose", 1),
        (["panda", "--position", "3", "0"], "--position = '3,0': must be 3 numbers", 1),
        (["panda", "--position", "0,0,x"], "--position = '0,0,x': must be 3 numbers", 1),
        (["panda", "--position", "0,0,1", "--rotation", "1,2"], "--rotation = '1,2': must be 3 or 4 or 9 numbers", 1),
        (["panda", "--position", "0,0,1", "--rotation", "0,0,0,0"], "--rotation is zero", 1),
        (["panda", "--position", "0,0,1", "--rotation", "2,0,0,0,2,0,0,0,2"], "must be a rotation matrix", 1),
        (["panda", "--position", "0,0,1", "--rank", "best"], "'best' is not one of 'distance'", 2),
        (["panda", "--tip", "tool", "--position", "0,0,1"], "panda is a preset", 2),
        (["arm.urdf", "--position", "0,0,1"], "a URDF file needs --tip LINK", 2),
        (["arm.urdf", "--tip", "tool", "--position", "0,0,1"], "cannot read arm.urdf", 1),
    ],
)
def test_wrong_arguments(arguments: list[str], message: str, status: int) -> None:
    result = call(*arguments)
    assert result.exit_code == status
    assert re.search(message, result.stderr)
