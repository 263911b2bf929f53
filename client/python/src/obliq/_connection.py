"""Drives a session over a blocking socket. Nothing here has a thread of its own."""
from __future__ import annotations

import contextlib
import os
import selectors
import signal
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterator
from types import FrameType
from typing import TypeVar

from ._requests import ConnectOptions, Tls
from ._protocol.session import Command, Request, Session, Wait
from ._protocol.wire import Splitter
from .errors import BadStream, CannotConnect, ConnectionLost, ObliqError, TimedOut, Untrusted

T = TypeVar("T")


def untrusted(address: str, error: ssl.SSLError) -> Untrusted:
    """What a failed TLS handshake means."""
    if isinstance(error, ssl.SSLCertVerificationError):
        return Untrusted(f"{address}: the server's certificate is not to be trusted: {error.verify_message or error}. "
                         "Give tls=obliq.Tls(ca_file=...) with the authority that signed it")
    return Untrusted(f"{address}: TLS is not spoken there ({error}). Leave out tls=, or check the port")


def open_socket(host: str, port: int, tls: Tls | None, timeout_s: float) -> socket.socket:
    """Connects, and shakes hands where TLS is wanted."""
    address = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
    try:
        plain = socket.create_connection((host, port), timeout=timeout_s)
    except OSError as error:
        raise CannotConnect(f"{address}: {error}. Is obliqd running there?") from error
    try:
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if tls is None:
            return plain
        return tls.context().wrap_socket(plain, server_hostname=host)
    except ssl.SSLError as error:
        plain.close()
        raise untrusted(address, error) from error
    except TimeoutError as error:
        plain.close()
        raise TimedOut(f"{address}: no TLS handshake within {timeout_s} s: is it obliqd, with TLS?") from error
    except OSError as error:
        plain.close()
        raise Untrusted(f"{address}: the connection was closed during the TLS handshake ({error}): is it obliqd?") from error
    except BaseException:
        plain.close()
        raise


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Ctrl-C waits for the end: else bytes that have been read, or half of a message, would be lost with it."""
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    signal.signal(signal.SIGINT, lambda number, frame: came.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if came:
            handler(*came[0])


class Connection:
    """A session and its socket. One thread at a time, one process."""

    def __init__(self, options: ConnectOptions):
        self._pid = os.getpid()
        self._lock = threading.Lock()
        self.session = Session()
        self._splitter = Splitter()
        self.address = f"[{options.host}]:{options.port}" if ":" in options.host else f"{options.host}:{options.port}"
        self._socket = open_socket(options.host, options.port, options.tls, options.timeout_s)
        self._readable = getattr(selectors, "PollSelector", selectors.DefaultSelector)()  # of no file that a fork would share
        self._readable.register(self._socket, selectors.EVENT_READ)
        try:
            self.run(self.session.hello(options.name, options.token, options.timeout_s))
        except TimedOut:
            self.close()
            raise TimedOut(f"{self.address}: something accepts connections there, but has sent nothing for {options.timeout_s} s: "
                           "it is not obliqd, or too busy to answer") from None
        except BaseException:
            self.close()
            raise

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        if os.getpid() != self._pid:
            raise RuntimeError("this connection belongs to the process that made it: connect again after a fork")
        if not self._lock.acquire(blocking=False):
            raise RuntimeError("this connection is in use by another thread: one connection for each thread")
        try:
            yield
        finally:
            self._lock.release()

    def run(self, command: Command[T]) -> T:
        """What a command of the session returns."""
        with self._alone():
            return self._run(command)

    def start(self, start: Callable[[], T]) -> T:
        """What a function of the session returns that waits for nothing; its requests are sent."""
        with self._alone():
            result = start()
            self._flush()
            return result

    def tell(self, message: Request, refused: Callable[[ObliqError], object]) -> None:
        """Sends a request whose answer nobody waits for, and takes what has come: it would fill the connection."""
        with self._alone():
            self.session.tell(message, refused)
            self._flush()
            while self.session.lost is None and not self.session.has_enough() and self._has_come(0):
                self._receive(0)
            self._flush()
            if self.session.lost is not None:
                self._shut()
                raise self.session.lost

    def _has_come(self, timeout_s: float) -> bool:
        if isinstance(self._socket, ssl.SSLSocket) and self._socket.pending():
            return True
        return bool(self._readable.select(timeout_s))

    def _run(self, command: Command[T]) -> T:
        error: ObliqError | None = None
        while True:
            try:
                wait = next(command) if error is None else command.throw(error)
            except StopIteration as end:
                value: T = end.value
                return value
            error = None
            try:
                self._await(wait)
            except ObliqError as failure:
                error = failure

    def _await(self, wait: Wait) -> None:
        self._flush()
        deadline = None if wait.timeout_s is None else time.monotonic() + wait.timeout_s
        while not wait.test():
            if self.session.lost is not None:
                self._shut()
                raise self.session.lost
            now = time.monotonic()
            if deadline is not None and now >= deadline:
                raise TimedOut(f"{wait.what} did not come within {wait.timeout_s:g} s")
            # Often enough to notice a server that has fallen silent.
            patience = self.session.patience_s() or 3600.0
            self._receive(min(patience, 3600.0 if deadline is None else deadline - now))
            self._flush()

    def _flush(self) -> None:
        while self.session.outgoing and self.session.lost is None:
            data = memoryview(self.session.outgoing[0])
            try:
                self._socket.settimeout(30.0)
                self._socket.sendall(data)
            except OSError as error:
                # What the server said before it closed may still be read.
                self.session.outgoing.clear()
                with contextlib.suppress(ObliqError):
                    while self.session.lost is None:
                        self._receive(1.0, quiet=True)
                if self.session.lost is None:
                    self.session.end(ConnectionLost(f"the connection to {self.address} was lost: {error}"))
            except BaseException:
                # Half a message may have gone: nothing more can.
                self.session.end(ConnectionLost("the connection was closed: sending was interrupted"))
                self._shut()
                raise
            else:
                self.session.outgoing.pop(0)

    def _receive(self, timeout_s: float, quiet: bool = False) -> None:
        """Some bytes, and all messages that they complete."""
        if self._has_come(timeout_s):
            with uninterrupted():
                return self._take()
        if quiet:
            raise TimedOut("quiet")
        return self.session.check_silence()

    def _take(self) -> None:
        splitter = self._splitter
        self._socket.settimeout(1e-3)
        try:
            count = self._socket.recv_into(splitter.space())
        except (TimeoutError, ssl.SSLWantReadError):
            return None  # a part of a TLS record
        except OSError as error:
            return self.session.end(ConnectionLost(f"the connection to {self.address} was lost: {error}"))
        if count == 0:
            where = "in the middle of a message" if splitter.waiting else "between two messages"
            return self.session.end(ConnectionLost(f"{self.address}: the server has closed the connection, {where}"))
        splitter.filled(count)
        try:
            while (message := splitter.next()) is not None:
                self.session.feed(message)
        except BadStream as error:
            self.session.end(error)
        return None

    def _shut(self) -> None:
        # A child after a fork closes its own copy; no shutdown, which would end the parent's connection.
        self._readable.close()
        with contextlib.suppress(OSError):
            self._socket.close()

    def close(self, why: str = "the connection was closed by close()") -> None:
        """The next use raises ConnectionLost."""
        self.session.end(ConnectionLost(why))
        self._shut()
