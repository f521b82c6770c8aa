"""The viewer in the browser: a page with the arm, the time, and the scheme's gains. Needs the extra 'view'.

Data flows one way. What the page asks for is a scheme (controls) and a time (player); a job makes a run of the scheme,
a film is what is drawn of a run, and the scene, the chart and the read-out draw it.
"""

try:
    import viser  # noqa: F401
    import yourdfpy  # noqa: F401
except ModuleNotFoundError as missing:
    raise ImportError('viewing needs viser: pip install "fpbm_cpp[view]"') from missing

from .viewer import Viewer

__all__ = ["Viewer"]
