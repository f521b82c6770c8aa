#!/bin/sh
# Runs a command without network access and without the installed Eigen. If the system permits no namespaces, the
# command has network access and the installed Eigen.
#   bare.sh COMMAND ...
set -eu
if ! unshare --map-root-user --net --mount true 2> /dev/null; then
    echo "Namespaces are not available: $1 has access to the network and to Eigen." >&2
    exec "$@"
fi
# shellcheck disable=SC2016 # Expanded by the inner shell.
exec unshare --map-root-user --net --mount sh -eu -c '
    for eigen in /usr/include/eigen3 /usr/share/eigen3 /usr/local/include/eigen3 /usr/local/share/eigen3; do
        test ! -d "$eigen" || mount -t tmpfs none "$eigen"
    done
    exec "$@"' sh "$@"
