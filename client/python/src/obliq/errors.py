"""What can go wrong, each with a sentence that says what to do. All are ObliqError.

Numbers are those of PROTOCOL.md, "Errors"; `number` is 0 where the server did not say anything.
"""
from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any

from . import obliq_pb2 as wire
from .parameters import Pose, Settings


def printable(text: str) -> str:
    """With escapes for what would steer a terminal or begin a line of its own: some of these texts are a server's."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class ObliqError(Exception):
    """Whatever goes wrong in obliq. number: that of PROTOCOL.md, "Errors", 0 where the server did not say anything."""

    number = 0

    def __str__(self) -> str:
        return printable(super().__str__())


class CannotConnect(ObliqError, ConnectionError):
    """Nothing listens there, or the name is unknown."""


class Untrusted(ObliqError, ConnectionError):
    """The certificate is not for that server or not to be trusted, or TLS is not spoken there."""


class TimedOut(ObliqError, TimeoutError):
    """The server is there and did not do it in time. The connection can still be used."""


class ConnectionLost(ObliqError, ConnectionError):
    """The server has gone, or the connection was closed."""


class BadStream(ObliqError):
    """What arrived is not the protocol, or damaged. `offset` counts bytes of the connection or the file."""

    def __init__(self, reason: str, offset: int | None = None):
        super().__init__(reason if offset is None else f"{reason} (at byte {offset})")
        self.reason, self.offset = reason, offset

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason, self.offset)


class FrameAborted(ObliqError):
    """A frame that had begun was ended by the server."""

    def __init__(self, reason: str):
        super().__init__(f"the server ended the frame before it was complete: {reason}")
        self.reason = reason

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason,)


@dataclasses.dataclass(frozen=True)
class Fault:
    """One value that was refused. field: as the server calls it, a key of the scene file or a field of the request."""

    field: str
    found: str
    allowed: str

    @property
    def argument(self) -> str:
        """The Python name of the value: r_min_m for radar.r_min_m."""
        return Settings.keys.get(self.field) or Pose.keys.get(self.field) or self.field

    def __str__(self) -> str:
        return printable(f"{self.argument}: found {self.found}; allowed: {self.allowed}")


class Refused(ObliqError):
    """The server answered with an Error. text, faults, radar: what it said."""

    def __init__(self, number: int, text: str, faults: Iterable[Fault] = (), radar: str = ""):
        self.number, self.text, self.faults, self.radar = number, text, tuple(faults), radar
        words = [self.text] + [str(fault) for fault in self.faults]
        advice = ADVICE.get(number)
        super().__init__(f"{'; '.join(words)}{f'. {advice}' if advice else ''} (error {number})")

    def __reduce__(self) -> tuple[Any, ...]:  # so that it passes between processes
        return type(self), (self.number, self.text, self.faults, self.radar)


class InvalidValue(Refused, ValueError):
    """`faults` lists each value, what was found, what is allowed."""


class UnknownRadar(Refused, LookupError):
    """The server has no radar of that name."""


class NotInControl(Refused):
    """Another client holds what the request takes, pose or settings, or none does."""

    @property
    def holder(self) -> str:
        """What the server says of the client that holds it; empty: none does."""
        return self.text if self.number == 102 else ""


class OverLimit(Refused):
    """More than the server gives."""

    @property
    def limit(self) -> str:
        """The limit's name: max_bins, max_renders_queued, ..."""
        named = {104: "max_renders_queued", 105: "max_subscriptions"}
        return named.get(self.number) or self.text.split(":")[0].split(" ")[0]


class RenderFailed(Refused):
    """The server could not render the frame."""


class Unauthorized(Refused, PermissionError):
    """The token is missing, wrong, or of a lesser role."""


class ServerFull(Refused):
    """The server has as many clients as it takes."""


class ServerStopping(Refused, ConnectionError):
    """The server is about to end."""


class ReplayOnly(Refused):
    """Of a server that replays a recording, or of one that does not."""


KINDS: dict[int, type[Refused]] = {
    8: ServerFull, 9: ServerStopping, 11: Unauthorized, 12: Unauthorized, 14: ServerFull, 100: InvalidValue,
    101: UnknownRadar, 102: NotInControl, 103: NotInControl, 104: OverLimit, 105: OverLimit, 106: RenderFailed,
    108: Unauthorized, 109: OverLimit, 125: ReplayOnly, 126: ReplayOnly,
}

ADVICE = {
    8: "Close other clients or raise server.max_clients",
    9: "Connect again when it is back, or stream with reconnect=SECONDS",
    10: "Take frames faster, or ask for less: rate_hz, planes, window, encoding='ci16', compress='zstd'",
    11: "Give token= or token_file=",
    12: "Give tls=obliq.Tls(ca_file=...)",
    13: "The connection was idle for longer than server.idle_timeout_s: connect again",
    14: "Close other clients of this machine or raise server.max_clients_per_address",
    102: "Wait until it is released, or take it over with control(force=True) as an admin",
    103: "Use `with radar.control() as control`",
    104: "Wait for a frame before asking for the next, as render_many does",
    105: "End a stream before beginning another",
    108: "Use a token of that role",
    110: "Begin the stream again with a window inside the frame",
}


def refusal(number: int, text: str, faults: Iterable[Fault] = (), radar: str = "") -> Refused:
    """The exception for an Error of the server."""
    return KINDS.get(number, Refused)(number, text, faults, radar)


def from_message(error: wire.Error) -> Refused:
    """The exception for a wire.Error."""
    faults = [Fault(fault.field, fault.found, fault.allowed) for fault in error.fields]
    return refusal(error.number, error.text, faults, error.radar)
