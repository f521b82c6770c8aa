"""Arms, paths and schemes are data: read, compared and replaced; pickle, tables and repr() give equal objects."""

import copy
import dataclasses
import json
import pickle

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import fpbm_cpp as fp
from fpbm_cpp.arms import ARMS
from fpbm_cpp.errors import ParameterError
from fpbm_cpp.parameter import REQUIRED, parameters
from fpbm_cpp.paths import PATH_OPTIONS, PATHS
from fpbm_cpp.schemes import SCHEMES
from fpbm_cpp.table import from_table, problems, to_table
from fpbm_cpp.tasks import TASKS

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
POSES = np.tile(np.eye(4), (3, 1, 1))
POSES[1:, 0, 3] = 0.1, 0.3
POSES[1, :3, :3] = fp.rotation([0, 0.5, 0])

SOME_PATHS = {
    "circle": fp.Circle(0.45, 8.0, time_law="quintic"),
    "lissajous": fp.Lissajous((0.4, 1 / 3), 8.0, frequencies=(3, 2), phase=0.7),
    "lissajous, one amplitude": fp.Lissajous(0.4, 8.0),
    "tricuspid": fp.Tricuspid(0.1 + 0.2, 8.0, time_law="constant_speed"),
    "line": fp.Line([0.5, -1.0], 8.0),
    "line in space": fp.Line([0.5, -1.0, 1 / 7], 8.0, time_law="quintic"),
    "waypoints, timed": fp.Waypoints([[0, 0], [0.1, 0.2], [1 / 3, 0]], times=[0, 1.0, 2.5]),
    "waypoints, lasting": fp.Waypoints(np.eye(3), duration=4.0),
    "waypoints, within": fp.Waypoints(
        POSES, velocity=0.2, acceleration=1.0, angular_velocity=2.0, angular_acceleration=3.0
    ),
    "waypoints, within bounds on jerk": fp.Waypoints(POSES, jerk=1 / 3, angular_jerk=7.0),
    "polyline": fp.Polyline([[0, 0], [0.1, 0.2], [1 / 3, 0]], 4.0, blend=0.01, time_law="quintic"),
    "polyline through poses": fp.Polyline(POSES, 4.0, blend=0.02),
    "at speed": fp.Circle(0.45, 8.0).in_plane("yz").at_speed(1 / 3, acceleration=0.5),
    "at speed, in a plane": fp.Tricuspid(0.1, 8.0).at_speed(0.1, acceleration=0.5, jerk=20).in_plane("yz"),
    "many at speed": fp.Line([1, 0, 0], 2.0)
    .then(fp.Line([0, 1, 2], 2.0).with_rotation([0, 0, 1]))
    .at_speed(0.1, acceleration=0.5)
    .then(fp.Line([0, 0, 0.1], 2.0)),
    "in a plane": fp.Circle(0.45, 8.0).in_plane("yz"),
    "in any plane": fp.Circle(0.45, 8.0).in_plane([[0, 1, 1], [1, 0, 0]]),
    "turned in the plane": fp.Circle(0.45, 8.0).with_rotation(0.3),
    "turned": fp.Line([0, 1, 2], 2.0).with_rotation(np.array([0.1, 0.2, 1 / 3]), time_law="sin_squared"),
    "one after another": fp.Line([1, 0], 1.0).then(fp.Line([0, 1, 2], 2.0)),
    "many after another": fp.Circle(0.1, 1.0).then(
        fp.Line([0, 1, 2], 2.0).then(fp.Line([0, 0, 1], 1.0).with_rotation([0, 0, 1]))
    ),
}


def options(n):
    return {
        "rest_posture": np.full(n, 1 / 3),
        "null_stiffness": 1.0,
        "c": np.full(n, 0.1),
        "joint_centring": 0.2,
        "manipulability_gain": 0.3,
        "singular_radius": 0.02,
        "singular_brake": 5.0,
    }


