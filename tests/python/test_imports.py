"""The modules of the package form no circles, not even through imports inside functions or for type checkers."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import fpbm_cpp as fp

FOLDER = Path(fp.__file__).parent
# Imports inside Run.plot(), Run.view() and Run.save().
LATE = {
    ("fpbm_cpp.motion.run", "fpbm_cpp.plot"),
    ("fpbm_cpp.motion.run", "fpbm_cpp.viewer"),
    ("fpbm_cpp.motion.run", "fpbm_cpp.io.run_file"),
}


def named(file: Path, folder: Path) -> str:
    parts = file.relative_to(folder.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(file: Path, module: str) -> Iterator[str]:
    """Names of the modules and of the objects that a file imports, anywhere in the file."""
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        if isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
            origin = ".".join([*above, *filter(None, [node.module])])
            yield from (f"{origin}.{each.name}" for each in node.names)


def graph(folder: Path) -> dict[str, set[str]]:
    """For each module of the package in a folder, the modules that it imports."""
    files = {named(file, folder): file for file in folder.rglob("*.py")}
    found: dict[str, set[str]] = {}
    for module, file in files.items():
        names = {each if each in files else each.rpartition(".")[0] for each in imports(file, module)}
        found[module] = {each for each in names if each in files and each != module}
    return found


def circle(modules: dict[str, set[str]]) -> list[str]:
    """The modules of a circle; empty if there is none."""
    try:
        TopologicalSorter(modules).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_modules_form_no_circle() -> None:
    modules = graph(FOLDER)
    assert len(modules) > 80
    pairs = {(module, each) for module in modules for each in modules[module]}
    assert pairs >= LATE
    known = {module: {each for each in modules[module] if (module, each) not in LATE} for module in modules}
    assert circle(known) == []


def test_a_circle_through_a_function_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "package"
    (folder / "inner").mkdir(parents=True)
    (folder / "__init__.py").write_text("from .one import x\n")
    (folder / "one.py").write_text("def late():\n    from .inner import two\n    return two\n")
    (folder / "inner" / "__init__.py").write_text("")
    (folder / "inner" / "two.py").write_text("from typing import TYPE_CHECKING\n")
    assert circle(graph(folder)) == []
    (folder / "inner" / "two.py").write_text("if 0:\n    from ..one import late\n")
    assert set(circle(graph(folder))) == {"package.one", "package.inner.two"}
