#!/bin/sh
# Compiles a source by clang instead of Visual C++, with the headers of mingw. Warnings are errors; nothing is linked.
# usage: visual.sh <source>
set -eu
gcc=$(dirname "$(x86_64-w64-mingw32-g++-posix -print-libgcc-file-name)")/include
includes=
for folder in "$gcc/c++" "$gcc/c++/x86_64-w64-mingw32" "$gcc/c++/backward" "$(clang -print-resource-dir)/include" \
              /usr/x86_64-w64-mingw32/include /usr/include/eigen3; do
  includes="$includes /clang:-isystem$folder"
done
# shellcheck disable=SC2086 # Several words.
clang --driver-mode=cl --target=x86_64-w64-windows-gnu /clang:-std=c++17 /EHsc /Zs /W4 /WX -Wno-unused-command-line-argument \
  /clang:-nostdinc /Icpp/include $includes "$1"
echo "$1: no warning at /W4 by clang in place of Visual C++"
