#!/bin/sh
# Writes the source distribution to dist/, and checks that the archive has exactly the files for building and testing.
#   sdist.sh PYTHON
# PYTHON must have the packages of the dependency group `wheel`.
set -eu
python=$1
rm -rf dist

"$python" -m build --sdist --outdir dist .
archive=$(ls dist/*.tar.gz)
"$python" -m twine check --strict "$archive"

expected="CHANGELOG.md CITATION.cff CMakeLists.txt LICENSE PKG-INFO README.md cmake cpp examples pyproject.toml python tests"
found=$(tar -tzf "$archive" | cut -d / -f 2 | LC_ALL=C sort -u | xargs)
if test "$found" != "$expected"; then
    printf '%s holds\n  %s\nand should hold\n  %s\n' "$archive" "$found" "$expected" >&2
    exit 1
fi
if tar -tzf "$archive" | grep -E '\.(png|pdf|so|pyd|o|pyc)$'; then
    echo "$archive contains generated files" >&2
    exit 1
fi
echo "$archive has $(stat --format %s "$archive") bytes"
