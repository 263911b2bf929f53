"""What a client has: server and radar. The one source of both clients: generate.py writes _classes.py, the blocking ones,
from it. A line that ends in `# aio` is left out there; `# blocking: LINE` becomes LINE."""
from __future__ import annotations

import asyncio
import collections
import contextlib
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from typing import Any, Literal, TypeVar, overload

import numpy.typing as npt

from . import _requests as requests
from . import ground
from . import obliq_pb2 as wire
from ._aio_connection import Connection
from ._aio_control import Control, Targets
from ._aio_streams import Replay, Stream
from ._protocol.assembly import Wedge
from ._protocol.asked import Rendering
from ._protocol.session import Command, Session
from .errors import CannotConnect, ConnectionLost, ObliqError, OverLimit, ServerFull, ServerStopping, TimedOut, printable
from .frame import Frame
from .parameters import Pose, PoseFields, Settings
from .planes import Planes, Window
from .targets import Target, TargetLike, World

FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 5.0
# A loss, or why an attempt to connect again failed for now; other refusals are for good.
RETRIABLE_ERRORS = (ConnectionLost, ServerStopping, CannotConnect, ServerFull, TimedOut)

T = TypeVar("T")
Encoding = Literal["cf32", "cf32_le", "ci16", "ci16_le"]
Compression = Literal["zstd", "none"]


