"""The ground that poses need."""
from __future__ import annotations

import math
import os
import re
import subprocess
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from .poses import Line
from ..local import find_program, toml
from ..mapping import direct

CORNERS = 16  # of the polygon about a disc
BEYOND = 1.05  # of the reach: what is loaded has a ragged edge of a cell


def printed_config(scene: str, obliqd: str | None, settings: Mapping[str, Any]) -> str:
    """The whole configuration that obliqd has of a scene file, as text. ValueError with its own words."""
    program, environment = find_program("obliqd", obliqd)
    words = [program, "--config", scene, "--print-config"]
    for key, value in settings.items():
        words += ["--set", f"{key}={toml(value)}"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        raise ValueError(f"{os.path.basename(scene)}: {done.stderr.strip() or 'obliqd cannot read it'}")
    return done.stdout


def area_of(lines: Iterable[Line], settings: Mapping[str, Any], config: str) -> list[list[float]] | None:
    """The polygon, longitude and latitude, around all that the antennas reach; None where the scene names its area or loads
    ground as it is flown over."""
    if re.search(r"^area = ", config, re.M):
        return None
    r_max = [float(text) for text in re.findall(r"^r_max_m = ([0-9.e+]+)", config, re.M)]
    usual_m = float(settings.get("r_max_m") or max(r_max, default=0.0) or 0.0)
    corners: list[tuple[float, float]] = []
    middle_deg: float | None = None
    turns = np.arange(CORNERS) * (2 * math.pi / CORNERS)
    for line in lines:
        reach_m = (line.settings.get("r_max_m") or usual_m) * BEYOND / math.cos(math.pi / CORNERS)
        latitude, longitude = direct(line.pose["latitude_deg"], line.pose["longitude_deg"], reach_m * np.sin(turns),
                                     reach_m * np.cos(turns))
        middle_deg = line.pose["longitude_deg"] if middle_deg is None else middle_deg
        near = (longitude - middle_deg + 180) % 360 - 180 + middle_deg
        corners += zip(near.tolist(), latitude.tolist())
    return [[round(x, 6), round(y, 6)] for x, y in hull(corners)]


def hull(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Convex hull, counter-clockwise: A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions",
    Information Processing Letters 9 (1979)."""
    ordered = sorted(set(points))

    def half(along: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        made: list[tuple[float, float]] = []
        for x, y in along:
            while len(made) >= 2 and ((made[-1][0] - made[-2][0]) * (y - made[-2][1])
                                      <= (made[-1][1] - made[-2][1]) * (x - made[-2][0])):
                made.pop()
            made.append((x, y))
        return made[:-1]

    return half(ordered) + half(reversed(ordered))


def with_area(settings: Mapping[str, Any], area: list[list[float]] | None) -> dict[str, Any]:
    """What --set takes."""
    return {**settings, "terrain.area": area} if area else dict(settings)
