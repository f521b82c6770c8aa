#!/bin/sh
# Installs a wheel into an empty environment, offline and with only the programs of this environment in PATH. Runs a
# small test with NumPy only, then the Python tests.
#   try_wheel.sh PYTHON WHEEL WHEELHOUSE
set -eu
trial=build/trial
wheel=$2
house=$3
rm -rf "$trial"
"$1" -m venv "$trial"
here=$(pwd)
python=$here/$trial/bin/python
alone() {
    env -i PATH="$here/$trial/bin" HOME="$here/$trial" PIP_DISABLE_PIP_VERSION_CHECK=1 "$@"
}

alone "$python" -m pip install --quiet --no-index --only-binary :all: --find-links "$house" "$wheel"
alone "$python" -m pip list
alone "$python" -I tests/package/installed.py
alone "$python" -m pip install --quiet --upgrade pip --no-index --find-links "$house"
alone "$python" -m pip install --quiet --no-index --only-binary :all: --find-links "$house" --group test
alone "$python" -m pytest -q -p no:cacheprovider --numprocesses auto
