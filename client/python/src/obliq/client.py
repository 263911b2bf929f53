"""The blocking client. One thread at a time for each connection."""
from __future__ import annotations

import collections
import contextlib
import time

from . import _requests as requests
from . import ground
from . import obliq_pb2 as wire
from ._connection import Connection
from .errors import CannotConnect, ConnectionLost, ObliqError, OverLimit, ServerFull, ServerStopping, TimedOut, printable
from .replay import Replay

FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 5.0
# A loss, or why an attempt to connect again failed for now; other refusals are for good.
PASSING = (ConnectionLost, ServerStopping, CannotConnect, ServerFull, TimedOut)


def connect(address="127.0.0.1:7420", *, token=None, token_file=None, tls=None, name="python", timeout=5.0):
    """A connection to obliqd: HOST:PORT, HOST, :PORT, PORT or [IPv6]:PORT. `timeout` in seconds for connecting and for
    the first answer. name: shown to others while this client holds control."""
    door = requests.Door.of(address, token, token_file, tls, name, timeout)
    return Server(lambda: Connection(door))


class Server:
    """A connected server. Use it as a context manager, or close() it."""

    def __init__(self, open_connection):
        self._open = open_connection
        self._connection = open_connection()
        self._closed = False

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._closed = True
        self._connection.close()

    def __repr__(self):
        return printable(f"<obliq.Server {self._connection.address}: {self.info.scene}, {', '.join(self.info.radars)}>")

    @property
    def address(self):
        """HOST:PORT of the server."""
        return self._connection.address

    @property
    def info(self):
        """Name, version, scene, radars, encodings, limits and role, as the server's Welcome had them."""
        return requests.ServerInfo.of(self._connection.session.welcome)

    def _run(self, command, *arguments):
        return self._connection.run(getattr(self._connection.session, command)(*arguments))

    def radar(self, name=None):
        """A live radar: the only one, or the one of that name."""
        return Radar(self, requests.radar_name(self.info.radars, name))

    @property
    def replay(self):
        """Pause, speed and place of a server that replays a recording (`obliq replay FILE --serve`)."""
        return Replay(self)

    def status(self):
        """The message Status."""
        return self._run("call", wire.GetStatus())

    def measure_clock(self):
        """Seconds by which the server's clock is behind this machine's; latencies take it into account."""
        return self._run("measure_clock")

    def query(self, latitude_deg=None, longitude_deg=None, height_m=None, *, timeout=30.0, **choice):
        """What is at places of the ground: an obliq.GroundPoints with arrays of the given shape. height_m: of points
        there, None: on the ground. choice: height_reference ("datum", "ground" or "ellipsoid" with geoid_undulation_m),
        and antenna (a Pose, or a dict) for whether it sees the points; bearing_deg and range_m in place of the first
        two. radar.query() asks for a live radar's antenna."""
        asked = ground.Asked(self.info.limits, latitude_deg, longitude_deg, height_m, **choice)
        for request in asked.requests():
            asked.add(*self._run("query", request, timeout))
        return asked.points()

    def render(self, settings=None, pose=None, *, planes=None, encoding="cf32", compress=None, window=None, timeout=60.0,
               radar="python"):
        """One frame for this client alone; no live radar is touched. settings, pose: objects or dicts; absent settings
        take their defaults. planes: "iq state", or None for iq, power, count and state."""
        session = self._connection.session
        rendering = self._connection.start(session.begin_render, *requests.render_request(
            settings, pose, planes, encoding, compress, window, radar))
        return self._run("finish_render", rendering, timeout)

    def render_many(self, poses, settings=None, *, planes=None, encoding="cf32", compress=None, window=None, timeout=60.0,
                    radar="python", return_exceptions=False, seed=None):
        """Frames of many poses, in their order, as many on their way as the server allows. A pose may also be a pair of
        pose and settings. return_exceptions: a refusal is yielded in its place and the rest goes on. seed: a whole number
        from which each frame has noise and independent speckle of its own, by its place (noise_frame, whatever the settings
        say); None: all have those that their settings name."""
        in_flight = max(1, self.info.limits.max_renders_queued)
        waiting = collections.deque()
        wanted = requests.wishes(poses, settings, seed, (planes, encoding, compress, window, radar))
        try:
            while True:
                while len(waiting) < in_flight:
                    try:
                        wish = next(wanted)
                    except StopIteration:
                        break
                    waiting.append(self._begin(return_exceptions, wish))
                if not waiting:
                    return
                yield self._finish(return_exceptions, waiting, timeout)
        finally:
            for _, rendering in waiting:
                if rendering is not None and not isinstance(rendering, Exception):
                    self._connection.session.forget_render(rendering)

    def _begin(self, keep_errors, wish):
        try:
            return wish, self._connection.start(self._connection.session.begin_render, *requests.render_request(*wish))
        except (TypeError, ValueError) as error:
            if not keep_errors:
                raise
            return wish, error

    def _finish(self, keep_errors, waiting, timeout):
        wish, rendering = waiting.popleft()
        try:
            if isinstance(rendering, Exception):
                raise rendering
            try:
                return self._run("finish_render", rendering, timeout)
            except OverLimit:
                # Others fill the server's queue: once more, when what this client has in flight is done.
                if not waiting:
                    raise
            for _, other in waiting:
                if not isinstance(other, Exception):
                    self._run("settle_render", other, timeout)
            return self._run("finish_render", self._begin(False, wish)[1], timeout)
        except (ConnectionLost, ServerStopping):
            raise
        except (ObliqError, TypeError, ValueError) as error:
            if not keep_errors:
                raise
            return error

    def _reconnect(self, why, patience_s):
        """Until all subscriptions are as they were, or patience ends and the loss is raised."""
        end = time.monotonic() + patience_s
        pause = FIRST_PAUSE_S
        while True:
            if self._closed or time.monotonic() + pause > end:
                raise why
            time.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE_S)
            held = self._connection.session.subscriptions
            try:
                fresh = self._open()
            except PASSING:
                continue
            try:
                for subscription in held.values():
                    subscription.lose()
                    fresh.run(fresh.session.begin_stream(subscription))
            except PASSING:
                fresh.close()
                continue
            except BaseException:
                fresh.close()
                raise
            self._connection.close()
            self._connection = fresh
            return


