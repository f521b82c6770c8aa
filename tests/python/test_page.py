"""The interactive page: its numbers are those of the package, and its controls work."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest
from browser import eventually, opened

import fpbm_cpp as fp

ROOT = Path(__file__).parents[2]
PAGE = Path(os.environ.get("FPBM_PAGE", ROOT / "build/web/page.html"))
SOURCES = [path for folder in ("web", "cpp/include") for path in (ROOT / folder).rglob("*") if path.is_file()]

pytestmark = pytest.mark.skipif(
    not PAGE.exists() or PAGE.stat().st_mtime < max(path.stat().st_mtime for path in SOURCES),
    reason="the page is not built, or older than its sources: make page",
)

BENT = np.pi / np.array([12, 12, 15, 15])
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
CHAIN = {"lower": [-2.8] * 4, "upper": [2.8] * 4, "velocity": [2.5] * 4, "acceleration": [20] * 4, "jerk": [1000] * 4}
PANDA = fp.SerialArm.preset("panda")
UPRIGHT = fp.Circle(0.15, 4.0, time_law="quintic").in_plane("yz")
ARMS = [
    (fp.PlanarArm([1, 1, 1, 1]), "position", BENT, fp.JointLimits(**CHAIN), fp.Circle(0.45, 10.0), [4, 20, 400]),
    (PANDA, "pose", READY, PANDA.limits, UPRIGHT, [1, 5, 100, 2, 10, 200]),
    (PANDA, "position", READY, PANDA.limits, UPRIGHT, [1, 5, 100]),
]
BOUNDS = ["velocity", "acceleration", "jerk", "angular_velocity", "angular_acceleration", "angular_jerk"]


def schemes(n, damping):
    W = np.arange(1, n + 1)
    options = {"null_damping": damping}
    return [
        fp.MVN(k=5),
        fp.WMVN(W, k=5),
        fp.MAN(**options),
        fp.WMVNAcceleration(W, **options),
        fp.FPBM(0.6, W, 10, 25, **options),
    ]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The page, by file://, with its clock stopped. The browser must report no errors."""
    errors = []
    with opened(tmp_path_factory.mktemp("browser"), 1280, 800) as page:
        page.on("console", lambda message: errors.append(message.text))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: errors.append(request.url) if "http" in request.url else None)
        page.goto(PAGE.as_uri())
        page.wait_for_function("window.fpbm")
        yield page
    assert errors == []


def begin(page, arm, **settings):
    page.evaluate("([arm, settings]) => { fpbm.pause(); fpbm.arm(arm); fpbm.set(settings); }", [arm, settings])


def state(page):
    q, qd, n = page.evaluate("[[...fpbm.simulator.q], [...fpbm.simulator.qd], fpbm.simulator.dof]")
    return np.array(q[: int(n)]), np.array(qd[: int(n)])


def number(page, name):
    return page.evaluate(f"fpbm.simulator.{name}")


def run(page, seconds):
    """Frames of 17 ticks."""
    page.evaluate("n => { for (let k = 0; k < n; ++k) fpbm.show.run(17); fpbm.paint(); }", round(seconds / 0.017))


def a_tracker(which, kind, limited, damping):
    arm, task, q0, limits, path, bounds = ARMS[which]
    free = fp.JointLimits(**{name: getattr(fp.PlanarArm([1] * arm.dof).limits, name) for name in CHAIN})
    scheme = schemes(arm.dof, damping)[kind]
    limits = limits if limited else free
    tracker = fp.Tracker(arm, scheme, q0, task=task, limits=limits, null_damping=0.0)  # As the page.
    return tracker, path, fp.TargetFilter(tracker.tip, task=task, **dict(zip(BOUNDS, bounds)))


