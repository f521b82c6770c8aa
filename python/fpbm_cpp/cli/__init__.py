"""The command line fpbm-cpp, built on click."""

import click

from .._core import __version__
from .inverse import inverse
from .motions import compare, fastest, servo, track, view
from .studies import sweep, tune
from .tools import bench, completion, export_capsules, export_header, reproduce

__all__ = ["command"]


class _InOrder(click.Group):
    """A group that lists its commands in the order of their definition."""

    def list_commands(self, context: click.Context) -> list[str]:
        return list(self.commands)


@click.group(
    cls=_InOrder,
    commands=[
        *(inverse, track, fastest, compare, sweep, tune, view, servo),
        *(bench, reproduce, export_header, export_capsules, completion),
    ],
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110, "show_default": True},
    epilog="""\b
Examples:
  fpbm-cpp track panda
  fpbm-cpp compare planar:1,1,1,1 --radius 0.45 --out circle
  fpbm-cpp track --help""",
)
@click.version_option(__version__, prog_name="fpbm-cpp")
def command() -> None:
    """Redundancy resolution for robot arms: MVN, WMVN, MAN and FPBM.

    Units are radians, metres and seconds.
    """
