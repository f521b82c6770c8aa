"""CMake blocks: each a whole CMakeLists.txt, built beside an installed fpbm and its sources."""

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
        Path(project, "fpbm").symlink_to(ROOT)
        options = [f"-DCMAKE_PREFIX_PATH={prefix}", f"-DFETCHCONTENT_SOURCE_DIR_FPBM={ROOT}"]
        if "find_package(fpbm" in example.parsed:
            build = f"{scratch}/fpbm"
            cmake("-S", str(ROOT), "-B", build, "-DFPBM_BUILD_TESTS=OFF", "-DFPBM_BUILD_EXAMPLES=OFF")
            cmake("--install", build, "--prefix", str(prefix))
        cmake("-S", str(project), "-B", f"{scratch}/build", *options)
        cmake("--build", f"{scratch}/build")


def cmake(*arguments: str) -> None:
    done = subprocess.run(["cmake", *arguments], capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, f"cmake {' '.join(arguments)}\n{done.stdout}{done.stderr}"
