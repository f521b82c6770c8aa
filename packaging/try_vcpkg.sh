#!/bin/sh
# Runs the port's portfile by vcpkg's own scripts, and builds a program with the installed files. The program vcpkg is
# not needed: this script replaces the commands that the scripts call.
# usage: try_vcpkg.sh <clone of vcpkg> <port> <archive of the release> <owner> <version> <program's project> <scratch dir>
set -eu
vcpkg=$1 port=$2 archive=$3 owner=$4 version=$5 program=$6 scratch=$7
triplet=x64-linux
installed=$scratch/installed/$triplet
package=$scratch/packages/fpbm_$triplet

mkdir -p "$scratch/downloads" "$installed/share"
cp "$archive" "$scratch/downloads/$owner-fpbm_cpp-v$version.tar.gz"
cat > "$scratch/vcpkg" << 'TOOL'
#!/bin/sh
case $1 in
    fetch) command -v "$2" ;;
    z-extract) tar -xf "$2" -C "$3" ;;
    *) echo "vcpkg $*: not available offline" >&2; exit 1 ;;
esac
TOOL
chmod +x "$scratch/vcpkg"

cd "$scratch"
VCPKG_COMMAND=$scratch/vcpkg VCPKG_FORCE_SYSTEM_BINARIES=1 cmake -DCMD=BUILD -DPORT=fpbm -DVERSION="$version" \
    -DCURRENT_PORT_DIR="$port" -DTARGET_TRIPLET=$triplet -DTARGET_TRIPLET_FILE="$vcpkg/triplets/$triplet.cmake" \
    -D_HOST_TRIPLET=$triplet -DVCPKG_ROOT_DIR="$vcpkg" -DDOWNLOADS="$scratch/downloads" -D_VCPKG_NO_DOWNLOADS=1 \
    -DBUILDTREES_DIR="$scratch/buildtrees" -DPACKAGES_DIR="$scratch/packages" \
    -D_VCPKG_INSTALLED_DIR="$scratch/installed" -DVCPKG_CONCURRENCY=1 -DVCPKG_BASE_VERSION=2999-12-31 -DVCPKG_FIXUP_ELF_RPATH=OFF \
    "-DVCPKG_PORT_CONFIGS=$vcpkg/ports/vcpkg-cmake/vcpkg-port-config.cmake;$vcpkg/ports/vcpkg-cmake-config/vcpkg-port-config.cmake" \
    -P "$vcpkg/scripts/ports.cmake"

# The package must have the format of the registry.
fail() {
    echo "$*:" >&2
    find "$package" -type f -not -path '*/include/*' >&2
    exit 1
}
for file in include/fpbm/fpbm.hpp share/fpbm/fpbmConfig.cmake share/fpbm/usage share/fpbm/copyright share/pkgconfig/fpbm.pc; do
    test -s "$package/$file" || fail "The package lacks $file"
done
test ! -e "$package/debug" || fail "The package has files for debugging"
test ! -e "$package/share/cmake" || fail "CMake's files are not in share/fpbm"
if grep -r "$scratch" "$package"; then
    fail "The package contains an absolute path"
fi

cp -R "$package/." "$installed/"
cmake -S "$program" -B "$scratch/program" -DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE="$vcpkg/scripts/buildsystems/vcpkg.cmake" \
    -DVCPKG_TARGET_TRIPLET=$triplet -DVCPKG_INSTALLED_DIR="$scratch/installed" -DVCPKG_MANIFEST_MODE=OFF
grep "^fpbm_DIR:PATH=$installed/share/fpbm$" "$scratch/program/CMakeCache.txt"
cmake --build "$scratch/program"
"$scratch/program/consumer"
