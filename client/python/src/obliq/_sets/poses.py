"""The poses of a data set: a JSON object a line."""
from __future__ import annotations

import dataclasses
import os
import stat
import sys
from collections.abc import Iterable, Mapping
from typing import Any, Union

from .._fields import hint
from .files import parsed
from ..parameters import Pose, Settings
from ..targets import message_of

Poses = Union[str, "os.PathLike[str]", Iterable[Union[Pose, Mapping[str, Any]]]]
# What a line may have beside fields of a pose and of the settings.
OWN = ("id", "meta", "split", "scene", "targets")


@dataclasses.dataclass(frozen=True)
class Line:
    """One pose. number: of its line, from 1. meta, split: carried through to the frame. scene: whose ground it sees; empty:
    that of the whole set. targets: that stand in its frame alone; None: the line says nothing of any."""

    id: str | int
    pose: dict[str, Any]
    settings: dict[str, Any]
    number: int
    meta: dict[str, Any] = dataclasses.field(default_factory=dict)
    split: str = ""
    scene: str = ""
    targets: tuple[dict[str, Any], ...] | None = None

    def columns(self) -> dict[str, Any]:
        """What is carried through, where there is any."""
        return {name: value for name in ("meta", "split", "scene") if (value := getattr(self, name))}

    def told(self) -> list[Any]:
        """What the frame is made of, as JSON, for a digest."""
        told = [self.id, self.pose, self.settings, *([self.columns()] if self.columns() else [])]
        return told if self.targets is None else [*told, {"targets": list(self.targets)}]


def _read(path: str | os.PathLike[str]) -> list[tuple[int, Any]]:
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


def name_of(given: Poses) -> str:
    """The file, for sentences."""
    return os.fspath(given) if isinstance(given, (str, os.PathLike)) else "poses"


def read_poses(given: Poses) -> tuple[Line, ...]:
    """From a file of JSON lines or from dicts. ValueError names the line."""
    name = name_of(given)
    rows: list[tuple[int, Any]] = _read(given) if isinstance(given, (str, os.PathLike)) else list(enumerate(given, 1))
    if not rows:
        raise ValueError(f"{name}: found no pose; allowed: a JSON object a line, {{\"id\": ..., \"latitude_deg\": ...}}")
    found: list[Line] = []
    lines: dict[str, int] = {}
    for number, row in rows:
        line = _line(f"{name}, line {number}", number, row)
        if str(line.id) in lines:
            raise ValueError(f"{name}, line {number}: id {line.id!r} stands in line {lines[str(line.id)]} already")
        lines[str(line.id)] = number
        found.append(line)
    for line in found:
        for key in ("azimuth_bins", "range_bins"):
            if line.settings.get(key) != found[0].settings.get(key):
                raise ValueError(f"{name}, line {line.number}: {key}: found {line.settings.get(key)}; allowed: that of the first "
                                 f"line, {found[0].settings.get(key)}: frames of a data set have one shape")
    return tuple(found)


def _line(where: str, number: int, row: Any) -> Line:
    if isinstance(row, Pose):
        row = row.as_dict()
    if not isinstance(row, Mapping):
        raise ValueError(f"{where}: found {type(row).__name__}; allowed: an object")
    row = dict(row)
    its_id = row.pop("id", number)
    if not isinstance(its_id, (str, int)) or isinstance(its_id, bool):
        raise ValueError(f"{where}: id: found {its_id!r}; allowed: a text or a whole number")
    meta = row.pop("meta", None) or {}
    if not isinstance(meta, dict):
        raise ValueError(f"{where}: meta: found {type(meta).__name__}; allowed: an object, whose columns are yours")
    targets = _targets(where, row.pop("targets", None))
    texts = {key: row.pop(key, None) or "" for key in ("split", "scene")}
    for key, text in texts.items():
        if not isinstance(text, str):
            raise ValueError(f"{where}: {key}: found {text!r}; allowed: a text")
    settings = {key: row.pop(key) for key in list(row) if key in Settings.names()}
    for key in row:
        if key not in Pose.names():
            known = hint(key, (*OWN, *Pose.names(), *Settings.names()))
            near = known if "did you mean" in known else ("; allowed: fields of a pose and of the settings, id, split, scene, "
                                                          "targets")
            raise ValueError(f"{where}: found {key!r}{near}; columns of your own go into \"meta\": {{\"{key}\": ...}}")
    try:
        pose = Pose.of(row, "pose")
        its = Settings.of(settings)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{where}: {error}") from None
    lacking = [key for key in ("latitude_deg", "longitude_deg", "height_m") if getattr(pose, key) is None]
    if lacking:
        raise ValueError(f"{where}: lacks {', '.join(lacking)}")
    return Line(its_id, pose.as_dict(), its.as_dict(), number, meta, **texts, targets=targets)


def _targets(where: str, given: Any) -> tuple[dict[str, Any], ...] | None:
    if given is None:
        return None
    if not isinstance(given, (list, tuple)):
        raise ValueError(f"{where}: targets: found {type(given).__name__}; allowed: a list of targets")
    for at, target in enumerate(given):
        if not isinstance(target, Mapping):
            raise ValueError(f"{where}: targets[{at}]: found {type(target).__name__}; allowed: an object")
        try:
            message_of(target, f"targets[{at}]")
        except (TypeError, ValueError) as error:
            raise ValueError(f"{where}: {error}") from None
    return tuple(dict(target) for target in given)
