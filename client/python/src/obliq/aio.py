"""The asyncio client: the same names as the blocking one, awaited.

    async with obliq.aio.connect("127.0.0.1:7420") as server:
        frame = await server.radar().frame()
        async for frame in server.radar().stream(rate_hz=10): ...

A connection belongs to the event loop that opened it; any number of tasks may use it. No thread, no polling: bytes are
taken as they come, at most a quarter of a megabyte at a time.
"""
from __future__ import annotations

import asyncio
import collections
import contextlib
import time

from . import _requests as requests
from . import ground
from . import obliq_pb2 as wire
from ._aio_connection import open_connection
from .client import FIRST_PAUSE_S, LONGEST_PAUSE_S, PASSING
from .errors import ConnectionLost, ObliqError, OverLimit, ServerStopping
from .replay import AioReplay


class connect:
    """As obliq.connect: `async with connect(...) as server`, or `server = await connect(...)`."""

    def __init__(self, address="127.0.0.1:7420", *, token=None, token_file=None, tls=None, name="python", timeout=5.0):
        door = requests.Door.of(address, token, token_file, tls, name, timeout)
        self._server = Server(lambda: open_connection(door))

    def __await__(self):
        return self._server._start().__await__()

    async def __aenter__(self):
        return await self._server._start()

    async def __aexit__(self, *_):
        await self._server.close()


class Server:
    def __init__(self, open_connection):
        self._open = open_connection
        self._protocol = None
        self._closed = False
        self._reconnecting = None

    async def _start(self):
        self._protocol = await self._open()
        return self

    async def __aenter__(self):
        return self

    async def __aexit__(self, *_):
        await self.close()

    async def close(self):
        self._closed = True
        self._protocol.close("the connection was closed by close()")
        await asyncio.sleep(0)  # the transport closes on the loop's next turn

    @property
    def info(self):
        return requests.ServerInfo.of(self._protocol.session.welcome)

    async def _run(self, command, *arguments):
        return await self._protocol.run(getattr(self._protocol.session, command)(*arguments))

    def radar(self, name=None):
        return Radar(self, requests.radar_name(self.info.radars, name))

    @property
    def replay(self):
        return AioReplay(self)

    async def status(self):
        return await self._run("call", wire.GetStatus())

    async def measure_clock(self):
        return await self._run("measure_clock")

    async def query(self, latitude_deg=None, longitude_deg=None, height_m=None, *, timeout=30.0, **choice):
        asked = ground.Asked(self.info.limits, latitude_deg, longitude_deg, height_m, **choice)
        for request in asked.requests():
            asked.add(*await self._run("query", request, timeout))
        return asked.points()

    def _begin(self, wish):
        session = self._protocol.session
        if session.lost is not None:
            raise session.lost
        rendering = session.begin_render(*requests.render_request(*wish))
        self._protocol.stir()
        return rendering

    async def render(self, settings=None, pose=None, *, planes=None, encoding="cf32", compress=None, window=None,
                     timeout=60.0, radar="python"):
        rendering = self._begin((settings, pose, planes, encoding, compress, window, radar))
        return await self._run("finish_render", rendering, timeout)

    async def render_many(self, poses, settings=None, *, planes=None, encoding="cf32", compress=None, window=None,
                          timeout=60.0, radar="python", return_exceptions=False, seed=None):
        in_flight = max(1, self.info.limits.max_renders_queued)
        waiting = collections.deque()
        wanted = requests.wishes(poses, settings, seed, (planes, encoding, compress, window, radar))
        more = True
        try:
            while more or waiting:
                while more and len(waiting) < in_flight:
                    wish = next(wanted, None)
                    more = wish is not None
                    if not more:
                        break
                    try:
                        waiting.append((wish, self._begin(wish)))
                    except (TypeError, ValueError) as error:
                        if not return_exceptions:
                            raise
                        waiting.append((wish, error))
                if waiting:
                    yield await self._finish(return_exceptions, waiting, timeout)
        finally:
            for _, rendering in waiting:
                if not isinstance(rendering, Exception):
                    self._protocol.session.forget_render(rendering)

    async def _finish(self, keep_errors, waiting, timeout):
        wish, rendering = waiting.popleft()
        try:
            if isinstance(rendering, Exception):
                raise rendering
            try:
                return await self._run("finish_render", rendering, timeout)
            except OverLimit:
                if not waiting:
                    raise
            for _, other in waiting:
                if not isinstance(other, Exception):
                    await self._run("settle_render", other, timeout)
            return await self._run("finish_render", self._begin(wish), timeout)
        except (ConnectionLost, ServerStopping):
            raise
        except (ObliqError, TypeError, ValueError) as error:
            if not keep_errors:
                raise
            return error

    async def _reconnect(self, why, patience_s, lost):
        """One attempt for all streams that noticed the loss."""
        if self._protocol is not lost:
            return  # another stream has done it
        if self._reconnecting is None:
            self._reconnecting = asyncio.ensure_future(self._connect_again(why, patience_s))
            self._reconnecting.add_done_callback(lambda _: setattr(self, "_reconnecting", None))
        await asyncio.shield(self._reconnecting)

    async def _connect_again(self, why, patience_s):
        end = time.monotonic() + patience_s
        pause = FIRST_PAUSE_S
        while True:
            if self._closed or time.monotonic() + pause > end:
                raise why
            await asyncio.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE_S)
            held = self._protocol.session.subscriptions
            fresh = None
            try:
                fresh = await self._open()
                for subscription in held.values():
                    subscription.lose()
                    await fresh.run(fresh.session.begin_stream(subscription))
            except PASSING:
                if fresh is not None:
                    fresh.close("the connection was closed")
                continue
            except BaseException:
                if fresh is not None:
                    fresh.close("the connection was closed")
                raise
            self._protocol.close("the connection was closed")
            self._protocol = fresh
            return