class Server:
    """A connected server. Use it as a context manager, or close() it."""

    def __init__(self, open_connection: Callable[[], Awaitable[Connection]]):
        self._open = open_connection
        self._connected: Connection | None = None
        self._closed = False
        self._reconnecting = asyncio.Lock()

    async def _start(self) -> Server:
        self._connected = await self._open()
        return self

    @property
    def _connection(self) -> Connection:
        assert self._connected is not None, "before it is awaited"
        return self._connected

    @property
    def _session(self) -> Session:
        return self._connection.session

    async def __aenter__(self) -> Server:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """The next use raises ConnectionLost."""
        self._closed = True
        if self._connected is not None:
            self._connected.close()
        await asyncio.sleep(0)  # the transport closes on the loop's next turn  # aio

    def __repr__(self) -> str:
        return printable(f"<obliq.Server {self._connection.address}: {self.info.scene}, {', '.join(self.info.radars)}>")

    @property
    def address(self) -> str:
        """HOST:PORT of the server."""
        return self._connection.address

    @property
    def info(self) -> requests.ServerInfo:
        """Name, version, scene, radars, encodings, limits and role, as the server's Welcome had them."""
        return requests.ServerInfo.of(self._session.welcome)

    async def _run(self, command: Command[T]) -> T:
        return await self._connection.run(command)

    def radar(self, name: str | None = None) -> Radar:
        """A live radar: the only one, or the one of that name."""
        return Radar(self, requests.radar_name(self.info.radars, name))

    async def platform(self, name: str | None = None) -> Radar:
        """What radars ride on: the only one, or the one of that name. Its pose moves all of them; settings are their own."""
        there = await self._run(self._session.call(wire.ListRadars(), wire.RadarList))
        return Radar(self, requests.radar_name(there.platforms, name, "platform"))

    @property
    def replay(self) -> Replay:
        """Pause, speed and place of a server that replays a recording (`obliq replay FILE --serve`)."""
        return Replay(self)

    async def status(self) -> wire.Status:
        """The message Status."""
        return await self._run(self._session.call(wire.GetStatus(), wire.Status))

    @contextlib.asynccontextmanager
    async def targets(self, force: bool = False) -> AsyncIterator[Targets]:
        """Claims the world's targets; the claim is released at the end, the targets stay. force: from another client, for
        an admin."""
        request = requests.of_1_2(self._session.welcome, wire.ClaimControl(force=force, kinds=[wire.TARGETS_CLAIM]))
        await self._run(self._session.act(request))
        try:
            yield Targets(self)
        finally:
            with contextlib.suppress(ObliqError):  # gone with the connection, or taken over by another
                await self._run(self._session.act(wire.ReleaseControl(kinds=[wire.TARGETS_CLAIM])))

    async def target_list(self) -> list[Target]:
        """All targets of the world, as they were set. Needs the server's truth role."""
        found: list[Target] = []
        while True:
            request = requests.of_1_2(self._session.welcome, wire.GetTargets(after=found[-1].id or 0 if found else 0))
            page = await self._run(self._session.call(request, wire.TargetList))
            found += [Target.read(each) for each in page.targets]
            if not page.more or not page.targets:
                return found

    async def exercise(self) -> wire.ExerciseState:
        """Poses, settings, seeds, times and switches of all radars, for load_exercise()."""
        return await self._run(self._session.call(requests.of_1_2(self._session.welcome, wire.GetExercise()), wire.ExerciseState))

    async def load_exercise(self, state: wire.ExerciseState) -> None:
        """Puts a state in place, all of it or nothing. This and the next two need both claims of all radars, or an admin."""
        await self._run(self._session.act(requests.of_1_2(self._session.welcome, wire.LoadExercise(state=state))))

    async def reset_exercise(self, radar: str = "") -> None:
        """A radar, or all, back to the scene file's settings, pose and switches."""
        await self._run(self._session.act(requests.of_1_2(self._session.welcome, wire.ResetExercise(radar=radar))))

    async def freeze_exercise(self, on: bool) -> None:
        """Clock, antenna and noise of all radars stand, for all clients, or go on."""
        await self._run(self._session.act(requests.of_1_2(self._session.welcome, wire.SetExercise(frozen=bool(on)))))

    async def events(self, after: int = 0) -> list[wire.ExerciseEvent]:
        """Who changed what of the exercise, and when: what the server has of its log, behind number `after`."""
        events: list[wire.ExerciseEvent] = []
        more = True
        while more:
            request = requests.of_1_2(self._session.welcome, wire.GetEvents(after=after))
            page = await self._run(self._session.call(request, wire.ExerciseEvents))
            events += page.events
            after, more = events[-1].number if events else after, page.more
        return events

    async def bookmark(self, text: str) -> None:
        """Marks this moment of the exercise, or the place of a replay, for all stations; at most 1000 bytes, for a controller."""
        await self._run(self._session.act(requests.of_1_2(self._session.welcome, requests.bookmark_request(text))))

    async def bookmarks(self) -> list[wire.ExerciseEvent]:
        """Those of the log, with `number`, `utc_ns`, `by` and `text`; server.replay.seek(bookmark=number) takes a replay there."""
        return [event for event in await self.events() if event.kind == wire.BOOKMARK_EVENT]

    async def measure_clock(self) -> float:
        """Seconds by which the server's clock is behind this machine's; latencies take it into account."""
        return await self._run(self._session.measure_clock())

    async def query(self, latitude_deg: npt.ArrayLike | None = None, longitude_deg: npt.ArrayLike | None = None,
                    height_m: npt.ArrayLike | None = None, *, bearing_deg: npt.ArrayLike | None = None,
                    range_m: npt.ArrayLike | None = None, height_reference: ground.Reference = "datum",
                    geoid_undulation_m: float = 0.0, antenna: Pose | PoseFields | None = None, radar: str = "",
                    timeout: float = 30.0) -> ground.GroundPoints:
        """What is at places of the ground: an obliq.GroundPoints with arrays of the given shape. height_m: of points
        there, None: on the ground. height_reference: "datum", "ground" or "ellipsoid" with geoid_undulation_m.
        antenna: a Pose, or a dict, for whether it sees the points; bearing_deg and range_m in place of the first
        two. radar.query() asks for a live radar's antenna."""
        asked = ground.Asked(self.info.limits, latitude_deg, longitude_deg, height_m, bearing_deg=bearing_deg, range_m=range_m,
                             height_reference=height_reference, geoid_undulation_m=geoid_undulation_m, antenna=antenna,
                             radar=radar)
        for request in asked.requests():
            asked.add(*await self._run(self._session.query(request, timeout)))
        return asked.points()

    async def render(self, settings: requests.SettingsLike = None, pose: requests.PoseLike = None, *, planes: Planes = None,
                     encoding: Encoding = "cf32", compress: Compression | None = None, window: Window | None = None,
                     timeout: float = 60.0, radar: str = "python", as_live: bool = False,
                     targets: Iterable[TargetLike] | None = None, live_targets: bool = False, truth: bool = False) -> Frame:
        """One frame for this client alone; no live radar is touched. settings, pose: objects or dicts; absent settings
        take their defaults; as_live: what is absent in either is as the live radar of that name has it now. planes: "iq
        state", or None for iq, power, count and state. targets: of this frame alone; live_targets: those of the world too.
        truth: frame.targets says where they are."""
        rendering = self._begin((settings, pose, planes, encoding, compress, window, radar, as_live, None,
                                 World.of(targets, live_targets, truth)))
        return await self._run(self._session.finish_render(rendering, timeout))

    @overload
    def render_many(self, poses: Iterable[requests.PoseRequest], settings: requests.SettingsLike = None, *, planes: Planes = None,
                    encoding: Encoding = "cf32", compress: Compression | None = None, window: Window | None = None,
                    timeout: float = 60.0, radar: str = "python", as_live: bool = False, return_exceptions: Literal[False] = False,
                    seed: int | None = None, targets: Iterable[TargetLike] | None = None, live_targets: bool = False,
                    truth: bool = False) -> AsyncIterator[Frame]: ...
    @overload
    def render_many(self, poses: Iterable[requests.PoseRequest], settings: requests.SettingsLike = None, *, planes: Planes = None,
                    encoding: Encoding = "cf32", compress: Compression | None = None, window: Window | None = None,
                    timeout: float = 60.0, radar: str = "python", as_live: bool = False, return_exceptions: bool,
                    seed: int | None = None, targets: Iterable[TargetLike] | None = None, live_targets: bool = False,
                    truth: bool = False) -> AsyncIterator[Frame | Exception]: ...

    async def render_many(self, poses: Iterable[requests.PoseRequest], settings: requests.SettingsLike = None, *,
                          planes: Planes = None, encoding: Encoding = "cf32", compress: Compression | None = None,
                          window: Window | None = None, timeout: float = 60.0, radar: str = "python",
                          as_live: bool = False, return_exceptions: bool = False, seed: int | None = None,
                          targets: Iterable[TargetLike] | None = None, live_targets: bool = False,
                          truth: bool = False) -> AsyncIterator[Any]:
        """Frames of many poses, in their order, as many on their way as the server allows. A pose may also be a pair of
        pose and settings, or three with targets of its own; targets, live_targets, truth: as render().
        return_exceptions: a refusal is yielded in its place and the rest goes on. seed: a whole number
        from which each frame has noise and independent speckle of its own, by its place (noise_frame, whatever the settings
        say); None: all have those that their settings name."""
        in_flight = max(1, self.info.limits.max_renders_queued)
        waiting: collections.deque[tuple[requests.FrameRequest, Rendering | Exception]] = collections.deque()
        wanted = requests.frame_requests(poses, settings, seed, (planes, encoding, compress, window, radar, as_live),
                                 World.of(targets, live_targets, truth))
        more = True
        broken: Exception | None = None

        def begin_some() -> None:
            nonlocal more, broken
            try:
                while more and len(waiting) < in_flight:
                    frame_request = next(wanted, None)
                    if frame_request is None:
                        more = False
                        break
                    try:
                        waiting.append((frame_request, self._begin(frame_request)))
                    except (TypeError, ValueError) as error:
                        waiting.append((frame_request, error))
            except Exception as error:  # the poses' own, or that of the connection: after what is done
                more, broken = False, error

        try:
            begin_some()
            while waiting and broken is None:
                result = await self._finish(return_exceptions, waiting, timeout)
                begin_some()  # on their way while this one is looked at
                yield result
            if broken is not None:
                raise broken
        finally:
            for _, rendering in waiting:
                if not isinstance(rendering, Exception):
                    self._session.forget_render(rendering)

    def _begin(self, frame_request: requests.FrameRequest) -> Rendering:
        request, names = requests.render_request(*frame_request)
        return self._connection.start(lambda: self._session.begin_render(request, names))

    async def _finish(self, keep_errors: bool, waiting: collections.deque[tuple[requests.FrameRequest, Rendering | Exception]],
                      timeout: float) -> Frame | Exception:
        frame_request, rendering = waiting.popleft()
        try:
            if isinstance(rendering, Exception):
                raise rendering
            try:
                return await self._run(self._session.finish_render(rendering, timeout))
            except OverLimit:
                # Others fill the server's queue: once more, when what this client has in flight is done.
                if not waiting:
                    raise
            for _, other in waiting:
                if not isinstance(other, Exception):
                    await self._run(self._session.settle_render(other, timeout))
            return await self._run(self._session.finish_render(self._begin(frame_request), timeout))
        except (ConnectionLost, ServerStopping):
            raise
        except (ObliqError, TypeError, ValueError) as error:
            if not keep_errors:
                raise
            return error

    async def _reconnect(self, why: ObliqError, patience_s: float, lost: Connection) -> None:
        """Until all subscriptions are as they were, or patience ends and the loss is raised. One attempt for all streams that
        noticed the loss."""
        end = time.monotonic() + patience_s
        async with self._reconnecting:
            if self._connection is lost:
                await self._connect_again(why, end)

    async def _connect_again(self, why: ObliqError, end: float) -> None:
        pause = FIRST_PAUSE_S
        while True:
            if self._closed or time.monotonic() + pause > end:
                raise why
            await asyncio.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE_S)
            held = self._session.subscriptions
            fresh = None
            try:
                fresh = await self._open()
                for subscription in held.values():
                    subscription.lose()
                    await fresh.run(fresh.session.begin_stream(subscription))
            except RETRIABLE_ERRORS:
                if fresh is not None:
                    fresh.close("the connection was closed")
                continue
            except BaseException:
                if fresh is not None:
                    fresh.close("the connection was closed")
                raise
            self._connection.close("the connection was closed")
            self._connected = fresh
            return


