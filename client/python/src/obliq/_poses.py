"""The poses of a data set."""
from __future__ import annotations

import os
import stat
import sys

from ._shards import parsed
from .parameters import Pose, Settings


def _read(path):
    """[(line, value), ...] of a file of JSON lines."""
    name, rows = os.fspath(path), []
    if stat.S_ISFIFO(os.stat(path).st_mode) or stat.S_ISCHR(os.stat(path).st_mode):
        print(f"obliq.batch: {name} is a pipe or a terminal: waiting for poses until it is closed at its other end",
              file=sys.stderr)
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            try:
                text = line.decode()
                if text.strip():
                    rows.append((number, parsed(text)))
            except UnicodeDecodeError:
                raise ValueError(f"{name}, line {number}: found bytes that are no UTF-8; allowed: a JSON object a line") from None
            except ValueError as error:
                raise ValueError(f"{name}, line {number}: not JSON: {error}") from None
    return rows


def read_poses(given):
    """((id, pose, settings, line), ...) from a file of JSON lines or from dicts. ValueError names the line."""
    if isinstance(given, (str, os.PathLike)):
        name, rows = os.fspath(given), _read(given)
    else:
        name, rows = "poses", list(enumerate(given, 1))
    if not rows:
        raise ValueError(f"{name}: found no pose; allowed: a JSON object a line, {{\"id\": ..., \"latitude_deg\": ...}}")
    found, lines = [], {}
    for number, row in rows:
        where = f"{name}, line {number}"
        if isinstance(row, Pose):
            row = row.as_dict()
        if not isinstance(row, dict):
            raise ValueError(f"{where}: found {type(row).__name__}; allowed: an object")
        row = dict(row)
        its_id = row.pop("id", number)
        if not isinstance(its_id, (str, int)) or isinstance(its_id, bool):
            raise ValueError(f"{where}: id: found {its_id!r}; allowed: a text or a whole number")
        if str(its_id) in lines:
            raise ValueError(f"{where}: id {its_id!r} stands in line {lines[str(its_id)]} already")
        lines[str(its_id)] = number
        settings = {key: row.pop(key) for key in list(row) if key in Settings.names()}
        try:
            pose = Pose.of(row, "pose")
            settings = Settings.of(settings)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{where}: {error}") from None
        lacking = [key for key in ("latitude_deg", "longitude_deg", "height_m") if getattr(pose, key) is None]
        if lacking:
            raise ValueError(f"{where}: lacks {', '.join(lacking)}")
        found.append((its_id, pose.as_dict(), settings.as_dict(), number))
    for _, _, settings, number in found:
        for key in ("azimuth_bins", "range_bins"):
            if settings.get(key) != found[0][2].get(key):
                raise ValueError(f"{name}, line {number}: {key}: found {settings.get(key)}; allowed: that of the first line, "
                                 f"{found[0][2].get(key)}: frames of a data set have one shape")
    return tuple(found)
