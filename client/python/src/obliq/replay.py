"""A server that replays a recording: where it is, and the requests that change it. What one client does holds for all."""
from __future__ import annotations

import dataclasses
import time

import numpy as np

from . import obliq_pb2 as wire
from .errors import ReplayOnly


@dataclasses.dataclass(frozen=True)
class ReplayState:
    """position_s counts from the recording's start; while `running` it grows by `speed` a second."""

    radar: str
    start: np.datetime64  # of the first frame, UTC
    duration_s: float
    position_s: float
    speed: float
    paused: bool
    running: bool  # not paused, not at the end, and some client watches
    loop: bool
    ended: bool
    sim_time_ns: int | None  # of the newest frame's pose
    seeks: int

    @staticmethod
    def of(kept, offset_ns):
        """kept: the message and the time in its header, or None."""
        if kept is None:
            raise ReplayOnly(126, "this server's radars are live: pause, speed and seek are for a server that replays")
        message, utc_ns = kept
        position_s = message.position_s
        if message.running and np.isfinite(message.speed):
            position_s += message.speed * max(0, time.time_ns() - offset_ns - utc_ns) * 1e-9
        return ReplayState(
            message.radar, np.datetime64(message.start_utc_ns, "ns"), message.duration_s, min(position_s, message.duration_s),
            message.speed, message.paused, message.running, message.loop, message.ended,
            message.sim_time_ns if message.HasField("sim_time_ns") else None, message.seeks)


def seek_request(position_s, sim_time_ns):
    if (position_s is None) == (sim_time_ns is None):
        raise TypeError("seek takes a position in seconds, or sim_time_ns")
    return wire.SetReplay(seek_s=position_s) if sim_time_ns is None else wire.SetReplay(seek_sim_time_ns=sim_time_ns)


class Replay:
    """server.replay."""

    def __init__(self, server):
        self._server = server

    def state(self):
        """A ReplayState of now."""
        self._server._run("call", wire.Heartbeat(answer_wanted=True))  # what has been sent before it has come then
        session = self._server._connection.session
        return ReplayState.of(session.replay_state, session.offset_ns)

    def pause(self):
        self._server._run("call", wire.SetReplay(paused=True))

    def resume(self):
        self._server._run("call", wire.SetReplay(paused=False))

    def set_speed(self, factor):
        """Recorded seconds in a second: 0.01 to 1000000, or math.inf: without waiting."""
        self._server._run("call", wire.SetReplay(speed=factor))

    def seek(self, position_s=None, *, sim_time_ns=None):
        """To the frame of that time, from the recording's start or by the poses' own clock."""
        self._server._run("call", seek_request(position_s, sim_time_ns))


class AioReplay:
    """The same, awaited."""

    def __init__(self, server):
        self._server = server

    async def state(self):
        await self._server._run("call", wire.Heartbeat(answer_wanted=True))
        session = self._server._protocol.session
        return ReplayState.of(session.replay_state, session.offset_ns)

    async def pause(self):
        await self._server._run("call", wire.SetReplay(paused=True))

    async def resume(self):
        await self._server._run("call", wire.SetReplay(paused=False))

    async def set_speed(self, factor):
        await self._server._run("call", wire.SetReplay(speed=factor))

    async def seek(self, position_s=None, *, sim_time_ns=None):
        await self._server._run("call", seek_request(position_s, sim_time_ns))
