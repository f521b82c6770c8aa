#!/bin/sh
# Under flags that change what a compiler may do with arithmetic, the library is right or says that it would not be.
# usage: arithmetic.sh <C++ compiler> <scratch dir> <Eigen's include dir>
set -eu
compiler=$1
scratch=$2
eigen=$3
here=$(dirname "$0")
mkdir -p "$scratch"

echo "#include <cmath>
int main() {}" >"$scratch/empty.cpp"
wrong=0
while read -r flags; do
  # Is there a compiler, and a library, for these flags? The flags are words.
  # shellcheck disable=SC2086
  if ! "$compiler" $flags -Werror -x c++ "$scratch/empty.cpp" -o "$scratch/empty" 2>"$scratch/said"; then
    echo "$flags: not here"
    continue
  fi
  # shellcheck disable=SC2086
  if "$compiler" -std=c++17 -O1 $flags -Wfatal-errors -I "$here/../../cpp/include" -isystem "$eigen" \
    "$here/kinematics.cpp" -o "$scratch/kinematics" 2>"$scratch/said"; then
    if said=$("$scratch/kinematics"); then outcome=right; else outcome=WRONG; fi
  else
    if said=$(grep -o "fpbm needs .*" "$scratch/said"); then outcome=refused; else outcome=WRONG; fi
  fi
  echo "${flags:-no flags}: $outcome: $said"
  if [ $outcome = WRONG ]; then wrong=1; fi
done <<FLAGS

-O3 -march=native
-Ofast
-ffast-math
-ffinite-math-only
-funsafe-math-optimizations
-fassociative-math -fno-signed-zeros -fno-trapping-math
-freciprocal-math
-fno-signed-zeros
-frounding-math
-ffp-contract=fast -march=native
-mfpmath=387
-mfpmath=both
-m32
-m32 -march=pentium4 -mfpmath=sse
FLAGS
exit $wrong
