"""One connection without its socket: messages in, messages out, and which wait is for which message.

Commands are generators: they put requests into `outgoing` and yield a Wait; a driver sends these, feeds what arrives,
and resumes the command when the wait is over. The blocking and the asyncio client are two such drivers.
"""
from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Generator
from typing import Any, TypeVar, Union, cast

from .. import obliq_pb2 as wire
from .asked import Answer, Pending, Rendering, Sink, Subscription, Told
from .wire import MAJOR, MINOR, Message, encode
from ..errors import BadStream, ConnectionLost, FrameAborted, ObliqError, Refused, from_message
from ..frame import Frame

REPLY_S = 30.0
# Heartbeats that may fail to come before a server is taken for dead: any may be late.
HEARTBEATS_MISSED = 3


@dataclasses.dataclass
class Wait:
    """Until test() holds. what: "the answer to Subscribe"."""

    test: Callable[[], bool]
    timeout_s: float | None
    what: str


T = TypeVar("T")
Command = Generator[Wait, None, T]
Request = Union[wire.Hello, wire.Heartbeat, wire.ListRadars, wire.GetRadar, wire.GetStatus, wire.QueryGround, wire.ClaimControl,
                wire.ReleaseControl, wire.SetSettings, wire.SetPose, wire.SetState, wire.Subscribe, wire.Unsubscribe,
                wire.RenderOnce, wire.SetReplay, wire.ResetExercise, wire.GetExercise, wire.LoadExercise, wire.SetExercise,
                wire.GetEvents, wire.AddBookmark, wire.SetTargets, wire.GetTargets]
A = TypeVar("A", wire.Welcome, wire.RadarList, wire.RadarInfo, wire.Status, wire.Heartbeat, wire.GroundAnswer,
            wire.ExerciseState, wire.ExerciseEvents, wire.TargetList, wire.Ack)