W = np.diag(np.linspace(1, 2, 7)) + 0.1
SOME_SCHEMES = {
    "MVN": fp.MVN(),
    "MVN with all": fp.MVN(k=5.0, **options(7)),
    "WMVN": fp.WMVN(np.linspace(1, 2, 7), k=1 / 3),
    "WMVN, dense": fp.WMVN(W, **options(7)),
    "MAN": fp.MAN(),
    "MAN with all": fp.MAN(null_damping=2.0, **options(7)),
    "WMVNAcceleration": fp.WMVNAcceleration(W.tolist(), null_damping=1.0),
    "Balanced": fp.Balanced(0.4, W),
    "FPBM": fp.FPBM(1 / 3, np.linspace(1, 2, 7), 10.0, k2=25.0),
    "MinimumEnergy": fp.MinimumEnergy(k=1 / 3),
    "MinimumTorque": fp.MinimumTorque(alpha=0.98, weights=W, k1=1, k2=2, null_damping=2, **options(7)),
    "FPBM with all": fp.FPBM(0.6, W, k1=10, k2=25, null_damping=2, **options(7)),
}


LIMITS = fp.JointLimits(lower=[-1, -np.inf], upper=[1, 2], velocity=[1, np.inf], acceleration=[np.inf, np.inf])
ARMS_AND_OTHERS = {
    "planar": fp.PlanarArm([1, 0.5, 1 / 3]),
    "panda": PANDA,
    "joints": fp.SerialArm(
        [fp.Joint(upper=2.0), fp.Joint(mimic=(0, -1.5, 0.2)), fp.Joint("prismatic", axis=[0, 1, 0], name="last")],
        tip=POSES[1],
    ),
    "limits": LIMITS,
    "task": fp.PoseTask("joint_1", rows=("x", "rz"), axes="frame", x=POSES[1], offset=POSES[1], k1=3),
    "axis": fp.AxisTask(axis=[0, 0, -1], x=[0, 1 / 3, -1], name="torch"),
    "posture": fp.PostureTask([1, 1 / 3], joints=["a", "b"], k=2),
    "capsule": fp.Capsule(3, [0, 0, 1 / 3], [0, 1, 0], 0.1, "elbow"),
    "half-space": fp.HalfSpace([0, 0, 2], -1 / 3),
    "box": fp.Cuboid(POSES[1], [0.1, 0, 1 / 3], name="shelf"),
    "clearance": fp.Clearance(
        [fp.Capsule(1, [0, 0, 0], [1, 0, 0], 1 / 3), fp.Capsule(3, [0, 0, 0], [0, 0, 0], 0.1, "hand")],
        [fp.HalfSpace([0, 0, 1], 0.1, name="table"), fp.Cuboid(POSES[1], [1, 1, 1])],
        margin=1 / 30,
        allowed=[("hand", "table")],
    ),
}
THINGS = {**SOME_PATHS, **SOME_SCHEMES, **ARMS_AND_OTHERS}
every_thing = pytest.mark.parametrize("name", THINGS)


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def evaluated(text):
    return eval(text, vars(fp).copy())


def through_json(thing):
    return from_table(json.loads(json.dumps(to_table(thing), allow_nan=False)))


def expect_same(thing, other):
    assert type(other) is type(thing)
    assert other == thing
    assert hash(other) == hash(thing)
    assert repr(other) == repr(thing)
    if isinstance(thing, fp.Path):
        assert other.duration == thing.duration
        for t in np.linspace(-0.1, thing.duration + 0.1, 57):
            for here, there in zip(thing.sample(t), other.sample(t)):
                assert here.tobytes() == there.tobytes()


@every_thing
@pytest.mark.parametrize(
    "copied",
    [again, lambda thing: again(again(thing)), copy.copy, copy.deepcopy, dataclasses.replace, through_json],
    ids=["pickle", "pickle twice", "copy", "deepcopy", "replace", "table"],
)
def test_copies(name, copied):
    expect_same(THINGS[name], copied(THINGS[name]))


