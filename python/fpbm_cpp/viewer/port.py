"""Check of the port to serve at."""

import errno
import socket


def require_free(host: str, port: int) -> None:
    """Raise OSError if the port cannot be served at; viser would silently take another one."""
    if not 0 <= port <= 65535:
        raise ValueError(f"port = {port}: must be 0 to 65535")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except socket.gaierror as error:
            raise ValueError(f"host = {host!r}: {error.strerror}") from None
        except OSError as error:
            text = f"cannot serve at {host}, port {port}: {error.strerror}"
            if error.errno == errno.EADDRINUSE:
                text = f"port {port} is in use: choose another one, or 0 for one that is free"
            raise OSError(error.errno, text) from None
