#!/bin/sh
# The library in firmware: in float, without exceptions and run-time types. A bad argument ends the program, and a
# tick computes nothing in double, which many small processors do in software.
# usage: firmware.sh <C++ compiler> <scratch dir> <Eigen's include dir>
set -eu
compiler=$1
scratch=$2
eigen=$3
here=$(dirname "$0")
mkdir -p "$scratch"

build() {
  "$compiler" -std=c++17 -O1 -fno-exceptions -fno-rtti -Wall -Wextra -Wdouble-promotion -Werror -Wfatal-errors \
    -I "$here/../../cpp/include" -isystem "$eigen" "$@"
}

build -DNDEBUG -S "$here/tick.cpp" -o "$scratch/tick.s"
case $("$compiler" -dumpmachine) in
x86_64*)
  arithmetic='(add|sub|mul|div|sqrt|min|max|u?comi|cmp[a-z]*|fn?m[a-z]*[0-9]*)[sp]d'
  conversion='cvt[a-z0-9]*[sp]d[a-z0-9]*'
  function='call[[:space:]]+(sin|cos|sincos|sqrt|atan2|pow|exp|log|hypot)(@PLT)?$'
  if grep -E "^[[:space:]]+(v?($arithmetic|$conversion)[[:space:]]|$function)" "$scratch/tick.s" >&2; then
    echo "a tick in float computes in double" >&2
    exit 1
  fi
  ;;
*) echo "not looked for arithmetic in double: another processor's instructions" ;;
esac

build "$here/firmware.cpp" -o "$scratch/firmware"
"$scratch/firmware"
if "$scratch/firmware" bad >"$scratch/said" 2>&1; then
  echo "a bad argument went on" >&2
  exit 1
fi
grep "lengths\[1\] = -1: must be positive and finite" "$scratch/said"
