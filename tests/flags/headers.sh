#!/bin/sh
# Every header compiles alone: one unit each that includes nothing else. Only the parsing counts.
# If a header includes Eigen, directly or indirectly, a precompiled Eigen/Core is included before, because Eigen needs
# most of the time. Other headers have no include before.
# usage: headers.sh <C++ compiler> <scratch dir> <Eigen's include dir>
set -eu
compiler=$1
scratch=$2
eigen=$3
include=$(cd "$(dirname "$0")/../../cpp/include" && pwd)
mkdir -p "$scratch"

parse() {
  "$compiler" -std=c++17 -O0 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Winvalid-pch -Werror -I "$include" \
    -isystem "$eigen" "$@"
}

echo '#include <Eigen/Core>' >"$scratch/eigen.hpp"
parse -x c++-header "$scratch/eigen.hpp" -o "$scratch/eigen.hpp.gch"

cd "$include"
find . -name '*.hpp' | sed 's|^\./||' | LC_ALL=C sort >"$scratch/all"
# Headers that include Eigen, directly or indirectly.
# shellcheck disable=SC2046 # A list of names without spaces.
awk '
  /^#include <Eigen\// { eigen[FILENAME] = 1 }
  /^#include "/ { split($0, part, "\""); edge[++edges] = FILENAME SUBSEP part[2] }
  END {
    do {
      changed = 0
      for (i = 1; i <= edges; ++i) {
        split(edge[i], ends, SUBSEP)
        if (ends[2] in eigen && !(ends[1] in eigen)) changed = eigen[ends[1]] = 1
      }
    } while (changed)
    for (header in eigen) print header
  }' $(cat "$scratch/all") | LC_ALL=C sort >"$scratch/with_eigen"
test "$(wc -l <"$scratch/with_eigen")" -gt 100

wrong=0
while read -r header; do
  echo "#include \"$header\"" >"$scratch/unit.cpp"
  prefix=
  if grep -qxF "$header" "$scratch/with_eigen"; then prefix=$scratch/eigen.hpp; fi
  parse -fsyntax-only ${prefix:+-include "$prefix"} "$scratch/unit.cpp" || wrong=1
done <"$scratch/all"
echo "$(wc -l <"$scratch/all") headers compile alone, $(wc -l <"$scratch/with_eigen") of them with Eigen"
exit $wrong
