"""Shards of a data set: folders that are whole or absent, and what reads them.

A data set is a folder: manifest.json (what it was made of), part-00000, part-00001, ... A part has an array for each
plane, NAME.npy [frame, azimuth, range], frames.jsonl with a line for each frame, and failed.jsonl for poses that the server
refused. A part is written beside its place and renamed: that the name exists means that it is whole.
"""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pathlib
import re
import shutil
import socket
import uuid

import numpy as np

from . import obliq_pb2 as wire
from .errors import BadStream
from .frame import restore
from .planes import NUMBERS

FORMAT = 1
MANIFEST = "manifest.json"
NPY_HEADER = 192  # bytes, whatever the shape: a multiple of 64, as the format wants


# A part that is being written; see PartWriter.
LEFT_BEHIND = re.compile(r"\.part-[0-9]+\.(?P<host>.+)\.(?P<pid>[0-9]+)\.[0-9a-f]{8}")


def part_name(number):
    return f"part-{number:05d}"


def _npy_header(kind, shape):
    """numpy/lib/format.py, version 1.0, padded to a length that does not change when the number of frames does."""
    text = repr({"descr": np.lib.format.dtype_to_descr(np.dtype(kind)), "fortran_order": False, "shape": tuple(shape)})
    return b"\x93NUMPY\x01\x00" + (NPY_HEADER - 10).to_bytes(2, "little") + text.ljust(NPY_HEADER - 11).encode() + b"\n"