@pytest.mark.parametrize("damping", [0, 2])
@pytest.mark.parametrize("limited", [0, 1])
@pytest.mark.parametrize("kind", range(5))
@pytest.mark.parametrize("which", range(3))
def test_ticks_of_the_page_equal_those_of_the_package(page, which, kind, limited, damping):
    tracker, path, targets = a_tracker(which, kind, limited, damping)
    begin(page, which, scheme=kind, limited=limited, damping=damping, alpha=0.6, feedback=5, weights=[*range(1, 8)])
    page.evaluate("fpbm.simulator.followPath(), fpbm.simulator.ticks(11000)")
    follower = tracker.follow(path)
    for _ in range(11000):
        tracker.tick(follower)
    q, qd = state(page)
    np.testing.assert_allclose(q, tracker.q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(qd, tracker.qd, rtol=0, atol=1e-12)

    tracker, _, targets = a_tracker(which, kind, limited, damping)
    page.evaluate("fpbm.simulator.restart()")
    to = tracker.tip
    place = to[:3, 3] if which == 1 else to
    place -= [0.8, 0.3] if which == 0 else [0.15, -0.1, 0.1]
    page.evaluate("x => { fpbm.simulator.push(...x); fpbm.simulator.ticks(700); }", [*place, 0][:3])
    targets.push(to)
    for _ in range(700):
        tracker.tick(targets)
    q, qd = state(page)
    np.testing.assert_allclose(q, tracker.q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(qd, tracker.qd, rtol=0, atol=1e-8)


def test_the_papers_drift(page):
    begin(page, 0, scheme=4, alpha=0.6, damping=0, limited=1, feedback=5)
    page.evaluate("fpbm.simulator.followPath(), fpbm.simulator.ticks(10000)")
    q, _ = state(page)
    page.evaluate("fpbm.simulator.ticks(30000)")
    assert abs(state(page)[0] - q).max() == pytest.approx(0.66, abs=0.01)  # As the README says.
    assert number(page, "fastest") > 0.03
    assert number(page, "error") < 1e-9
    page.evaluate("fpbm.set({ damping: 2 }), fpbm.simulator.ticks(15000)")
    assert number(page, "fastest") < 1e-9
    assert number(page, "error") < 1e-9


def test_the_steps_of_a_visitor(page):
    """By true events of a mouse: drag, release, increase the damping."""
    page.reload()
    page.wait_for_function("window.fpbm")
    assert page.locator("#install").is_visible()
    assert page.locator("#install").inner_text() == "pip install ."
    page.evaluate("fpbm.pause()")
    run(page, 1)
    page.locator("#rest").click()
    run(page, 1)
    assert page.locator("#step-drag").get_attribute("class") == "now"  # The user has not dragged yet.
    x, y = page.evaluate("fpbm.onPage(fpbm.show.goal)")
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(1, 31):
        page.mouse.move(x - 5 * k, y + 60 * math.sin(0.1 * k))
        run(page, 0.034)
    to = page.evaluate("fpbm.show.goal")
    np.testing.assert_allclose(page.evaluate("fpbm.onPage(fpbm.show.goal)"), [x - 150, y + 60 * math.sin(3)], atol=1)
    page.mouse.up()
    run(page, 4)
    np.testing.assert_allclose(page.evaluate("[...fpbm.simulator.tip]")[:2], to[:2], atol=1e-3)
    assert page.locator("#step-drag").get_attribute("class") == "done"
    assert page.locator("#step-rest").get_attribute("class") == "done"
    assert float(page.locator("#speed").inner_text()) > 0.5
    assert "nothing in this scheme brakes them" in page.locator("#status").inner_text()
    page.locator("#damping").fill("4")
    run(page, 5)
    assert page.locator("#step-damp").get_attribute("class").split() == ["done", "last"]
    assert float(page.locator("#speed").inner_text()) < 0.05
    np.testing.assert_allclose(page.evaluate("[...fpbm.simulator.tip]")[:2], to[:2], atol=1e-6)


@pytest.mark.parametrize("which", [0, 1])
def test_undamped_self_motion_drifts(page, which):
    begin(page, which, damping=3)
    page.locator("#restart").click()
    run(page, 0.1)
    assert number(page, "fastest") == 0
    page.locator("#rest").click()
    run(page, 12)
    assert page.evaluate("fpbm.show.resting")
    assert number(page, "settings")["damping"] == 0
    assert number(page, "fastest") > 0.02
    assert page.evaluate("fpbm.stage.ghost.visible")


def test_every_control_keeps_the_limits(page):
    """After every choice during a motion, the arm continues to move within its limits."""
    rng = np.random.default_rng(0)
    page.evaluate("fpbm.pause()")
    for which, (arm, _, _, limits, _, _) in enumerate(ARMS):
        page.locator("input[name=arm]").nth(which).check(force=True)
        assert number(page, "dof") == arm.dof
        for _ in range(25):
            page.locator("#scheme").select_option(str(rng.integers(5)))
            page.locator("#limited").set_checked(bool(rng.random() < 0.7))
            page.evaluate("x => fpbm.set(x)", {"damping": 5 * rng.random(), "alpha": rng.random()})
            place = page.evaluate("[...fpbm.simulator.tip]") + rng.normal(size=3) * 0.3
            page.evaluate("x => { fpbm.show.take(); fpbm.show.move(x); fpbm.show.release(); }", place.tolist())
            run(page, 0.3)
            q, qd = state(page)
            assert np.isfinite(q).all()
            if page.locator("#limited").is_checked():
                assert (limits.lower - 1e-9 <= q).all()
                assert (q <= limits.upper + 1e-9).all()
                assert (abs(qd) <= limits.velocity + 1e-9).all()
    with pytest.raises(Exception, match="out of range"):
        page.evaluate("fpbm.set({ alpha: 2 })")


def test_keys_move_the_target(page):
    page.reload()
    page.wait_for_function("window.fpbm")
    begin(page, 0)
    page.evaluate("fpbm.show.restart()")
    page.locator("#arm").focus()
    before = page.evaluate("fpbm.show.goal")
    page.keyboard.press("ArrowLeft")
    after = page.evaluate("fpbm.show.goal")
    assert after[0] < before[0] - 0.02
    assert abs(after[1] - before[1]) < 0.01
    run(page, 0.1)
    assert page.locator("#step-drag").get_attribute("class") == "done"


def test_the_target_stays_visible(page):
    """A target that is dragged out of the window stays visible. A drag beside the target does not rotate the view."""
    begin(page, 0)
    page.evaluate("fpbm.show.restart()")
    box = page.locator("#arm").bounding_box()
    view = page.evaluate("fpbm.stage.camera.position.toArray()")
    page.mouse.move(box["x"] + 60, box["y"] + box["height"] - 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 200, box["y"] + 40, steps=5)
    page.mouse.up()
    run(page, 0.2)
    np.testing.assert_allclose(page.evaluate("fpbm.stage.camera.position.toArray()"), view, rtol=0, atol=1e-9)
    page.mouse.move(*page.evaluate("fpbm.onPage(fpbm.show.goal)"))
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] + 150, box["y"] - 30, steps=5)
    page.mouse.up()
    x, y = page.evaluate("fpbm.onPage(fpbm.show.goal)")
    assert box["x"] < x < box["x"] + box["width"]
    assert box["y"] < y < box["y"] + box["height"]


