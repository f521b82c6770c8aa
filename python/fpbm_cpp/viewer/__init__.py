"""The viewer: a page in the browser with the arm, the time and the scheme's parameters. Needs the extra 'view'.

Data flows one way. The page asks for a scheme (controls) and a time (player); the motion is made again under the
scheme (rerun) and prepared for drawing (playback); the scene, the chart and the readout draw it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .entry import view

if TYPE_CHECKING:
    from .viewer import Viewer

__all__ = ["Viewer", "view"]


def __getattr__(name: str) -> Any:
    """Import Viewer, which needs viser, when it is first used."""
    if name != "Viewer":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .viewer import Viewer

    return Viewer
