#!/bin/sh
# Makes sure that programs and headers are there, by installing Debian packages where they are not.
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
# One at a time, where make runs several.
exec 9> "${TMPDIR:-/tmp}/fpbm_need.$(id -u).lock"
if command -v flock > /dev/null; then flock 9; fi
export DEBIAN_FRONTEND=noninteractive
# shellcheck disable=SC2086 # A list of packages and an empty or one-word command are meant to be split.
$sudo apt-get update -qq && $sudo apt-get install -y -qq --no-install-recommends $missing > /dev/null
