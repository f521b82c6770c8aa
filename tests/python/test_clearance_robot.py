"""Robots as trees that avoid self-collision, between all branches, and obstacles."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import two_arms
from test_capsules import ROBOTS, with_robots

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.urdf.capsule_gaps import link_frames, postures

MOTIONS = int(os.environ.get("FPBM_MOTIONS", "20"))
TICKS = 2000
EVERY = 20  # Ticks between two postures that Coal measures: 20 ms.
TABLE = fp.Cuboid(two_arms.pose([0.75, 0, 0.7], [0, 0, 0]), [0.3, 0.6, 0.02], name="table")


def fitted_two_arms(folder: Path, **options: Any) -> tuple[fp.Robot, fp.Clearance, Path]:
    assert ROBOTS is not None
    urdf, srdf = two_arms.write(ROBOTS, folder)
    clearance = fp.Clearance.from_urdf(urdf, srdf=srdf, obstacles=[TABLE], per_link=1, **options)
    return fp.Robot.from_urdf(urdf), clearance, urdf


def across(one: str, other: str) -> bool:
    """Whether two links belong to two of these parts: left arm, right arm, torso, stand."""
    sides = {name.split("_")[0] for name in (one, other)}
    return len(sides) == 2 and sides <= {"left", "right", "stand", "torso"}


def place(rng: np.random.Generator, side: str, robot: fp.Robot) -> tuple[str, Array]:
    """Target of a hand: a frame and a point of this frame, on the other arm, the torso, the stand or the table."""
    other = {"left": "right", "right": "left"}[side]
    links = [name for name in robot.frames if name.startswith(other)]
    frame = str(rng.choice([str(rng.choice(links[3:])), "torso", "stand"], p=[0.6, 0.1, 0.3]))
    size = {"torso": [0.07, 0.25, 0.1], "stand": [0.1, 0.1, 0.45]}.get(frame, [0.03, 0.03, 0.03])
    middle = {"torso": [0, 0, 0.06], "stand": [0, 0, 0.45]}.get(frame, [0, 0, 0])
    if frame == "stand" and rng.random() < 0.5:
        middle, size = [0.75, 0, 0.7], [0.3, 0.6, 0.02]  # The table.
    return frame, np.append(middle + np.array(size) * rng.uniform(-1, 1, 3), 1.0)


@with_robots
@pytest.mark.parametrize("fault", [False, True], ids=["guarded", "without pairs across branches"])
def test_no_contact_of_two_arms_driven_together(fault: bool, tmp_path: Path) -> None:
    """Hands are driven into the other arm, the stand, the torso and the table; Coal measures the meshes."""
    coal = pytest.importorskip("coal")
    pytest.importorskip("trimesh")
    robot, clearance, urdf = fitted_two_arms(tmp_path)
    guarded = clearance
    if fault:
        names = {each.name for each in clearance.capsules}
        pairs = [(a, b) for a in names for b in names if a < b and across(a, b)]
        guarded = fp.Clearance(clearance.capsules, [TABLE], allowed=[*clearance.allowed, *pairs])
    assert not any(across(*pair) for pair in clearance.excluded_pairs(robot))
    bodies = two_arms.Bodies(coal, urdf, robot, [TABLE], {frozenset(pair) for pair in clearance.allowed})
    acceleration = [1.0 if "finger" in name else 10.0 for name in robot.joint_names]
    limits = fp.JointLimits(**{**robot.bounds(), "acceleration": acceleration})
    ready = np.array([0.0, *2 * two_arms.READY])
    stack = fp.Stack(
        [fp.PositionTask(f"{side}_panda_hand_tcp", name=side) for side in two_arms.SIDES],
        fp.PostureTask(ready, k1=4, k2=4),
    )
    scheme = fp.Balanced(0, np.ones(robot.dof), null_damping=2)
    rng = np.random.default_rng(8)
    contacts, blocked, mesh, beyond = 0, 0, np.inf, np.inf
    for _ in range(MOTIONS):
        while True:
            q = np.clip(ready + rng.normal(0, 0.35, robot.dof), limits.lower, limits.upper)
            nearest = clearance.nearest(robot, q)
            assert nearest is not None
            if nearest.distance > 1.5 * clearance.margin:
                break
        tracker = fp.Tracker(robot, scheme, q, stack=stack, limits=limits, bounds=[guarded])
        places = {side: place(rng, side, robot) for side in two_arms.SIDES}
        touched, path = False, [q]
        for k in range(TICKS):
            if k % EVERY == 0:
                goals = {side: (robot.forward(path[-1], frame) @ point)[:3] for side, (frame, point) in places.items()}
                distance, _ = bodies.nearest(path[-1], 0.02)
                mesh = min(mesh, distance)
                touched = touched or distance <= 0
            tick = tracker.tick(goals)
            beyond = min(beyond, tick.nearest.distance - clearance.margin)
            blocked += tick.status is fp.Status.BLOCKED
            path.append(tick.q)
        contacts += touched
        assert np.all((limits.lower - 1e-9 <= path) & (path <= limits.upper + 1e-9))
        assert np.all(np.abs(np.diff(path, axis=0)) <= limits.velocity * 1e-3 * (1 + 1e-9))
    print(
        f"\n{MOTIONS} motions: {contacts} with contacts of meshes, least distance of meshes {mesh:.4f} m, "
        f"of capsules less the margin {beyond:.1e} m, {blocked} of {MOTIONS * TICKS} ticks blocked"
    )
    assert beyond >= -1e-9
    assert blocked > 0
    if fault:
        assert contacts > 0
        assert mesh <= 0
    else:
        assert contacts == 0
        assert mesh >= clearance.margin  # Capsules contain the meshes.


@with_robots
@pytest.mark.parametrize("bounded", [True, False], ids=["bounded", "without bounds"])
def test_postures_of_two_hands_are_clear_of_meshes(bounded: bool, tmp_path: Path) -> None:
    """The targets are poses of random postures without contact; Coal measures the meshes."""
    coal = pytest.importorskip("coal")
    pytest.importorskip("trimesh")
    robot, clearance, urdf = fitted_two_arms(tmp_path)
    bodies = two_arms.Bodies(coal, urdf, robot, [TABLE], {frozenset(pair) for pair in clearance.allowed})
    frames = {side: f"{side}_panda_hand_tcp" for side in two_arms.SIDES}
    stack = fp.Stack([fp.PoseTask(frame, name=side) for side, frame in frames.items()])
    inverse = fp.InverseKinematics(robot, stack=stack, bounds=[clearance] if bounded else (), starts=256)
    rng, targets, contacts = np.random.default_rng(9), 0, 0
    while targets < 60:
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        nearest = clearance.nearest(robot, q)
        assert nearest is not None
        if nearest.distance < clearance.margin:
            continue
        targets += 1
        found = inverse.solve({side: robot.forward(q, frame) for side, frame in frames.items()})
        assert found.solved
        distance, pair = bodies.nearest(found.q, 0.02)
        assert distance >= clearance.margin or not bounded, pair  # Capsules contain the meshes.
        contacts += distance <= 0
    assert bounded == (contacts == 0)


# Presets and arms

PANDA = fp.SerialArm.preset("panda")
READY = np.array(2 * two_arms.READY[:7])


def shifted(*p: float) -> Array:
    frame = np.eye(4)
    frame[:3, 3] = p
    return frame


PLACES = {"right": shifted(0, -0.4, 0), "left": shifted(0, 0.4, 0)}
ARMS = {"right": PANDA, "left": PANDA}
BOTH = dict.fromkeys(ARMS, fp.Clearance.preset("panda"))


def test_the_preset_combines_those_of_its_arms() -> None:
    robot, clearance = fp.Robot.preset("two_pandas"), fp.Clearance.preset("two_pandas", obstacles=[TABLE], margin=0.02)
    assert clearance == fp.Clearance.from_arms(ARMS, BOTH, PLACES, obstacles=[TABLE], margin=0.02)
    assert robot.joints == fp.Robot.from_arms(ARMS, PLACES).joints
    pairs = clearance.pairs(robot)
    assert clearance.excluded_pairs(robot) == []
    assert ("left_panda_link7", "right_panda_link3") in pairs
    assert ("left_panda_link3", "right_panda_link0") in pairs
    assert ("right_panda_link4", "table") in pairs
    assert not {("left_panda_link5", "left_panda_link7"), ("left_panda_link7", "left_panda_link5")} & set(pairs)
    alone = BOTH["left"].pairs(PANDA)
    own = [tuple(name.removeprefix("left_") for name in pair) for pair in pairs if "right" not in "".join(pair)]
    assert sorted(pair for pair in own if "table" not in pair) == sorted(alone)


def test_distances_of_two_arms_are_at_most_those_of_each_alone() -> None:
    """If the arms are far apart, the nearest pair is within one arm."""
    rng = np.random.default_rng(2)
    far = {"right": shifted(0, -3, 0), "left": fp_turned(rng, [0, 3, 0.2])}
    robot, clearance = fp.Robot.from_arms(ARMS, far), fp.Clearance.from_arms(ARMS, BOTH, far)
    for q in rng.uniform(PANDA.limits.lower, PANDA.limits.upper, (50, 2, 7)):
        alone = [BOTH["left"].nearest(PANDA, each) for each in q]
        nearest = clearance.nearest(robot, q.ravel())
        assert nearest is not None
        assert nearest.distance == pytest.approx(min(each.distance for each in alone if each), abs=1e-9)


def fp_turned(rng: np.random.Generator, p: list[float]) -> Array:
    frame = shifted(*p)
    frame[:3, :3] = fp.rotation(rng.normal(size=3))
    return frame


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_a_stack_of_two_arms_keeps_the_margin(level: str) -> None:
    robot, clearance = fp.Robot.preset("two_pandas"), fp.Clearance.preset("two_pandas")
    hands = [fp.PositionTask("left_tip", name="left"), fp.PositionTask("right_tip", name="right")]
    stack = fp.Stack(hands, fp.PostureTask(READY, k1=4, k2=4, k=2))
    scheme = fp.MVN() if level == "velocity" else fp.Balanced(0, np.ones(14), null_damping=2)
    tracker = fp.Tracker(robot, scheme, READY, stack=stack, bounds=[clearance])
    goals = {"left": tracker.tip["right"].copy(), "right": tracker.tip["left"].copy()}
    least = np.inf
    for _ in range(2000):
        expected = clearance.nearest(robot, tracker.q)
        tick = tracker.tick(goals)
        assert repr(tick.nearest) == repr(expected)
        least = min(least, tick.nearest.distance)
    assert tick.status is fp.Status.BLOCKED
    assert clearance.margin - 1e-9 <= least < 1.5 * clearance.margin
    assert {name.split("_")[0] for name in tick.nearest.pair} == {"left", "right"}


# From files: a torso on a mobile base or a rail, with an arm and a gripper to either side

CYLINDER = '<collision><origin xyz="0 0 {}"/><geometry><cylinder radius="0.04" length="{}"/></geometry></collision>'


def robot_file(folder: Path, base: str = "revolute") -> Path:
    def link(name: str, length: float = 0.3) -> str:
        return f'<link name="{name}">{CYLINDER.format(length / 2, length)}</link>'

    def joint(name: str, kind: str, parent: str, child: str, origin: str, axis: str, more: str = "") -> str:
        limit = '<limit lower="-0.5" upper="2" velocity="2" acceleration="8"/>'
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{origin}"/><axis xyz="{axis}"/>{limit}{more}</joint>'
        )

    parts = [link("base", 0.1), link("chest", 0.5), joint("waist", base, "base", "chest", "0 0 0.2", "0 0 1")]
    for side, y in (("left", 0.2), ("right", -0.2)):
        parts += [
            *(link(f"{side}_{name}") for name in ("upper", "lower")),
            *(link(f"{side}_{name}", 0.1) for name in ("thumb", "finger")),
            joint(f"{side}_shoulder", "revolute", "chest", f"{side}_upper", f"0 {y} 0.5", "0 1 0"),
            joint(f"{side}_elbow", "revolute", f"{side}_upper", f"{side}_lower", "0 0 0.4", "1 0 0"),
            joint(f"{side}_grip", "prismatic", f"{side}_lower", f"{side}_thumb", "0.1 0 0.4", "1 0 0"),
            joint(
                f"{side}_grip_too",
                "prismatic",
                f"{side}_lower",
                f"{side}_finger",
                "-0.1 0 0.4",
                "-1 0 0",
                f'<mimic joint="{side}_grip" multiplier="0.5" offset="0.1"/>',
            ),
        ]
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="r">{"".join(parts)}</robot>')
    return file


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"base": "planar"},
        {"locked": {"waist": 0.4, "left_grip": 0.05}},
        {"tips": ["left_lower"]},
        {"base": "planar", "tips": "right_thumb", "locked": {"waist": -0.3}},
    ],
    ids=str,
)
def test_capsules_have_the_positions_of_their_links(options: dict[str, Any], tmp_path: Path) -> None:
    """The axis of each capsule is the z axis of the frame of its link."""
    file = robot_file(tmp_path)
    robot, clearance = fp.Robot.from_urdf(file, **options), fp.Clearance.from_urdf(file, per_link=1, **options)
    assert len(clearance.capsules) == 10
    frames = {each.name: each for each in robot.named_frames}
    parents = [-1, *(each.parent for each in robot.joints)]
    for each in clearance.capsules:
        frame = frames[each.name]
        assert each.link == frame.link
        (x, y, _), ends = frame.offset[:3, 3], (np.linalg.inv(frame.offset) @ [*end, 1.0] for end in (each.a, each.b))
        assert np.abs([end[:2] for end in ends]).max() < 1e-9, (x, y)
    link = {each.name: each.link for each in clearance.capsules}
    pairs = [tuple(sorted(pair)) for pair in (*clearance.pairs(robot), *clearance.excluded_pairs(robot))]
    expected = [
        (a, b)
        for a in sorted(link)
        for b in sorted(link)
        if a < b and link[a] not in (link[b], parents[link[b]]) and link[b] != parents[link[a]]
    ]
    assert sorted(pairs) == expected


def test_frames_of_the_gap_measurement_equal_those_of_the_robot(tmp_path: Path) -> None:
    robot = fp.Robot.from_urdf(robot_file(tmp_path), base="planar")
    joints = [each.joint for each in robot.joints]
    positions = postures(joints, 8)
    drives = [i for i, joint in enumerate(joints) if joint.mimic is None]
    for q, frames in zip(positions, link_frames(robot.joints, positions)):
        for joint, frame in zip(joints, frames[1:]):
            np.testing.assert_allclose(frame, robot.forward(q[drives], joint.name), atol=1e-12)


def test_srdf_of_a_robot(tmp_path: Path) -> None:
    """Pairs by name, without pairs of unknown links; the clearance must accept the posture of a state of all joints."""
    file, srdf = robot_file(tmp_path), tmp_path / "robot.srdf"
    file.write_text(re.sub("<cylinder[^>]*>", '<sphere radius="0.04"/>', file.read_text()))  # Fitted faster.
    robot = fp.Robot.from_urdf(file, base="planar")
    home = dict.fromkeys(robot.joint_names[3:], 0.1)
    state = "".join(f'<joint name="{name}" value="{value}"/>' for name, value in home.items())
    srdf.write_text(
        '<robot name="r"><disable_collisions link1="right_upper" link2="left_upper"/>'
        '<disable_collisions link1="camera" link2="left_upper"/>'
        f'<group_state name="home" group="all">{state}</group_state></robot>'
    )
    clearance = fp.Clearance.from_urdf(file, base="planar", srdf=srdf)
    assert clearance.allowed == (("left_upper", "right_upper"),)
    nearest = clearance.nearest(robot, [0, 0, 0, *home.values()])
    assert nearest is not None
    assert nearest.distance >= clearance.margin
    given = fp.Clearance.from_urdf(file, base="planar", postures=[0, 0, 0, *home.values()], allowed=clearance.allowed)
    assert given == clearance


def test_a_mobile_base_stops_before_a_wall(tmp_path: Path) -> None:
    file = robot_file(tmp_path)
    robot = fp.Robot.from_urdf(file, base="planar")
    wall = fp.HalfSpace([-1, 0, 0], -3.0, name="wall")  # All beyond x = 3 m.
    clearance = fp.Clearance.from_urdf(file, base="planar", obstacles=[wall], per_link=1)
    bounds = robot.bounds()
    limits = fp.JointLimits(**{**bounds, "velocity": [1.0] * robot.dof, "acceleration": [4.0] * robot.dof})
    stack = fp.Stack(fp.PositionTask("chest"), fp.PostureTask(np.zeros(robot.dof), k1=4, k2=4))
    q = np.where(np.isfinite(limits.lower), 0.1, 0.0)
    scheme = fp.Balanced(0, np.ones(robot.dof), null_damping=2)
    tracker = fp.Tracker(robot, scheme, q, stack=stack, limits=limits, bounds=[clearance])
    least = np.inf
    for _ in range(6000):
        tick = tracker.tick({"position": [5.0, 0.5, 0.2]})
        least = min(least, tick.nearest.distance)
    assert tick.status in (fp.Status.BLOCKED, fp.Status.STALLED)
    assert clearance.margin - 1e-9 <= least < 1.5 * clearance.margin


def test_a_clearance_without_pairs_changes_nothing() -> None:
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack(fp.PoseTask("left_tip", name="left"), fp.PostureTask(READY))
    scheme = fp.Balanced(0, np.ones(14), null_damping=2)
    nothing = fp.Clearance.from_arms(ARMS, {})
    assert nothing.nearest(robot, READY) is None
    one, other = (fp.Tracker(robot, scheme, READY, stack=stack, bounds=each) for each in ((), [nothing]))
    goal = one.tip["left"].copy()
    goal[:3, 3] += [0.1, -0.1, 0.2]
    for _ in range(500):
        assert one.tick({"left": goal}).q.tobytes() == other.tick({"left": goal}).q.tobytes()


ONE = [fp.Capsule(2, [0, 0, 0], [0, 0, 0.1], 0.01)]
RAIL = fp.Robot([fp.TreeJoint(fp.Joint()), fp.TreeJoint(fp.Joint("prismatic", name="rail"), 1)])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda file: fp.Clearance.from_urdf(file, locked={"wrist": 0.0}),
            "locked has 'wrist': must be names of joints",
        ),
        (lambda file: fp.Clearance.from_urdf(file, tips=["hand"]), "tips has 'hand': must be links"),
        (lambda file: fp.Clearance.from_urdf(file, base="chest"), "base = 'chest': must be"),
        (
            lambda file: fp.Clearance.from_urdf(file, "left_lower", tips=["left_lower"]),
            "tips = ['left_lower']: is for a Robot: give tips= without tip=",
        ),
        (
            lambda file: fp.Clearance.from_urdf(file, postures=[0.0] * 9),
            "postures of shape (9,): must be finite, of shape (7,)",
        ),
        (
            lambda file: fp.Clearance.from_urdf(file, allowed=[("chest", "camera")], per_link=1),
            "allowed[0] has 'camera': must be names of shapes",
        ),
        (
            lambda _: fp.Clearance.from_arms(ARMS, {"lift": BOTH["left"]}),
            "clearances has 'lift': must be names of arms; did you mean 'left'?",
        ),
        (
            lambda _: fp.Clearance.from_arms(ARMS, {"left": fp.Clearance([], [TABLE])}),
            "clearances['left'] has obstacles: give them to from_arms(obstacles=)",
        ),
        (
            lambda _: fp.Clearance(ONE).pairs(RAIL),
            "capsules[0].link = 2: moves with the prismatic joint 'rail', which has no bounds, after a revolute joint",
        ),
        (lambda _: fp.Clearance.preset("three_pandas"), "name = 'three_pandas': must be one of panda, fr3, iiwa14"),
    ],
)
def test_invalid_arguments_are_rejected(make: Callable[[Path], Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(fp.ParameterError) as caught:
        make(robot_file(tmp_path))
    assert str(caught.value).startswith(message)


def test_a_job_has_the_clearance_of_its_robot(tmp_path: Path) -> None:
    pytest.importorskip("tomlkit")
    from fpbm_cpp.job import prepare

    file = str(robot_file(tmp_path))
    job = {
        "arm": {"kind": "robot", "file": file, "locked": {"waist": 0.2}},
        "path": {"left": {"kind": "line", "displacement": [0.02, 0.0, 0.0]}},
        "clearance": {"file": file, "per_link": 1},
        "task": [
            {"kind": "position", "frame": "left_lower", "name": "left"},
            {"kind": "posture", "level": 1},
        ],
    }
    motion = prepare(job)
    (clearance,) = motion.bounds
    assert clearance == fp.Clearance.from_urdf(file, locked={"waist": 0.2}, per_link=1)
    assert isinstance(motion.arm, fp.Robot)
    assert isinstance(clearance, fp.Clearance)
    assert clearance.pairs(motion.arm)