@every_thing
def test_repr_evaluates(name):
    expect_same(THINGS[name], evaluated(repr(THINGS[name])))


def test_different_objects_are_unequal():
    assert len(set(THINGS.values())) == len(THINGS)
    for one in THINGS.values():
        assert sum(one == other for other in THINGS.values()) == 1
    assert fp.MAN() != "MAN()"


def test_attributes_have_the_given_values():
    scheme = fp.FPBM(1, [1, 2, 3], k1=10, k2=np.float32(0.5), null_damping=np.array(2))
    assert (scheme.alpha, scheme.k1, scheme.k2, scheme.null_damping) == (1.0, 10.0, 0.5, 2.0)
    assert all(type(value) is float for value in (scheme.alpha, scheme.k1, scheme.k2, scheme.null_damping))
    assert scheme.weights.tolist() == [1, 2, 3]
    assert scheme.rest_posture is None
    assert (scheme.level, scheme.kind) == ("acceleration", "fpbm")
    path = fp.Circle(0.1, 2).in_plane("yz").with_rotation([0, 0, 1])
    assert (path.path.plane, path.path.path.radius, path.duration) == ("yz", 0.1, 2.0)
    assert fp.Circle(0.1, 2).with_rotation(0.5).rotation == 0.5
    assert THINGS["waypoints, within"].velocity == 0.2
    assert THINGS["one after another"].paths == (fp.Line([1, 0], 1.0), fp.Line([0, 1, 2], 2.0))
    assert fp.PlanarArm([1, 2]).lengths.tolist() == [1, 2]
    assert THINGS["joints"].joints[1].mimic == (0, -1.5, 0.2)


def test_replacing():
    scheme = fp.FPBM(0.6, [1, 2, 3], 10, 25, null_damping=2.0)
    other = dataclasses.replace(scheme, alpha=0.5)
    assert other == fp.FPBM(0.5, [1, 2, 3], 10, 25, null_damping=2.0)
    assert scheme.alpha == 0.6
    with pytest.raises(ParameterError, match=r"alpha = 2: must be in \[0, 1\]"):
        dataclasses.replace(scheme, alpha=2)
    points = [[0, 0], [1, 1]]
    quick = dataclasses.replace(fp.Waypoints(points, velocity=0.2), velocity=0.4)
    assert quick == fp.Waypoints(points, velocity=0.4)
    assert quick.duration == fp.Waypoints(points, velocity=0.4).duration
    arm = dataclasses.replace(PANDA, tip=PANDA.tip @ POSES[1])
    np.testing.assert_allclose(arm.forward(READY), PANDA.forward(READY) @ POSES[1], atol=1e-15)


@every_thing
def test_objects_are_immutable(name):
    thing = THINGS[name]
    for parameter in parameters(type(thing)):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(thing, parameter, getattr(thing, parameter))
        value = getattr(thing, parameter)
        if isinstance(value, np.ndarray):
            with pytest.raises(ValueError, match="read-only"):
                value[...] = 0.0


def test_arguments_are_copied():
    points, weights, rotation = np.eye(3), np.ones(4), np.array([0.1, 0.2, 0.3])
    path = fp.Waypoints(points, duration=1.0).with_rotation(rotation)
    scheme = fp.WMVN(weights)
    x = path.sample(0.5)[0]
    points[:], weights[:], rotation[:] = 7.0, -1.0, np.nan
    np.testing.assert_array_equal(again(path).sample(0.5)[0], x)
    assert repr(again(scheme)) == "WMVN(weights=[1, 1, 1, 1])"


