"""A page in a browser without a screen."""

from __future__ import annotations

import shutil
import time
from contextlib import contextmanager

import pytest

FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@contextmanager
def opened(folder, width, height):
    """A page of this size, in a browser whose profile is in a folder. Skips the test if there is no browser."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("chromium is not installed")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as tools:
        size = {"width": width, "height": height}
        how = {"executable_path": chromium, "args": FLAGS, "viewport": size, "headless": True}
        with tools.chromium.launch_persistent_context(folder, **how) as browser:
            browser.set_default_timeout(120_000)
            yield browser.pages[0]


def eventually(page, check):
    """Waits until a check holds, as long as a machine without a graphics processor may need."""
    end = time.monotonic() + 120
    while not check():
        assert time.monotonic() < end, check
        page.wait_for_timeout(50)
