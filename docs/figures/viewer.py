"""The viewer, with a Panda halfway along its circle: draws viewer.png in a headless browser.

    python docs/figures/viewer.py [where to write the picture]

Needs the dependency groups 'browser' and 'peers' (for the Panda's meshes), and chromium. Without a graphics processor
this script takes minutes.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

import fpbm_cpp as fp
from fpbm_cpp.viewer import Viewer
from fpbm_cpp.viewer.page import Page

ROBOTS = "cmeel.prefix/share/example-robot-data/robots"
SIZE = {"width": 1440, "height": 900}
PATIENCE = 600_000  # [ms]
FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def panda_file() -> Path:
    """The Panda's URDF file, beside its meshes."""
    robots = Path(str(metadata.distribution("example-robot-data").locate_file(ROBOTS)))
    return robots / "panda_description/urdf/panda.urdf"


def a_viewer() -> Viewer:
    urdf = panda_file()
    arm = fp.SerialArm.from_urdf(urdf, tip="panda_link8")
    path = fp.Circle(0.15, duration=10.0).in_plane("yz")
    scheme = fp.FPBM(0.6, weights=np.ones(7), k1=10.0, k2=25.0, null_damping=2.0)
    q0 = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
    return Viewer(fp.simulate(arm, path, scheme, q0, task="pose", hold=2.0), urdf=urdf, port=0)


def photograph(shown: Page, target: Path, text: str, then: Callable[[], None] = lambda: None) -> None:
    """Saves a screenshot of a page after the page shows the text and `then` was called."""
    with tempfile.TemporaryDirectory() as profile, sync_playwright() as tools:
        how: dict[str, Any] = {"executable_path": shutil.which("chromium"), "args": FLAGS, "viewport": SIZE}
        with tools.chromium.launch_persistent_context(profile, **how) as browser:
            page = browser.pages[0]
            page.set_default_timeout(PATIENCE)
            page.goto(shown.url)
            page.get_by_text(text).first.wait_for()
            page.add_style_tag(content=".mantine-Notifications-root { display: none }")  # Message: no GPU.
            page.wait_for_timeout(10_000)  # Meshes load last.
            then()
            page.screenshot(path=target)


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "viewer.png"
    with a_viewer() as viewer:
        viewer.time = 6.0
        photograph(viewer, target, "manipulability")


if __name__ == "__main__":
    main()