class Radar:
    """A live radar of a server."""

    def __init__(self, server: Server, name: str):
        self._server, self.name = server, name

    def __repr__(self) -> str:
        return printable(f"<obliq.Radar {self.name}>")

    async def info(self) -> requests.RadarInfo:
        """Asks the server for settings, pose, the client in control, and faults."""
        session = self._server._session
        return requests.RadarInfo.of(await self._server._run(session.call(wire.GetRadar(radar=self.name), wire.RadarInfo)))

    @property
    async def settings(self) -> Settings:
        """Its settings at this moment: asked of the server."""
        return (await self.info()).settings

    @property
    async def pose(self) -> Pose:
        """Its pose at this moment: asked of the server."""
        return (await self.info()).pose

    async def query(self, latitude_deg: npt.ArrayLike | None = None, longitude_deg: npt.ArrayLike | None = None,
                    height_m: npt.ArrayLike | None = None, *, bearing_deg: npt.ArrayLike | None = None,
                    range_m: npt.ArrayLike | None = None, height_reference: ground.Reference = "datum",
                    geoid_undulation_m: float = 0.0, antenna: Pose | PoseFields | None = None,
                    timeout: float = 30.0) -> ground.GroundPoints:
        """What is at places of the ground, and whether this radar's antenna sees points there: as Server.query.
        bearing_deg, range_m: true bearing and slant range from the antenna to the ground."""
        return await self._server.query(latitude_deg, longitude_deg, height_m, bearing_deg=bearing_deg, range_m=range_m,
                                        height_reference=height_reference, geoid_undulation_m=geoid_undulation_m,
                                        antenna=antenna, radar=self.name, timeout=timeout)

    async def frame(self, timeout: float | None = 30.0, *, rate_hz: float = 10.0, planes: Planes = None,
                    encoding: Encoding = "cf32", compress: Compression | None = None, window: Window | None = None,
                    lossless: bool = False, truth: bool = False) -> Frame:
        """The next live frame; choice as in stream()."""
        async with self.stream(rate_hz, planes, encoding, compress, window, lossless, timeout=timeout, truth=truth) as frames:
            return await frames.__anext__()

    def stream(self, rate_hz: float = 10.0, planes: Planes = None, encoding: Encoding = "cf32",
               compress: Compression | None = None, window: Window | None = None, lossless: bool = False,
               reconnect: float = 0.0, copy: bool = True, timeout: float | None = 30.0, truth: bool = False) -> Stream[Frame]:
        """Live frames. Where reading is slow, the newest wins and frame.frames_skipped counts the others; lossless: the
        radar waits (needs the role controller). copy=False: arrays are used again by the next frame. reconnect: seconds to
        try again for after a loss. timeout: for each frame; None: as long as the server lives. truth: frame.targets says where
        targets are, for the server's truth role."""
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          False, copy, truth), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    def wedges(self, rate_hz: float = 10.0, planes: Planes = None, encoding: Encoding = "cf32",
               compress: Compression | None = None, window: Window | None = None, lossless: bool = False,
               reconnect: float = 0.0, timeout: float | None = 30.0) -> Stream[Wedge]:
        """Parts of live frames as they arrive: neighbouring azimuths, complete in all planes. For pictures with the
        least delay, and for scanning antennas."""
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          True, True), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    @contextlib.asynccontextmanager
    async def control(self, force: bool = False, claims: str | None = None) -> AsyncIterator[Control]:
        """Claims the radar; it is released at the end, also after an exception. force: from another client, for an
        admin. claims: "pose" to fly it while others may turn its knobs, "settings" to turn these while another flies it;
        None: both."""
        kinds = requests.claim_kinds(claims)
        await self._server._run(self._server._session.act(wire.ClaimControl(radar=self.name, force=force, kinds=kinds)))
        try:
            yield Control(self._server, self.name)
        finally:
            with contextlib.suppress(ObliqError):  # gone with the connection, or taken over by another
                await self._server._run(self._server._session.act(wire.ReleaseControl(radar=self.name, kinds=kinds)))
