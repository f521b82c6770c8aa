"""Arms that avoid self-collision and obstacles."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp._types import Array

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854])
# Rough estimates; hand and finger represent a gripper.
CAPSULES = (
    fp.Capsule(0, [-0.05, 0, 0.06], [0, 0, 0.12], 0.1, "base"),
    fp.Capsule(1, [0, 0, -0.15], [0, 0, 0], 0.07, "shoulder"),
    fp.Capsule(2, [0, 0, -0.06], [0, -0.15, 0], 0.07, "upper arm"),
    fp.Capsule(4, [0, 0, -0.05], [-0.06, 0.1, 0], 0.06, "forearm"),
    fp.Capsule(6, [0, 0, -0.05], [0.08, 0, 0.02], 0.05, "wrist"),
    fp.Capsule(7, [0, -0.06, 0.14], [0, 0.06, 0.14], 0.04, "hand"),
    fp.Capsule(7, [0, 0, 0.14], [0, 0, 0.2], 0.02, "finger"),
)
TABLE = fp.HalfSpace([0, 0, 1], 0.05, name="table")
CLEARANCE = fp.Clearance(CAPSULES, [TABLE], allowed=[("table", "shoulder")])

PLANAR = fp.PlanarArm([0.5, 0.4, 0.3])
LINKS = tuple(fp.Capsule(i, [0, 0, 0], [length, 0, 0], 0.02 * i) for i, length in enumerate(PLANAR.lengths, 1))


def turned(rng: np.random.Generator, extent: float) -> Array:
    """A random frame."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = fp.rotation(rng.normal(size=3)), rng.uniform(-extent, extent, 3)
    return pose


def frames(arm: fp.Arm, q: Array) -> list[Array]:
    """Frames of all links: the frames of the joints, displaced by the joint positions."""
    if isinstance(arm, fp.PlanarArm):
        arm = fp.SerialArm([fp.Joint(placement=shifted(x)) for x in (0, *arm.lengths[:-1])])
    assert isinstance(arm, fp.SerialArm)
    found = [np.eye(4)]
    for joint, position in zip(arm.joints, q):
        motion = np.eye(4)
        axis = joint.axis / np.linalg.norm(joint.axis)
        if joint.type == "prismatic":
            motion[:3, 3] = position * axis
        else:
            motion[:3, :3] = fp.rotation(position * axis)
        found.append(found[-1] @ joint.placement @ motion)
    return found


def shifted(x: float) -> Array:
    frame = np.eye(4)
    frame[0, 3] = x
    return frame


# Distances


class Coal:
    """Distances of the pairs of shapes of a clearance, by Coal."""

    def __init__(self, arm: fp.Arm, clearance: fp.Clearance) -> None:
        self.coal = pytest.importorskip("coal", reason="needs Coal: pip install coal")
        self.arm = arm
        self.capsules = {each.name: each for each in clearance.capsules}
        self.others = self.capsules | {each.name: each for each in clearance.obstacles}
        self.pairs = clearance.pairs(arm)
        assert len(self.others) == len(clearance.capsules) + len(clearance.obstacles)
        self.request = self.coal.DistanceRequest()
        self.request.gjk_tolerance = self.request.epa_tolerance = 1e-12
        self.request.gjk_max_iterations = self.request.epa_max_iterations = 1000

    def _shape(self, shape: Any, links: list[Array]) -> tuple[Any, Any]:
        if isinstance(shape, fp.HalfSpace):
            length = np.linalg.norm(shape.normal)
            return self.coal.Halfspace(shape.normal / length, shape.offset), self.coal.Transform3s.Identity()
        if isinstance(shape, fp.Cuboid):
            return self.coal.Box(*(2 * shape.half)), self.coal.Transform3s(shape.pose[:3, :3], shape.pose[:3, 3])
        a, b = (links[shape.link][:3] @ [*end, 1.0] for end in (shape.a, shape.b))
        length = np.linalg.norm(b - a)
        z = (b - a) / length if length > 0 else np.array([0.0, 0.0, 1.0])
        x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
        x /= np.linalg.norm(x)
        R = np.stack((x, np.cross(z, x), z), axis=1)
        return self.coal.Capsule(shape.radius, length), self.coal.Transform3s(R, (a + b) / 2)

    def distances(self, q: Array) -> Array:
        links = frames(self.arm, q)
        placed = {name: self._shape(shape, links) for name, shape in self.others.items()}
        return np.array(
            [
                self.coal.distance(*placed[a], *placed[b], self.request, self.coal.DistanceResult())
                for a, b in self.pairs
            ]
        )


