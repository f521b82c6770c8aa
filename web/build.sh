#!/bin/sh
# Builds the page, one file that needs no server: build.sh OUT.html [BUILD FOLDER]
# If a tool is missing, the script prints its name and succeeds without a page.
set -eu

out=$1
work=${2:-build/web}
here=$(cd "$(dirname "$0")" && pwd)
headers=$(cd "$here/../cpp/include" && pwd)
eigen=${EIGEN:-/usr/include/eigen3}

no_page() {
    echo "The page is not built: $1."
    exit 0
}
command -v em++ > /dev/null || no_page "em++ is missing (Debian: emscripten)"
command -v npm > /dev/null || no_page "npm is missing (Debian: npm)"
test -e "$eigen/Eigen/Core" || no_page "Eigen is missing (Debian: libeigen3-dev)"

mkdir -p "$work" "$(dirname "$out")"
if ! test -e "$work/node_modules/.package-lock.json" || ! cmp -s "$here/package-lock.json" "$work/package-lock.json"; then
    cp "$here/package.json" "$work"
    cp "$here/package-lock.json" "$work/package-lock.json"
    (cd "$work" && npm ci --no-audit --no-fund > npm.log 2>&1) || no_page "npm could not fetch the packages, see $work/npm.log"
fi

# With a separate link, because em++ does not search /usr/include.
ln -sfn "$eigen" "$work/eigen3"
wasm=$work/simulator.wasm
functions=_settings_address,_view_address,_begin,_change,_restart,_follow_path,_push,_ticks
newer=$(find "$here/plain.hpp" "$here/session.hpp" "$here/simulator.cpp" "$here/build.sh" "$headers" -newer "$wasm" -type f 2> /dev/null || echo all)
if test -n "$newer"; then
    em++ -std=c++17 -O2 -fno-exceptions -fno-rtti -I"$headers" -isystem "$work/eigen3" \
      "$here/simulator.cpp" -o "$wasm" --no-entry -sSTANDALONE_WASM -sEXPORTED_FUNCTIONS=$functions
fi
gzip --best --no-name --stdout "$wasm" > "$wasm.gz"
node "$here/build.mjs" "$wasm.gz" "$work/node_modules" "$out"
echo "$out: $(wc -c < "$out") bytes; the simulator in it: $(wc -c < "$wasm") bytes, packed $(wc -c < "$wasm.gz")"