@pytest.mark.parametrize("name", SOME_SCHEMES)
def test_copied_schemes_give_the_same_motion(name):
    scheme = SOME_SCHEMES[name]
    path = fp.Circle(0.05, 0.5).in_plane("yz")
    here = fp.simulate(PANDA, path, scheme, READY, dt=0.01)
    for copied in (again(scheme), copy.deepcopy(scheme), through_json(scheme)):
        there = fp.simulate(PANDA, path, copied, READY, dt=0.01)
        assert here.q.tobytes() == there.q.tobytes()
        assert here.qdd.tobytes() == there.qdd.tobytes()


def test_long_chains():
    path = fp.Line([0.1, 0.0], 1.0)
    for _ in range(1500):
        path = path.then(fp.Line([0.1, 0.0], 1.0))
    assert len(path.paths) == 1501
    for copied in (again(path), copy.deepcopy(path), through_json(path), evaluated(repr(path))):
        assert copied == path
        np.testing.assert_allclose(copied.sample(1500.5)[0], path.sample(1500.5)[0], rtol=0, atol=0)


# Declarations.

MAKERS = [
    fp.PlanarArm,
    fp.SerialArm,
    fp.Joint,
    fp.JointLimits,
    *TASKS.values(),
    fp.Capsule,
    fp.HalfSpace,
    fp.Cuboid,
    fp.Clearance,
    *PATHS.values(),
    *SCHEMES.values(),
]


@pytest.mark.parametrize("maker", MAKERS, ids=lambda maker: maker.__name__)
def test_docstrings_have_every_parameter(maker):
    section = maker.__doc__.split("Parameters\n----------\n")[1]
    for name, parameter in parameters(maker).items():
        assert f"{name} : " in section
        assert parameter.help.endswith(".")
        if parameter.unit:
            assert f"[{parameter.unit}]" in section


@pytest.mark.parametrize("maker", MAKERS, ids=lambda maker: maker.__name__)
def test_defaults_and_usual_values_are_in_range(maker):
    for parameter in parameters(maker).values():
        for value in (parameter.default, parameter.usual):
            if value is not REQUIRED:
                parameter.check(value)


@given(st.sampled_from([*PATHS.values(), *SCHEMES.values()]), st.floats(), st.data())
def test_bounds_are_kept(maker, value, data):
    """A number in range is accepted unchanged; other numbers are rejected with name and value."""
    numbers = [each for each in parameters(maker).values() if each.type is float]
    parameter = data.draw(st.sampled_from(numbers))
    inside = parameter.low < value <= parameter.high or (value == parameter.low and not parameter.open_low)
    if inside and np.isfinite(value):
        assert parameter.check(value) == value
        return
    with pytest.raises(ParameterError) as caught:
        parameter.check(value)
    assert caught.value.name == parameter.name
    assert str(caught.value).startswith(f"{parameter.name} = ")
    assert repr(caught.value.value) == repr(value)


@pytest.mark.parametrize(
    ("make", "name", "index", "value"),
    [
        (lambda: fp.Circle(-1, 1), "radius", None, -1.0),
        (lambda: fp.Circle("wide", 1), "radius", None, "wide"),
        (lambda: fp.Circle(True, 1), "radius", None, True),
        (lambda: fp.Circle(1, 1, time_law="quintc"), "time_law", None, "quintc"),
        (lambda: fp.WMVN([1, 0]), "weights", 1, 0.0),
        (lambda: fp.FPBM(2, [1, 1], 1, 1), "alpha", None, 2.0),
        (lambda: fp.MAN(null_stiffness=1.0), "null_stiffness", None, 1.0),
        (lambda: fp.WMVN([[1, 2], [2, 1]]), "weights", 1, 1.0),
        (lambda: fp.PlanarArm([1, np.inf]), "lengths", 1, np.inf),
        (lambda: fp.SerialArm.preset("pnada"), "name", None, "pnada"),
    ],
)
def test_errors_have_name_index_and_value(make, name, index, value):
    with pytest.raises(ParameterError) as caught:
        make()
    assert isinstance(caught.value, ValueError)
    assert (caught.value.name, caught.value.index, caught.value.value) == (name, index, value)
    assert str(caught.value).startswith(name)
    copied = again(caught.value)
    assert (str(copied), copied.name, copied.value) == (str(caught.value), name, value)
    assert str(caught.value.within("job.path")) == f"job.path.{caught.value}"


