"""Poses judged before they are rendered: does a server take them, and how much of what they look at has ground?"""
from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .poses import Line
from ..client import Server
from ..mapping import direct
from ..planes import Window

BEARINGS, RANGES = 24, 12  # places in a sector, each of the same area


@dataclasses.dataclass(frozen=True)
class Checked:
    """What check() found. refused: a dict for each pose that would make no frame, with id, line and text. coverage: of each
    pose, the share of its sector with ground, by places in it; NaN where it is not asked for."""

    poses: int
    refused: list[dict[str, Any]]
    coverage: npt.NDArray[np.float64]

    def sentence(self, name: str) -> str:
        """In a line."""
        lowest = f"; the least coverage is {np.nanmin(self.coverage):.2f}" if np.isfinite(self.coverage).any() else ""
        if not self.refused:
            return f"{self.poses} poses are good{lowest}"
        first = self.refused[0]
        return (f"{len(self.refused)} of {self.poses} poses would be refused: {name}, line {first['line']}: {first['text']}"
                f"{lowest}")


def coverage_of(server: Server, lines: Sequence[Line], settings: dict[str, Any]) -> npt.NDArray[np.float64]:
    """Share of each pose's sector with known ground, at places that stand for the same area each."""
    latitude, longitude = np.empty((2, len(lines), BEARINGS * RANGES))
    for row, line in enumerate(lines):
        its = {**settings, **line.settings}
        sector, r_min, r_max = (float(its.get(name) or usual) for name, usual in
                                (("sector_deg", 360.0), ("r_min_m", 0.0), ("r_max_m", 0.0)))
        bearing = (line.pose.get("bearing_deg") or 0.0) + sector * ((np.arange(BEARINGS) + 0.5) / BEARINGS - 0.5)
        away = np.sqrt(r_min**2 + (r_max**2 - r_min**2) * (np.arange(RANGES) + 0.5) / RANGES)
        turn, distance = np.meshgrid(np.radians(bearing), away)
        latitude[row], longitude[row] = direct(line.pose["latitude_deg"], line.pose["longitude_deg"],
                                               (distance * np.sin(turn)).ravel(), (distance * np.cos(turn)).ravel())
    known = server.query(latitude, (longitude + 180) % 360 - 180, timeout=300.0).known
    return np.asarray(known.mean(axis=1))


def off_the_ground(server: Server, lines: Sequence[Line]) -> list[Line]:
    """Those under whose antenna no ground is loaded."""
    found = server.query([line.pose["latitude_deg"] for line in lines], [line.pose["longitude_deg"] for line in lines],
                         timeout=300.0)
    return [line for line, known in zip(lines, found.known) if not known]


def refusals(server: Server, asked: Sequence[Any], timeout: float, radar: str) -> list[Exception | None]:
    """Of pairs of pose and settings: what the server says against each. Each is planned as its frame would be, and one bin of
    it is rendered."""
    one = Window(azimuth=slice(0, 1), range=slice(0, 1))
    results = server.render_many(asked, planes="state", window=one, timeout=timeout, return_exceptions=True, radar=radar)
    return [result if isinstance(result, Exception) else None for result in results]


def too_low(coverage: float, least: float) -> ValueError:
    """Why a frame is not taken."""
    return ValueError(f"coverage: found {math.floor(1000 * coverage) / 1000:g}; allowed: from {least:g} (min_coverage): ground is "
                      "loaded for so little of the sector")
