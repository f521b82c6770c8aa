"""Clearance.from_urdf accepts robots' home postures with the default margin; the error of a start that is too close."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from test_capsules import ARMS, ROBOTS, fitted, heavy, outside, with_robots
from test_preset_capsules import PRESETS, load_tool, needs_clone, urdf_of

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.clearance import MARGIN
from fpbm_cpp.urdf.capsule_fit import Fit
from fpbm_cpp.urdf.capsule_gaps import Gaps, Link, Part, capsules_apart, hulls_apart, link_frames, postures
from fpbm_cpp.urdf.capsule_slabs import MOST
from fpbm_cpp.urdf.capsules import capsules_of
from fpbm_cpp.urdf.chain import read_places
from fpbm_cpp.urdf.shapes import Shape, read_shapes

pytest.importorskip("trimesh")

# `make homes` tests the other robots.
EVERY_DAY = {"ur5e", "panda with its hand"}


def some(names: Iterable[str]) -> list[object]:
    return [name if name in EVERY_DAY else pytest.param(name, marks=heavy) for name in names]


PI = np.pi
FRANKA = [[0, -PI / 4, 0, -3 * PI / 4, 0, PI / 2, PI / 4], [0, -0.3, 0, -2.2, 0, 2, 0.785]]
UR = [[0] * 6, [0, -PI / 2, 0, -PI / 2, 0, 0], [0, -PI / 2, PI / 2, -PI / 2, -PI / 2, 0]]
# All joints at zero, if this is the home posture of the file, and start postures of manufacturers and planners.
HOMES = {
    "panda": FRANKA,
    "fr3": FRANKA,
    "iiwa14": [[0] * 7, [0, PI / 4, 0, -PI / 2, 0, PI / 4, 0]],
    "gen3": [[0] * 7, np.radians([0, 15, 180, -130, 0, 55, 90]), np.radians([0, -20, 180, -145, 0, -60, 90])],
    "ur5e": UR,
    "ur10e": UR,
}


class Other(NamedTuple):
    urdf: str
    tip: str
    base: str | None
    homes: list[list[float]]


OTHERS = {
    "panda with its hand": Other("panda_description/urdf/panda.urdf", "panda_hand_tcp", None, FRANKA),
    "xarm7": Other("xarm_description/urdf/xarm7.urdf", "link_eef", None, [[0] * 7]),
    # Posture "arm_up" of the file: at zero the arm is folded onto itself, see below.
    "z1": Other("z1_description/urdf/z1.urdf", "gripperStator", None, [[0, 0.26178, -0.26178, 0, 0, 0]]),
    # Posture "arm_up" of the file, within the joints' ranges, and with all joints at half a turn.
    "kinova": Other(
        "kinova_description/robots/kinova.urdf",
        "j2s6s200_end_effector",
        None,
        [[1.5707, 2.618, 4.7124, 3.1415, 2.618, 0], [PI] * 6],
    ),
}


def expect_accepted(arm: fp.SerialArm, clearance: fp.Clearance, homes: list[list[float]]) -> None:
    assert clearance.margin == MARGIN
    for home in homes:
        nearest = clearance.nearest(arm, home)
        assert nearest is None or nearest.distance >= MARGIN, (home, nearest)


@needs_clone
@pytest.mark.parametrize("name", some(PRESETS))
def test_home_of_a_preset_s_urdf(name: str) -> None:
    tool = load_tool()
    with urdf_of(tool, name) as urdf:
        tip = tool.ARMS[name].tip
        expect_accepted(fp.SerialArm.from_urdf(urdf, tip), fp.Clearance.from_urdf(urdf, tip), HOMES[name])


@with_robots
@pytest.mark.parametrize("name", some(OTHERS))
def test_home_of_a_robot(name: str, once) -> None:
    urdf, tip, base, homes = OTHERS[name]
    assert base is None
    expect_accepted(fp.SerialArm.from_urdf(ROBOTS / urdf, tip), once(fitted, urdf, tip, base, 2), homes)


# TIAGo's "home" of tiago_motions, torso first: by Coal, the closest links that are not left out are 17.9 mm apart.
REQUIRED = {
    "tiago": (
        Other(
            "tiago_description/robots/tiago_no_hand.urdf",
            "arm_7_link",
            None,
            [[0.15, 0.20, -1.34, -0.20, 1.94, -1.57, 1.37, 0]],
        ),
        r"arm_3_link and torso_lift_link overlap by 0\.05",
    ),
}


@with_robots
@pytest.mark.parametrize("name", some(REQUIRED))
def test_required_postures_are_accepted(name: str) -> None:
    (urdf, tip, base, (home,)), expected = REQUIRED[name]
    arm = fp.SerialArm.from_urdf(ROBOTS / urdf, tip, base)
    without = fp.Clearance.from_urdf(ROBOTS / urdf, tip, base)
    with pytest.raises(fp.ParameterError, match=expected):
        fp.Tracker(arm, fp.MVN(), home, bounds=[without])
    clearance = fp.Clearance.from_urdf(ROBOTS / urdf, tip, base, postures=home)
    assert clearance.margin == MARGIN
    fp.Tracker(arm, fp.MVN(), home, bounds=[clearance])
    nearest = clearance.nearest(arm, home)
    assert nearest is not None
    assert nearest.distance >= MARGIN
    counts = Counter(each.name for each in clearance.capsules)
    assert max(counts.values()) <= MOST
    assert len(clearance.capsules) <= len(without.capsules) + 12
    places = read_places(ROBOTS / urdf, tip, base)[2]
    for link, shapes in read_shapes(ROBOTS / urdf).items():
        own = [each for each in clearance.capsules if each.name == link]
        for shape in (each for each in shapes if each.cylinder is None and len(each.edges)):
            moved = shape.moved(places[link][1])
            edges = moved.corners[moved.edges]
            inner = np.linspace(0, 1, 21)[:, None, None] * (edges[:, 1] - edges[:, 0]) + edges[:, 0]
            assert outside(inner.reshape(-1, 3), own) <= 1e-9, link


@with_robots
def test_accepted_postures_do_not_change_the_fit(once) -> None:
    urdf, tip, _, homes = OTHERS["panda with its hand"]
    assert fp.Clearance.from_urdf(ROBOTS / urdf, tip, postures=homes) == once(fitted, urdf, tip, None, 2)


@with_robots
@pytest.mark.parametrize("postures", [[0.0] * 5, [[[0.0] * 6]], [[np.nan] * 6], "home"])
def test_invalid_postures_are_rejected(postures: object) -> None:
    urdf, tip, _, _ = OTHERS["z1"]
    with pytest.raises(fp.ParameterError, match=r"^postures") as caught:
        fp.Clearance.from_urdf(ROBOTS / urdf, tip, postures=postures)
    assert caught.value.name == "postures"


def arm_of_boxes(folder: Path) -> Path:
    """Three boxes, links 0 and 2 beside one another at q = (0, 0), 40 mm apart: capsules about them overlap."""
    geometry = '<origin xyz="{} 0 0"/><geometry><box size="0.08 0.3 0.3"/></geometry>'
    box = '<link name="{}"><collision>' + geometry + "</collision></link>"
    joint = (
        '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><axis xyz="1 0 0"/>'
        '<limit lower="-1" upper="1" velocity="1"/></joint>'
    )
    file = folder / "boxes.urdf"
    file.write_text(
        f'<robot name="r">{box.format("l0", 0)}<link name="l1"/>{box.format("l2", 0.12)}'
        f"{joint.format('j1', 'revolute', 'l0', 'l1')}{joint.format('j2', 'prismatic', 'l1', 'l2')}</robot>"
    )
    return file


def test_group_states_are_required(tmp_path: Path) -> None:
    urdf, srdf = arm_of_boxes(tmp_path), tmp_path / "boxes.srdf"
    state = '<joint name="j1" value="0"/><joint name="j2" value="0"/>'
    arm = fp.SerialArm.from_urdf(urdf, "l2")
    for inside, accepted in ((state, True), (state.replace("j2", "finger"), False), ("", False)):
        srdf.write_text(f'<robot name="r"><group_state name="home" group="arm">{inside}</group_state></robot>')
        clearance = fp.Clearance.from_urdf(urdf, "l2", srdf=srdf)
        nearest = clearance.nearest(arm, [0, 0])
        assert nearest is not None
        assert (nearest.distance >= MARGIN) == accepted
    srdf.write_text(f'<robot name="r"><group_state name="home" group="arm">{state}</group_state></robot>')
    assert len(fp.Clearance.from_urdf(urdf, "l2", srdf=srdf, per_link=1).capsules) == 2
    allowed = fp.Clearance.from_urdf(urdf, "l2", srdf=srdf, allowed=[("l0", "l2")])
    assert allowed.capsules == fp.Clearance.from_urdf(urdf, "l2").capsules


@with_robots
def test_capsules_contain_divided_triangles(once) -> None:
    """Every triangle of a link's meshes is covered: points that fill it are each in some capsule."""
    urdf, tip, _, _ = OTHERS["panda with its hand"]
    found = once(fitted, urdf, tip, None, 2).capsules
    assert max(len([c for c in found if c.name == name]) for name in {c.name for c in found}) == 3
    trimesh = pytest.importorskip("trimesh")
    places = read_places(ROBOTS / urdf, tip)[2]
    for k in (5, 7):
        own = [c for c in found if c.name == f"panda_link{k}"]
        assert len(own) > 1
        mesh = trimesh.load(ROBOTS / f"panda_description/meshes/collision/link{k}.stl", force="mesh", process=False)
        frame = places[f"panda_link{k}"][1]
        shares = np.random.default_rng(k).dirichlet([1, 1, 1], 200)
        points = np.einsum("ij,fjk->fik", shares, np.asarray(mesh.triangles)).reshape(-1, 3)
        assert outside(points @ frame[:3, :3].T + frame[:3, 3], own) <= 1e-12


