"""The asyncio client: the same names as the blocking one, awaited.

    async with obliq.aio.connect("127.0.0.1:7420") as server:
        frame = await server.radar().frame()
        async for frame in server.radar().stream(rate_hz=10): ...

A connection belongs to the event loop that opened it; any number of tasks may use it. No thread, no polling: bytes are
taken as they come, at most a quarter of a megabyte at a time.
"""
from __future__ import annotations

import os
from collections.abc import Generator
from typing import Any

from ._aio_classes import Radar, Server
from ._aio_connection import open_connection
from ._aio_control import Control, Targets
from ._aio_streams import Replay, Stream
from ._requests import ConnectOptions, Tls

__all__ = ["Control", "Radar", "Replay", "Server", "Stream", "Targets", "connect"]


class connect:
    """As obliq.connect: `async with connect(...) as server`, or `server = await connect(...)`."""

    def __init__(self, address: str | int = "127.0.0.1:7420", *, token: str | None = None,
                 token_file: str | os.PathLike[str] | None = None, tls: Tls | bool | None = None, name: str = "python",
                 timeout: float = 5.0):
        options = ConnectOptions.of(address, token, token_file, tls, name, timeout)
        self._server = Server(lambda: open_connection(options))

    def __await__(self) -> Generator[Any, None, Server]:
        return self._server._start().__await__()

    async def __aenter__(self) -> Server:
        return await self._server._start()

    async def __aexit__(self, *_: object) -> None:
        await self._server.close()