class Radar:
    """A live radar of a server."""

    def __init__(self, server, name):
        self._server, self.name = server, name

    def __repr__(self):
        return printable(f"<obliq.Radar {self.name}>")

    def info(self):
        """Settings, pose, who controls it, what is wrong with it: asked of the server."""
        return requests.RadarInfo.of(self._server._run("call", wire.GetRadar(radar=self.name)))

    @property
    def settings(self):
        """Its settings at this moment: asked of the server."""
        return self.info().settings

    @property
    def pose(self):
        """Its pose at this moment: asked of the server."""
        return self.info().pose

    def query(self, latitude_deg=None, longitude_deg=None, height_m=None, **choice):
        """What is at places of the ground, and whether this radar's antenna sees points there: as Server.query.
        bearing_deg, range_m: true bearing and slant range from the antenna to the ground."""
        return self._server.query(latitude_deg, longitude_deg, height_m, radar=self.name, **choice)

    def frame(self, timeout=30.0, **choice):
        """The next live frame; choice as in stream()."""
        with self.stream(timeout=timeout, **choice) as frames:
            return next(frames)

    def stream(self, rate_hz=10.0, planes=None, encoding="cf32", compress=None, window=None, lossless=False, reconnect=0.0,
               copy=True, timeout=30.0):
        """Live frames. Where reading is slow, the newest wins and frame.frames_skipped counts the others; lossless: the
        radar waits (needs the role controller). copy=False: arrays are used again by the next frame. reconnect: seconds to
        try again for after a loss. timeout: for each frame; None: as long as the server lives."""
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          False, copy), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    def wedges(self, rate_hz=10.0, planes=None, encoding="cf32", compress=None, window=None, lossless=False, reconnect=0.0,
               timeout=30.0):
        """Parts of live frames as they arrive: neighbouring azimuths, complete in all planes. For pictures with the
        least delay, and for scanning antennas."""
        self._server.measure_clock()
        return Stream(self._server, requests.subscription(self.name, rate_hz, planes, encoding, compress, window, lossless,
                                                          True, True), reconnect,
                      requests.stream_timeout(timeout, rate_hz))

    @contextlib.contextmanager
    def control(self, force=False):
        """Claims the radar; it is released at the end, also after an exception. force: from another client, for an
        admin."""
        self._server._run("call", wire.ClaimControl(radar=self.name, force=force))
        try:
            yield Control(self._server, self.name)
        finally:
            with contextlib.suppress(ObliqError):  # gone with the connection, or taken over by another
                self._server._run("call", wire.ReleaseControl(radar=self.name))


class Control:
    """A radar that this client controls."""

    def __init__(self, server, name):
        self._server, self.name = server, name

    def set_pose(self, pose=None, **fields):
        """Moves and turns the antenna; what is not given stays. sim_time_ns: by your own clock, for smooth motion."""
        return requests.Accepted.of(self._server._run("call", requests.pose_request(self.name, pose, fields)))

    def set(self, settings=None, **fields):
        """Changes settings, all or none; the next frame has them."""
        return requests.Accepted.of(self._server._run("call", requests.settings_request(self.name, settings, fields)))

    def set_state(self, transmit=None, freeze=None):
        """transmit=False: no frames. freeze=True: frames keep the pose and settings of this moment."""
        self._server._run("call", requests.state_request(self.name, transmit, freeze))


class Stream:
    """Frames or wedges, one after the other. Ends with its `for` loop, its `with` block, or close()."""

    def __init__(self, server, subscription, reconnect_s, timeout_s):
        self._server, self._subscription = server, subscription
        self._reconnect_s, self._timeout_s = reconnect_s, timeout_s
        self._over = False
        server._run("begin_stream", subscription)

    def __iter__(self):
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def frames_aborted(self):
        """Frames that the server began and did not finish."""
        return self._subscription.frames_aborted

    def __next__(self):
        if self._over:
            raise StopIteration
        while True:
            try:
                return self._server._run("next_of", self._subscription, self._timeout_s)
            except (ConnectionLost, ServerStopping) as why:
                if not self._reconnect_s:
                    raise
                self._server._reconnect(why, self._reconnect_s)

    def close(self):
        if self._over:
            return
        self._over = True
        with contextlib.suppress(ObliqError):
            self._server._run("end_stream", self._subscription)

    def __del__(self):
        # Of a `for` loop that was left: the server need not go on. Not where the connection is busy or gone.
        with contextlib.suppress(Exception):
            self.close()
