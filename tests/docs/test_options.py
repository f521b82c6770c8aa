"""The table of options in docs/realtime.md names the keyword arguments of Tracker, track and sweep."""

import inspect
import re
from pathlib import Path

import fpbm_cpp as fp

SECTION = (Path(__file__).parents[2] / "docs" / "realtime.md").read_text().partition("\n## Options\n")[2]
ONLY_TRACKER = {"recovery", "measured_delay", "keep_first_level"}


def options() -> set[str]:
    """Names of the first column: in Python where they differ from C++."""
    cells = re.findall(r"^\| (`[^|]+?) \|", SECTION.partition("\n\n**")[0], re.MULTILINE)
    return {name for cell in cells for name in re.findall(r"`(\w+)`", cell.partition(";")[2] or cell)}


def test_every_option_is_a_keyword_of_a_tracker() -> None:
    assert len(options()) >= 12
    assert options() <= set(re.findall(r"(\w+):", str(fp.Tracker.__init__.__doc__)))


def test_the_page_names_the_options_that_track_and_sweep_do_not_have() -> None:
    sentence = SECTION.partition("\n|")[0]
    assert {name for name in options() if f"`{name}`" in sentence} == ONLY_TRACKER | {"recover_start"}
    assert options() - set(inspect.signature(fp.track).parameters) == ONLY_TRACKER
    assert options() - set(inspect.signature(fp.sweep).parameters) == ONLY_TRACKER | {"recover_start"}