# Tables.

numbers = st.floats(-1e6, 1e6)
gains = st.floats(0, 1e6)
sizes = st.floats(1e-3, 1e3)


@st.composite
def shapes(draw):
    duration, law = draw(sizes), draw(st.sampled_from(["sin_squared", "quintic", "constant_speed"]))
    shape = draw(st.sampled_from(["circle", "lissajous", "tricuspid", "line", "polyline", "waypoints"]))
    if shape == "lissajous":
        return fp.Lissajous(draw(sizes), duration, frequencies=(draw(st.integers(1, 9)), 2), phase=draw(numbers))
    if shape == "line":
        return fp.Line(draw(st.tuples(numbers, numbers)), duration, time_law=law)
    if shape == "polyline":
        return fp.Polyline([[0, 0], [draw(sizes), 1], [2, draw(numbers)]], duration, blend=draw(gains), time_law=law)
    if shape == "waypoints":
        return fp.Waypoints([[0, 0], [draw(sizes), 1], [2, draw(numbers)]], duration=duration)
    return (fp.Circle if shape == "circle" else fp.Tricuspid)(draw(sizes), duration, time_law=law)


@st.composite
def any_path(draw):
    path = draw(shapes())
    if draw(st.booleans()):
        speed, acceleration = draw(sizes), draw(sizes)
        try:
            path = path.at_speed(speed, acceleration=acceleration)
        except fp.ParameterError as error:  # All points of the path may be equal.
            assume("has no length" not in str(error))
            raise
    for piece in draw(st.lists(shapes(), max_size=3)):
        path = path.then(piece)
    if draw(st.booleans()):
        return path.with_rotation(draw(st.floats(-3, 3)))
    return path.in_plane(draw(st.sampled_from(["xy", "yz", "zx"]))).then(fp.Line([0, 0, draw(sizes)], 1.0))


@given(any_path())
def test_paths_are_converted_to_tables_and_back(path):
    expect_equal(path)


@given(st.sampled_from([*SCHEMES.values()]), st.data(), st.integers(1, 9))
def test_schemes_are_converted_to_tables_and_back(maker, data, n):
    values = {}
    for name, parameter in parameters(maker).items():
        if parameter.type is float and (parameter.required or data.draw(st.booleans())):
            values[name] = data.draw(st.floats(0, min(parameter.high, 1e6)))
    values.pop("null_stiffness", None)
    if "weights" in parameters(maker):
        values["weights"] = data.draw(st.lists(st.floats(0.1, 10), min_size=n, max_size=n))
    if data.draw(st.booleans()):
        values["c"] = data.draw(st.lists(numbers, min_size=n, max_size=n))
    expect_equal(maker(**values))


def expect_equal(thing):
    assert through_json(thing) == thing
    assert evaluated(repr(thing)) == thing
    assert again(thing) == thing


def test_short_tables_are_read():
    table = {
        "kind": "circle",
        "radius": 0.2,
        "in_plane": "yz",
        "with_rotation": [0, 0, 1],
        "rotation_time_law": "quintic",
    }
    path = from_table({**table, "duration": 10}, PATHS)
    assert path == fp.Circle(0.2, 10.0).in_plane("yz").with_rotation([0, 0, 1], time_law="quintic")
    lines = [{"kind": "line", "displacement": [0, 1], "duration": 1}, {"kind": "circle", "radius": 1, "duration": 2}]
    assert from_table(lines, PATHS) == fp.Line([0, 1], 1).then(fp.Circle(1, 2))
    assert from_table(lines[:1], PATHS) == fp.Line([0, 1], 1)
    tasks = [{"kind": "pose"}, {"kind": "axis", "frame": "panda_joint4", "x": [0, 0, 1], "level": 1}]
    assert from_table(tasks, TASKS) == fp.Stack(fp.PoseTask(), fp.AxisTask("panda_joint4", x=[0, 0, 1]))
    assert from_table({"kind": "preset", "name": "panda"}, ARMS) == PANDA
    joints = [{"type": "prismatic", "upper": 1.0}, {"mimic": [0, 1.0, 0.5]}]
    assert from_table({"kind": "joints", "joints": joints}) == fp.SerialArm(
        [fp.Joint("prismatic", upper=1.0), fp.Joint(mimic=(0, 1.0, 0.5))]
    )


