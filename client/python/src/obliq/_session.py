"""One connection without its socket: messages in, messages out, and which wait is for which message.

Commands are generators: they put requests into `outgoing` and yield a Wait; a driver sends these, feeds what arrives,
and resumes the command when the wait is over. The blocking and the asyncio client are two such drivers.
"""
from __future__ import annotations

import collections
import dataclasses
import time
import typing

from . import obliq_pb2 as wire
from ._assembly import Assembler, Buffers, Wedge
from ._wire import MAJOR, MINOR, encode
from .errors import BadStream, ConnectionLost, FrameAborted, ObliqError, Refused, from_message

REPLY_S = 30.0
# Heartbeats that may fail to come before a server is taken for dead: any may be late.
HEARTBEATS_MISSED = 3
# Complete frames, and wedges, that wait for a slow reader before no more is read for it.
MOST_FRAMES_WAITING = 2
MOST_WEDGES_WAITING = 512


@dataclasses.dataclass
class Wait:
    test: typing.Callable[[], bool]
    timeout_s: float | None
    what: str  # "an answer to Subscribe"


ANSWERS = {wire.Hello: wire.Welcome, wire.ListRadars: wire.RadarList, wire.GetRadar: wire.RadarInfo,
           wire.GetStatus: wire.Status, wire.Heartbeat: wire.Heartbeat, wire.QueryGround: wire.GroundAnswer}


class Pending:
    """A request that has not been answered."""

    reply = error = message = None

    def __init__(self, request):
        self.answer = ANSWERS.get(type(request), wire.Ack)

    def done(self):
        return self.reply is not None or self.error is not None


class Sink:
    """Where the frames of a subscription or a RenderOnce go."""

    def __init__(self, names, buffers=None):
        self.names, self.buffers = names, buffers
        self.assembler = None
        self.error = None
        self.ready = collections.deque()  # whole frames or wedges

    def waits(self):
        return not self.ready and self.error is None

    def begin(self, begin, header):
        if self.assembler is not None:
            raise BadStream("a frame began before the one before it ended")
        self.assembler = Assembler(begin, header, self.names, self.buffers)

    def lose(self):
        """The connection is gone: of a frame that has begun, no more will come."""
        self.assembler = None


class Rendering(Sink):
    """Of one RenderOnce."""

    def whole(self, frame):
        self.ready.append(frame)

    def aborted(self, reason):
        self.error = FrameAborted(reason)

    def wedge(self, rows, block, header, offset_ns):
        pass

    def has_enough(self):
        return False


class Subscription(Sink):
    """Of one radar. Where frames may be left out, a newer whole frame takes the place of one that has not been taken."""

    def __init__(self, request, names, by_wedge=False, copy=True):
        super().__init__(names, None if copy else Buffers())
        self.request, self.by_wedge = request, by_wedge
        self.frames_aborted = 0
        self._skipped = 0
        self._handed_out = None

    def whole(self, frame):
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

    def wedge(self, rows, block, header, offset_ns):
        if self.by_wedge:
            self.ready.append(Wedge(self.assembler.frame, rows, block, header, time.time_ns(), offset_ns))

    def aborted(self, reason):
        self.frames_aborted += 1

    def has_enough(self):
        """Reading on would only fill memory: the server is to wait, or to leave frames out."""
        if self.by_wedge:
            return len(self.ready) >= MOST_WEDGES_WAITING
        return self.request.lossless and len(self.ready) >= MOST_FRAMES_WAITING

    def take(self):
        if self.buffers and self._handed_out is not None:
            self.buffers.give(self._handed_out)
        self._handed_out = self.ready.popleft()
        return self._handed_out


