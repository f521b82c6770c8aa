"""The command inverse: postures for a pose of the tip."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from .._core import PRESETS, rotation
from .._types import Array
from ..motion.comparison import columns
from ..schemes import FPBM
from ..urdf.place import pose
from .plain import PLACE, Plain, import_viser, read_arm

ROTATIONS = {3: "roll, pitch, yaw about fixed axes [rad]", 4: "quaternion x, y, z, w", 9: "matrix, row by row"}
RANKS = {"distance": "distance from the start", "manipulability": "manipulability", "ranges": "distance from the ends"}
NUMBERS = ("--position", "--rotation", "--start")


class _Numbers(Plain):
    """A command whose options for several numbers accept commas and spaces."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        joined: list[str] = []
        for text in args:
            follows = len(joined) > 1 and joined[-2] in NUMBERS and _is_number(joined[-1].split(",")[-1])
            if follows and _is_number(text):
                joined[-1] += f",{text}"
            else:
                joined.append(text)
        return super().parse_args(context, joined)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _numbers(name: str, text: str, sizes: Sequence[int]) -> Array:
    parts = text.replace(" ", ",").split(",")
    if len(parts) not in sizes or not all(map(_is_number, parts)):
        wanted = " or ".join(map(str, sizes))
        raise click.ClickException(f"{name} = {text!r}: must be {wanted} numbers, separated by commas or spaces")
    return np.array(parts, dtype=float)


def rotation_matrix(numbers: Array) -> Array:
    """Rotation matrix of roll, pitch and yaw, of a quaternion of any length, or of nine entries."""
    if numbers.size == 9:
        return numbers.reshape(3, 3)
    if numbers.size == 3:
        return pose([0.0, 0.0, 0.0], numbers)[:3, :3]
    vector, length = numbers[:3], float(np.linalg.norm(numbers[:3]))
    if not numbers.any():
        raise click.ClickException("--rotation is zero: a quaternion must have a nonzero length")
    return rotation(2.0 * np.arctan2(length, numbers[3]) * vector / (length or 1.0))


@click.command(
    cls=_Numbers,
    short_help="Compute postures for a pose of the tip.",
    epilog="""\b
Examples:
  fpbm-cpp inverse panda --position 0.5 0 0.4 --rotation 1 0 0 0
  fpbm-cpp inverse my_arm.urdf --tip tool0 --position 0.4,0.1,0.3 --count 4 --view""",
)
@click.argument("arm", metavar="ARM", type=PLACE)
@click.option("--tip", metavar="LINK", help="Tip link of a URDF file.")
@click.option("--base", metavar="LINK", help="Base link of a URDF file; default: the root.")
@click.option("--position", metavar="X Y Z", required=True, help="Position of the tip in the base frame [m].")
@click.option(
    "--rotation",
    metavar="NUMBERS",
    help=f"{'; or '.join(ROTATIONS.values())}. Without a rotation, the orientation of the tip is free.",
)
@click.option("--start", metavar="NUMBERS", help="Start posture [rad or m]; default: the middle of the ranges.")
@click.option("--count", type=click.IntRange(1, 1000), default=8, help="Largest number of postures.")
@click.option("--rank", type=click.Choice(list(RANKS)), default="distance", help="Order of the postures.")
@click.option("--starts", type=click.IntRange(1), default=256, help="Largest number of start postures.")
@click.option("--tolerance", type=float, default=1e-6, help="Largest distance [m] and angle [rad] from the pose.")
@click.option("--view", is_flag=True, help="Open the first posture in the browser, where the tip can be dragged.")
def inverse(
    arm: Path,
    tip: str | None,
    base: str | None,
    position: str,
    rotation: str | None,
    start: str | None,
    count: int,
    rank: str,
    starts: int,
    tolerance: float,
    view: bool,
) -> None:
    """Compute postures for a pose of the tip, the nearest to the start first.

    ARM is a preset, such as panda or ur5e, or a URDF file with --tip. Prints a row for each posture: the joint
    positions, the distance from the start, and the distance from the pose. If no posture is found, prints the nearest
    posture, and the exit status is 1. With --rank manipulability, the posture with the largest manipulability is first;
    with --rank ranges, the posture that is farthest from the ends of the ranges, as a fraction of the range. This value
    replaces the distance from the start.
    """
    try:
        chain = read_arm(arm, tip, base)
        target: Any = _numbers("--position", position, [3])
        if rotation is not None:
            turn = rotation_matrix(_numbers("--rotation", rotation, list(ROTATIONS)))
            target = np.block([[turn, target[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
        begin = None if start is None else _numbers("--start", start, [chain.dof])
        task = "position" if rotation is None else "pose"
        options: dict[str, Any] = {"task": task, "starts": starts, "tolerance": tolerance}
        found = chain.inverse_all(target, begin, count, rank=rank, **options)
        shown: list[Any] = found or [chain.inverse(target, begin, **options)]
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    rows = [
        [
            str(i),
            *(f"{x:.4f}" for x in each.q),
            "-" if each.rank_value is None else f"{each.rank_value:.3f}",
            f"{each.error:.0e}",
        ]
        for i, each in enumerate(shown, 1)
    ]
    slides = any(joint.type == "prismatic" for joint in chain.joints)
    click.echo(f"Joint positions [{'rad or m' if slides else 'rad'}], {RANKS[rank]}, error [m or rad]")
    click.echo(columns(["", *chain.joint_names, "from start" if rank == "distance" else rank, "error"], *rows))
    if not found:
        raise click.ClickException(
            f"no posture found: the posture above is {shown[0].error:.3g} m or rad from the pose; "
            "the pose may be unreachable"
        )
    if view:
        import_viser()
        from ..viewer import servo

        scheme = FPBM(0.6, weights=np.ones(chain.dof), k1=10.0, k2=25.0, null_damping=2.0)
        servo(chain, scheme, shown[0].q, task=task, urdf=None if str(arm) in PRESETS else arm)
