"""fpbm-cpp export-header."""

from pathlib import Path

import click

from .plain import Plain, file_errors, file_option


@click.command(
    "export-header",
    short_help="Write the arm of a URDF file in C++.",
    cls=Plain,
    epilog="Example: fpbm-cpp export-header my_arm.urdf --tip tool -o my_arm.hpp",
)
@click.argument("urdf", metavar="ARM.urdf", type=click.Path(path_type=Path))
@click.option("--tip", metavar="LINK", required=True, help="Link to move.")
@click.option("--base", metavar="LINK", help="Link that stays; the root unless given.")
@file_option(
    "-o",
    "--out",
    metavar="FILE.hpp",
    required=True,
    help="Header to write, whole or not at all; - is the standard output.",
)
@click.option("--name", metavar="NAMESPACE", help="C++ namespace; after the header's file name unless given.")
def export_header(urdf: Path, tip: str, base: str | None, out: Path, name: str | None) -> None:
    """Write the arm of a URDF file as a C++ header.

    The header constructs the arm from base to tip, with neither parser nor file when the program runs.
    """
    from ..io.header import export_header, namespace_of
    from ..io.urdf import read_urdf
    from ..io.write_whole import write_whole

    to_stdout = str(out) == "-"
    source = f"{urdf.name}, {f'base {base}, ' if base else ''}tip {tip}"
    try:
        with file_errors("read", urdf):
            joints, frame = read_urdf(urdf, tip, base)
        name = name or namespace_of((urdf if to_stdout else out).stem)
        header = export_header(joints, frame, name=name, source=source)
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    if to_stdout:
        click.echo(header, nl=False)
        return
    with file_errors("write to", out):
        write_whole(out.resolve(), header.encode())
