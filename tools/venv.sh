#!/bin/sh
# Creates a virtual environment that can build this package, unless the environment exists.
#   venv.sh FOLDER
set -eu
here=$(dirname "$0")
python=${PYTHON:-python3}

"$here/need.sh" "$python:python3" g++
"$python" -c 'import ensurepip, venv' 2> /dev/null || "$here/need.sh" /ensurepip:python3-venv
"$here/need.sh" "$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h:python3-dev"
test -x "$1/bin/python" || "$python" -m venv "$1"
"$1/bin/python" -m pip install --quiet --upgrade pip
