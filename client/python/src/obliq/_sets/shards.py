"""Shards of a data set: folders that are whole or absent.

A data set is a folder: manifest.json (what it was made of), part-00000, part-00001, ... A part has an array for each
plane, NAME.npy [frame, azimuth, range], frames.jsonl with a line for each frame, failed.jsonl for poses that the server
refused, log.jsonl with what differs from run to run, and SHA256SUMS of all but that. A part is written beside its place and
renamed: a file with its final name is complete. Poses that failed and are good later come into parts of their own,
part-00000-1, -2, ..., each with those that still fail.
"""
from __future__ import annotations

import contextlib
import hashlib
import io
import os
import pathlib
import re
import shutil
import socket
import uuid
from typing import Any

import numpy as np
from google.protobuf import json_format
from google.protobuf.message import Message

from .files import SUMS, as_lines, file_sum, json_lines, sum_lines, sync
from .poses import Line
from ..frame import Frame

NPY_HEADER = 192  # bytes, whatever the shape: a multiple of 64, as the format wants
# A part that is being written; see PartWriter.
LEFT_BEHIND = re.compile(r"\.part-[0-9]+(-[0-9]+)?\.(?P<host>.+)\.(?P<pid>[0-9]+)\.[0-9a-f]{8}")
# Of a descriptor: what counts a server's frames and settings, not what the frame is.
OF_THE_RUN = ("frame_id", "settings_version")


def part_name(number: int, again: int = 0) -> str:
    """The folder of a shard, or of its poses that were taken up again."""
    return f"part-{number:05d}" + (f"-{again}" if again else "")


def parts_of(out: str | os.PathLike[str], number: int) -> list[pathlib.Path]:
    """The folders of a shard that are there, oldest first; none: it is not done."""
    found: list[pathlib.Path] = []
    while (path := pathlib.Path(out) / part_name(number, len(found))).is_dir():
        found.append(path)
    return found


def failed_of(out: str | os.PathLike[str], number: int) -> list[dict[str, Any]]:
    """The poses of a shard that failed when it was last done."""
    parts = parts_of(out, number)
    return json_lines(parts[-1] / "failed.jsonl") if parts else []


