"""Whether there is a port to serve at."""

from __future__ import annotations

import errno
import socket


def require_free(host: str, port: int) -> None:
    """Raise OSError where the port cannot be served at; the server itself would take another one."""
    if not 0 <= port <= 65535:
        raise ValueError(f"port = {port}: must be 0 to 65535")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except socket.gaierror as error:
            raise ValueError(f"host = {host!r}: {error.strerror}") from None
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise OSError(error.errno, f"cannot serve at {host}, port {port}: {error.strerror}") from None
            raise OSError(
                error.errno, f"port {port} is in use: choose another one, or 0 for one that is free"
            ) from None
