#!/bin/sh
# Builds the wheel of the package for 64-bit Arm into FOLDER/dist, and tests the wheel under qemu.
#   PYTHON=… arm64_wheel.sh FOLDER [arguments of pytest]
# PYTHON must have pip.
#
# qemu runs Debian's Python for Arm, which is unpacked into FOLDER/root. The packages of this system do not change.
# CMake and the cross compiler are not emulated.
set -eu
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
root=$folder/root
python=$root/usr/bin/python-arm64
here=$(cd "$(dirname "$0")/.." && pwd)

if ! test -x "$python"; then
    # Separate folders for the lists and packages of apt for Arm.
    apt=$folder/apt
    rm -rf "$root" "$apt"
    mkdir -p "$root" "$apt/lists/partial" "$apt/cache/archives/partial"
    : > "$apt/status"
    get() {
        apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User="$(id -un)" \
            -o Dir::State::Lists="$apt/lists" -o Dir::State::status="$apt/status" -o Dir::Cache="$apt/cache" "$@"
    }
    get update
    get install --yes --download-only --no-install-recommends python3 python3-distutils libpython3-dev libstdc++6 > /dev/null
    for package in "$apt"/cache/archives/*.deb; do dpkg -x "$package" "$root"; done
    # Python uses argv[0] (-0) to find its prefix, and to start itself again.
    cat > "$python" << RUN
#!/bin/sh
exec qemu-aarch64 -L '$root' -0 "\$0" '$root/usr/bin/python3' "\$@"
RUN
    chmod +x "$python"
fi

export PIP_BREAK_SYSTEM_PACKAGES=1 PIP_ROOT_USER_ACTION=ignore PIP_NO_WARN_SCRIPT_LOCATION=0 PIP_DISABLE_PIP_VERSION_CHECK=1
if ! "$python" -m pip --version > /dev/null 2>&1; then
    "$PYTHON" -m pip download --quiet --no-deps --only-binary :all: --dest "$folder" pip
    pip=$(ls "$folder"/pip-*.whl)
    "$python" "$pip/pip" install --quiet "$pip"
fi
"$python" -m pip install --quiet --only-binary :all: scikit-build-core pybind11 numpy --group "$here/pyproject.toml:test"

rm -rf "$folder/dist"
# With build isolation, pip would install a Ninja for Arm. A header of Debian's Python includes a header from
# $root/usr/include.
CMAKE_ARGS="-DCMAKE_TOOLCHAIN_FILE=$here/cmake/toolchains/arm64.cmake" CXXFLAGS="-idirafter $root/usr/include" \
    "$python" -m pip wheel --quiet --no-build-isolation --no-deps --wheel-dir "$folder/dist" "$here"
"$python" -m pip install --quiet --no-deps --force-reinstall "$folder"/dist/*.whl
cd "$here"
"$python" -I tests/package/installed.py
"$python" -m pytest -q -p no:cacheprovider "$@"
ls -l "$folder"/dist/*.whl
