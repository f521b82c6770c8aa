#!/bin/sh
# Uses fpbm as others do: installed into a prefix of its own and found there, then as a subdirectory.
# usage: run.sh <source dir> <scratch dir> [generator] [C++ compiler]
set -eu
source_dir=$1
scratch=$2
generator=${3:-Ninja}
compiler=${4:-c++}
consumer=$source_dir/tests/package

configure() {
  cmake -G "$generator" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release "$@" >/dev/null
}

rm -rf "$scratch"

# Installed: the headers and the package files, without the tests and the examples.
configure -S "$source_dir" -B "$scratch/fpbm" -DCMAKE_INSTALL_PREFIX="$scratch/prefix" \
  -DFPBM_BUILD_TESTS=OFF -DFPBM_BUILD_EXAMPLES=OFF
cmake --build "$scratch/fpbm" >/dev/null
cmake --install "$scratch/fpbm" >/dev/null

# Moved: nothing installed may remember where it was.
mv "$scratch/prefix" "$scratch/elsewhere"
rm -rf "$scratch/fpbm"
configure -S "$consumer" -B "$scratch/installed" -DCMAKE_PREFIX_PATH="$scratch/elsewhere"
cmake --build "$scratch/installed"
grep -q "fpbm_DIR:PATH=$scratch/elsewhere" "$scratch/installed/CMakeCache.txt"
"$scratch/installed/consumer"

# As a subdirectory, which brings the library alone: none of our tests, examples or warnings.
configure -S "$consumer" -B "$scratch/subdirectory" -DFPBM_SOURCE_DIR="$source_dir"
cmake --build "$scratch/subdirectory"
"$scratch/subdirectory/consumer"
if [ -e "$scratch/subdirectory/fpbm/tests" ]; then
  echo "add_subdirectory brought our tests along" >&2
  exit 1
fi