def sync(path):
    """So that what is renamed is on the disk before its name is."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_whole(path, text):
    """A small file that is old or new, never half."""
    part = path.with_name(f".{path.name}.{os.getpid()}.{uuid.uuid4().hex[:8]}")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            part.unlink()


class PartWriter:
    """One part. Nothing has its name until finish(); without it, nothing stays."""

    def __init__(self, out, number):
        self._target = pathlib.Path(out) / part_name(number)
        self._folder = self._target.with_name(
            f".{self._target.name}.{socket.gethostname()}.{os.getpid()}.{uuid.uuid4().hex[:8]}")
        self._folder.mkdir()
        self._arrays = {}
        self._lines, self._failed = [], []

    def add(self, its_id, frame):
        from google.protobuf import json_format

        def told(message):
            return json_format.MessageToDict(message, preserving_proto_field_name=True)

        for name, values in frame.planes().items():
            if name not in self._arrays:
                file = open(self._folder / f"{name}.npy", "wb")
                file.write(_npy_header(values.dtype, (0, *values.shape)))
                self._arrays[name] = (file, values.dtype, values.shape)
            file, kind, shape = self._arrays[name]
            if values.shape != shape or values.dtype != kind:
                raise ValueError(f"{its_id}: {name} has shape {values.shape}; the frames before have {shape}")
            file.write(memoryview(values).cast("B"))
        self._lines.append({"id": its_id, "sha256": frame.sha256(), "utc_ns": int(frame.utc.astype("i8")),
                            "descriptor": told(frame.descriptor), "summary": told(frame.summary)})

    def fail(self, its_id, line, error):
        faults = [{"field": fault.field, "argument": fault.argument, "found": fault.found, "allowed": fault.allowed}
                  for fault in getattr(error, "faults", ())]
        self._failed.append({"id": its_id, "line": line, "number": getattr(error, "number", 0), "text": str(error),
                             "faults": faults})

    def finish(self):
        """Gives the part its name. Where another worker has done so before, that one stays."""
        with contextlib.closing(self):
            self._finish()

    def _finish(self):
        for file, kind, shape in self._arrays.values():
            file.seek(0)
            file.write(_npy_header(kind, (len(self._lines), *shape)))
            file.close()
        for name, lines in (("frames.jsonl", self._lines), ("failed.jsonl", self._failed)):
            (self._folder / name).write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
        for path in self._folder.iterdir():
            sync(path)
        sync(self._folder)
        try:
            os.rename(self._folder, self._target)
        except OSError:
            if not self._target.is_dir():
                raise
        sync(self._target.parent)

    def close(self):
        for file, _, _ in self._arrays.values():
            file.close()
        shutil.rmtree(self._folder, ignore_errors=True)


def sweep(out):
    """Removes what workers of this machine left when they were killed."""
    here = socket.gethostname()
    for left in pathlib.Path(out).glob(".part-*"):
        made = LEFT_BEHIND.fullmatch(left.name)
        if made and made["host"] == here and not pathlib.Path(f"/proc/{made['pid']}").exists():
            shutil.rmtree(left, ignore_errors=True)


class Dataset:
    """The frames of a data set, in the order of their poses: len(), [number], iteration, by_id(). Planes are mapped from
    the files, not read."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        try:
            self.manifest = parsed((self.folder / MANIFEST).read_text())
        except (FileNotFoundError, NotADirectoryError):
            raise FileNotFoundError(f"{folder}: no data set: it has no {MANIFEST}") from None
        except ValueError as error:
            raise ValueError(f"{self.folder / MANIFEST}: {error}") from None
        if self.manifest.get("format") != FORMAT:
            raise ValueError(f"{self.folder / MANIFEST}: format: found {self.manifest.get('format')}; allowed: {FORMAT}")
        self._rows = []  # (part, row, line)
        self.failed = []
        for number in range(self.parts_wanted):
            part = self.folder / part_name(number)
            if part.is_dir():
                for row, line in enumerate(_lines(part / "frames.jsonl")):
                    self._rows.append((part, row, line))
                self.failed += _lines(part / "failed.jsonl")
        self._ids = {line["id"]: at for at, (_, _, line) in enumerate(self._rows)}
        self._maps = {}

    def __repr__(self):
        left = f", {len(self.missing)} of {self.parts_wanted} parts missing" if self.missing else ""
        return f"<obliq.Dataset {self.folder}: {len(self)} frames{left}>"

    @property
    def parts_wanted(self):
        return -(-self.manifest["poses"] // self.manifest["shard_size"])

    @property
    def missing(self):
        """Parts that are not there yet."""
        return [number for number in range(self.parts_wanted) if not (self.folder / part_name(number)).is_dir()]

    def __len__(self):
        return len(self._rows)

    @property
    def ids(self):
        return [line["id"] for _, _, line in self._rows]

    def by_id(self, its_id):
        return self[self._ids[its_id]]

    def __iter__(self):
        return (self[at] for at in range(len(self)))

    def __getitem__(self, at):
        from google.protobuf import json_format

        part, row, line = self._rows[at]
        planes = {}
        for name in NUMBERS:
            path = part / f"{name}.npy"
            if path not in self._maps:
                self._maps[path] = np.load(path, mmap_mode="r") if path.exists() else None
            if self._maps[path] is not None:
                planes[name] = self._maps[path][row]
        frame = restore(planes, json_format.ParseDict(line["descriptor"], wire.FrameDescriptor()).SerializeToString(),
                        json_format.ParseDict(line["summary"], wire.FrameSummary()).SerializeToString(), line["utc_ns"])
        frame.id = line["id"]
        return frame

    def verify(self):
        """BadStream for a frame whose values are not those that were rendered, an id that stands twice or is missing.
        Returns {id: sha256}."""
        found = {}
        for at, (part, row, line) in enumerate(self._rows):
            if line["id"] in found:
                raise BadStream(f"{part.name}: id {line['id']!r} stands twice")
            if self[at].sha256() != line["sha256"]:
                raise BadStream(f"{part.name}: frame {row}, id {line['id']!r}: its values are not those that were rendered")
            found[line["id"]] = line["sha256"]
        if not self.missing and len(found) + len(self.failed) != self.manifest["poses"]:
            raise BadStream(f"{self.folder}: found {len(found)} frames and {len(self.failed)} failed poses; "
                            f"allowed: {self.manifest['poses']} in all")
        return found


def parsed(text):
    """A JSON text; ValueError also where it is nested too deep."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deep") from None


def _lines(path):
    with open(path, encoding="utf-8") as file:
        return [parsed(line) for line in file]


def digest(value):
    """Of anything that JSON holds."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
