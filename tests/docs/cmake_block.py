"""CMake blocks: each a whole CMakeLists.txt, built as it is typed, in a new folder beside a clone."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
MAIN = "#include <fpbm/fpbm.hpp>\nint main() { return fpbm::failed(fpbm::Status::kOk); }\n"


def build_project(example: Any) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        project, prefix = Path(scratch, "project"), Path(scratch, "prefix")
        project.mkdir()
        Path(project, "CMakeLists.txt").write_text(str(example.parsed))
        Path(project, "main.cpp").write_text(MAIN)
        clone(Path(scratch, "fpbm_cpp"))
        if "find_package(fpbm" in example.parsed:
            options = ["-DFPBM_BUILD_TESTS=OFF", "-DFPBM_BUILD_EXAMPLES=OFF"]
            run("cmake", "-S", str(ROOT), "-B", f"{scratch}/fpbm", *options)
            run("cmake", "--install", f"{scratch}/fpbm", "--prefix", str(prefix))
        run("cmake", "-S", str(project), "-B", f"{scratch}/build", f"-DCMAKE_PREFIX_PATH={prefix}")
        cache = Path(scratch, "build", "CMakeCache.txt").read_text()
        assert "CMAKE_BUILD_TYPE:STRING=Release\n" in cache, "the block sets no build type"
        run("cmake", "--build", f"{scratch}/build")


def clone(folder: Path) -> None:
    """A clone of the present sources with a branch main, also if this folder has changes."""
    folder.mkdir()
    listed = run("git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "CMakeLists.txt", "cmake", "cpp")
    for file in filter(None, listed.split("\0")):
        folder.joinpath(file).parent.mkdir(parents=True, exist_ok=True)
        folder.joinpath(file).write_bytes((ROOT / file).read_bytes())
    git = ["git", "-C", str(folder), "-c", "user.name=test", "-c", "user.email=test@example.org"]
    run("git", "init", "--quiet", "--initial-branch", "main", str(folder))
    run(*git, "add", ".")
    run(*git, "commit", "--quiet", "--message", "Sources")


def run(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
    return done.stdout
