"""Blocks to arrays: every bin of every plane exactly once. Knows no sockets."""
from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import obliq_pb2 as wire
from .wire import Header
from ..errors import BadStream, FrameAborted
from ..frame import Dwell, Frame
from ..parameters import Pose
from ..planes import BINS, MISSED, NAMES, TYPES, Scaled, plain
from ..targets import records_of
from ..trains import Train, Trains

# Above any radar's limits; what is kept for each azimuth from a frame's beginning is then small.
MOST_AZIMUTHS = 1 << 14
MOST_RANGES = 1 << 24
# A frame that needs more is refused, whatever it claims.
MOST_BYTES = 8 << 30
# A pass that brought less than this part of its values and missed the others is given up, unless it is small; as
# client/frame_assembler.cpp does.
LEAST_PART = 64
SMALL_BYTES = 1 << 20
MOST_TARGETS = 1_000_000
# More than this the C library takes from the system, as pages that are 0 and cost nothing until something is written to them
# (mallopt(3): the greatest M_MMAP_THRESHOLD).
FRESH_BYTES = 32 << 20


class Buffers:
    """Arrays that are used again. A frame that has been handed out gives its arrays back when the next one is."""

    def __init__(self) -> None:
        self._free: dict[tuple[Any, ...], list[npt.NDArray[Any]]] = {}

    def take(self, name: str, shape: tuple[int, int], kind: np.dtype[Any]) -> tuple[npt.NDArray[Any], bool]:
        """An array, and whether all of it is 0."""
        waiting = self._free.get((name, shape, kind))
        if waiting:
            return waiting.pop(), False
        if shape[0] * shape[1] * kind.itemsize > FRESH_BYTES:
            return np.zeros(shape, kind), True
        return np.empty(shape, kind), False

    def give(self, frame: Frame) -> None:
        """Its arrays may be written again."""
        for name in BINS:
            values = getattr(frame, name)
            if values is not None:
                self._free.setdefault((name, values.shape, values.dtype), []).append(values)
        if len(self._free) > 16:  # of radars whose shape changes
            self._free.clear()