class Radar:
    def __init__(self, server, name):
        self._server, self.name = server, name

    async def info(self):
        return requests.RadarInfo.of(await self._server._run("call", wire.GetRadar(radar=self.name)))

    @property
    async def settings(self):
        return (await self.info()).settings

    @property
    async def pose(self):
        return (await self.info()).pose

    async def query(self, latitude_deg=None, longitude_deg=None, height_m=None, **choice):
        return await self._server.query(latitude_deg, longitude_deg, height_m, radar=self.name, **choice)

    async def frame(self, timeout=30.0, **choice):
        async with self.stream(timeout=timeout, **choice) as frames:
            return await frames.__anext__()

    def stream(self, rate_hz=10.0, planes=None, encoding="cf32", compress=None, window=None, lossless=False, reconnect=0.0,
               copy=True, timeout=30.0):
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          False, copy), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    def wedges(self, rate_hz=10.0, planes=None, encoding="cf32", compress=None, window=None, lossless=False, reconnect=0.0,
               timeout=30.0):
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          True, True), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    @contextlib.asynccontextmanager
    async def control(self, force=False):
        await self._server._run("call", wire.ClaimControl(radar=self.name, force=force))
        try:
            yield Control(self._server, self.name)
        finally:
            with contextlib.suppress(ObliqError):
                await self._server._run("call", wire.ReleaseControl(radar=self.name))


class Control:
    def __init__(self, server, name):
        self._server, self.name = server, name

    async def set_pose(self, pose=None, **fields):
        return requests.Accepted.of(await self._server._run("call", requests.pose_request(self.name, pose, fields)))

    async def set(self, settings=None, **fields):
        return requests.Accepted.of(await self._server._run("call", requests.settings_request(self.name, settings, fields)))

    async def set_state(self, transmit=None, freeze=None):
        await self._server._run("call", requests.state_request(self.name, transmit, freeze))


class Stream:
    """Frames or wedges. Begins with its first frame or its `async with`; ends with either, or close()."""

    def __init__(self, server, subscription, reconnect_s, timeout_s):
        self._server, self._subscription = server, subscription
        self._reconnect_s, self._timeout_s = reconnect_s, timeout_s
        self._begun = self._over = False

    def __aiter__(self):
        return self

    async def __aenter__(self):
        await self._begin()
        return self

    async def __aexit__(self, *_):
        await self.close()

    @property
    def frames_aborted(self):
        return self._subscription.frames_aborted

    async def _begin(self):
        if self._begun:
            return
        self._begun = True
        if self._subscription.by_wedge:
            await self._server.measure_clock()
        await self._server._run("begin_stream", self._subscription)

    async def __anext__(self):
        if self._over:
            raise StopAsyncIteration
        await self._begin()
        while True:
            protocol = self._server._protocol
            try:
                return await protocol.run(protocol.session.next_of(self._subscription, self._timeout_s))
            except (ConnectionLost, ServerStopping) as why:
                if not self._reconnect_s:
                    raise
                await self._server._reconnect(why, self._reconnect_s, protocol)

    async def close(self):
        if self._over:
            return
        self._over = True
        with contextlib.suppress(ObliqError):
            await self._server._run("end_stream", self._subscription)
