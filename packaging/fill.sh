#!/bin/sh
# Writes the owner of the release and the checksums of its archive into the recipes.
# usage: fill.sh <owner> <archive> [folder with the recipes]
set -eu
owner=$1
archive=$2
recipes=${3:-$(dirname "$0")}
port=$recipes/vcpkg/ports/fpbm
recipe=$recipes/conan/all
sum() { "$1" "$archive" | cut -d ' ' -f 1; }

sed -i -e '/^# OWNER/d' -e "s|OWNER|$owner|" \
    "$port/portfile.cmake" "$port/vcpkg.json" "$recipe/conandata.yml" "$recipe/conanfile.py"
sed -i "s|SHA512 .*|SHA512 $(sum sha512sum)|" "$port/portfile.cmake"
sed -i "s|sha256: .*|sha256: \"$(sum sha256sum)\"|" "$recipe/conandata.yml"
