#!/bin/sh
# Tries the recipes offline, on an archive of these sources instead of the archive of the release. The Conan recipe
# needs conan in the PATH. The vcpkg port is tried if VCPKG_ROOT is a clone of vcpkg. Eigen is from the system.
# usage: try.sh <scratch dir>
set -eu
mkdir -p "$1"
scratch=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
version=$(sed -n 's/^project(fpbm_cpp VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
archive=$scratch/release.tar.gz
recipes=$scratch/recipes

rm -rf "$recipes" "$scratch/vcpkg" "$scratch/conan"
mkdir -p "$recipes"
cp -R packaging/conan packaging/vcpkg "$recipes"
tar -czf "$archive" --transform "s,^,fpbm_cpp-$version/," CMakeLists.txt LICENSE cmake cpp
packaging/fill.sh somebody "$archive" "$recipes"
grep -q "\"version\": \"$version\"" "$recipes/vcpkg/ports/fpbm/vcpkg.json"
grep -q "\"$version\":" "$recipes/conan/config.yml"

# A separate home of Conan, in which the system's Eigen replaces the recipe of Conan Center.
sed -i "s|https://.*/v$version.tar.gz|file://$archive|" "$recipes/conan/all/conandata.yml"
export CONAN_HOME="$scratch/conan"
conan profile detect
conan create packaging/conan/eigen --no-remote
conan create "$recipes/conan/all" --version "$version" --no-remote -s compiler.cppstd=17

if test -z "${VCPKG_ROOT:-}"; then
    echo "vcpkg not tried: VCPKG_ROOT is not set: set it to a clone of github.com/microsoft/vcpkg" >&2
    exit 0
fi
packaging/try_vcpkg.sh "$VCPKG_ROOT" "$recipes/vcpkg/ports/fpbm" "$archive" somebody "$version" "$PWD/tests/package" "$scratch/vcpkg"