class Session:
    def __init__(self):
        self.outgoing = []
        self.welcome = None
        self.replay_state = None  # the newest ReplayState and when it was sent
        self.lost = None  # the exception that ended the connection
        self.offset_ns = 0  # the server's clock is so much behind ours
        self.heard = time.monotonic()
        self.subscriptions = {}  # radar -> Subscription
        self._renderings = {}  # request_id -> Rendering
        self._streams = {}  # stream_id -> Sink, while a frame is on its way
        self._pending = {}
        self._last_request = 0
        self._sequence = 0

    # Messages.

    def _send(self, message):
        self._sequence += 1
        self.outgoing.append(encode(message, self._sequence))

    def ask(self, message):
        """Puts a request on its way."""
        self._last_request += 1
        message.request_id = self._last_request
        pending = self._pending[self._last_request] = Pending(message)
        self._send(message)
        return pending

    def call(self, message, timeout_s=REPLY_S):
        """Command: the answer to a request."""
        return (yield from self._answer(self.ask(message), message, timeout_s)).reply

    def _answer(self, pending, message, timeout_s=REPLY_S):
        try:
            yield Wait(pending.done, timeout_s, f"the answer to {message.DESCRIPTOR.name}")
        finally:
            self._pending.pop(message.request_id, None)
        if pending.error:
            raise pending.error
        return pending

    def end(self, error):
        """Nothing more will come."""
        if self.lost is None:
            self.lost = error
        for sink in [*self._renderings.values(), *self.subscriptions.values()]:
            sink.lose()

    def feed(self, message):
        """Takes a message of the server. Raises BadStream for one that cannot be."""
        self.heard = time.monotonic()
        parsed = message.parsed()
        if parsed is None:
            return  # of a later minor version
        kind = message.header.type
        if kind >= 48:
            try:
                self._feed_frame(message, parsed)
            except BadStream as error:
                raise BadStream(error.reason, message.offset if error.offset is None else error.offset) from None
        elif kind == 4:
            self._feed_error(parsed)
        elif kind == 33:
            self.replay_state = parsed, message.header.utc_ns
        elif kind == 5 and parsed.answer_wanted:
            self._send(wire.Heartbeat(request_id=parsed.request_id))
        elif kind in (2, 3, 5, 17, 19, 28, 31):
            pending = self._pending.get(parsed.request_id)
            if pending and isinstance(parsed, pending.answer):
                del self._pending[parsed.request_id]
                pending.reply, pending.message = parsed, message
            elif pending and kind != 5:
                raise BadStream(f"{parsed.DESCRIPTOR.name} answers a request; allowed: {pending.answer.DESCRIPTOR.name}",
                                message.offset)

    def _feed_error(self, message):
        error = from_message(message)
        pending = self._pending.pop(message.request_id, None)
        if pending:
            pending.error = error
        elif message.request_id in self._renderings:
            self._renderings[message.request_id].error = error
        elif message.radar in self.subscriptions and message.number in (106, 110):
            self.subscriptions[message.radar].error = error
        if message.number < 100:
            self.end(error)

    def _feed_frame(self, message, parsed):
        header = message.header
        if header.type == 48:
            sink = self._renderings.get(parsed.request_id) if parsed.request_id else self.subscriptions.get(
                parsed.frame.radar)
            if sink is not None:
                sink.begin(parsed, header)
                self._streams[header.stream_id] = sink
            return
        sink = self._streams.get(header.stream_id)
        if sink is None or sink.assembler is None or not sink.assembler.is_mine(header, parsed.frame_id):
            return  # of a subscription that was ended
        if header.type == 49:
            rows = sink.assembler.block(header, parsed, message.plane)
            if rows is not None:
                sink.wedge(rows, parsed, header, self.offset_ns)
            return
        assembler, sink.assembler = sink.assembler, None
        del self._streams[header.stream_id]
        if header.type == 51:
            sink.aborted(parsed.reason)
            return
        try:
            frame = assembler.end(parsed)
        except FrameAborted as given_up:
            sink.aborted(given_up.reason)
        else:
            sink.whole(frame)

    def has_enough(self):
        """Nothing more is to be read for now. Not while an answer is awaited, which may be behind the frames."""
        if self._pending or self._renderings:
            return False
        return any(sink.has_enough() for sink in self.subscriptions.values())

    def patience_s(self):
        """So long may the server be silent before it is taken for dead; None: for ever."""
        heartbeat_s = self.welcome.limits.heartbeat_s if self.welcome else 0
        return HEARTBEATS_MISSED * heartbeat_s if heartbeat_s > 0 else None

    def check_silence(self):
        """Where nothing has come and nothing waits to be read: ConnectionLost, once it has lasted too long."""
        patience = self.patience_s()
        silence = time.monotonic() - self.heard
        if patience is not None and silence > patience:
            self.end(ConnectionLost(f"the server has said nothing for {silence:.0f} s"))
            raise self.lost

    # Commands.

    def hello(self, name, token, timeout_s):
        self.welcome = yield from self.call(
            wire.Hello(major=MAJOR, minor=MINOR, client_name=name[:64], token=token or ""), timeout_s)
        if self.welcome.major != MAJOR:
            raise BadStream(f"protocol version: found {self.welcome.major}.{self.welcome.minor}; allowed: {MAJOR}.x")

    def measure_clock(self):
        """How much the server's clock is behind ours: PROTOCOL.md, "Latency"."""
        before_ns = time.time_ns()
        beat = wire.Heartbeat(answer_wanted=True)
        pending = yield from self._answer(self.ask(beat), beat)
        self.offset_ns = (before_ns + time.time_ns()) // 2 - pending.message.header.utc_ns
        return self.offset_ns * 1e-9

    def query(self, request, timeout_s):
        """Command: the answer to a QueryGround, and the records behind it."""
        pending = yield from self._answer(self.ask(request), request, timeout_s)
        return pending.reply, pending.message.plane

    def begin_render(self, request, names):
        """RenderOnce on its way: finish() waits for its frame."""
        pending = self.ask(request)
        rendering = self._renderings[request.request_id] = Rendering(names)
        rendering.request_id, rendering.pending = request.request_id, pending
        return rendering

    def finish_render(self, rendering, timeout_s):
        try:
            yield Wait(lambda: rendering.pending.error or not rendering.waits(), timeout_s, "a rendered frame")
        finally:
            self.forget_render(rendering)
        error = rendering.pending.error or rendering.error
        if error:
            raise error
        return rendering.ready.popleft()

    def settle_render(self, rendering, timeout_s):
        """Command: until the frame is there, or is not to come. It is not taken."""
        yield Wait(lambda: rendering.pending.error or not rendering.waits(), timeout_s, "a rendered frame")

    def forget_render(self, rendering):
        self._renderings.pop(rendering.request_id, None)
        self._pending.pop(rendering.request_id, None)
        self._streams = {number: sink for number, sink in self._streams.items() if sink is not rendering}

    def begin_stream(self, subscription):
        """Command. A subscription of the same radar is replaced, as on the server."""
        radar = subscription.request.radar
        old = self.subscriptions.get(radar)
        pending = self.ask(subscription.request)
        # Frames may come as soon as the Ack has: they are expected from now on. Blocks of the old one's frame in
        # progress are not this one's: its stream is forgotten.
        self._streams = {number: sink for number, sink in self._streams.items() if sink is not old}
        self.subscriptions[radar] = subscription
        try:
            yield from self._answer(pending, subscription.request)
        except Refused:
            self.subscriptions.pop(radar, None)
            if old is not None:
                self.subscriptions[radar] = old
            raise
        if old is not None and old is not subscription:
            old.error = ObliqError(f"another stream of radar {radar} was begun on this connection: connect once more "
                                   "to watch it twice")

    def next_of(self, subscription, timeout_s):
        yield Wait(lambda: not subscription.waits(), timeout_s, f"a frame of radar {subscription.request.radar}")
        if subscription.ready:
            return subscription.take()
        raise subscription.error

    def end_stream(self, subscription):
        radar = subscription.request.radar
        if self.subscriptions.get(radar) is not subscription:
            return
        try:
            yield from self.call(wire.Unsubscribe(radar=radar))
        finally:
            self.subscriptions.pop(radar, None)
            self._streams = {number: sink for number, sink in self._streams.items() if sink is not subscription}
