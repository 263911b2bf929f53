"""What was asked of a server, and where its answers go: a request that waits, the frames of a subscription or a RenderOnce."""
from __future__ import annotations

import collections
import time
from collections.abc import Callable
from typing import Any, Union

from .. import obliq_pb2 as wire
from .assembly import Assembler, Buffers, Wedge
from .wire import Header, Message
from ..errors import BadStream, FrameAborted, ObliqError
from ..frame import Frame

# Complete frames, and wedges, that wait for a slow reader before no more is read for it.
MOST_FRAMES_WAITING = 2
MOST_WEDGES_WAITING = 512

Answer = Union[wire.Welcome, wire.RadarList, wire.RadarInfo, wire.Status, wire.Heartbeat, wire.GroundAnswer, wire.ExerciseState,
               wire.ExerciseEvents, wire.TargetList, wire.Ack]


class Pending:
    """A request that has not been answered."""

    reply: Answer | None = None
    error: ObliqError | None = None
    message: Message | None = None

    def __init__(self, answer: type[Answer]):
        self.answer = answer

    def done(self) -> bool:
        return self.reply is not None or self.error is not None

    def refuse(self, error: ObliqError) -> None:
        """Takes the server's refusal."""
        self.error = error


class Told(Pending):
    """A request whose answer nobody waits for; its refusal goes to a function."""

    def __init__(self, refused: Callable[[ObliqError], object]):
        super().__init__(wire.Ack)
        self._refused = refused

    def refuse(self, error: ObliqError) -> None:
        self._refused(error)


class Sink:
    """Where the frames of a subscription or a RenderOnce go."""

    def __init__(self, names: tuple[str, ...], buffers: Buffers | None = None):
        self.names, self.buffers = names, buffers
        self.assembler: Assembler | None = None
        self.error: ObliqError | None = None
        self.ready: collections.deque[Any] = collections.deque()  # whole frames or wedges

    def waits(self) -> bool:
        return not self.ready and self.error is None

    def begin(self, begin: wire.FrameBegin, header: Header) -> None:
        if self.assembler is not None:
            raise BadStream("a frame began before the one before it ended")
        self.assembler = Assembler(begin, header, self.names, self.buffers)

    def lose(self) -> None:
        """The connection is gone: of a frame that has begun, no more will come."""
        self.assembler = None

    def whole(self, frame: Frame) -> None:
        """Takes a frame."""
        self.ready.append(frame)

    def aborted(self, reason: str) -> None:
        """Takes note that a frame will not come."""

    def wedge(self, rows: slice, block: wire.WedgeBlock, header: Header, offset_ns: int) -> None:
        """Takes rows that are complete."""

    def has_enough(self) -> bool:
        """Reading on would only fill memory."""
        return False


class Rendering(Sink):
    """Of one RenderOnce."""

    def __init__(self, names: tuple[str, ...], request_id: int, pending: Pending):
        super().__init__(names)
        self.request_id, self.pending = request_id, pending

    def aborted(self, reason: str) -> None:
        self.error = FrameAborted(reason)

    def over(self) -> bool:
        """The frame is there, or will not come."""
        return self.pending.error is not None or not self.waits()


class Subscription(Sink):
    """Of one radar. Where frames may be left out, a newer whole frame takes the place of one that has not been taken."""

    def __init__(self, request: wire.Subscribe, names: tuple[str, ...], by_wedge: bool = False, copy: bool = True):
        super().__init__(names, None if copy else Buffers())
        self.request, self.by_wedge = request, by_wedge
        self.frames_aborted = 0
        self._skipped = 0
        self._handed_out: Frame | None = None

    def whole(self, frame: Frame) -> None:
        if self.by_wedge:
            return
        if self.ready and not self.request.lossless:
            old = self.ready.popleft()
            self._skipped += 1 + old.frames_skipped
            if self.buffers:
                self.buffers.give(old)
        frame.frames_skipped += self._skipped
        self._skipped = 0
        self.ready.append(frame)

    def wedge(self, rows: slice, block: wire.WedgeBlock, header: Header, offset_ns: int) -> None:
        if self.by_wedge and self.assembler is not None:
            self.ready.append(Wedge(self.assembler.frame, rows, block, header, time.time_ns(), offset_ns))

    def aborted(self, reason: str) -> None:
        self.frames_aborted += 1

    def has_enough(self) -> bool:
        """Reading on would only fill memory: the server is to wait, or to leave frames out."""
        if self.by_wedge:
            return len(self.ready) >= MOST_WEDGES_WAITING
        return self.request.lossless and len(self.ready) >= MOST_FRAMES_WAITING

    def take(self) -> Any:
        """The oldest frame or wedge."""
        if self.buffers and self._handed_out is not None:
            self.buffers.give(self._handed_out)
        taken = self.ready.popleft()
        if isinstance(taken, Frame):
            self._handed_out = taken
        return taken
