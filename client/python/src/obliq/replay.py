"""Where a server that replays a recording is, and the requests that change it. What one client does holds for all."""
from __future__ import annotations

import dataclasses
import time

import numpy as np

from . import obliq_pb2 as wire
from .errors import ReplayOnly


@dataclasses.dataclass(frozen=True)
class ReplayState:
    """position_s counts from the recording's start; while `running` it grows by `speed` a second. start: of the first frame,
    UTC. running: not paused, not at the end, and some client watches. sim_time_ns: of the newest frame's pose."""

    radar: str
    start: np.datetime64
    duration_s: float
    position_s: float
    speed: float
    paused: bool
    running: bool
    loop: bool
    ended: bool
    sim_time_ns: int | None
    seeks: int

    @staticmethod
    def of(kept: tuple[wire.ReplayState, int] | None, offset_ns: int) -> ReplayState:
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


def seek_request(position_s: float | None, sim_time_ns: int | None, bookmark: int | None = None) -> wire.SetReplay:
    """What seek() asks for."""
    if [position_s, sim_time_ns, bookmark].count(None) != 2:
        raise TypeError("seek takes a position in seconds, or sim_time_ns, or bookmark")
    return wire.SetReplay(seek_s=position_s, seek_sim_time_ns=sim_time_ns, seek_bookmark=bookmark)