@pytest.mark.parametrize(("kind", "seen"), [(0, "k"), (1, "kW"), (2, ""), (3, "W"), (4, "αkW")])
def test_a_scheme_shows_its_parameters(page, kind, seen):
    begin(page, 0, scheme=kind)
    rows = {"α": "#alpha-row", "k": "#feedback-row", "W": "#weights-row"}
    assert {name for name, row in rows.items() if page.locator(row).is_visible()} == set(seen)


def test_a_remaining_tip_error_is_explained(page):
    """Without feedback, an initial tip error persists although the target is reachable."""
    begin(page, 0, scheme=2, damping=5, limited=1)
    page.evaluate("fpbm.show.restart()")
    x, y, _ = page.evaluate("[...fpbm.simulator.tip]")
    page.evaluate("x => { fpbm.show.take(); fpbm.show.move(x); fpbm.show.release(); }", [x - 2.5, y - 1.5, 0])
    run(page, 20)
    assert number(page, "error") > 0.01
    assert "no feedback" in page.locator("#status").inner_text()


def test_ticks_of_a_frame_are_fast_enough(page):
    begin(page, 1, scheme=4, limited=1, damping=2)
    page.evaluate("fpbm.simulator.followPath()")
    frame = """() => { const start = performance.now(); for (let k = 0; k < 100; ++k) fpbm.show.run(17);
                       return (performance.now() - start) / 100; }"""
    page.evaluate(frame)
    milliseconds = page.evaluate(frame)
    print(f"17 ticks of a Panda: {milliseconds:.2f} ms of a frame's 16.7 ms")
    assert milliseconds < 4


def test_on_a_phone(page):
    page.set_viewport_size({"width": 390, "height": 844})
    page.reload()
    page.wait_for_function("window.fpbm")
    eventually(page, lambda: number(page, "time") > 0.1)  # By the clock of the page.
    page.evaluate("fpbm.pause()")
    run(page, 0.1)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    for seen in ("#arm", "#speed", "#damping", "#rest", "#install"):
        box = page.locator(seen).bounding_box()
        assert box["y"] + box["height"] <= 844, seen

    browser = page.context.new_cdp_session(page)
    browser.send("Emulation.setTouchEmulationEnabled", {"enabled": True})

    def touch(kind, *points):
        fingers = [{"x": x, "y": y} for x, y in points]
        browser.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    x, y = page.evaluate("fpbm.onPage(fpbm.show.goal)")
    touch("touchStart", (x + 30, y + 30))  # Beside the target: fingers are inaccurate.
    for k in range(1, 21):
        touch("touchMove", (x + 30 - 4 * k, y + 30 + k))
        run(page, 0.05)
    touch("touchEnd")
    run(page, 3)
    np.testing.assert_allclose(page.evaluate("fpbm.onPage([...fpbm.simulator.tip])"), [x - 80, y + 20], atol=1)
    assert page.evaluate("scrollY") == 0
