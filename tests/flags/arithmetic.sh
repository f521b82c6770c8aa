#!/bin/sh
# Under flags that relax the rules of arithmetic, the library is right, or compilation fails with an explanation.
# Under flags that keep to IEEE 754, the library must be right.
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
while read -r wanted flags; do
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
    if said=$(grep -m 1 "error.*fpbm needs" "$scratch/said"); then outcome=refused; else outcome=WRONG; fi
    said=${said##*error: }
  fi
  echo "${flags:-no flags}: $outcome: $said"
  case $wanted:$outcome in
  *:WRONG | right:refused) wrong=1 ;;
  esac
done <<FLAGS
right
right -O3 -march=native
any -Ofast
any -ffast-math
any -ffinite-math-only
any -funsafe-math-optimizations
any -fassociative-math -fno-signed-zeros -fno-trapping-math
any -freciprocal-math
any -fno-signed-zeros
right -frounding-math
right -ffp-contract=fast -march=native
right -mfpmath=387
right -mfpmath=both
right -m32
right -m32 -march=pentium4 -mfpmath=sse
FLAGS
exit $wrong