@with_robots
def test_the_fit_is_deterministic(once) -> None:
    """By default for an arm whose fit is fast."""
    urdf, tip, base, most = (*OTHERS["z1"][:3], 2) if "FPBM_ALL_HOMES" in os.environ else ARMS["ur5"]
    assert tuple(capsules_of(ROBOTS / urdf, tip, base, per_link=most)) == tuple(
        once(fitted, urdf, tip, base, most).capsules
    )


# Files whose arms, all joints at zero, have meshes closer than the margin: by Coal, 0.0 mm (links 6 and 2) and 1.0 mm
# (4 and 2) in the z1, 0.3 mm (arm_2_link and torso_fixed_column_link) in TIAGo.
CLOSE = {
    "z1": (OTHERS["z1"], r"^q0: link0[46] and link02 overlap by 0\.\d{4} m, with margin=0\.01; give allowed="),
    "tiago": (
        Other("tiago_description/robots/tiago_no_hand.urdf", "arm_7_link", "torso_lift_link", []),
        r"^q0: arm_2_link and torso_\w+ overlap by 0\.\d{4} m, with margin=0\.01; give allowed=",
    ),
}


@with_robots
@pytest.mark.parametrize("name", [pytest.param("z1", marks=heavy), "tiago"])
def test_links_that_touch_are_rejected(name: str, once) -> None:
    (urdf, tip, base, _), message = CLOSE[name]
    arm = fp.SerialArm.from_urdf(ROBOTS / urdf, tip, base)
    with pytest.raises(fp.ParameterError, match=message):
        fp.Tracker(arm, fp.MVN(), np.zeros(arm.dof), bounds=[once(fitted, urdf, tip, base, 2)])


