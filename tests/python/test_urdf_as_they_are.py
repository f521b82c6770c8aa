"""URDF files as robots' makers and users publish them: missing bounds, fixed joints, odd mimic joints.

Each file is read, or it is refused with the keyword that helps.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp

pytest.importorskip("click")

from click.testing import CliRunner

from fpbm_cpp.cli import command

LIMIT = 'lower="-1" upper="2" velocity="3" effort="4"'


def link(*names: str) -> str:
    return "".join(f'<link name="{name}"/>' for name in names)


def joint(name: str, parent: str, child: str, limit: str | None = LIMIT, more: str = "", type: str = "revolute") -> str:
    bounds = "" if limit is None else f"<limit {limit}/>"
    where = f'<origin xyz="0 0 0.3"/><axis xyz="0 {int(parent == "base")} {int(parent != "base")}"/>'
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{type}">{ends}{where}{bounds}{more}</joint>'


def robot(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


def chain(*limits: str | None) -> str:
    """Joints a, b, c and so on, from base to tip."""
    links = ["base", *(f"l{i}" for i in range(1, len(limits))), "tip"]
    joints = (joint(chr(ord("a") + i), links[i], links[i + 1], limit) for i, limit in enumerate(limits))
    return robot(link(*links), *joints)


def hand(follower: str, mimic: str, leader: str = 'lower="0" upper="0.8" velocity="2"') -> str:
    """An arm of one joint with two fingers: 'left' leads, 'right' is a mimic joint."""
    fingers = joint("left", "tip", "l", leader), joint("right", "tip", "r", follower, f"<mimic {mimic}/>")
    return robot(link("base", "tip", "l", "r"), joint("a", "base", "tip"), *fingers)


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        file = tmp_path / "arm.urdf"
        file.write_text(text)
        return file

    return write


def refused(read: Callable[[], object]) -> str:
    with pytest.raises(ValueError, match=r".") as caught:
        read()
    message = str(caught.value)
    assert "\n" not in message
    return message


# Bounds that are not given


@pytest.mark.parametrize("limit", ['lower="-1" upper="2"', 'lower="-1" upper="2" velocity="0" effort="0"'])
def test_a_velocity_of_zero_or_none_is_not_a_bound(limit: str, write) -> None:
    arm = fp.SerialArm.from_urdf(write(chain(limit, LIMIT)), "tip")
    np.testing.assert_array_equal(arm.limits.velocity, [inf, 3])
    np.testing.assert_array_equal(fp.Robot.from_urdf(write(chain(limit, LIMIT))).limits.velocity, [inf, 3])
    tracker = fp.Tracker(
        arm,
        fp.Balanced(0, [1, 1], null_damping=1),
        [0.5, 0.5],
        stack=fp.Stack(fp.PositionTask(rows=("x",))),
        limits=fp.JointLimits(velocity=1.5, acceleration=10),
    )
    for _ in range(500):
        tick = tracker.tick({"position": [0.0, 0.0, 0.0]})
        assert np.all(np.abs(tick.qd) <= 1.5)


def test_accelerations_and_jerks_of_zero_are_not_bounds(write) -> None:
    limits = fp.SerialArm.from_urdf(write(chain(f'{LIMIT} acceleration="0" jerk="0"')), "tip").limits
    assert (limits.acceleration, limits.jerk) == (inf, inf)


# Own limits


def test_own_limits_replace_bounds_before_the_check(write) -> None:
    file = write(chain('lower="1" upper="-1" velocity="-2"', LIMIT))
    assert "give limits=fp.JointLimits(lower=..., upper=...)" in refused(lambda: fp.SerialArm.from_urdf(file, "tip"))
    ranged = fp.JointLimits(lower=-2, upper=[2, 1])
    for read in (
        lambda own: fp.SerialArm.from_urdf(file, "tip", limits=own),
        lambda own: fp.Robot.from_urdf(file, limits=own),
    ):
        assert "give limits=fp.JointLimits(velocity=...)" in refused(lambda read=read: read(ranged))
        limits = read(ranged.replace(velocity=2, acceleration=[10, 20])).limits
        np.testing.assert_array_equal([limits.lower, limits.upper], [[-2, -2], [2, 1]])
        np.testing.assert_array_equal([limits.velocity, limits.acceleration], [[2, 2], [10, 20]])
        with pytest.raises(fp.ParameterError, match=r"^velocity has 3 entries: must have 2, one per joint"):
            read(ranged.replace(velocity=[1, 2, 3]))


def test_own_limits_replace_bounds_of_mimic_joints(write) -> None:
    file = write(hand('lower="0" upper="0.3" velocity="1"', 'joint="left" multiplier="0.5"'))
    np.testing.assert_allclose(fp.Robot.from_urdf(file).limits.upper, [2, 0.6])
    own = fp.Robot.from_urdf(file, limits=fp.JointLimits(lower=-2, upper=2, acceleration=5)).limits
    np.testing.assert_array_equal([own.upper, own.velocity, own.acceleration], [[2, 2], [3, 2], [5, 5]])


# Joints without a range


@pytest.mark.parametrize(
    ("limit", "at"),
    [('lower="0.5" upper="0.5" velocity="1"', 0.5), ('velocity="1"', 0.0), (None, 0.0)],
)
def test_a_joint_without_a_range_is_fixed(limit: str | None, at: float, write) -> None:
    file = write(chain(LIMIT, limit, LIMIT))
    message = (
        f"{file}: joints are fixed, because lower = upper, which are 0 if missing: 'b' at {at:g} rad: "
        "to move a joint, give limits=fp.JointLimits(lower=..., upper=...)"
    )
    with pytest.warns(fp.UrdfWarning) as warned:
        arm = fp.SerialArm.from_urdf(file, "tip")
    assert [str(each.message) for each in warned] == [message]
    assert warned[0].filename == __file__
    with pytest.warns(fp.UrdfWarning) as warned:
        tree = fp.Robot.from_urdf(file)
    assert [str(each.message) for each in warned] == [message]
    assert warned[0].filename == __file__
    free = fp.SerialArm.from_urdf(file, "tip", limits=fp.JointLimits(lower=-1, upper=1))
    assert (arm.joint_names, tree.joint_names, free.joint_names) == (["a", "c"], ["a", "c"], ["a", "b", "c"])
    expected = free.forward([0.3, at, -0.2])
    np.testing.assert_allclose(arm.forward([0.3, -0.2]), expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(tree.forward([0.3, -0.2], "tip"), expected, rtol=0, atol=1e-14)


def test_a_mimic_joint_of_a_fixed_joint_is_fixed(write) -> None:
    leader = 'lower="0.4" upper="0.4"'
    file = write(hand('lower="-1" upper="1"', 'joint="left" multiplier="-2" offset="0.1"', leader))
    with pytest.warns(fp.UrdfWarning, match="'left' at 0.4 rad"):
        tree = fp.Robot.from_urdf(file)
    assert tree.joint_names == ["a"]
    turn = tree.forward([0.0], "tip").T @ tree.forward([0.0], "r")
    np.testing.assert_allclose(fp.rotation_vector(turn[:3, :3]), [0, 0, -0.7], atol=1e-12)


def test_a_file_whose_joints_are_all_fixed_names_the_keyword(write) -> None:
    file = write(chain(None, 'lower="1" upper="1"'))
    assert refused(lambda: fp.SerialArm.from_urdf(file, "tip")) == (
        f"{file}: all joints between base and tip are fixed, because lower = upper: 'a', 'b': to move a joint, "
        "give limits=fp.JointLimits(lower=..., upper=...), or give another base or tip"
    )
    assert "limits=fp.JointLimits(lower=..., upper=...), or if the base moves, give base='planar'" in refused(
        lambda: fp.Robot.from_urdf(file)
    )
    assert fp.Robot.from_urdf(file, limits=fp.JointLimits(lower=-1, upper=1)).dof == 2


def test_a_file_without_joints_can_have_a_planar_base(write) -> None:
    file = write(robot(link("box")))
    assert refused(lambda: fp.Robot.from_urdf(file)).endswith(
        "no joints move: must be 1 to 64: if the base moves, give base='planar'"
    )
    assert fp.Robot.from_urdf(file, base="planar").dof == 3


# Mimic joints


@pytest.mark.parametrize(
    "follower",
    [
        'lower="0" upper="0.87" velocity="4"',  # The range for the multiplier 1.
        'lower="0.5" upper="0.5" velocity="4"',
        'lower="0.9" upper="-0.9" velocity="4"',
        'velocity="4"',
    ],
)
def test_a_mimic_joint_that_leaves_no_range_loses_its_range(follower: str, write) -> None:
    file = write(hand(follower, 'joint="left" multiplier="-1"'))
    with pytest.warns(fp.UrdfWarning) as warned:
        tree = fp.Robot.from_urdf(file)
    assert [str(each.message) for each in warned] == [
        f"{file}: ranges of mimic joints are ignored, because they leave no range for the joint that leads them: "
        "'right' of 'left'"
    ]
    np.testing.assert_array_equal([tree.limits.lower, tree.limits.upper], [[-1, 0], [2, 0.8]])
    np.testing.assert_array_equal(tree.limits.velocity, [3, 2])
    fp.Robot.from_urdf(file, tips=["tip"])  # No warning: the fingers are fixed.
    fp.Robot.from_urdf(file, locked={"left": 0.1})


def test_consistent_ranges_of_other_mimic_joints_are_used(write) -> None:
    third = joint("third", "tip", "t", 'lower="0" upper="0.5"', '<mimic joint="left"/>')
    text = hand('lower="0" upper="0.87"', 'joint="left" multiplier="-1"')
    file = write(text.replace("</robot>", f"{link('t')}{third}</robot>"))
    with pytest.warns(fp.UrdfWarning, match=r"leads them: 'right' of 'left'$"):
        np.testing.assert_array_equal(fp.Robot.from_urdf(file).limits.upper, [2, 0.5])


DANGLING = hand(LIMIT, 'joint="lft"')


@pytest.mark.parametrize(
    "text",
    [
        DANGLING,
        DANGLING.replace(
            "</robot>", joint("third", "r", "t", LIMIT, '<mimic joint="right"/>') + link("t") + "</robot>"
        ),
    ],
    ids=["dangling", "a mimic of a dangling mimic"],
)
def test_a_dangling_mimic_outside_the_robot_does_not_matter(text: str, write) -> None:
    file = write(text)
    assert fp.SerialArm.from_urdf(file, "tip").dof == 1
    assert fp.Robot.from_urdf(file, tips=["tip"]).dof == 1
    assert fp.Robot.from_urdf(file, tips="l").dof == 2
    message = refused(lambda: fp.Robot.from_urdf(file))
    assert message == (
        f"{file}: joints mimic joints that do not exist: 'right': must mimic a joint of the file: "
        "fix the joints by locked= or tips=, or correct the names"
    )
    fixed = fp.Robot.from_urdf(file, locked={"right": 0.3})
    assert fixed.joint_names == ["a", "left"]
    turn = fixed.forward([0.0, 0.0], "tip").T @ fixed.forward([0.0, 0.0], "r")
    np.testing.assert_allclose(fp.rotation_vector(turn[:3, :3]), [0, 0, 0.3], atol=1e-12)
    assert refused(lambda: fp.SerialArm.from_urdf(file, "r")).endswith(
        "joint 'right' mimics 'lft', which does not exist: must mimic a joint of the file: correct the name, "
        "or remove <mimic>, or give another base or tip"
    )


def test_a_loop_of_mimics_outside_the_robot_does_not_matter(write) -> None:
    file = write(
        hand(LIMIT, 'joint="left"')
        .replace("effort=", "effort=", 1)
        .replace('<joint name="left" type="revolute">', '<joint name="left" type="revolute"><mimic joint="right"/>')
    )
    assert fp.Robot.from_urdf(file, tips=["tip"]).dof == 1
    assert "mimics form a loop" in refused(lambda: fp.Robot.from_urdf(file))


def test_a_follower_cannot_be_locked(write) -> None:
    file = write(hand('lower="-1" upper="1"', 'joint="left"'))
    with pytest.raises(fp.ParameterError, match="locked has 'right', which mimics 'left': lock the leader"):
        fp.Robot.from_urdf(file, locked={"right": 0.1})


def test_a_joint_with_a_range_of_nothing_can_be_locked(write) -> None:
    file = write(chain(LIMIT, 'lower="1" upper="-1"'))
    assert "fix the joint by locked= or tips=" in refused(lambda: fp.Robot.from_urdf(file))
    assert fp.Robot.from_urdf(file, locked={"b": 0.2}).dof == 1
    assert fp.Robot.from_urdf(file, tips=["l1"]).dof == 1


# XML text


@pytest.mark.parametrize("text", [chain(LIMIT), '<?xml version="1.0"?>\n' + chain(LIMIT), "  <robot/>"])
@pytest.mark.parametrize(
    "read",
    [
        lambda text: fp.SerialArm.from_urdf(text, "tip"),
        lambda text: fp.Robot.from_urdf(text),
        lambda text: fp.Clearance.from_urdf(text, "tip"),
    ],
)
def test_xml_text_is_refused_as_such(read: Callable[[str], object], text: str) -> None:
    with pytest.raises(fp.ParameterError) as caught:
        read(text)
    assert caught.value.name == "path"
    assert str(caught.value).startswith("path = '<")
    assert str(caught.value).endswith(": must be the name of a file, not XML text: write the text to a file")


# Clearance


def test_a_clearance_reads_the_same_joints(write) -> None:
    body = '<collision><geometry><sphere radius="0.02"/></geometry></collision>'
    text = chain(LIMIT, None, LIMIT).replace('<link name="tip"/>', f'<link name="tip">{body}</link>')
    file = write(text)
    own = fp.JointLimits(lower=-1, upper=1)
    for limits, number in ((None, 2), (own, 3)):
        (capsule,) = fp.Clearance.from_urdf(file, "tip", limits=limits).capsules  # Without a warning.
        assert capsule.link == number
        (capsule,) = fp.Clearance.from_urdf(file, limits=limits).capsules
        assert capsule.link == number


# The command line


@pytest.mark.filterwarnings("default")
def test_the_command_line_prints_a_warning_as_one_line(write) -> None:
    file = write(chain(*[LIMIT] * 3, None, *[LIMIT] * 4))
    given = ["--tip", "tip", "--radius", "0.02", "--duration", "1", "--limits", "--limit-acceleration", "10"]
    result = CliRunner().invoke(command, ["track", str(file), *given])
    assert result.exit_code == 0, result.output
    lines = [line for line in result.stderr.splitlines() if line]
    assert len(lines) == 1
    assert lines[0].startswith(
        f"Warning: {file}: joints are fixed, because lower = upper, which are 0 if missing: 'd' at 0"
    )
    free = CliRunner().invoke(command, ["track", str(file), *given, "--limit-lower", "-1", "--limit-upper", "1"])
    assert (free.exit_code, free.stderr) == (0, ""), free.output


def test_limits_of_the_command_line_come_before_the_check(write) -> None:
    file = write(chain('lower="1" upper="-1"', *[LIMIT] * 6))
    arguments = ["track", str(file), "--tip", "tip", "--radius", "0.02", "--limits", "--limit-acceleration", "10"]
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 1
    assert "joint 'a': lower = 1: must be below upper = -1: give limits=" in result.stderr
    result = CliRunner().invoke(command, [*arguments, "--limit-lower", "-1", "--limit-upper", "1"])
    assert result.exit_code == 0, result.output


# Files of other packages


def files() -> Iterator[Path]:
    """The URDF files of the packages that are installed."""
    cmeel = importlib.util.find_spec("cmeel")
    if cmeel is not None and cmeel.origin is not None:
        yield from (Path(cmeel.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots").rglob("*.urdf")
    for package in ("ManipulaPy", "airo_models", "rtbdata", "robosuite"):
        spec = importlib.util.find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
            yield from Path(folder).rglob("*.urdf")


FILES = sorted(files())
MALFORMED = ("invalid XML", "must be one link, the root")  # A list of links without joints, an empty robot.
KEYWORDS = ("limits=", "locked=", "tips=", "base=")


@pytest.mark.skipif(not FILES, reason="needs example-robot-data, ManipulaPy, airo-models, rtb-data or robosuite")
def test_each_published_file_is_read_or_refused_with_a_keyword() -> None:
    read = 0
    for file in FILES:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fp.UrdfWarning)
            for base in (None, "fixed", "planar"):
                try:
                    fp.Robot.from_urdf(file, base=base)
                except ValueError as error:
                    reason = str(error)
                    assert reason.startswith(f"{file}: "), reason
                    if any(words in reason for words in MALFORMED):
                        break
                    assert any(keyword in reason for keyword in KEYWORDS), reason
                else:
                    read += 1
                    break
    print(f"{len(FILES)} files, {read} read")
    assert read >= len(FILES) * 0.9


def published(name: str) -> Path:
    found = [file for file in FILES if file.as_posix().endswith(name)]
    return found[0] if found else pytest.skip(f"needs {name}")


@pytest.mark.parametrize(
    ("name", "options", "dof", "warning"),
    [
        ("centauro_description/urdf/centauro.urdf", {}, 35, "joints are fixed"),
        ("quadruped_description/urdf/quadruped.urdf", {"limits": fp.JointLimits(lower=-2, upper=2)}, 8, ""),
        ("double_pendulum_description/urdf/double_pendulum.urdf", {"limits": fp.JointLimits(lower=-3, upper=3)}, 2, ""),
        ("pr2_description/urdf/pr2.urdf", {}, 20, "ranges of mimic joints are ignored"),
        ("alex_description/urdf/alex_psyonic_hands.urdf", {"tips": ["LeftWristYawLink", "RightWristYawLink"]}, 13, ""),
        ("tiago_description/robots/tiago_dual.urdf", {"tips": ["arm_left_7_link", "arm_right_7_link"]}, 15, ""),
        ("romeo_description/urdf/romeo.urdf", {"tips": ["l_wrist", "r_wrist"]}, 15, ""),
    ],
)
def test_a_remedy_of_a_published_file_helps(
    name: str, options: dict[str, object], dof: int, warning: str, recwarn: pytest.WarningsRecorder
) -> None:
    warnings.simplefilter("always")
    assert fp.Robot.from_urdf(published(name), **options).dof == dof
    said = [str(each.message) for each in recwarn if issubclass(each.category, fp.UrdfWarning)]
    assert [warning in each for each in said] == ([True] if warning else [])


def test_the_warning_has_its_own_category() -> None:
    assert issubclass(fp.UrdfWarning, UserWarning)
    program = "import warnings, fpbm_cpp; warnings.simplefilter('ignore', fpbm_cpp.UrdfWarning)"
    subprocess.run([sys.executable, "-c", program], check=True)