class Session:
    """What has been asked, what has come, what waits. Each command is a generator that its driver runs."""

    def __init__(self) -> None:
        self.outgoing: list[bytes] = []
        self._welcome: wire.Welcome | None = None
        self.replay_state: tuple[wire.ReplayState, int] | None = None  # the newest, and when it was sent
        self.lost: ObliqError | None = None  # what ended the connection
        self.offset_ns = 0  # the server's clock is so much behind ours
        self.heard = time.monotonic()
        self.subscriptions: dict[str, Subscription] = {}  # by radar
        self._renderings: dict[int, Rendering] = {}  # by request_id
        self._streams: dict[int, Sink] = {}  # by stream_id, while a frame is on its way
        self._pending: dict[int, Pending] = {}
        self._last_request = 0
        self._sequence = 0

    # Messages.

    @property
    def welcome(self) -> wire.Welcome:
        """What the server said first."""
        assert self._welcome is not None, "before hello()"
        return self._welcome

    def _send(self, message: Request) -> None:
        self._sequence += 1
        self.outgoing.append(encode(message, self._sequence))

    def ask(self, message: Request, answer: type[Answer] = wire.Ack) -> Pending:
        """Puts a request on its way."""
        return self._ask(message, Pending(answer))

    def tell(self, message: Request, refused: Callable[[ObliqError], object]) -> None:
        """The same of one whose Ack nobody waits for."""
        self._ask(message, Told(refused))

    def _ask(self, message: Request, pending: Pending) -> Pending:
        self._last_request += 1
        message.request_id = self._last_request
        self._pending[self._last_request] = pending
        self._send(message)
        return pending

    def call(self, message: Request, answer: type[A], timeout_s: float = REPLY_S) -> Command[A]:
        """Command: the answer to a request."""
        pending = yield from self._answer(self.ask(message, answer), message, timeout_s)
        return cast(A, pending.reply)

    def act(self, message: Request) -> Command[wire.Ack]:
        """Command: until the server has done it."""
        return self.call(message, wire.Ack)

    def _answer(self, pending: Pending, message: Request, timeout_s: float = REPLY_S) -> Command[Pending]:
        try:
            yield Wait(pending.done, timeout_s, f"the answer to {message.DESCRIPTOR.name}")
        finally:
            self._pending.pop(message.request_id, None)
        if pending.error:
            raise pending.error
        return pending

    def end(self, error: ObliqError) -> None:
        """Nothing more will come."""
        if self.lost is None:
            self.lost = error
        for sink in [*self._renderings.values(), *self.subscriptions.values()]:
            sink.lose()

    def feed(self, message: Message) -> None:
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
        elif kind in (2, 3, 5, 17, 19, 28, 31, 36, 39, 43):
            pending = self._pending.get(parsed.request_id)
            if pending and isinstance(parsed, pending.answer):
                del self._pending[parsed.request_id]
                pending.reply, pending.message = parsed, message
            elif pending and kind != 5:
                raise BadStream(f"{parsed.DESCRIPTOR.name} answers a request; allowed: {pending.answer.DESCRIPTOR.name}",
                                message.offset)

    def _feed_error(self, message: wire.Error) -> None:
        error = from_message(message)
        pending = self._pending.pop(message.request_id, None)
        if pending:
            pending.refuse(error)
        elif message.request_id in self._renderings:
            self._renderings[message.request_id].error = error
        elif message.radar in self.subscriptions and message.number in (106, 110):
            self.subscriptions[message.radar].error = error
        if message.number < 100:
            self.end(error)

    def _feed_frame(self, message: Message, parsed: Any) -> None:
        header = message.header
        sink: Sink | None
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
        if header.type == 52:
            sink.assembler.targets(parsed, message.plane)
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

    def has_enough(self) -> bool:
        """Nothing more is to be read for now. Not while an answer is awaited, which may be behind the frames."""
        if self._renderings or not all(isinstance(pending, Told) for pending in self._pending.values()):
            return False
        return any(sink.has_enough() for sink in self.subscriptions.values())

    def patience_s(self) -> float | None:
        """So long may the server be silent before it is taken for dead; None: for ever."""
        heartbeat_s = self._welcome.limits.heartbeat_s if self._welcome else 0
        return HEARTBEATS_MISSED * heartbeat_s if heartbeat_s > 0 else None

    def check_silence(self) -> None:
        """Where nothing has come and nothing waits to be read: ConnectionLost, once it has lasted too long."""
        patience = self.patience_s()
        silence = time.monotonic() - self.heard
        if patience is not None and silence > patience:
            self.end(ConnectionLost(f"the server has said nothing for {silence:.0f} s"))
            raise self.lost or ConnectionLost("the connection is closed")

    # Commands.

    def hello(self, name: str, token: str, timeout_s: float) -> Command[None]:
        """Command: until the server has let this client in."""
        self._welcome = yield from self.call(
            wire.Hello(major=MAJOR, minor=MINOR, client_name=name[:64], token=token or ""), wire.Welcome, timeout_s)
        if self.welcome.major != MAJOR:
            raise BadStream(f"protocol version: found {self.welcome.major}.{self.welcome.minor}; allowed: {MAJOR}.x")

    def measure_clock(self) -> Command[float]:
        """How much the server's clock is behind ours: PROTOCOL.md, "Latency"."""
        before_ns = time.time_ns()
        beat = wire.Heartbeat(answer_wanted=True)
        pending = yield from self._answer(self.ask(beat, wire.Heartbeat), beat)
        assert pending.message is not None
        self.offset_ns = (before_ns + time.time_ns()) // 2 - pending.message.header.utc_ns
        return self.offset_ns * 1e-9

    def query(self, request: wire.QueryGround, timeout_s: float) -> Command[tuple[wire.GroundAnswer, memoryview]]:
        """Command: the answer to a QueryGround, and the records behind it."""
        pending = yield from self._answer(self.ask(request, wire.GroundAnswer), request, timeout_s)
        assert pending.message is not None
        return cast(wire.GroundAnswer, pending.reply), pending.message.plane

    def begin_render(self, request: wire.RenderOnce, names: tuple[str, ...]) -> Rendering:
        """RenderOnce on its way: finish_render() waits for its frame."""
        pending = self.ask(request)
        rendering = self._renderings[request.request_id] = Rendering(names, request.request_id, pending)
        return rendering

    def finish_render(self, rendering: Rendering, timeout_s: float) -> Command[Frame]:
        """Command: the frame."""
        try:
            yield Wait(rendering.over, timeout_s, "a rendered frame")
        finally:
            self.forget_render(rendering)
        error = rendering.pending.error or rendering.error
        if error:
            raise error
        return cast(Frame, rendering.ready.popleft())

    def settle_render(self, rendering: Rendering, timeout_s: float) -> Command[None]:
        """Command: until the frame is there, or is not to come. It is not taken."""
        yield Wait(rendering.over, timeout_s, "a rendered frame")

    def forget_render(self, rendering: Rendering) -> None:
        """Its frame is not wanted any more."""
        self._renderings.pop(rendering.request_id, None)
        self._pending.pop(rendering.request_id, None)
        self._streams = {number: sink for number, sink in self._streams.items() if sink is not rendering}

    def begin_stream(self, subscription: Subscription) -> Command[None]:
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

    def next_of(self, subscription: Subscription, timeout_s: float | None) -> Command[Any]:
        """Command: its next frame or wedge."""
        yield Wait(lambda: not subscription.waits(), timeout_s, f"a frame of radar {subscription.request.radar}")
        if subscription.ready:
            return subscription.take()
        assert subscription.error is not None
        raise subscription.error

    def end_stream(self, subscription: Subscription) -> Command[None]:
        """Command: no more is to come."""
        radar = subscription.request.radar
        if self.subscriptions.get(radar) is not subscription:
            return
        try:
            yield from self.act(wire.Unsubscribe(radar=radar))
        finally:
            self.subscriptions.pop(radar, None)
            self._streams = {number: sink for number, sink in self._streams.items() if sink is not subscription}