def test_the_message_names_both_remedies() -> None:
    arm = fp.SerialArm.preset("panda")
    q = np.array([0, -PI / 4, 0, -3 * PI / 4, 0, PI / 2, PI / 4])
    capsules = fp.Clearance.preset("panda").capsules
    with pytest.raises(fp.ParameterError) as caught:
        fp.Tracker(arm, fp.MVN(), q, bounds=[fp.Clearance(capsules)])
    assert str(caught.value) == (
        "q0: panda_link7 and panda_link5 are 0.0089 m apart, closer than margin=0.01; "
        "give margin=0.0089 or allowed=[('panda_link7', 'panda_link5')]"
    )
    assert caught.value.name == "q0"
    (proposed,) = re.findall(r"give margin=(\S+) or allowed=(.*)", str(caught.value))
    fp.Tracker(arm, fp.MVN(), q, bounds=[fp.Clearance(capsules, margin=float(proposed[0]))])
    fp.Tracker(arm, fp.MVN(), q, bounds=[fp.Clearance(capsules, allowed=eval(proposed[1]))])


# Input of the cuts of capsules


def test_a_face_that_is_cut_twice_is_covered() -> None:
    """Two planes cut a face into quarters. Each quarter contains the corner where both cuts intersect."""
    whole = Shape(np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]), np.array([[0, 1], [1, 2], [2, 0]]))
    ex, ey = np.eye(3)[:2]
    for x in ((-np.inf, 1.0), (1.0, np.inf)):
        for y in ((-np.inf, 1.0), (1.0, np.inf)):
            quarter = whole.between(ex, *x).between(ey, *y)
            assert np.min(np.linalg.norm(quarter.points - [1, 1, 0], axis=1)) < 1e-12


