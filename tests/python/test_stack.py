"""Stacks of tasks from Python: references, bounds, and one level compared with the tracker of its task."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3
READY = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
PLANAR_LIMITS = fp.JointLimits(lower=[-3.0] * 4, upper=[3.0] * 4, velocity=[2.0] * 4, acceleration=[10.0] * 4)


@pytest.fixture(scope="module")
def panda():
    return fp.SerialArm.preset("panda")


@pytest.fixture
def balanced():
    return fp.Balanced(0.6, [1, 2, 3, 4, 3, 2, 1], null_damping=2)


def cup(**posture):
    """Axis, place, height of the elbow, posture."""
    return fp.Stack(
        fp.AxisTask(name="upright"),
        fp.PositionTask(name="place"),
        fp.PositionTask("panda_joint4", rows=("z",), name="elbow"),
        fp.PostureTask(k1=4, k2=4, **posture),
    )


def motion(tracker, references, ticks):
    """Commands of some ticks, the start first, and the last tick."""
    q, tick = [tracker.q], None
    for _ in range(ticks):
        tick = tracker.tick(references)
        q.append(tick.q)
    return np.array(q), tick


def excess(limits, q, qd0=0.0):
    """Largest excess over the bounds on positions, velocities and accelerations, by differences of q."""
    qd = np.diff(q, axis=0) / DT
    qdd = np.diff(qd, axis=0) / DT
    return max(
        (limits.lower - q).max(),
        (q - limits.upper).max(),
        (np.abs(qd) - limits.velocity).max(),
        (np.abs(qdd) - limits.acceleration).max() * 1e-3,  # Round-off error of q / dt^2.
    )


@pytest.mark.parametrize("name", ["panda", "ur5e", "iiwa14"])
@pytest.mark.parametrize("task", ["position", "pose"])
def test_one_level_moves_as_the_tracker_of_that_task(name, task):
    arm = fp.SerialArm.preset(name)
    q0 = (arm.limits.lower.clip(-2) + arm.limits.upper.clip(max=2)) / 2 + 0.2
    weights = np.arange(1.0, 1.0 + arm.dof)
    kind = {"position": fp.PositionTask, "pose": fp.PoseTask}[task]
    pairs = [
        (fp.FPBM(0.6, weights, 10, 25, null_damping=2), fp.Balanced(0.6, weights, null_damping=2)),
        (fp.WMVN(weights, k=5), fp.WMVN(weights)),
    ]
    for single, first in pairs:
        expected = fp.Tracker(arm, single, q0, task=task)
        tracker = fp.Tracker(arm, first, q0, stack=fp.Stack(kind()))
        goal = np.array(expected.tip)
        point = goal[:3, 3] if task == "pose" else goal
        point += 0.2
        for _ in range(2000):
            tick, other = expected.tick(goal), tracker.tick({task: goal})
            assert np.abs(tick.q - other.q).max() < 1e-8
            assert tick.status == other.status
        assert tick.scales is None
        assert tick.errors is None
        assert other.scales.shape == (1,)
        assert np.abs(other.errors[task] - tick.error).max() < 1e-9


def test_a_cup_stays_upright(panda, balanced):
    tracker = fp.Tracker(panda, balanced, READY, stack=cup())
    goal = tracker.tip["place"] + [0.2, 0.3, -0.1]
    tilt = 0.0
    for _ in range(8000):
        tick = tracker.tick({"place": goal})
        tilt = max(tilt, np.abs(tick.errors["upright"]).max())
    assert tilt < 1e-5
    assert np.abs(tick.errors["place"]).max() < 1e-6
    assert set(tick.errors) == {"upright", "place", "elbow", "posture"}
    assert tick.error.shape == (3 + 3 + 3 + 7,)
    assert (tick.errors["elbow"][:2] == 0).all()
    np.testing.assert_allclose(tracker.frame("upright")[:3, 2], tracker.tip["upright"])
    np.testing.assert_allclose(tracker.frame("place"), panda.forward(tracker.q))
    np.testing.assert_allclose(tracker.tip["posture"], tracker.q)


def random_stack(rng, arm):
    """Two to four levels, some with two tasks."""
    frames = ["tip", *arm.joint_names[1:]]
    planar = isinstance(arm, fp.PlanarArm)

    def task(name):
        frame = str(rng.choice(frames))
        if planar:
            return fp.PositionTask(frame, rows=rng.choice(["x", "y"], rng.integers(1, 3), replace=False), name=name)
        kind = rng.integers(4)
        if kind == 0:
            return fp.PositionTask(frame, rows=("x", "y", "z")[: rng.integers(1, 4)], axes="frame", name=name)
        if kind == 1:
            return fp.OrientationTask(frame, rows=("rx", "ry"), axes="frame", name=name)
        return fp.AxisTask(frame, rng.normal(size=3), name=name) if kind == 2 else fp.PositionTask(frame, name=name)

    levels = [[task(f"{k}.{i}") for i in range(rng.integers(1, 3))] for k in range(rng.integers(1, 4))]
    if planar:
        levels = [level[:1] for level in levels]
    return fp.Stack(*levels, fp.PostureTask())


@pytest.mark.parametrize("name", ["panda", "ur5e", "gen3", "planar"])
@pytest.mark.parametrize("level", ["acceleration", "velocity"])
def test_keeps_every_bound_and_stops(name, level):
    rng = np.random.default_rng(sum(map(ord, name + level)))
    arm = fp.PlanarArm([0.4, 0.3, 0.3, 0.2]) if name == "planar" else fp.SerialArm.preset(name)
    limits = PLANAR_LIMITS if name == "planar" else arm.limits
    scheme = fp.Balanced(0.6, np.ones(arm.dof)) if level == "acceleration" else fp.MVN()
    for _ in range(3):
        middle = (limits.lower.clip(-2) + limits.upper.clip(max=2)) / 2
        stack = random_stack(rng, arm)
        tracker = fp.Tracker(arm, scheme, middle + rng.uniform(-0.3, 0.3, arm.dof), stack=stack, limits=limits)
        q = [tracker.q]
        for _ in range(4):
            references = {}
            for each, x in tracker.tip.items():
                task = next(task for task in stack.tasks if task.name == each)
                if isinstance(task, fp.PositionTask):
                    references[each] = x + rng.uniform(-0.8, 0.8, 3) * (1, 1, name != "planar")
                elif isinstance(task, fp.AxisTask):
                    references[each] = rng.normal(size=3)
                elif isinstance(task, fp.OrientationTask):
                    references[each] = x @ fp.rotation(rng.uniform(-1, 1, 3))
            q.extend(motion(tracker, references, 500)[0][1:])
            if len(stack.levels) > 1:
                tracker.enable(len(stack.levels) - 1, bool(rng.integers(2)))
        tracker.stop()
        rest, tick = motion(tracker, {}, 2000)
        q.extend(rest[1:])
        assert excess(limits, np.array(q)) < 1e-9
        assert np.abs(tick.qd).max() < 1e-9


def test_a_slow_approach_does_not_keep_lower_tasks_moving():
    """While the first level settles by its integral, a second level with an unreachable target stops."""
    arm = fp.PlanarArm([0.4, 0.3, 0.3, 0.2])
    stack = fp.Stack(
        fp.PositionTask("joint_3", rows=("x", "y"), name="elbow"),
        fp.PositionTask("joint_4", rows=("y",), name="wrist"),
        fp.PostureTask(),
    )
    limits = replace(PLANAR_LIMITS, jerk=[600.0] * 4)
    scheme = fp.Balanced(0.6, np.ones(4))
    tracker = fp.Tracker(arm, scheme, [0.26, -0.29, 0.23, -0.07], stack=stack, limits=limits, integral_gain=1.0)
    _, tick = motion(tracker, {"elbow": [0.26, 0.15, 0.0], "wrist": [0.71, 0.81, 0.0]}, 40000)
    assert np.abs(tick.qd).max() < 1e-3
    assert tick.scales[0] == 1
    assert tick.scales[1] == 0


@pytest.mark.parametrize("name", ["panda", "gen3"])
@pytest.mark.parametrize("k1", [10, 40])
def test_a_lower_level_does_not_disturb_a_higher_one(name, k1):
    """The motion of the first level is equal if the lower level meets limits, holds its target, or is missing (RK4)."""
    arm = fp.SerialArm.preset(name)
    q0 = {"panda": READY, "gen3": [0.0, 0.3, 0.0, 1.6, 0.0, 1.2, 0.0]}[name]
    scheme = fp.Balanced(0.6, [1, 2, 3, 4, 3, 2, 1], null_damping=2)
    first = fp.AxisTask(name="axis", k1=k1, k2=k1**2 / 4)
    alone = fp.Tracker(arm, scheme, q0, stack=fp.Stack(first))
    held, moved = (
        fp.Tracker(arm, scheme, q0, stack=fp.Stack(first, fp.PositionTask()), keep_first_level=True) for _ in range(2)
    )
    axis = np.add(alone.tip["axis"], [0.05, 0.03, 0.0])
    hold = held.tip["position"]
    slowed = 0
    for _ in range(3000):
        error = alone.tick({"axis": axis}).errors["axis"]
        beside_held = held.tick({"axis": axis, "position": hold}).errors["axis"]
        tick = moved.tick({"axis": axis, "position": moved.tip["position"] + [0.3, 0.5, 0.2]})
        assert np.abs(tick.errors["axis"] - beside_held).max() < 1e-6
        assert np.abs(tick.errors["axis"] - error).max() < 1e-6
        slowed += tick.scales[1] < 1
    assert slowed > 50


def test_tasks_follow_paths_and_filters(panda, balanced):
    stack = fp.Stack(fp.PositionTask(name="tip", k1=20, k2=100), fp.PositionTask("panda_joint4", name="elbow"))
    tracker = fp.Tracker(panda, balanced, READY, stack=stack)
    follower = tracker.follow(fp.Circle(0.05, 3.0).in_plane("yz"), task="tip")
    elbow = tracker.tip["elbow"]
    target = fp.TargetFilter(elbow, velocity=0.2, acceleration=1.0, jerk=20.0)
    target.push(np.add(elbow, [0.0, 0.02, 0.0]))
    worst = 0.0
    for _ in range(3200):
        tick = tracker.tick({"tip": follower, "elbow": target})
        worst = max(worst, np.abs(tick.errors["tip"]).max())
    assert follower.done
    assert worst < 1e-5
    assert np.abs(tracker.tip["elbow"] - elbow - [0.0, 0.02, 0.0]).max() < 1e-3
    tracker.stop()
    with pytest.raises(fp.ParameterError, match="several tasks follow paths"):
        tracker.follow(fp.Circle(0.05, 3.0).in_plane("yz"))


def test_a_task_without_a_reference_keeps_its_target(panda, balanced):
    tracker = fp.Tracker(panda, balanced, READY, stack=cup(q=np.add(READY, 0.1)))
    goal = tracker.tip["place"] + [0.0, 0.1, 0.0]
    tracker.tick({"place": (goal, [0.1, 0.0, 0.0], [0.0, 0.0, 0.0])})
    _, tick = motion(tracker, {}, 6000)
    np.testing.assert_allclose(tracker.tip["place"], goal, atol=1e-6)
    np.testing.assert_allclose(tick.errors["posture"] + tracker.q, np.add(READY, 0.1), atol=1e-3)


def test_a_free_rotation(panda, balanced):
    welding = fp.PoseTask(rows=("x", "y", "z", "rx", "ry"), axes="frame", name="torch")
    tracker = fp.Tracker(
        panda, balanced, READY, stack=fp.Stack(welding, fp.PostureTask(np.add(READY, [0] * 6 + [0.5])))
    )
    start = tracker.frame("torch")
    _, tick = motion(tracker, {}, 6000)
    reached = tracker.frame("torch")
    assert np.abs(reached[:3, 2:] - start[:3, 2:]).max() < 1e-6
    assert np.abs(reached[:3, 0] - start[:3, 0]).max() > 0.2
    assert tick.status == fp.Status.OK


def test_offsets_and_joints(panda, balanced):
    offset = np.eye(4)
    offset[:3, 3] = 0.0, 0.1, 0.2
    stack = fp.Stack(
        fp.PoseTask(name="tool", offset=offset), fp.PostureTask([0.3], joints=("panda_joint1",), name="shoulder")
    )
    tracker = fp.Tracker(panda, balanced, READY, stack=stack)
    np.testing.assert_allclose(tracker.frame("tool"), panda.forward(READY) @ offset, atol=1e-12)
    assert tracker.tip["shoulder"].shape == (1,)
    motion(tracker, {}, 6000)
    np.testing.assert_allclose(tracker.frame("tool"), panda.forward(READY) @ offset, atol=1e-6)
    assert tracker.q[0] > 0.05


def test_measured_states_are_resolved(panda, balanced):
    tracker = fp.Tracker(panda, balanced, READY, stack=cup(), measured_delay=0)
    goal = tracker.tip["place"] + [0.1, 0.1, -0.1]
    q, qd = np.array(READY), np.zeros(7)
    for _ in range(6000):
        tick = tracker.resolve_measured(q, qd, {"place": goal})
        q, qd = q + DT * qd + DT**2 / 2 * tick.qdd, qd + DT * tick.qdd
    assert np.abs(tick.errors["place"]).max() < 1e-6
    assert np.abs(tick.errors["upright"]).max() < 1e-3
    np.testing.assert_array_equal(tracker.q, READY)
    with pytest.raises(ValueError, match="velocity level"):
        fp.Tracker(panda, fp.MVN(), READY, stack=cup()).resolve_measured(q, qd, {})


def test_the_margin_to_a_wall_is_kept(panda, balanced):
    wall = fp.HalfSpace((0, -1, 0), -0.25, name="wall")
    clearance = fp.Clearance([fp.Capsule(7, (0, 0, 0), (0, 0, 0.1), 0.05)], [wall], margin=0.01)
    tracker = fp.Tracker(panda, balanced, READY, stack=cup(), bounds=[clearance])
    goal = tracker.tip["place"] + [0.0, 0.6, 0.0]
    nearest = np.inf
    for _ in range(9000):
        tick = tracker.tick({"place": goal})
        nearest = min(nearest, tick.nearest.distance)
    assert 0.01 - 1e-9 < nearest < 0.02
    assert np.abs(tick.errors["upright"]).max() < 1e-4
    assert np.abs(tick.qd).max() < 1e-3


def test_stacks_are_values():
    stack = cup(q=READY)
    assert pickle.loads(pickle.dumps(stack)) == stack == eval(repr(stack), vars(fp))
    assert hash(stack) == hash(cup(q=READY))
    assert stack != fp.Stack(fp.PositionTask())
    assert [task.name for task in stack.tasks] == ["upright", "place", "elbow", "posture"]
    assert replace(fp.PoseTask(), name="grasp").name == "grasp"
    assert fp.AxisTask(axis="y") == fp.AxisTask(axis=(0, 1, 0))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fp.Stack(), "must have at least one level"),
        (lambda: fp.Stack([]), "levels.0. is empty"),
        (lambda: fp.Stack(3), "must be a task"),
        (lambda: fp.Stack(fp.PoseTask(), fp.PoseTask()), "a second task with the name 'pose'"),
        (lambda: fp.PositionTask(rows=("x", "q")), "rows = 'q': must be one of"),
        (lambda: fp.PositionTask(rows="xy"), "must be some of"),
        (lambda: fp.PositionTask(rows=("x", "x")), "twice"),
        (lambda: fp.PoseTask(axes="tool"), "axes = 'tool'"),
        (lambda: fp.PositionTask(k2=-1), "k2 = -1"),
        (lambda: fp.AxisTask(axis=(0, 0, 0)), "axis = 0"),
        (lambda: fp.AxisTask(axis="up"), "axis = 'up': must be one of x, y, z"),
        (lambda: fp.PostureTask(joints=()), "joints"),
        (lambda: fp.PostureTask(joints=2), "joints = 2: must be names of joints, each once"),
        (lambda: fp.PostureTask(joints=[0, 2]), "must be names of joints"),
        (lambda: fp.PostureTask(joints=[["a"]]), "must be names of joints"),
    ],
)
def test_invalid_tasks_are_rejected(make, message):
    with pytest.raises(fp.ParameterError, match=message):
        make()


@pytest.mark.parametrize(
    ("stack", "message"),
    [
        (3, "stack: must be a Stack"),
        (
            fp.Stack(fp.PoseTask("elbow")),
            "frame = 'elbow': must be a frame, or the joint of a link: 'base', 'tip', 'panda_joint1'",
        ),
        (
            fp.Stack(fp.PostureTask(joints=("elbow",))),
            "joints has 'elbow': must be joints of the robot: panda_joint1, panda_joint2",
        ),
        (fp.Stack(fp.PostureTask([1, 2])), "posture"),
        (fp.Stack([fp.PoseTask(), fp.PositionTask()]), "rows of level.0. = 9"),
        (fp.Stack([fp.AxisTask(name=n) for n in "abc"]), "more than two tasks of frames"),
        (fp.Stack([fp.PostureTask(name=n) for n in "ab"]), "more than one PostureTask"),
        (fp.Stack(*(fp.PostureTask(name=n) for n in "abcde")), "number of levels = 5"),
    ],
)
def test_invalid_stacks_are_rejected(panda, balanced, stack, message):
    with pytest.raises(fp.ParameterError, match=message):
        fp.Tracker(panda, balanced, READY, stack=stack)


def test_invalid_schemes_are_rejected(panda):
    weights = np.ones(7)
    for scheme, message in [
        (fp.FPBM(0.6, weights, 10, 25), "k1 = 10: must be 0: give gains to the tasks of the stack"),
        (fp.MVN(k=2), "k = 2: must be 0"),
        (fp.Balanced(0.6, weights, manipulability_gain=1), "must not be given with a stack"),
    ]:
        with pytest.raises(fp.ParameterError, match=message):
            fp.Tracker(panda, scheme, READY, stack=cup())


def test_gains_are_checked(panda, balanced):
    stack = fp.Stack(fp.PositionTask(k1=1, k2=2), fp.PostureTask())
    fp.Tracker(panda, balanced, READY, stack=stack, integral_gain=1)
    for wrong in ({"stack": stack, "integral_gain": 3}, {"stack": fp.Stack(fp.PositionTask(k1=1e4))}):
        with pytest.raises(fp.ParameterError, match=r"gain|k1"):
            fp.Tracker(panda, balanced, READY, **wrong)


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_the_largest_gains_that_are_accepted_damp_errors(panda, level):
    """With the largest gain on its level, the tip stays at rest while a lower level meets its limits."""
    largest = 2.785 / DT
    scheme = fp.WMVN(np.ones(7)) if level == "velocity" else fp.Balanced(0.6, np.ones(7), null_damping=2)
    last = []
    for gain in (0.95 * largest, 1.05 * largest):
        tip = fp.PositionTask(k1=gain, k2=0, k=gain)
        stack = fp.Stack(tip, fp.PostureTask(k1=100, k2=0, k=100))
        if gain > largest:
            with pytest.raises(fp.ParameterError, match=r"k1? = 2924.25: must be at most 2785"):
                fp.Tracker(panda, scheme, READY, stack=stack)
            continue
        tracker = fp.Tracker(panda, scheme, READY, stack=stack)
        held = tracker.tip["position"]
        for i in range(3000):
            swing = 2.0 * np.cos(40 * i * DT) * np.array([1, -1, 1, -1, 1, -1, 1])
            tick = tracker.tick({"position": (held, np.zeros(3)), "posture": (tracker.q, swing)})
            last.append(np.linalg.norm(panda.jacobian(tick.q) @ tick.qd))
        assert tick.saturated.any() or tick.scales[1] < 1
    assert max(last[-1000:]) < 1e-4


def test_invalid_references_have_no_effect(panda, balanced):
    tracker = fp.Tracker(panda, balanced, READY, stack=cup())
    place = tracker.tip["place"]
    for references, message in [
        ({"cup": place}, "task = 'cup': must be a task of the stack: 'upright'"),
        ({"place": place[:2]}, "place has 2 entries"),
        ({"place": place * np.nan}, r"place\[0\] = nan"),
        ({"elbow": place + 1, "upright": (0, 0, 0)}, "upright is zero"),
        ({"place": (place, [1, 2])}, "place's xd has 2 entries: must have 3$"),
        ({3: place}, "references: the keys of the dictionary must be task names"),
        ({"upright": fp.TargetFilter(place, velocity=1, acceleration=1, jerk=1)}, "another task than 'upright'"),
        ({"place": fp.TargetFilter(place, velocity=1, acceleration=1, jerk=1, dt=2e-3)}, "filter's dt"),
        (place, "must be given a dictionary"),
    ]:
        with pytest.raises(fp.ParameterError, match=message):
            tracker.tick(references)
    _, tick = motion(tracker, {}, 200)
    np.testing.assert_allclose(tick.q, READY, atol=1e-9)
    for wrong in (lambda: tracker.enable(0, False), lambda: tracker.enable(4, True), lambda: tracker.frame("posture")):
        with pytest.raises(fp.ParameterError):
            wrong()
    single = fp.Tracker(panda, fp.MVN(), READY)
    for wrong in (lambda: single.tick({}), lambda: single.enable(1, True), lambda: single.frame("tip")):
        with pytest.raises(fp.ParameterError, match="has one task"):
            wrong()


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_levels_are_reordered(panda, level):
    """Of two conflicting tasks, the task on the higher level is done. Reordering keeps all bounds, also on jerk."""
    scheme = fp.WMVN(np.ones(7)) if level == "velocity" else fp.Balanced(0.6, np.ones(7), null_damping=2)
    stack = fp.Stack(fp.PositionTask(name="near"), fp.PositionTask(name="far"), fp.PostureTask(READY))
    tracker = fp.Tracker(panda, scheme, READY, stack=stack)
    tip = tracker.tip["near"]
    goals = {"near": tip + np.array([0, 0.1, 0]), "far": tip + np.array([0, 0.2, 0.1])}
    q = [tracker.q]
    tracker.tick(goals)
    q.append(tracker.q)
    for order, first in (([1, 0, 2], "far"), ([1, 2, 0], "near"), ([0, 1, 2], "near"), ([2, 1, 0], "far")):
        tracker.reorder(order)
        q += [tracker.tick({}).q for _ in range(3000)]
        tick = tracker.tick({})
        q.append(tick.q)
        assert np.linalg.norm(tick.errors[first]) < 1e-5, first
        assert np.linalg.norm(tick.errors["near" if first == "far" else "far"]) > 0.1
    assert excess(panda.limits, np.array(q)) < 1e-9
    jerk = np.diff(np.array(q), 3, axis=0) / DT**3
    assert (np.abs(jerk) - panda.limits.jerk).max() < 1e-3 * panda.limits.jerk.max()


def test_a_kept_stop_does_not_move_a_reordered_arm(panda, balanced):
    """The level that becomes the first during a stop is far from its target; the arm does not move."""
    stack = fp.Stack(fp.PositionTask(name="near"), fp.PositionTask("panda_joint4", name="far"))
    tracker = fp.Tracker(panda, balanced, READY, stack=stack, keep_first_level=True)
    goals = {"near": tracker.tip["near"], "far": tracker.tip["far"] + np.array([0, 0.3, 0.1])}
    for _ in range(200):
        tracker.tick(goals)
    tracker.stop()
    tracker.tick({})
    tracker.reorder([1, 0])
    before = tracker.tip["far"]
    for _ in range(6000):
        tick = tracker.tick({})
    assert np.abs(tick.qd).max() < 1e-6
    assert np.linalg.norm(tracker.tip["far"] - before) < 1e-2
    assert np.linalg.norm(tracker.tip["far"] - goals["far"]) > 0.2


def test_invalid_orders_have_no_effect(panda, balanced):
    tracker = fp.Tracker(panda, balanced, READY, stack=cup())
    tracker.enable(2, False)
    for order in ([0, 1], [0, 1, 2, 2], [0, 1, 2, 4], [-1, 0, 1, 2], [2, 0, 1, 3], []):
        with pytest.raises(fp.ParameterError, match="order: must have each level from 0 to 3 once, with an enabled"):
            tracker.reorder(order)
    same = fp.Tracker(panda, balanced, READY, stack=cup())
    same.enable(2, False)
    goal = {"place": tracker.tip["place"] + 0.1}
    for _ in range(100):
        np.testing.assert_array_equal(tracker.tick(goal).q, same.tick(goal).q)


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_an_arm_continues_after_a_wall(panda, level):
    """A wall for the elbow blocks the position task. Later, the target is reachable again. The cup stays upright."""
    scheme = fp.WMVN(np.ones(7)) if level == "velocity" else fp.Balanced(0.6, np.ones(7), null_damping=2)
    stack = fp.Stack(fp.AxisTask(x=[0, 0, -1], name="upright"), fp.PositionTask(name="place"), fp.PostureTask(READY))
    wall = fp.TaskBounds(fp.PositionTask("panda_joint4", rows=("y",)), upper=0.02)
    path = fp.Line([0.15, 0.4, 0.1], 2.5).then(fp.Line([-0.15, -0.8, -0.1], 3.5))
    run = fp.track(panda, path, scheme, READY, stack=stack, task="place", bounds=[wall], hold=2.0)
    place = np.linalg.norm(run.errors["place"], axis=1)
    assert place[2500] > 0.1
    assert place[-1] < 1e-3
    assert np.linalg.norm(run.errors["upright"][2500:], axis=1).max() < 1e-4
    assert excess(panda.limits, run.q) < 1e-9


@pytest.mark.parametrize(
    ("alone", "law"),
    [
        (fp.MVN(k=5), fp.MVN()),
        (fp.FPBM(0.6, np.arange(1, 8), 10, 25, null_damping=2), fp.Balanced(0.6, np.arange(1, 8), null_damping=2)),
    ],
    ids=["velocity", "acceleration"],
)
@pytest.mark.parametrize(
    ("radius", "dt", "status"),
    [(0.1, 0.01, fp.Status.OK), (0.1, 0.25, fp.Status.COARSE), (0.8, 0.01, fp.Status.TASK_LOST)],
    ids=["complete", "coarse", "unreachable"],
)
def test_a_simulated_stack_of_one_task_equals_the_task(panda, alone, law, radius, dt, status):
    """simulate() has one integrator: arrays and status are those of the task without a stack."""
    circle = fp.Circle(radius, 2.0).in_plane("yz")
    one = fp.simulate(panda, circle, alone, READY, dt=dt, hold=0.5, partial=True)
    many = fp.simulate(panda, circle, law, READY, dt=dt, hold=0.5, partial=True, stack=fp.Stack(fp.PositionTask()))
    assert many.status.code is one.status.code is status
    for name in ("t", "q", "qd", "qdd", "x", "x_ref", "error"):
        np.testing.assert_allclose(getattr(many, name), getattr(one, name), rtol=1e-6, atol=1e-9, err_msg=name)
    np.testing.assert_array_equal(many.task_errors, many.error)
    assert many.scale is many.scales is many.saturated is None
    assert many.replay() == many


@pytest.mark.parametrize(
    "law", [fp.MVN(), fp.Balanced(0.6, np.ones(7), null_damping=2)], ids=["velocity", "acceleration"]
)
@pytest.mark.parametrize("dt", [0.01, 0.001])
def test_rows_along_the_axes_of_a_rotating_frame_do_not_stop_the_motion(panda, law, dt):
    """If selected axes rotate, the free displacement moves into the rows, also with exact integration."""
    free = fp.Stack(fp.PositionTask(axes="frame", rows=("x", "y"), name="place"), fp.AxisTask(x=[1, 0, -1]))
    run = fp.simulate(panda, fp.Circle(0.08, 2.0).in_plane("yz"), law, READY, stack=free, task="place", dt=dt)
    assert run.status.code is fp.Status.OK
    turned = fp.Stack(fp.PoseTask(axes="frame", rows=("x", "y", "z", "rx", "ry")))
    path = fp.Circle(0.08, 2.0).in_plane("yz").with_rotation([0.3, 0.2, 1.2])
    assert fp.simulate(panda, path, law, READY, stack=turned, dt=dt).status.code is fp.Status.OK


def test_a_simulated_stack_holds_targets_and_ends_each_path_in_time(panda):
    """A task with a target converges to the target, and a task whose path has ended stays at the end of the path."""
    stack = fp.Stack(fp.PositionTask(name="hand"), fp.AxisTask(x=[0, 0.3, -1], name="tool"), fp.PostureTask(READY))
    run = fp.simulate(
        panda, {"hand": fp.Line([0, 0, 0.05], 1.0)}, fp.Balanced(0.6, np.ones(7)), READY, stack=stack, hold=2
    )
    assert run.status.code is fp.Status.OK
    assert run.max_error() < 1e-6
    assert np.linalg.norm(run.errors["tool"][0]) > 0.2
    assert np.linalg.norm(run.errors["tool"][-1]) < 1e-4
    both = fp.Stack([fp.PositionTask(name="hand"), fp.PositionTask("panda_joint4", rows=("y",), name="elbow")])
    paths = {"hand": fp.Line([0, 0, 0.05], 1.0), "elbow": fp.Line([0, 0.05, 0], 0.5)}
    run = fp.simulate(panda, paths, fp.MVN(), READY, stack=both, dt=0.01)
    elbow = run.frames["elbow"][:, 1, 3]
    assert run.t[-1] == 1.0
    assert np.abs(elbow[50:] - elbow[0] - 0.05).max() < 1e-5


def test_one_path_of_several_tasks_names_its_task(panda, balanced):
    """A dictionary of one path needs no task=, as in track(), also in sweep()."""
    stack = fp.Stack(fp.PositionTask(name="hand"), fp.PositionTask("panda_joint4", name="elbow"))
    line = fp.Line([0, 0, 0.02], 0.1)
    run = fp.track(panda, {"hand": line}, balanced, READY, stack=stack)
    one = fp.sweep(panda, {"hand": line}, balanced, READY, stack=stack, limits=panda.limits, motions=True)
    assert np.array_equal(one.motions[0, 0].q, run.q)
    assert one.motions[0, 0].task == "hand"
    with pytest.raises(fp.ParameterError, match="path has paths of 2 tasks"):
        fp.sweep(panda, {"hand": line, "elbow": line}, balanced, READY, stack=stack)


def test_gains_have_the_defaults_of_the_command_line():
    assert fp.FPBM(0.6, [1, 2, 3]) == fp.FPBM(0.6, [1, 2, 3], 10, 25)