def _npy_header(kind: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    """numpy/lib/format.py, version 1.0, padded to a length that does not change when the number of frames does."""
    text = repr({"descr": kind.str, "fortran_order": False, "shape": tuple(shape)})
    return b"\x93NUMPY\x01\x00" + (NPY_HEADER - 10).to_bytes(2, "little") + text.ljust(NPY_HEADER - 11).encode() + b"\n"


class _Array:
    """A plane's file. Its sum is made as it is written, for as many frames as are expected."""

    def __init__(self, path: pathlib.Path, kind: np.dtype[Any], shape: tuple[int, ...], frames: int):
        self.kind, self.shape, self._expected = kind, shape, frames
        self._file: io.BufferedWriter = open(path, "wb")
        self._path = path
        self._sum = hashlib.sha256()
        self._write(_npy_header(kind, (frames, *shape)))

    def _write(self, data: bytes | memoryview) -> None:
        self._file.write(data)
        self._sum.update(data)

    def add(self, values: Any) -> None:
        """One frame."""
        self._write(memoryview(np.ascontiguousarray(values)).cast("B"))  # type: ignore[arg-type, unused-ignore]

    def finish(self, frames: int) -> str:
        """Closes the file; its sum."""
        if frames != self._expected:
            self._file.seek(0)
            self._file.write(_npy_header(self.kind, (frames, *self.shape)))
        self._file.close()
        return self._sum.hexdigest() if frames == self._expected else file_sum(self._path)

    def close(self) -> None:
        """Of a part that will not be."""
        self._file.close()


class PartWriter:
    """One part, of so many poses. Nothing has its name until finish(); without it, nothing stays."""

    def __init__(self, out: str | os.PathLike[str], number: int, poses: int, again: int = 0):
        self._target = pathlib.Path(out) / part_name(number, again)
        self._folder = self._target.with_name(
            f".{self._target.name}.{socket.gethostname()}.{os.getpid()}.{uuid.uuid4().hex[:8]}")
        self._folder.mkdir()
        self._poses = poses
        self._arrays: dict[str, _Array] = {}
        self._lines: list[dict[str, Any]] = []
        self._failed: list[dict[str, Any]] = []
        self._log: list[dict[str, Any]] = []

    def add(self, line: Line, frame: Frame) -> None:
        """A frame, with what its line had."""
        def told(message: Message | None) -> dict[str, Any]:
            return {} if message is None else json_format.MessageToDict(message, preserving_proto_field_name=True)

        arrays = frame.planes()
        if frame.trains:
            arrays["pulses"] = frame.trains[0].pulses
        for name, values in arrays.items():
            if name not in self._arrays:
                self._arrays[name] = _Array(self._folder / f"{name}.npy", values.dtype, values.shape, self._poses)
            array = self._arrays[name]
            if values.shape != array.shape or values.dtype != array.kind:
                raise ValueError(f"{line.id}: {name} has shape {values.shape}; the frames before have {array.shape}")
            array.add(values)
        descriptor = told(frame.descriptor)
        summary = told(frame.summary)
        summary.pop("frame_id", None)
        self._log.append({"id": line.id, "utc_ns": int(frame.utc.astype("i8")),
                          **{name: descriptor.pop(name) for name in OF_THE_RUN if name in descriptor}})
        # Where they are: the members of a record in their order, but for the last.
        truth = {} if line.targets is None or frame.targets is None else {
            "targets": [list(record)[:-1] for record in frame.targets.tolist()]}
        self._lines.append({"id": line.id, "line": line.number, **line.columns(), "sha256": frame.sha256(), **truth,
                            "descriptor": descriptor, "summary": summary})

    def fail(self, line: Line, error: Exception) -> None:
        """A pose that makes no frame."""
        faults = [{"field": fault.field, "argument": fault.argument, "found": fault.found, "allowed": fault.allowed}
                  for fault in getattr(error, "faults", ())]
        self._failed.append({"id": line.id, "line": line.number, **line.columns(), "number": getattr(error, "number", 0),
                             "text": str(error), "faults": faults})

    def finish(self) -> None:
        """Gives the part its name. Where another worker has done so before, that one stays."""
        with contextlib.closing(self):
            self._finish()

    def _finish(self) -> None:
        sums = {f"{name}.npy": array.finish(len(self._lines)) for name, array in self._arrays.items()}
        for name, lines in (("frames.jsonl", self._lines), ("failed.jsonl", self._failed), ("log.jsonl", self._log)):
            (self._folder / name).write_text(as_lines(lines), encoding="utf-8")
            if lines is not self._log:
                sums[name] = file_sum(self._folder / name)
        (self._folder / SUMS).write_text(sum_lines(sums))
        for path in self._folder.iterdir():
            sync(path)
        sync(self._folder)
        try:
            os.rename(self._folder, self._target)
        except OSError:
            if not self._target.is_dir():
                raise
        sync(self._target.parent)

    def close(self) -> None:
        """Of a part that was not finished, nothing stays."""
        for array in self._arrays.values():
            array.close()
        shutil.rmtree(self._folder, ignore_errors=True)


def _lives(pid: str) -> bool:
    """Of a process that was killed, its parent may not have asked yet how it ended."""
    try:
        status = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    return status.rpartition(")")[2].split()[0] not in ("Z", "X")


def sweep(out: str | os.PathLike[str]) -> None:
    """Removes what workers of this machine left when they were killed."""
    here = socket.gethostname()
    for left in pathlib.Path(out).glob(".part-*"):
        made = LEFT_BEHIND.fullmatch(left.name)
        if made and made["host"] == here and not _lives(made["pid"]):
            with contextlib.suppress(OSError):
                shutil.rmtree(left)
