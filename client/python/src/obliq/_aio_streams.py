"""Frames one after the other, and a server that replays. The one source of both clients, as _aio_classes.py."""
from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Generic, TypeVar

from . import obliq_pb2 as wire
from ._protocol.assembly import Wedge
from ._protocol.asked import Subscription
from .errors import ConnectionLost, ObliqError, ServerStopping
from .frame import Frame
from .replay import ReplayState, seek_request

if TYPE_CHECKING:
    from ._aio_classes import Server

Taken = TypeVar("Taken", Frame, Wedge)


class Stream(Generic[Taken]):
    """Frames or wedges, one after the other. Ends with its `for` loop, its `with` block, or close()."""

    def __init__(self, server: Server, subscription: Subscription, reconnect_s: float, timeout_s: float | None):
        self._server, self._subscription = server, subscription
        self._reconnect_s, self._timeout_s = reconnect_s, timeout_s
        self._begun = self._over = False
        # blocking: self._begin()

    def __aiter__(self) -> Stream[Taken]:
        return self

    async def __aenter__(self) -> Stream[Taken]:
        await self._begin()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    @property
    def frames_aborted(self) -> int:
        """Frames that the server began and did not finish."""
        return self._subscription.frames_aborted

    async def _begin(self) -> None:
        if self._begun:
            return
        self._begun = True
        if self._subscription.by_wedge:
            await self._server.measure_clock()
        await self._server._run(self._server._session.begin_stream(self._subscription))

    async def __anext__(self) -> Taken:
        if self._over:
            raise StopAsyncIteration
        await self._begin()
        while True:
            connection = self._server._connection
            try:
                taken: Taken = await connection.run(connection.session.next_of(self._subscription, self._timeout_s))
                return taken
            except (ConnectionLost, ServerStopping) as why:
                if not self._reconnect_s:
                    raise
                await self._server._reconnect(why, self._reconnect_s, connection)

    async def close(self) -> None:
        """No more frames: the server need not send any."""
        if self._over:
            return
        self._over = True
        with contextlib.suppress(ObliqError):
            await self._server._run(self._server._session.end_stream(self._subscription))
    # blocking:
    # blocking: def __del__(self) -> None:
    # blocking:     # Of a `for` loop that was left: the server need not go on. Not where the connection is busy or gone.
    # blocking:     with contextlib.suppress(Exception):
    # blocking:         self.close()


class Replay:
    """Pause, speed and place of a server that replays a recording: server.replay."""

    def __init__(self, server: Server):
        self._server = server

    async def state(self) -> ReplayState:
        """Of now."""
        session = self._server._session
        # What has been sent before it has come then.
        await self._server._run(session.call(wire.Heartbeat(answer_wanted=True), wire.Heartbeat))
        return ReplayState.of(session.replay_state, session.offset_ns)

    async def _set(self, request: wire.SetReplay) -> None:
        await self._server._run(self._server._session.act(request))

    async def pause(self) -> None:
        """It stands still."""
        await self._set(wire.SetReplay(paused=True))

    async def resume(self) -> None:
        """It goes on."""
        await self._set(wire.SetReplay(paused=False))

    async def set_speed(self, factor: float) -> None:
        """Recorded seconds in a second: 0.01 to 1000000, or math.inf: without waiting."""
        await self._set(wire.SetReplay(speed=factor))

    async def seek(self, position_s: float | None = None, *, sim_time_ns: int | None = None, bookmark: int | None = None) -> None:
        """To the frame of that time, from the recording's start or by the poses' own clock, or to an event of that number."""
        await self._set(seek_request(position_s, sim_time_ns, bookmark))