def ball(*centre: float) -> Shape:
    return Shape(centers=np.array([centre]), radii=np.array([0.1]))


def placed(rng: np.random.Generator) -> Array:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = fp.rotation(rng.normal(size=3)), rng.uniform(-1, 1, 3)
    return frame


def test_distances_of_capsules_equal_those_of_the_extension() -> None:
    rng = np.random.default_rng(1)
    arm = fp.SerialArm([fp.Joint(), fp.Joint(placement=placed(rng), axis=(0, 1, 0)), fp.Joint(placement=placed(rng))])
    q = rng.uniform(-3, 3, (200, 3))
    frames = link_frames([fp.TreeJoint(joint, i) for i, joint in enumerate(arm.joints)], q)
    poses = np.linalg.inv(frames[:, 0]) @ frames[:, 2]
    for _ in range(10):
        one, two = (Fit(*rng.uniform(-0.5, 0.5, (2, 3)), 0.01) for _ in range(2))
        clearance = fp.Clearance([fp.Capsule(0, *one, name="a"), fp.Capsule(2, *two, name="b")], margin=0.0)
        expected = [clearance.nearest(arm, each).distance for each in q]
        found = capsules_apart([one], [two], poses)
        apart = found > 1e-9
        assert np.count_nonzero(apart) > 100
        assert np.abs(found - expected)[apart].max() < 1e-9


def test_hull_distances_are_lower_bounds() -> None:
    rng = np.random.default_rng(2)
    for _ in range(50):
        pose = placed(rng)
        exact = float(np.linalg.norm(pose[:3, 3])) - 0.2
        found = hulls_apart(ball(0, 0, 0), ball(0, 0, 0), pose)
        assert exact - 1e-3 < found <= exact + 1e-12


def test_gaps_are_measured_against_the_margin() -> None:
    """Balls of radius 5 mm, in capsules of radius 15 mm, with centres 60 mm apart: gaps of 50 mm and 30 mm."""

    def link(number: int) -> Link:
        shape = Shape(centers=np.zeros((1, 3)), radii=np.array([0.005]))
        return Link(number, number - 1, [Part(shape, Fit(np.zeros(3), np.zeros(3), 0.015))])

    frames = np.tile(np.eye(4), (8, 3, 1, 1))
    frames[:, 2, 0, 3] = 0.06
    frames[-1, 2, 0, 3] = 0.2
    assert Gaps([link(0), link(2)], frames, 0.02).worst(set()) is None
    assert Gaps([link(0), link(2)], frames, 0.03).worst(set()) == (0, 1)
    assert Gaps([link(0), link(2)], frames, 0.04).worst(set()) is None


def test_an_invalid_margin_is_rejected_before_the_fit(tmp_path: Path) -> None:
    with pytest.raises(fp.ParameterError, match=r"^margin"):
        fp.Clearance.from_urdf(tmp_path / "none.urdf", "tip", margin=-1.0)


def test_postures_fill_the_ranges() -> None:
    arm = fp.SerialArm.preset("panda")
    q = postures(arm.joints, 64)
    assert np.all((q >= arm.limits.lower) & (q <= arm.limits.upper))
    assert np.array_equal(q[0], np.clip(np.zeros(7), arm.limits.lower, arm.limits.upper))
    assert np.array_equal(q[1], (arm.limits.lower + arm.limits.upper) / 2)
    assert np.all(np.ptp(q, axis=0) > 0.9 * (arm.limits.upper - arm.limits.lower))
    assert np.all(np.isfinite(postures([fp.Joint(type="continuous", mimic=(1, 2.0, 0.5)), fp.Joint()], 8)))


def test_per_link_limits_the_number_of_capsules(tmp_path: Path) -> None:
    link = '<link name="{}"><collision><geometry><box size="0.1 0.1 0.3"/></geometry></collision></link>'
    joint = (
        '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 0.12"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1"/></joint>'
    )
    file = tmp_path / "arm.urdf"
    joints = [joint.format(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(3)]
    file.write_text(f'<robot name="r">{"".join([*(link.format(f"l{i}") for i in range(4)), *joints])}</robot>')
    assert len(capsules_of(file, "l3", per_link=1)) == 4
