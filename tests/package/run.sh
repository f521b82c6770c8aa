#!/bin/sh
# Uses fpbm as user projects do: installed into a separate prefix and found by CMake and by pkg-config, as a
# subdirectory, and fetched.
# usage: run.sh <source dir> <scratch dir> [generator] [C++ compiler]
set -eu
source_dir=$1
scratch=$2
generator=${3:-Ninja}
compiler=${4:-c++}
consumer=$source_dir/tests/package
unset CXXFLAGS

configure() {
  cmake -G "$generator" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 "$@" \
    >/dev/null
}
fail() {
  echo "$*" >&2
  exit 1
}

rm -rf "$scratch"

# Installed: the headers and the package files, without the tests and the examples.
configure -S "$source_dir" -B "$scratch/fpbm" -DCMAKE_INSTALL_PREFIX="$scratch/prefix" \
  -DFPBM_BUILD_TESTS=OFF -DFPBM_BUILD_EXAMPLES=OFF
cmake --build "$scratch/fpbm" >/dev/null
cmake --install "$scratch/fpbm" >/dev/null

# Moved: the installed files must not contain their first location.
prefix=$scratch/elsewhere
mv "$scratch/prefix" "$prefix"
rm -rf "$scratch/fpbm"
configure -S "$consumer" -B "$scratch/installed" -DCMAKE_PREFIX_PATH="$prefix"
cmake --build "$scratch/installed"
grep -q "fpbm_DIR:PATH=$prefix" "$scratch/installed/CMakeCache.txt"
"$scratch/installed/consumer"

# The same program with flags from pkg-config.
flags=$(PKG_CONFIG_PATH="$prefix/share/pkgconfig" pkg-config --cflags fpbm)
# shellcheck disable=SC2086 # Several words.
"$compiler" -std=c++17 -fsyntax-only "$consumer/main.cpp" $flags

# As a subdirectory, which adds only the library, without our tests, examples or flags.
configure -S "$consumer" -B "$scratch/subdirectory" -DFPBM_SOURCE_DIR="$source_dir"
test ! -e "$scratch/subdirectory/fpbm/tests" || fail "add_subdirectory added the tests of fpbm"
test ! -e "$scratch/subdirectory/fpbm/examples" || fail "add_subdirectory added the examples of fpbm"
cmake --build "$scratch/subdirectory"
"$scratch/subdirectory/consumer"

# Fetched from a repository; with FIND_PACKAGE_ARGS, only if fpbm is not installed.
repository=$scratch/repository
mkdir "$repository"
cp -R "$source_dir/CMakeLists.txt" "$source_dir/cmake" "$source_dir/cpp" "$source_dir/examples" "$source_dir/tests" "$repository"
git -C "$repository" init --quiet
git -C "$repository" add .
git -C "$repository" -c user.name=fpbm -c user.email=fpbm commit --quiet --message fpbm
git -C "$repository" tag v0.1.0
from="GIT_REPOSITORY;file://$repository;GIT_TAG;v0.1.0"
fetch() {
  name=$1
  shift
  configure -S "$consumer" -B "$scratch/$name" "$@"
}
fetch fetched -DFPBM_FETCH="$from"
test ! -e "$scratch/fetched/_deps/fpbm-build/tests" || fail "FetchContent added the tests of fpbm"
test ! -e "$scratch/fetched/_deps/fpbm-build/examples" || fail "FetchContent added the examples of fpbm"
cmake --build "$scratch/fetched"
"$scratch/fetched/consumer"

fetch not_installed -DFPBM_FETCH="$from;FIND_PACKAGE_ARGS;0.1"
test -e "$scratch/not_installed/_deps/fpbm-src" || fail "FIND_PACKAGE_ARGS did not fetch fpbm, which is not installed"
fetch already_installed -DFPBM_FETCH="$from;FIND_PACKAGE_ARGS;0.1" -DCMAKE_PREFIX_PATH="$prefix"
test ! -e "$scratch/already_installed/_deps/fpbm-src" || fail "FIND_PACKAGE_ARGS fetched fpbm, which is installed"
fetch overridden -DFPBM_FETCH="$from;OVERRIDE_FIND_PACKAGE" -DCMAKE_PREFIX_PATH="$prefix"
test -e "$scratch/overridden/_deps/fpbm-src" || fail "OVERRIDE_FIND_PACKAGE used the installed fpbm"

# In all cases, the project has only the include paths and C++17.
for way in installed subdirectory fetched; do
  if grep -E '"command".* -[Wmf]' "$scratch/$way/compile_commands.json"; then
    fail "The project has compiler flags of fpbm: $way"
  fi
done