class Assembler:
    """One frame from its FrameBegin on. Arrays are made when a plane's first block comes; their pages are touched as
    values come, so memory follows what arrives, not what is claimed."""

    def __init__(self, begin: wire.FrameBegin, header: Header, names: tuple[str, ...], buffers: Buffers | None = None):
        descriptor = begin.frame
        settings = descriptor.settings
        if not (1 <= settings.azimuth_bins <= MOST_AZIMUTHS and 1 <= settings.range_bins <= MOST_RANGES):
            raise BadStream(f"a frame of {settings.azimuth_bins} x {settings.range_bins} bins; allowed: 1 to "
                            f"{MOST_AZIMUTHS} x 1 to {MOST_RANGES}")
        self.frame = Frame(begin, header.utc_ns)
        self.azimuth, self.range = self.frame.azimuth_run, self.frame.range_run
        if not self.azimuth.n or not self.range.n:
            raise BadStream("a frame of a window without bins")
        self.shape = (self.azimuth.n, self.range.n)
        self._trains = Trains(self.frame) if "pulses" in names else None
        self.names = names
        names = tuple(name for name in names if name != "pulses")
        self._bytes_of_value = {name: TYPES[name].itemsize if name in TYPES else 2 for name in names}
        self._bytes_needed = sum(self._bytes_of_value.values()) * self.shape[0] * self.shape[1]
        if self._bytes_needed > MOST_BYTES:
            raise BadStream(f"the frame needs {self._bytes_needed} bytes; allowed: at most {MOST_BYTES}")
        self._bytes_received = 0
        self.stream_id, self.frame_id = header.stream_id, begin.frame_id
        self._take = (buffers or Buffers()).take
        self._filled = {name: [0] * self.azimuth.n for name in names}
        self._fresh: set[str] = set()  # planes whose array is 0 where nothing has come

    def is_mine(self, header: Header, frame_id: int) -> bool:
        """A message of this frame."""
        return header.stream_id == self.stream_id and frame_id == self.frame_id

    def block(self, header: Header, block: wire.WedgeBlock, data: memoryview) -> slice | None:
        """Takes a block; returns the rows that it has completed in all planes, as a slice, or None."""
        name = NAMES.get(block.plane, "")
        values = plain(block, data)
        if name == "pulses" and self._trains is not None:
            if self._trains.bytes + self._bytes_needed > MOST_BYTES:
                raise BadStream(f"the frame's pulses need more than {MOST_BYTES} bytes")
            return self._trains.add(block, values, header.utc_ns)
        filled = self._filled.get(name)
        if filled is None:
            return None
        n, n_range = block.n_azimuth, block.n_range
        row = self.azimuth.place(block.first_azimuth, n, block.azimuth_step)
        column = self.range.place(block.first_range, n_range, block.range_step)
        if row is None or column is None:
            raise BadStream("a data block does not fit the frame")
        rows, end = slice(row, row + n), column + n_range
        if filled[rows] != [column] * n or not values.size:
            raise BadStream("a data block overlaps another or leaves a gap")
        done = filled[rows] = [end] * n
        self._bytes_received += values.size * self._bytes_of_value[name]
        array = getattr(self.frame, name)
        if array is None or array.dtype != values.dtype:
            if array is not None:
                raise BadStream(f"blocks of {name} with values of different sizes")
            array = self._allocate(name, values.dtype)
        if isinstance(values, Scaled):
            values.into(array[rows, column:end])
        else:
            array[rows, column:end] = values
        if end < self.range.n or (len(self._filled) > 1 and any(other[rows] != done for other in self._filled.values())):
            return None
        self.frame._note_dwell(rows, block, header.utc_ns)
        return rows

    def targets(self, block: wire.TargetBlock, plane: memoryview | bytes) -> None:
        """Takes where targets are; of a pass the parts of its dwells, one behind the other."""
        records, before = records_of(block, plane), self.frame.targets
        if before is not None and len(before) + len(records) > MOST_TARGETS:
            raise BadStream("the frame has too many targets")
        self.frame.targets = records if before is None else np.concatenate([before, records])

    def _allocate(self, name: str, kind: np.dtype[Any]) -> npt.NDArray[Any]:
        try:
            array, fresh = self._take(name, self.shape, kind)
        except MemoryError:
            raise BadStream(f"there is no memory for a frame of {self.shape[0]} x {self.shape[1]} bins") from None
        if fresh:
            self._fresh.add(name)
        setattr(self.frame, name, array)
        return array

    def end(self, end: wire.FrameEnd) -> Frame:
        """The complete frame; what a scanning antenna missed is 0, "not sampled". FrameAborted where that is nearly all of a
        large one, which would take memory that nothing that came accounts for."""
        missed = []
        for span in end.missed:
            first = max(0, -(-(span.first_azimuth - self.azimuth.first) // self.azimuth.step))
            past = max(0, -(-(span.first_azimuth + span.n_azimuth - self.azimuth.first) // self.azimuth.step))
            rows = slice(min(first, self.azimuth.n), min(past, self.azimuth.n))
            missed.append(rows)
            if sum(part.stop - part.start for part in missed) > self.azimuth.n:
                raise BadStream("the frame's end says that more azimuth bins were missed than the frame has")
        unseen = {at for rows in missed for at in range(rows.start, rows.stop)}
        for name, filled in self._filled.items():
            if filled == [self.range.n] * self.azimuth.n:
                continue
            lacking = sum(self.range.n - done for at, done in enumerate(filled) if done or at not in unseen)
            if lacking:
                raise BadStream(f"the frame ended with {lacking} values of {name} missing")
        if self._trains is not None:
            self._trains.end()
        if self._bytes_needed > SMALL_BYTES and LEAST_PART * self._bytes_received < self._bytes_needed:
            raise FrameAborted("the scanning antenna missed nearly all of it")
        for name, filled in self._filled.items():
            array = getattr(self.frame, name)
            if array is None:
                array = self._allocate(name, TYPES.get(name, np.dtype("u1")))
            if name not in self._fresh or name in MISSED:
                for at in unseen:
                    if filled[at] == 0:
                        array[at] = MISSED.get(name, 0)
        self.frame._finish(end, tuple(rows for rows in missed if rows.stop > rows.start))
        return self.frame


class Wedge:
    """Neighbouring azimuths of a frame that have arrived in all planes, its arrays parts of the frame's; or a train of pulses
    along them, without arrays.

    train: of a radar that gives out its pulses; else None. frame: the whole, not yet complete. azimuth: rows of the frame's
    arrays. latency_s: from the beam, or the start of rendering. pose_age_s: from the pose's arrival at the server.
    """

    iq: npt.NDArray[np.complex64] | None
    power: npt.NDArray[np.float64] | None
    count: npt.NDArray[np.uint32] | None
    state: npt.NDArray[np.uint8] | None
    video: npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | None
    material: npt.NDArray[np.uint8] | None
    building: npt.NDArray[np.float32] | None
    height: npt.NDArray[np.float32] | None
    returns: npt.NDArray[np.uint8] | None
    target: npt.NDArray[np.uint32] | None

    def __init__(self, frame: Frame, rows: slice, block: wire.WedgeBlock, header: Header, received_ns: int, offset_ns: int):
        self.frame = frame
        self.azimuth = rows
        self.train: Train | None = frame.trains[-1] if NAMES.get(block.plane) == "pulses" else None
        for name in BINS:
            array = None if self.train is not None else getattr(frame, name)
            setattr(self, name, None if array is None else array[rows])
        self.pose: Pose = Dwell.pose_of(block)
        self.settings_version: int = block.settings_version
        self.pose_stale: bool = block.pose_stale
        self.utc = np.datetime64(header.utc_ns, "ns")
        here_ns = received_ns - offset_ns  # arrival by the server's clock

        def since(reading_ns: int) -> float:
            return (here_ns - header.utc_ns + block.send_ns - reading_ns) * 1e-9

        self.latency_s = since(block.beam_ns or block.render_start_ns)
        self.pose_age_s = since(block.pose_received_ns)
        self.pose_id: int = block.pose.pose_id

    @property
    def azimuth_deg(self) -> npt.NDArray[np.float64]:
        """Centres of its azimuth bins."""
        return self.frame.azimuth_deg[self.azimuth]

    @property
    def range_m(self) -> npt.NDArray[np.float64]:
        """Centres of the range bins."""
        return self.frame.range_m