CIRCLE = {"kind": "circle", "radius": 1, "duration": 1}


@pytest.mark.parametrize(
    ("table", "makers", "words"),
    [
        (3, PATHS, ["path = 3: must be a table"]),
        ([], PATHS, ["path = []: must have at least one path"]),
        ({}, PATHS, ["path.kind: is missing: must be one of circle, lissajous, tricuspid, line, polyline, "]),
        ({"kind": "cirle"}, PATHS, ["path.kind = 'cirle': must be one of", "; did you mean 'circle'?"]),
        ({"kind": ["circle"]}, PATHS, ["path.kind = ['circle']: must be one of"]),
        ({**CIRCLE, "radius": -1}, PATHS, ["path.radius = -1: must be positive and finite"]),
        ({**CIRCLE, "radius": "1"}, PATHS, ["path.radius = '1': must be a number"]),
        (
            {**CIRCLE, "radus": 1},
            PATHS,
            ["path.radus: is not a key of circle", "at_jerk; did you mean 'radius'?"],
        ),
        ({"kind": "circle", "duration": 1}, PATHS, ["path.radius: is missing"]),
        ({**CIRCLE, "in_plane": "xw"}, PATHS, ["path.in_plane = 'xw': must be one of xy, xz, yx, yz, zx, zy"]),
        ([CIRCLE, {**CIRCLE, "radius": 0}], PATHS, ["path[1].radius = 0: must be positive"]),
        ([{"kind": "axes"}], TASKS, ["path[0].kind = 'axes': must be one of position", "did you mean 'axis'?"]),
        ([{"kind": "axis", "level": -1}], TASKS, ["path[0].level = -1: must be a whole number, not negative"]),
        (
            {"kind": "joints", "joints": [{}, {"axis": "x"}]},
            ARMS,
            ["path.joints[1].axis = 'x': must be real numbers of shape (3,)"],
        ),
        ({"kind": "joints", "joints": [{}, 3]}, ARMS, ["path.joints[1] = 3: must be a table"]),
        ({"kind": "preset"}, ARMS, ["path.name: is missing"]),
    ],
)
def test_invalid_tables_are_rejected(table, makers, words):
    (problem,) = problems(table, makers, "path")
    assert all(word in str(problem) for word in words)
    with pytest.raises(ParameterError) as caught:
        from_table(table, makers, "path")
    assert str(caught.value) == str(problem)


def test_all_problems_are_reported():
    table = [{**CIRCLE, "radius": 0, "time_law": "sin"}, {"kind": "tricuspid", "duration": "x"}]
    names = [problem.name for problem in problems(table, PATHS, "path")]
    assert names == ["path[0].radius", "path[0].time_law", "path[1].duration", "path[1].size"]
    assert [problem.name for problem in problems(table, PATHS, "path", usual=True)] == names[:3]


def test_path_options_equal_those_of_the_paths():
    placed = {"in_plane", "with_rotation", "rotation_time_law"}
    assert set(PATH_OPTIONS) == placed | {"at_speed", "at_acceleration", "at_jerk"}


def test_foreign_objects_have_no_table():
    with pytest.raises(TypeError, match="must be an object of this package"):
        to_table(object())
