"""The class decides the meaning of an object: subclasses keep it, and foreign objects are refused by name."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

READY = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
POSE = np.array([[1, 0, 0, 0.4], [0, -1, 0, 0.1], [0, 0, -1, 0.5], [0, 0, 0, 1.0]])
FAR = np.eye(4)
FAR[:3, 3] = 3.0

# Class variables of a subclass. They must have no effect.
HOSTILE: list[dict[str, Any]] = [
    {"kind": "mine", "_kind": "mine", "name": "mine"},
    {"kind": "position", "frame": "base", "axes": "frame", "offset": FAR, "reference_frame": "base", "rows": ("y",)},
    {"kind": "pose", "all_rows": (), "point_shape": (9,), "x": np.ones(3), "joints": ("none",), "axis": (1, 0, 0)},
    {"level": "velocity", "fixed": {"alpha": 1.0, "k1": 99.0}, "alpha": 0.1, "weights": [9.0] * 7, "k": 9.0},
    {"level": "acceleration", "kind": 3, "k1": 0.0, "k2": 0.0, "null_damping": 50.0, "c": [1.0] * 7},
    {"selected": [False] * 3, "lower_corner": [9.0] * 3, "upper_corner": [-9.0] * 3, "least_angle": 3.0},
    {"largest_angle": 0.0, "task": None, "lower": [9.0] * 3, "upper": [-9.0] * 3, "velocity": 1e-9},
    {"radius": 9.0, "duration": 9.0, "displacement": [9.0] * 3, "points": None, "path": None, "paths": ()},
    {"link": 3, "capsules": (), "obstacles": (), "margin": 1.0, "allowed": (), "tip": FAR, "lengths": [9.0]},
    {"lower": [9.0] * 7, "jerk": [1e-9] * 7, "acceleration": [1e-9] * 7, "mimic": (0, 1.0, 0.0), "parent": 0},
]


def subclass(thing: Any, attributes: dict[str, Any]) -> Any:
    """The same object of a subclass with these class variables."""
    known = thing._values()
    return type("Mine", (type(thing),), dict(attributes))(**known)


@pytest.fixture(scope="module")
def panda() -> fp.SerialArm:
    return fp.SerialArm.preset("panda")


def scheme() -> fp.Scheme:
    return fp.Balanced(0.6, np.ones(7), null_damping=2)


def ticks(arm: Any, scheme: Any, stack: Any = None, targets: Any = None, **options: Any) -> list[np.ndarray]:
    tracker = fp.Tracker(arm, scheme, READY, stack=stack, **options)
    target = targets if stack is not None else tracker.tip + np.array([0.05, 0.1, -0.1])
    return [tracker.tick(target).q for _ in range(60)]


TASKS = [
    (fp.PositionTask(x=[0.4, 0.1, 0.5]), POSE[:3, 3]),
    (fp.PositionTask(rows=("x", "z"), axes="frame"), POSE[:3, 3]),
    (fp.OrientationTask(rows=("rx",)), POSE[:3, :3]),
    (fp.PoseTask(), POSE),
    (fp.AxisTask(axis=(0, 1, 0)), [0.0, 0.6, -0.8]),
    (fp.RelativePoseTask(reference_frame="panda_joint2"), POSE),
    (fp.CenterOfMassTask(), [0.1, 0.0, 0.4]),
    (fp.PostureTask(joints=("panda_joint2", "panda_joint4")), [0.3, -1.0]),
]


@pytest.mark.parametrize(("task", "target"), TASKS, ids=lambda each: type(each).__name__)
def test_a_subclass_of_a_task(task: Any, target: Any, panda: fp.SerialArm) -> None:
    robot: Any = panda
    if isinstance(task, (fp.RelativePoseTask, fp.CenterOfMassTask)):
        robot = fp.Robot.from_arms({"left": panda})
        names = {"frame": "left_tip", "reference_frame": "left_panda_joint2"}
        task = type(task)(**{name: names.get(name, value) for name, value in task._values().items()})
    expected = ticks(robot, scheme(), fp.Stack(task), {task.name: target})
    for attributes in HOSTILE:
        mine = subclass(task, attributes)
        assert mine.name == task.name
        assert mine.kind == task.kind
        assert np.array_equal(ticks(robot, scheme(), fp.Stack(mine), {task.name: target}), expected)
        again = pickle.loads(pickle.dumps(type(task)(**mine._values())))
        assert again == task


def schemes() -> list[fp.Scheme]:
    one = np.ones(7)
    velocity = [fp.MVN(k=5), fp.WMVN(one, k=5)]
    return [*velocity, fp.MAN(), fp.WMVNAcceleration(one), fp.Balanced(0.6, one), fp.FPBM(0.6, one, 10, 25)]


@pytest.mark.parametrize("law", schemes(), ids=lambda each: type(each).__name__)
def test_a_subclass_of_a_scheme(law: fp.Scheme, panda: fp.SerialArm) -> None:
    expected = ticks(panda, law)
    for attributes in HOSTILE:
        mine = subclass(law, attributes)
        assert mine.level == law.level
        assert np.array_equal(ticks(panda, mine), expected)


def paths() -> list[fp.Path]:
    line = fp.Line([0.05, 0, 0.02], 0.1)
    shapes = [fp.Circle(0.02, 0.1), fp.Lissajous(0.02, 0.1), fp.Tricuspid(0.01, 0.1), line]
    points = fp.Waypoints([[0, 0, 0], [0.01, 0.02, 0], [0.03, 0, 0]], duration=0.1)
    return [*shapes, points, fp.Circle(0.02, 0.1).in_plane("yz"), line.with_rotation([0.1, 0, 0]), line.then(line)]


@pytest.mark.parametrize("path", paths(), ids=lambda each: type(each).__name__)
def test_a_subclass_of_a_path(path: fp.Path, panda: fp.SerialArm) -> None:
    law, task = fp.FPBM(0.6, np.ones(7), 10, 25), "pose" if isinstance(path, fp.WithRotation) else "position"
    expected = fp.track(panda, path, law, READY, task=task).q
    for attributes in HOSTILE:
        run = fp.track(panda, subclass(path, attributes), law, READY, task=task)
        assert np.array_equal(run.q, expected)


def bounds() -> list[fp.TaskBounds]:
    wall = fp.TaskBounds(fp.PositionTask(rows=("y",)), upper=0.02, velocity=0.3)
    return [wall, fp.TaskBounds(fp.AxisTask(x=[0, 0, -1]), upper=0.5)]


@pytest.mark.parametrize("bound", bounds(), ids=["wall", "cone"])
def test_a_subclass_of_a_bound(bound: fp.TaskBounds, panda: fp.SerialArm) -> None:
    expected = ticks(panda, scheme(), bounds=(bound,))
    for attributes in HOSTILE:
        assert np.array_equal(ticks(panda, scheme(), bounds=(subclass(bound, attributes),)), expected)
        inner = fp.TaskBounds(**{**bound._values(), "task": subclass(bound.task, attributes)})
        assert np.array_equal(ticks(panda, scheme(), bounds=(inner,)), expected)


def test_a_subclass_of_a_shape_or_a_clearance(panda: fp.SerialArm) -> None:
    wall, box = fp.HalfSpace([0, -1, 0], -0.2, name="wall"), fp.Cuboid(POSE + 0.0, [0.1] * 3, name="box")
    ball = fp.Capsule(0, [0.4, 0.3, 0.5], [0.4, 0.3, 0.6], 0.05, "ball")
    for obstacle in (wall, box, ball):
        clearance = fp.Clearance.preset("panda", obstacles=[obstacle], margin=0.001)
        try:
            expected = ticks(panda, scheme(), bounds=[clearance])
        except fp.ParameterError:
            continue
        for attributes in HOSTILE:
            mine = fp.Clearance.preset("panda", obstacles=[subclass(obstacle, attributes)], margin=0.001)
            assert np.array_equal(ticks(panda, scheme(), bounds=[mine]), expected)
            assert np.array_equal(ticks(panda, scheme(), bounds=[subclass(clearance, attributes)]), expected)


def test_a_subclass_of_an_arm_of_joints_and_of_limits(panda: fp.SerialArm) -> None:
    expected = ticks(panda, scheme())
    for attributes in HOSTILE:
        assert np.array_equal(ticks(subclass(panda, attributes), scheme()), expected)
        joints = [subclass(joint, attributes) for joint in panda.joints]
        assert np.array_equal(ticks(fp.SerialArm(joints, panda.tip), scheme()), expected)
        assert np.array_equal(ticks(panda, scheme(), limits=subclass(panda.limits, attributes)), expected)
    planar = fp.PlanarArm([1, 1, 1, 1])
    for attributes in HOSTILE:
        assert np.array_equal(subclass(planar, attributes).forward([0.1] * 4), planar.forward([0.1] * 4))


def test_a_subclass_of_a_stack(panda: fp.SerialArm) -> None:
    class Mine(fp.Stack):
        levels = ()
        tasks = ()
        kind = "mine"

    task = fp.PositionTask()
    mine = Mine(task)
    assert mine.tasks == (task,)
    targets = {task.name: POSE[:3, 3]}
    assert np.array_equal(ticks(panda, scheme(), mine, targets), ticks(panda, scheme(), fp.Stack(task), targets))


def test_a_subclass_with_another_constructor_can_be_copied() -> None:
    again = pickle.loads(pickle.dumps(Round(2.0)))
    assert type(again) is Round
    assert again.radius == 1.0
    assert again == Round(2.0)
    assert repr(again) == "Round(radius=1, duration=3)"


class Round(fp.Circle):
    def __init__(self, width: float) -> None:
        super().__init__(width / 2, 3.0)


def test_a_property_does_not_change_the_kind(panda: fp.SerialArm) -> None:
    kind = property(lambda _: "pose")
    mine = type("Mine", (fp.PositionTask,), {"kind": kind})()
    assert fp.Tracker(panda, scheme(), READY, stack=fp.Stack(mine)).tip["position"].shape == (3,)
    other = type("Mine", (fp.Balanced,), {"level": property(lambda _: "velocity")})(0.6, np.ones(7), null_damping=2)
    assert np.array_equal(ticks(panda, other), ticks(panda, scheme()))


@pytest.mark.parametrize("base", [fp.Task, fp.Scheme, fp.tasks.RowsTask, fp.tasks.FrameTask])
def test_a_class_of_its_own_is_refused(base: type) -> None:
    with pytest.raises(TypeError, match=r"Mine: is not a (task|scheme): must be derived from one of "):
        type("Mine", (base,), {"kind": "position", "level": "velocity"})()
    with pytest.raises(TypeError, match=r": is not a (task|scheme): must be derived from one of "):
        base()


class Foreign:
    """An object with attributes of everything."""

    kind = "position"
    level = "velocity"
    name = "mine"
    dof = 7
    duration = 1.0
    levels = tasks = capsules = obstacles = ()
    task = fp.PositionTask()
    link = 0

    def __repr__(self) -> str:
        return "<foreign>"


WHAT = {
    "arm": "an arm or a Robot",
    "path": "a path",
    "scheme": "a scheme",
    "stack": "a Stack",
    "bounds": "TaskBounds",
    "limits": "JointLimits",
}


@pytest.mark.parametrize("given", [Foreign(), Foreign, 3.0, "text"], ids=["object", "class", "number", "text"])
@pytest.mark.parametrize("argument", WHAT)
@pytest.mark.parametrize("call", ["Tracker", "simulate", "track", "sweep"])
def test_foreign_arguments_are_refused_by_name(call: str, argument: str, given: Any, panda: fp.SerialArm) -> None:
    path, law = fp.Line([0, 0, 0.01], 0.01), fp.MVN()
    arguments: dict[str, Any] = {"arm": panda, "path": path, "scheme": law}
    arguments["q0s" if call == "sweep" else "q0"] = READY
    if call == "sweep":
        arguments["schemes"] = arguments.pop("scheme")
    if call == "Tracker":
        del arguments["path"]
    name = "schemes" if (call, argument) == ("sweep", "scheme") else argument
    known: Callable[..., Any] = getattr(fp, call)
    if name not in arguments and (call, name) in {
        ("simulate", "limits"),
        ("simulate", "bounds"),
        ("sweep", "bounds"),
        ("Tracker", "path"),
    }:
        pytest.skip("no such argument")
    arguments[name] = given if argument != "bounds" or given == 3.0 else [given]
    with pytest.raises((ValueError, TypeError)) as caught:
        known(**arguments)
    text = str(caught.value)
    assert text.startswith(name), text
    assert f"must be {WHAT[argument]}" in text or WHAT[argument].split()[-1] in text, text
    assert "got " in text, text
    assert ("type" if isinstance(given, type) else type(given).__name__) in text or "Foreign" in text, text


def test_foreign_parts_are_refused_by_name(panda: fp.SerialArm) -> None:
    def refused(match: str, make: Callable[[], Any]) -> None:
        with pytest.raises((ValueError, TypeError), match=match):
            make()

    thing, line = Foreign(), fp.Line([0, 0, 0.01], 0.1)
    tracker = fp.Tracker(panda, fp.MVN(k=5), READY)
    capsules = fp.Clearance.preset("panda").capsules
    refused(r"^levels\[0\] = .*: must be a task.*got Foreign", lambda: fp.Stack(thing))  # type: ignore[arg-type]
    refused(r"^levels\[1\] = .*: must be a task.*got Line", lambda: fp.Stack(fp.PoseTask(), [line]))  # type: ignore[list-item]
    refused(r"^task = .*: must be a PositionTask or an AxisTask, got Foreign", lambda: fp.TaskBounds(thing))
    refused(r"^task = .*: must be a PositionTask or an AxisTask, got PoseTask", lambda: fp.TaskBounds(fp.PoseTask()))
    refused(r"^obstacles\[0\] = .*: must be a HalfSpace.*got Foreign", lambda: fp.Clearance(capsules, [thing]))
    refused(r"^capsules\[0\] = .*: must be a Capsule, got Foreign", lambda: fp.Clearance([thing]))
    refused(r"^arm: must be an arm or a Robot, got Foreign", lambda: fp.Clearance(capsules).nearest(thing, READY))
    refused(r"^path: must be a path, got Foreign", lambda: tracker.follow(thing))
    refused(r"^shape: must be a HalfSpace.*got Foreign", lambda: tracker.move("wall", thing))
    refused(r"^path = .*: must be a path, got Foreign", lambda: fp.InPlane(thing, "yz"))
    refused(r"^path = .*: must be a path, got Foreign", lambda: fp.WithRotation(thing, [0, 0, 1]))
    refused(r"^paths\[1\] = .*: must be a path, got Foreign", lambda: line.then(thing))
    refused(r"^joints\[0\] = .*: must be a Joint, got Foreign", lambda: fp.SerialArm([thing]))
    refused(r"^joints\[0\] = .*: must be a TreeJoint, got Joint", lambda: fp.Robot([fp.Joint()]))
    refused(r"^named_frames\[0\] = .*: must be a NamedFrame", lambda: fp.Robot([fp.TreeJoint(fp.Joint())], [thing]))
    refused(
        r"^path\['tip'\] = .*: must be a path",
        lambda: fp.track(panda, {"tip": thing}, fp.MVN(), READY, stack=fp.Stack(fp.PositionTask(name="tip"))),
    )
