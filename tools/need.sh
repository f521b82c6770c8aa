#!/bin/sh
# Installs the Debian packages of missing programs and headers.
#   need.sh PROGRAM[:PACKAGE] | /PATH/OF/HEADER:PACKAGE ...
set -eu

missing=
for need in "$@"; do
    thing=${need%%:*}
    case $thing in
        /*) test -e "$thing" ;;
        *) command -v "$thing" > /dev/null ;;
    esac || missing="$missing ${need##*:}"
done
test -n "$missing" || exit 0

if ! command -v apt-get > /dev/null; then
    echo "Missing:$missing (names of Debian packages). Install them by this system's own means." >&2
    exit 1
fi
if test "$(id -u)" -eq 0; then
    sudo=
elif command -v sudo > /dev/null; then
    sudo=sudo
else
    echo "Missing:$missing. Ask an administrator to run: apt-get install$missing" >&2
    exit 1
fi
echo "Installing:$missing"
# A parallel make may run several installations: a lock serialises them.
exec 9> "${TMPDIR:-/tmp}/fpbm_need.$(id -u).lock"
if command -v flock > /dev/null; then flock 9; fi
export DEBIAN_FRONTEND=noninteractive
# shellcheck disable=SC2086 # Word splitting is intended: $missing is a list, and $sudo may be empty.
$sudo apt-get update -qq && $sudo apt-get install -y -qq --no-install-recommends $missing > /dev/null
