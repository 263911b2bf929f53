"""The blocking client. One thread at a time for each connection."""
from __future__ import annotations

import os

from ._classes import Radar, Server
from ._connection import Connection
from ._requests import ConnectOptions, Tls
from ._control import Control, Targets
from ._streams import Replay, Stream

__all__ = ["Control", "Radar", "Replay", "Server", "Stream", "Targets", "connect"]


def connect(address: str | int = "127.0.0.1:7420", *, token: str | None = None,
            token_file: str | os.PathLike[str] | None = None, tls: Tls | bool | None = None, name: str = "python",
            timeout: float = 5.0) -> Server:
    """A connection to obliqd: HOST:PORT, HOST, :PORT, PORT or [IPv6]:PORT. `timeout` in seconds for connecting and for
    the first answer. name: shown to others while this client holds control."""
    options = ConnectOptions.of(address, token, token_file, tls, name, timeout)
    return Server(lambda: Connection(options))._start()