@pytest.mark.parametrize("arm", [PANDA, PLANAR], ids=["panda", "planar"])
def test_the_nearest_pair_agrees_with_coal(arm: fp.Arm) -> None:
    rng = np.random.default_rng(3)
    capsules = CAPSULES if arm is PANDA else LINKS
    apart, worst = 0, 0.0
    for _ in range(20):
        obstacles = [
            fp.HalfSpace(rng.normal(size=3), rng.uniform(-2.0, -0.5)),
            fp.Cuboid(turned(rng, 0.8), rng.uniform(0, 0.2, 3)),
            fp.Cuboid(turned(rng, 0.8), [0.1, 0, 0.05], name="plate"),
            fp.Capsule(0, rng.uniform(-0.8, 0.8, 3), rng.uniform(-0.8, 0.8, 3), 0.05),
            fp.Capsule(0, *[rng.uniform(-0.8, 0.8, 3)] * 2, 0.1, "ball"),
        ]
        clearance = fp.Clearance(capsules, obstacles)
        coal = Coal(arm, clearance)
        for q in rng.uniform(-2.5, 2.5, (20, arm.dof)):
            nearest, distances = clearance.nearest(arm, q), coal.distances(q)
            assert nearest is not None
            if nearest.distance > 1e-6:  # If shapes overlap, the distance by Coal is less exact.
                apart += 1
                worst = max(worst, abs(nearest.distance - distances.min()))
                assert distances[coal.pairs.index(nearest.pair)] <= distances.min() + 1e-9
            else:
                assert distances.min() < 1e-6
    print(f"\n{apart} of 400 postures clear of all; off by {worst:.1e} m at most")
    assert apart > 100
    assert worst <= 1e-9


