"""The frames of data sets."""
from __future__ import annotations

import dataclasses
import os
import pathlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Union, cast, overload

import numpy as np
import numpy.typing as npt
from google.protobuf import json_format

from .. import obliq_pb2 as wire
from .files import SUMS, file_sum, json_lines, read_sums
from .shards import OF_THE_RUN, parts_of
from .world import read_manifest, warn_without_hash, worlds_in
from ..errors import BadStream
from ..frame import Frame, restore
from ..planes import NUMBERS
from ..targets import RECORD

if TYPE_CHECKING:
    import xarray

Folder = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class _Row:
    part: pathlib.Path
    row: int  # in the part's arrays
    line: dict[str, Any]  # of its frames.jsonl


def _rows_of(folder: pathlib.Path, manifest: dict[str, Any]) -> tuple[list[_Row], list[dict[str, Any]], list[int]]:
    """Frames and failed poses in the order of their lines, and numbers of the parts that are missing."""
    rows: list[_Row] = []
    failed: list[dict[str, Any]] = []
    missing = []
    for number in range(manifest.get("parts") or -(-manifest["poses"] // manifest["shard_size"])):
        parts = parts_of(folder, number)
        if not parts:
            missing.append(number)
            continue
        its = [_Row(part, row, line) for part in parts for row, line in enumerate(json_lines(part / "frames.jsonl"))]
        rows += its
        failed += json_lines(parts[-1] / "failed.jsonl")
    if all("line" in row.line for row in rows):  # several scenes, or poses that were taken up later
        rows.sort(key=lambda row: row.line["line"])
    failed.sort(key=lambda line: line["line"])
    return rows, failed, missing


class Dataset:
    """The frames of a data set, or of several, in the order of their poses: len(), [number], iteration, by_id(), select().
    Planes are mapped from the files, not read.

    manifest: what the (first) data set was made of. failed: a dict for each pose without a frame.
    """

    def __init__(self, folder: Folder | Sequence[Folder], *, _quiet: bool = False):
        several = [folder] if isinstance(folder, (str, os.PathLike)) else list(folder)
        if not several:
            raise ValueError("Dataset(): found no folder; allowed: one or several")
        self.folders = tuple(pathlib.Path(one) for one in several)
        self._chosen: list[int] | None = None
        self._read()
        if not _quiet:
            for one, manifest in zip(self.folders, self._manifests):
                warn_without_hash(worlds_in(manifest), os.fspath(one))

    def _read(self) -> None:
        self._manifests = [read_manifest(folder) for folder in self.folders]
        self._rows: list[_Row] = []
        self.failed: list[dict[str, Any]] = []
        self._missing: list[list[int]] = []
        for folder, manifest in zip(self.folders, self._manifests):
            rows, failed, missing = _rows_of(folder, manifest)
            self._rows += rows
            self.failed += failed
            self._missing.append(missing)
        if self._chosen is not None:
            self._rows = [self._rows[at] for at in self._chosen]
        self._ids = {row.line["id"]: at for at, row in enumerate(self._rows)}
        self._maps: dict[pathlib.Path, npt.NDArray[Any] | None] = {}
        self._logs: dict[pathlib.Path, list[dict[str, Any]]] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Folders and what is selected: a worker reads and maps the files itself."""
        return {"folders": self.folders, "_chosen": self._chosen}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._read()

    def __repr__(self) -> str:
        left = f", {len(self.missing)} of {self.parts_wanted} parts missing" if self.missing else ""
        return f"<obliq.Dataset {', '.join(map(str, self.folders))}: {len(self)} frames{left}>"

    @property
    def folder(self) -> pathlib.Path:
        """Of the (first) data set."""
        return self.folders[0]

    @property
    def manifest(self) -> dict[str, Any]:
        """Of the (first) data set."""
        return self._manifests[0]

    @property
    def parts_wanted(self) -> int:
        """Of all parts."""
        return sum(manifest.get("parts") or -(-manifest["poses"] // manifest["shard_size"]) for manifest in self._manifests)

    @property
    def missing(self) -> list[int]:
        """Parts that are not there yet."""
        return [number for missing in self._missing for number in missing]

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def ids(self) -> list[str | int]:
        """Of all frames."""
        return [row.line["id"] for row in self._rows]

    @property
    def columns(self) -> list[dict[str, Any]]:
        """Of each frame: id, split, scene and its columns of meta."""
        return [_columns(row.line) for row in self._rows]

    def about(self, at: int) -> dict[str, Any]:
        """The columns of one frame."""
        return _columns(self._rows[at].line)

    def select(self, where: Callable[[dict[str, Any]], object] | None = None, **columns: object) -> Dataset:
        """A part of the frames: those for whose columns where(...) holds, and whose columns have these values:
        data.select(split="train"), data.select(lambda row: row["weather"] in ("dry", "wet")). A frame without a column has None
        there."""
        other = object.__new__(Dataset)
        other.__dict__.update(self.__dict__)
        known = {name for row in self._rows for name in _columns(row.line)}
        for name in columns:
            if self._rows and name not in known:
                raise KeyError(f"select(): found {name!r}; allowed: {', '.join(sorted(known))}")
        chosen = [at for at, row in enumerate(self._rows) if (its := _columns(row.line)) is not None
                  and all(its.get(name) == value for name, value in columns.items()) and (where is None or where(its))]
        other._chosen = [self._chosen[at] for at in chosen] if self._chosen is not None else chosen
        other._rows = [self._rows[at] for at in chosen]
        other._ids = {row.line["id"]: at for at, row in enumerate(other._rows)}
        other._maps, other._logs = {}, {}
        return other

    def by_id(self, its_id: str | int) -> Frame:
        """The frame of a pose."""
        return self[self._ids[its_id]]

    def __iter__(self) -> Iterator[Frame]:
        return (self[at] for at in range(len(self)))

    def arrays(self, at: int) -> dict[str, npt.NDArray[Any]]:
        """Planes of one frame, name -> [azimuth, range], mapped: all that a training loop needs, in a fifth of the time that
        the frame takes."""
        row = self._rows[at]
        return {name: values[row.row] for name in NUMBERS if (values := self._map(row.part / f"{name}.npy")) is not None}

    def _log_of(self, row: _Row) -> dict[str, Any]:
        """When a frame was rendered, where that is known."""
        if "utc_ns" in row.line:  # of a data set that has no log.jsonl
            return row.line
        if row.part not in self._logs:
            path = row.part / "log.jsonl"
            self._logs[row.part] = json_lines(path) if path.exists() else []
        return self._logs[row.part][row.row] if row.row < len(self._logs[row.part]) else {}

    def _map(self, path: pathlib.Path) -> npt.NDArray[Any] | None:
        if path not in self._maps:
            self._maps[path] = np.load(path, mmap_mode="r") if path.exists() else None
        return self._maps[path]

    @overload
    def __getitem__(self, at: int) -> Frame: ...
    @overload
    def __getitem__(self, at: slice) -> Dataset: ...

    def __getitem__(self, at: int | slice) -> Frame | Dataset:
        if isinstance(at, slice):
            wanted = set(range(len(self))[at])
            numbers = iter(range(len(self)))
            return self.select(lambda _: next(numbers) in wanted)
        row = self._rows[at]
        line = row.line
        log = self._log_of(row)
        descriptor = {**line["descriptor"], **{name: log[name] for name in OF_THE_RUN if name in log}}
        frame = restore(self.arrays(at), json_format.ParseDict(descriptor, wire.FrameDescriptor()).SerializeToString(),
                        json_format.ParseDict(line["summary"], wire.FrameSummary()).SerializeToString(), int(log.get("utc_ns", 0)))
        frame.id, frame.meta = line["id"], dict(line.get("meta") or {})
        frame.split, frame.scene = line.get("split", ""), line.get("scene", "")
        if "targets" in line:
            frame.targets = np.array([(*record, 0) for record in line["targets"]], RECORD)
        return frame

    def verify(self) -> dict[str | int, str]:
        """BadStream for a frame whose values are not those that were rendered, a file that is not what it was, an id that
        stands twice or is missing. Returns {id: sha256}."""
        for part in dict.fromkeys(row.part for row in self._rows):
            for name, value in read_sums(part / SUMS).items():
                if not name.endswith(".npy") and file_sum(part / name) != value:
                    raise BadStream(f"{part / name}: it is not what was written: its sum differs from {SUMS}")
        found: dict[str | int, str] = {}
        for at, row in enumerate(self._rows):
            its_id = row.line["id"]
            if its_id in found:
                raise BadStream(f"{row.part.name}: id {its_id!r} stands twice")
            if self[at].sha256() != row.line["sha256"]:
                raise BadStream(f"{row.part.name}: frame {row.row}, id {its_id!r}: its values are not those that were rendered")
            found[its_id] = row.line["sha256"]
        wanted = sum(manifest["poses"] for manifest in self._manifests)
        if self._chosen is None and not self.missing and len(found) + len(self.failed) != wanted:
            raise BadStream(f"{self.folder}: found {len(found)} frames and {len(self.failed)} failed poses; "
                            f"allowed: {wanted} in all")
        return found

    def to_xarray(self, lazy: bool = True) -> xarray.Dataset:
        """All frames as one xarray.Dataset [frame, azimuth, range]. azimuth counts from the sector's centre; poses, columns of
        meta and `bearing` beside it. lazy: values are read when they are asked for (needs dask)."""
        from . import export

        return export.to_xarray(self, lazy)

    def to_zarr(self, path: Folder) -> None:
        """The same as a zarr store: chunks of a frame each."""
        from . import export

        export.to_zarr(self, path)

    def to_webdataset(self, pattern: str, frames: int = 1000) -> list[pathlib.Path]:
        """Tar files of so many frames that WebDataset reads: "train-%05d.tar", with a NAME.npy for each plane and a .json.
        Returns their paths."""
        from . import export

        return export.to_webdataset(self, pattern, frames)

    def planes(self) -> tuple[str, ...]:
        """Names of the planes that the frames have."""
        return tuple(self.arrays(0)) if len(self) else ()

    def stacks(self, name: str) -> Iterator[tuple[npt.NDArray[Any], list[int]]]:
        """A plane's mapped array of each part, and which of its rows are the next frames: without a gap, in order."""
        for row in self._rows:
            yield cast("npt.NDArray[Any]", self._map(row.part / f"{name}.npy")), [row.row]

    def descriptors(self) -> Iterable[dict[str, Any]]:
        """Of each frame its descriptor as JSON has it."""
        return (row.line["descriptor"] for row in self._rows)


def _columns(line: dict[str, Any]) -> dict[str, Any]:
    return {**(line.get("meta") or {}), "id": line["id"], **{name: line.get(name) for name in ("split", "scene")}}
