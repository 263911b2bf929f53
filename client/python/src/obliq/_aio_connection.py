"""The asyncio driver of a session: one connection, fed by what the event loop reads."""
from __future__ import annotations

import asyncio
import ssl
import time
from collections.abc import Callable
from typing import TypeVar, cast

from ._connection import untrusted
from ._requests import ConnectOptions
from ._protocol.session import Command, Request, Session, Wait
from ._protocol.wire import Splitter
from .errors import BadStream, CannotConnect, ConnectionLost, ObliqError, TimedOut, Untrusted

T = TypeVar("T")


class Connection(asyncio.BufferedProtocol):
    """Drives a session by what the event loop reads."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.session = Session()
        self._splitter = Splitter()
        self._waiters: list[tuple[Wait, asyncio.Future[None]]] = []
        self._transport: asyncio.Transport | None = None
        self._paused = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """asyncio's: it begins."""
        self._transport = cast(asyncio.Transport, transport)

    def get_buffer(self, sizehint: int) -> memoryview:
        """asyncio's: where to read to."""
        return self._splitter.space()

    def buffer_updated(self, nbytes: int) -> None:
        """asyncio's: it has read."""
        self._splitter.filled(nbytes)
        try:
            while (message := self._splitter.next()) is not None:
                self.session.feed(message)
        except BadStream as error:
            self.session.end(error)
        except Exception as error:  # nothing of ours raises in the event loop: waiting calls do
            self.session.end(ObliqError(f"{type(error).__name__}: {error}"))
        self.stir()

    def connection_lost(self, exc: Exception | None) -> None:
        """asyncio's: it has ended."""
        self.session.end(ConnectionLost(f"the connection was lost: {exc}" if exc else
                                        "the server has closed the connection"))
        self.stir()

    def stir(self) -> None:
        """Sends what is to be sent, wakes those whose wait is over, reads no faster than frames are taken."""
        session = self.session
        assert self._transport is not None, "before connection_made()"
        if session.lost is not None:
            session.outgoing.clear()
            self._transport.close()
        for data in session.outgoing:
            self._transport.write(data)
        session.outgoing.clear()
        for wait, future in self._waiters:
            if not future.done() and (session.lost is not None or wait.test()):
                future.set_result(None)
        enough = session.has_enough()
        if session.lost is None and enough != self._paused:
            self._paused = enough
            (self._transport.pause_reading if enough else self._transport.resume_reading)()

    def start(self, start: Callable[[], T]) -> T:
        """What a function of the session returns that waits for nothing; its requests are sent."""
        if self.session.lost is not None:
            raise self.session.lost
        result = start()
        self.stir()
        return result

    def tell(self, message: Request, refused: Callable[[ObliqError], object]) -> None:
        """Sends a request whose answer nobody waits for."""
        self.start(lambda: self.session.tell(message, refused))

    async def run(self, command: Command[T]) -> T:
        """What a command of the session returns."""
        error: ObliqError | None = None
        while True:
            try:
                wait = next(command) if error is None else command.throw(error)
            except StopIteration as end:
                self.stir()
                value: T = end.value
                return value
            error = None
            try:
                await self._await(wait)
            except ObliqError as failure:
                error = failure

    async def _await(self, wait: Wait) -> None:
        self.stir()
        deadline = None if wait.timeout_s is None else time.monotonic() + wait.timeout_s
        while not wait.test():
            if self.session.lost is not None:
                raise self.session.lost
            left = 3600.0 if deadline is None else deadline - time.monotonic()
            if left <= 0:
                raise TimedOut(f"{wait.what} did not come within {wait.timeout_s:g} s")
            future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            entry = (wait, future)
            self._waiters.append(entry)
            try:
                await asyncio.wait_for(future, min(left, self.session.patience_s() or 3600.0))
            except asyncio.TimeoutError:
                if not self._paused:
                    try:
                        self.session.check_silence()
                    except ConnectionLost:
                        self.stir()
            finally:
                self._waiters.remove(entry)

    def close(self, why: str = "the connection was closed by close()") -> None:
        """The next use raises ConnectionLost."""
        self.session.end(ConnectionLost(why))
        self.stir()


async def open_connection(options: ConnectOptions) -> Connection:
    """Connects, and is let in."""
    address, tls = f"{options.host}:{options.port}", options.tls
    protocol = Connection(address)
    try:
        await asyncio.wait_for(asyncio.get_running_loop().create_connection(
            lambda: protocol, options.host, options.port, ssl=None if tls is None else tls.context(),
            server_hostname=None if tls is None else options.host), options.timeout_s)
    except ssl.SSLError as error:
        raise untrusted(address, error) from error
    except asyncio.TimeoutError as error:
        raise CannotConnect(f"{address}: nothing answered within {options.timeout_s:g} s") from error
    except OSError as error:
        if tls is not None and isinstance(error, ConnectionError) and not isinstance(error, ConnectionRefusedError):
            raise Untrusted(f"{address}: the connection was closed during the TLS handshake: is it obliqd?") from error
        raise CannotConnect(f"{address}: {error}. Is obliqd running there?") from error
    try:
        await protocol.run(protocol.session.hello(options.name, options.token, options.timeout_s))
    except BaseException:
        protocol.close("the connection was closed")
        raise
    return protocol