def test_links_of_a_planar_arm_are_along_x() -> None:
    rng = np.random.default_rng(5)
    for q in rng.uniform(-3, 3, (50, 3)):
        x = rng.uniform(-1, 1, 2)
        clearance = fp.Clearance(LINKS, [fp.Capsule(0, [*x, 0.3], [*x, 0.3], 0.1, "ball")])
        heading = np.cumsum(q)
        ends = np.cumsum(
            [[0, 0], *(length * np.array([np.cos(a), np.sin(a)]) for length, a in zip(PLANAR.lengths, heading))], axis=0
        )
        expected = []
        for link, a, b in zip(LINKS, ends, ends[1:]):
            s = np.clip((x - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            expected.append(np.hypot(np.linalg.norm(x - a - s * (b - a)), 0.3) - link.radius - 0.1)
        balls = fp.Clearance(LINKS, clearance.obstacles, allowed=[("link_3", "link_1")])
        nearest = balls.nearest(PLANAR, q)
        assert nearest is not None
        assert nearest.distance == pytest.approx(min(expected), abs=1e-12)
        assert nearest.pair == (f"link_{1 + int(np.argmin(expected))}", "ball")


# Pairs


def test_pairs_exclude_neighbours_and_allowed_pairs() -> None:
    pairs = CLEARANCE.pairs(PANDA)
    link = {each.name: each.link for each in CAPSULES}
    for i, a in enumerate(link):
        assert ((a, "table") in pairs) == (a not in ("base", "shoulder"))
        for b in list(link)[:i]:
            assert ((a, b) in pairs) == (link[a] - link[b] > 1)
    assert len(pairs) == len(set(pairs))
    assert CLEARANCE.excluded_pairs(PANDA) == []


def test_pairs_that_overlap_in_every_posture_are_left_out() -> None:
    thick = fp.Clearance([*CAPSULES[:1], fp.Capsule(2, [0, 0, 0], [0, 0, 0], 0.3, "elbow")], margin=0.02)
    assert thick.excluded_pairs(PANDA) == [("elbow", "base")]
    assert thick.pairs(PANDA) == []
    assert thick.nearest(PANDA, READY) is None
    tracker = fp.Tracker(PANDA, fp.MAN(), READY, bounds=[thick])
    assert tracker.tick(tracker.tip).nearest is None


def test_names_have_defaults() -> None:
    clearance = fp.Clearance(LINKS, [fp.HalfSpace([0, 1, 0], -1), fp.HalfSpace([1, 0, 0], -2, name="wall")])
    assert [each.name for each in clearance.capsules] == ["link_1", "link_2", "link_3"]
    assert [each.name for each in clearance.obstacles] == ["obstacle_1", "wall"]
    assert clearance.obstacles[0].offset == -1


def test_a_clearance_applies_to_several_arms() -> None:
    lengths = [0.5, 0.4, 0.3]
    clearance = fp.Clearance(LINKS, [fp.HalfSpace([0, 1, 0], -1)], allowed=[("link_3", "link_1")])
    for scale in (1.0, 0.5, 1.0):
        nearest = clearance.nearest(fp.PlanarArm(np.multiply(lengths, scale)), [-np.pi / 2, 0, 0])
        assert nearest is not None
        assert nearest.distance == pytest.approx(1 - scale * 0.9 - 0.3 - 0.06, abs=1e-12)


@pytest.mark.parametrize("again", [copy.deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_copies_measure_the_same_distances(again: Callable[[Any], Any]) -> None:
    CLEARANCE.nearest(PANDA, READY)
    other = again(CLEARANCE)
    assert other == CLEARANCE
    assert repr(other.nearest(PANDA, READY)) == repr(CLEARANCE.nearest(PANDA, READY))


# Motions

SCHEMES = [fp.MVN(k=5), fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)]
THROUGH = fp.Line([0.1, 0.2, -0.8], 2.0)


@pytest.mark.parametrize("scheme", SCHEMES, ids=["velocity", "acceleration"])
@pytest.mark.parametrize("task", ["position", "pose"])
def test_a_reference_through_a_table_stops_at_the_margin(scheme: fp.Scheme, task: str) -> None:
    run = fp.track(PANDA, THROUGH, scheme, READY, task=task, bounds=[CLEARANCE], hold=0.5)
    assert run.clearance is not None
    assert run.status.code in (fp.Status.BLOCKED, fp.Status.STALLED)
    assert run.clearance.shape == run.t.shape
    assert run.clearance.min() >= CLEARANCE.margin - 1e-9
    assert run.clearance.min() <= 2 * CLEARANCE.margin  # The arm was near a shape.
    limits = run.limits
    assert np.all((limits.lower - 1e-9 <= run.q) & (run.q <= limits.upper + 1e-9))
    assert np.all(np.abs(run.qd) <= limits.velocity + 1e-9)
    assert np.all(np.abs(run.qdd) <= limits.acceleration + 1e-6)
    coal = Coal(PANDA, CLEARANCE)
    assert min(coal.distances(q).min() for q in run.q[::20]) >= CLEARANCE.margin - 1e-9

    free = fp.track(PANDA, THROUGH, scheme, READY, task=task, hold=0.5)
    nearest = [CLEARANCE.nearest(PANDA, q) for q in free.q[::20]]
    assert min(each.distance for each in nearest if each is not None) < 0
    assert free.clearance is None


def test_a_planar_arm_stops_before_a_post() -> None:
    post = fp.Capsule(0, [0.5, 0.5, -1], [0.5, 0.5, 1], 0.1, "post")
    clearance = fp.Clearance(LINKS, [post])
    limits = fp.JointLimits(lower=[-3] * 3, upper=[3] * 3, velocity=[2] * 3, acceleration=[10] * 3, jerk=[500] * 3)
    run = fp.track(
        PLANAR, fp.Line([-0.5, 0.8], 1.5), fp.MAN(), [0, 0.3, 0.3], limits=limits, bounds=[clearance], hold=1.0
    )
    assert run.clearance is not None
    assert clearance.margin - 1e-9 <= run.clearance.min() <= 2 * clearance.margin


@pytest.mark.parametrize("scheme", SCHEMES, ids=["velocity", "acceleration"])
def test_the_tip_keeps_its_bound_on_speed(scheme: fp.Scheme) -> None:
    slow = fp.TaskBounds(fp.PositionTask(), velocity=0.1)
    fast, run = (
        fp.track(PANDA, fp.Line([0.1, 0.2, -0.2], 1.0), scheme, READY, bounds=each, hold=4.0) for each in ((), (slow,))
    )
    speeds = [
        np.linalg.norm(np.diff([PANDA.forward(q)[:3, 3] for q in each.q], axis=0), axis=1).max() / 1e-3
        for each in (fast, run)
    ]
    assert speeds[0] > 0.4
    assert 0.099 <= speeds[1] <= 0.101
    assert run.status.code == fp.Status.SLOWED
    np.testing.assert_allclose(PANDA.forward(run.q[-1])[:3, 3], PANDA.forward(fast.q[-1])[:3, 3], atol=1e-3)


def test_distances_of_a_run_equal_those_of_its_samples() -> None:
    run = fp.track(PANDA, THROUGH, SCHEMES[1], READY, bounds=[CLEARANCE])
    assert run.clearance is not None
    nearest = [CLEARANCE.nearest(PANDA, q) for q in run.q]
    assert [each.distance for each in nearest if each is not None] == run.clearance.tolist()


@pytest.mark.parametrize("scheme", SCHEMES, ids=["velocity", "acceleration"])
def test_a_clearance_without_pairs_changes_nothing(scheme: fp.Scheme) -> None:
    nothing = fp.Clearance(CAPSULES[:2])
    assert nothing.pairs(PANDA) == []
    free, same = (fp.track(PANDA, THROUGH, scheme, READY, bounds=each) for each in ((), [nothing]))
    assert free.q.tobytes() == same.q.tobytes()
    assert free.qdd.tobytes() == same.qdd.tobytes()
    assert np.all(np.isposinf(same.clearance))


def test_a_tick_has_the_nearest_pair_at_its_start() -> None:
    tracker = fp.Tracker(PANDA, SCHEMES[1], READY, bounds=[CLEARANCE])
    follower = tracker.follow(THROUGH)
    for _ in range(1500):
        expected = CLEARANCE.nearest(PANDA, tracker.q)
        tick = tracker.tick(follower)
        assert repr(tick.nearest) == repr(expected)
    assert tick.nearest.pair == ("hand", "table")
    assert repr(tick.nearest) == f"<Nearest: hand and table, {tick.nearest.distance:.6g} m apart>"
    expected = CLEARANCE.nearest(PANDA, READY)
    assert repr(tracker.resolve_measured(READY, np.zeros(7), tracker.tip).nearest) == repr(expected)
    assert repr(fp.Tracker(PANDA, fp.MAN(), READY, bounds=[CLEARANCE]).tick([0.4, 0, 0.5]).nearest) == repr(expected)
    assert fp.Tracker(PANDA, fp.MAN(), READY).tick([0.4, 0, 0.5]).nearest is None


def test_an_obstacle_moves() -> None:
    tracker = fp.Tracker(PANDA, SCHEMES[1], READY, bounds=[CLEARANCE])
    for height in (0.1, 0.2, -0.5):
        moved = fp.HalfSpace([0, 0, 1], height)
        tracker.move("table", moved)
        there = fp.Clearance(CAPSULES, [fp.HalfSpace([0, 0, 1], height, name="table")], allowed=CLEARANCE.allowed)
        expected = there.nearest(PANDA, tracker.q)
        assert repr(tracker.tick(tracker.tip).nearest) == repr(expected)
    assert CLEARANCE.obstacles == (TABLE,)


def test_an_arm_avoids_an_obstacle_that_is_expected_to_continue() -> None:
    """If the table is expected to approach, the arm stops farther away."""

    def final_distance(speed: float) -> float:
        tracker = fp.Tracker(PANDA, SCHEMES[1], READY, bounds=[fp.Clearance(CAPSULES[5:], [TABLE])])
        tracker.move("table", TABLE, velocity=(0, 0, speed))
        for _ in range(3500):
            tick = tracker.tick([0.4, 0.1, -0.2])
        return float(tick.nearest.distance)

    assert final_distance(0.0) <= 1.5 * CLEARANCE.margin < 2 * CLEARANCE.margin <= final_distance(0.3)


# Run files


def test_a_run_is_loaded_and_replayed(tmp_path: Path) -> None:
    wall = fp.Cuboid(turned(np.random.default_rng(1), 0.0), [0.1, 0.1, 0.1], name="box")
    far = fp.Capsule(0, [2, 0, 0], [2, 0, 1], 0.1, "post")
    clearance = fp.Clearance(CAPSULES[2:], [TABLE, wall, far], margin=1 / 300, allowed=[("box", "upper arm")])
    run = fp.track(PANDA, THROUGH, SCHEMES[1], READY, bounds=[clearance])
    run.save(tmp_path / "run.npz")
    back = fp.load(tmp_path / "run.npz")
    assert run.clearance is not None
    assert back.clearance is not None
    assert back == run
    assert back.options == run.options
    assert back.options["bounds"] == (clearance,)
    assert back.clearance.tobytes() == run.clearance.tobytes()
    assert back.status.code is run.status.code
    assert back.replay() == run


# Errors

BALL = fp.Capsule(0, [0, 0, 0], [0, 0, 0], 0.1, "ball")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fp.HalfSpace([0, 0, 0], 1), "normal is zero: must be a nonzero vector"),
        (lambda: fp.HalfSpace([0, 0], 1), "normal = [0, 0]: must be real numbers of shape (3,)"),
        (lambda: fp.HalfSpace([0, 0, 1], np.inf), "offset = inf: must be finite"),
        (lambda: fp.Cuboid(2 * np.eye(4), [1, 1, 1]), "pose: must be a homogeneous matrix, with (0, 0, 0, 1) as"),
        (lambda: fp.Cuboid(np.diag([1, 1, -1, 1]), [1, 1, 1]), "pose.R: must be a rotation matrix"),
        (lambda: fp.Cuboid(np.eye(4), [1, 1, -1]), "half[2] = -1: must be finite and not negative"),
        (lambda: fp.Clearance(BALL), "capsules = Capsule(link=0, "),
        (
            lambda: fp.Clearance([TABLE]),
            "capsules[0] = HalfSpace(normal=[0, 0, 1], offset=0.05, name='table'): must be",
        ),
        (lambda: fp.Clearance([], [BALL, 3]), "obstacles[1] = 3: must be a HalfSpace, a Cuboid or a Capsule"),
        (lambda: fp.Clearance([], [TABLE, TABLE]), "obstacles[1].name = 'table': must be unique"),
        (lambda: fp.Clearance([], LINKS), "obstacles[0].link = 1: must be 0, the base"),
        (lambda: fp.Clearance([], margin=-1), "margin = -1: must be finite and not negative"),
        (lambda: fp.Clearance([], allowed=[("a",)]), "allowed[0] = ('a',): must be two names"),
        (
            lambda: fp.Clearance(CAPSULES, allowed=[("base", "wrsit")]),
            "allowed[0] has 'wrsit': must be names of shapes; did you mean 'wrist'?",
        ),
        (lambda: CLEARANCE.pairs(PLANAR), "capsules[3].link = 4: must be a link of the arm, from 0 to 3"),
        (lambda: CLEARANCE.nearest(PANDA, [0, 0]), "q has 2 entries: must have 7, one per joint"),
        (
            lambda: fp.Tracker(PANDA, fp.MAN(), READY, bounds=[3]),
            "bounds: must be a Clearance, TaskBounds and TorqueBounds in a sequence",
        ),
        (
            lambda: fp.track(PANDA, THROUGH, fp.MAN(), READY, bounds=[fp.Clearance(CAPSULES, margin=0.3)]),
            "q0: hand and upper arm are 0.2372 m apart, closer than margin=0.3; give margin=0.2372 or ",
        ),
        (lambda: tracker().move("tabel", TABLE), "name = 'tabel': must be one of the obstacles: table"),
        (lambda: tracker().move("table", BALL), "shape: must be a HalfSpace, like obstacle 'table'"),
        (lambda: tracker().move("table", TABLE, (0, 0, np.nan)), "velocity[2] = nan: must be finite"),
        (lambda: tracker(BALL).move("ball", LINKS[0]), "shape.link = 1: must be 0, the base"),
        (lambda: fp.Tracker(PANDA, fp.MAN(), READY).move("x", TABLE), "name = 'x': must be one of the obstacles: none"),
    ],
)
def test_invalid_arguments_are_rejected(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(fp.ParameterError) as caught:
        make()
    assert str(caught.value).startswith(message)


def tracker(*obstacles: Any) -> fp.Tracker:
    return fp.Tracker(PANDA, fp.MAN(), READY, bounds=[fp.Clearance(CAPSULES[3:], obstacles or [TABLE])])


# From files

LINK = '<collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.04" length="0.2"/></geometry></collision>'
AXES = ["0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1"]
TABLE_FILE = """[clearance]
margin = 0.02
[[clearance.obstacles]]
kind = "half_space"
normal = [0, 0, 1]
offset = 0.2
name = "table"
"""
URDF = ("arm.urdf", "--tip", "l7")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with an arm of seven joints, and a job with a table. The links l0 and l2 may touch."""
    links = "".join(f'<link name="l{i}">{LINK}</link>' for i in range(8))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/><origin xyz="0 0 0.2"/>'
        f'<axis xyz="{axis}"/><limit lower="-2.9" upper="2.9" velocity="2" effort="1"/></joint>'
        for i, axis in enumerate(AXES, 1)
    )
    (tmp_path / "arm.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    disabled = "".join(
        f'<disable_collisions link1="l0" link2="{name}" reason="Never"/>' for name in ("l2", "l1", "camera")
    )
    (tmp_path / "arm.srdf").write_text(f'<robot name="r">{disabled}</robot>')
    (tmp_path / "table.toml").write_text(TABLE_FILE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_from_urdf(folder: Path) -> None:
    arm = fp.SerialArm.from_urdf("arm.urdf", "l7")
    clearance = fp.Clearance.from_urdf("arm.urdf", "l7", srdf="arm.srdf", obstacles=[TABLE], margin=0.02, per_link=1)
    assert [(each.link, each.name) for each in clearance.capsules] == [(i, f"l{i}") for i in range(8)]
    assert clearance.allowed == (("l0", "l1"), ("l0", "l2"))
    assert (clearance.margin, clearance.obstacles) == (0.02, (TABLE,))
    pairs = [(f"l{i}", f"l{j}") for i in range(8) for j in range(i - 1) if (i, j) != (2, 0)]
    assert {*clearance.pairs(arm), *clearance.excluded_pairs(arm)} == {
        *pairs,
        *((f"l{i}", "table") for i in range(1, 8)),
    }
    more = fp.Clearance.from_urdf("arm.urdf", "l7", srdf="arm.srdf", allowed=[("l5", "l7")], per_link=1)
    assert more.allowed == (("l0", "l1"), ("l0", "l2"), ("l5", "l7"))
    upper = fp.Clearance.from_urdf("arm.urdf", "l7", "l3", per_link=1)
    assert {each.link for each in upper.capsules} == set(range(5))


def call(*arguments: str) -> Any:
    pytest.importorskip("click")
    pytest.importorskip("tomlkit")
    from click.testing import CliRunner

    from fpbm_cpp.cli import command

    return CliRunner().invoke(command, [*arguments])


MOTION = (*URDF, "--path", "line", "--displacement", "0,0,-0.5", "--duration", "1", "--limit-acceleration", "10")
FILES = ("--per-link", "1", "--clearance", "arm.urdf", "--srdf", "arm.srdf")


def test_command_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda self, file, **_: file.write(b"\x89PNG"))
    result = call("track", *MOTION, *FILES, "--job", "table.toml", "--out", "out/here")
    assert result.exit_code == 0, result.output
    run = fp.load("out/here/run.npz")
    assert run.clearance is not None
    assert run.options["bounds"][0] == fp.Clearance.from_urdf(
        "arm.urdf",
        "l7",
        srdf="arm.srdf",
        obstacles=[fp.HalfSpace([0, 0, 1], 0.2, name="table")],
        margin=0.02,
        per_link=1,
    )
    assert 0.02 - 1e-9 <= run.clearance.min() < 0.05
    assert f"least clearance {run.clearance.min():.4g} m at" in " ".join(result.output.split())
    # The job repeats all options, in any folder.
    monkeypatch.chdir("out")
    result = call("track", "--job", "here/job.toml", "--out", "again")
    assert result.exit_code == 0, result.output
    assert fp.load("again/run.npz") == run
    assert call("compare", "--job", "here/job.toml", "--schemes", "mvn,fpbm").exit_code == 0
    result = call("track", "--job", "here/job.toml", "--margin", "0.03", "--out", "wider")
    assert fp.load("wider/run.npz").options["bounds"][0].margin == 0.03


def test_servo_has_the_same_clearance(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fpbm_cpp import viewer

    shown: list[dict[str, Any]] = []

    class Shown:
        def __init__(self, *what: Any, **how: Any) -> None:
            shown.append(how)

        def wait(self) -> None:
            pass

    monkeypatch.setitem(vars(viewer), "Servo", Shown)
    limits = ("--limit-acceleration", "10")
    result = call("servo", *URDF, *limits, *FILES, "--job", "table.toml", "--no-browser")
    assert result.exit_code == 0, result.output
    assert shown[0]["bounds"][0] == fp.Clearance.from_urdf(
        "arm.urdf",
        "l7",
        srdf="arm.srdf",
        obstacles=[fp.HalfSpace([0, 0, 1], 0.2, name="table")],
        margin=0.02,
        per_link=1,
    )


def test_capsules_in_a_job(folder: Path) -> None:
    text = TABLE_FILE.replace("offset = 0.2", "offset = 0.1") + (
        '[[clearance.capsules]]\nkind = "capsule"\nlink = 7\na = [0, 0, 0]\nb = [0, 0, 0.2]\nradius = 0.05\n'
    )
    Path("hand.toml").write_text(text)
    result = call("track", "panda", "--job", "hand.toml", "--path", "line", "--displacement", "0,0,-0.5")
    assert result.exit_code == 0, result.output
    assert "least clearance" in result.output


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            [*URDF, "--clearance", "arm.urdf"],
            "--limit-acceleration: is missing, and this arm has no acceleration bounds",
        ),
        ([*MOTION, "--clearance", "none.urdf"], "cannot read none.urdf: No such file or directory"),
        ([*MOTION, *FILES[:5], "none.srdf"], "cannot read none.srdf: No such file or directory"),
        ([*MOTION, *FILES[:5], "table.toml"], "clearance: table.toml: line 1: invalid XML"),
        ([*MOTION, *FILES[4:]], "--clearance: is missing"),
        ([*MOTION, "--job", "table.toml"], "--clearance: is missing"),
        ([*MOTION, *FILES, "--margin", "-1"], "--margin = -1: must be finite and not negative"),
        ([*MOTION, *FILES, "--margin", "x"], "--margin = 'x': must be a number"),
        ([*MOTION, *FILES, "--per-link", "0"], "--per-link = 0: must be a whole number, at least 1"),
        ([*MOTION, *FILES, "--margin", "0.5"], "--q0: l"),
        (["panda", "--clearance", "arm.urdf"], "clearance.tip = '': must be a link; branches end in 'l7'"),
    ],
)
def test_command_errors_have_one_line(folder: Path, arguments: list[str], line: str) -> None:
    result = call("track", *arguments)
    assert result.exit_code == 1
    assert result.stderr.startswith(f"Error: {line}")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize("name", ["sweep", "tune"])
def test_commands_without_clearance_reject_it(folder: Path, name: str) -> None:
    result = call(name, "panda", "--job", "table.toml")
    assert result.exit_code == 1
    assert result.stderr == f"Error: {name} does not accept clearance: remove clearance, or use track\n"
