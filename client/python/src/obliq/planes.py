"""Planes of a frame, windows of it, and how a block's bytes become values. PROTOCOL.md, "Frames"."""
from __future__ import annotations

import collections.abc
import dataclasses
import types
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, TypeVar, Union, cast

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire
from ._fields import hint
from ._protocol.wire import MOST_PLANE
from .errors import BadStream

# Number on the wire and type of a value, little-endian on any machine. A VIDEO value has as many bytes as its
# blocks' sizes say.
NUMBERS = {"iq": 0, "power": 1, "count": 2, "state": 3, "video": 4, "pulses": 5, "material": 6, "building": 7, "height": 8,
           "returns": 9, "target": 10}
TYPES: dict[str, np.dtype[Any]] = {"iq": np.dtype("<c8"), "power": np.dtype("<f8"),
                                   "count": np.dtype("<u4"), "state": np.dtype("u1"), "material": np.dtype("u1"),
                                   "building": np.dtype("<f4"), "height": np.dtype("<f4"), "returns": np.dtype("u1"),
                                   "target": np.dtype("<u4"), "pulses": np.dtype("<c8")}
VIDEO_TYPES: dict[int, np.dtype[Any]] = {1: np.dtype("u1"), 2: np.dtype("<u2")}
NAMES = {number: name for name, number in NUMBERS.items()}
BINS = tuple(name for name in NUMBERS if name != "pulses")  # of which a frame has [azimuth, range]
FOUR = ("iq", "power", "count", "state")
LABELS = ("material", "building", "height", "returns")
NO_MATERIAL = 255
# What bins have that a scanning antenna missed, where it is not 0.
MISSED = {"material": NO_MATERIAL, "height": np.nan}
STATES = ("not_sampled", "sampled", "shadow", "no_surface", "no_ground")
ENCODINGS = {"cf32": 0, "cf32_le": 0, "ci16": 1, "ci16_le": 1}
COMPRESSIONS: dict[str | None, int] = {None: 0, "none": 0, "zstd": 1}


Planes = Union[str, Iterable[str], None]
K = TypeVar("K")


def _words(given: Planes) -> list[str]:
    if not isinstance(given, (str, collections.abc.Iterable, type(None))):
        raise TypeError(f"planes: found {given!r}; allowed: a text such as \"iq state\", or a list of names")
    return given.replace(",", " ").split() if isinstance(given, str) else list(given or ())


def plane_names(given: Planes) -> tuple[str, ...]:
    """"iq state", ["iq", "state"] or None, the four, as a tuple in the order of their numbers. "video16" is video."""
    if given is None:
        return FOUR
    names = ["video" if name == "video16" else name for name in _words(given)]
    for name in names:
        if name not in NUMBERS:
            raise ValueError(f"planes: found {name!r}{hint(name, NUMBERS)}")
    if not names:
        raise ValueError(f"planes: found none; allowed: some of {', '.join(NUMBERS)}")
    return tuple(sorted(set(names), key=NUMBERS.__getitem__))


def choice(name: str, table: Mapping[K, int], given: K) -> int:
    """The number of one of a table's words."""
    if given not in table:
        raise ValueError(f"{name}: found {given!r}; allowed: {', '.join(repr(key) for key in table)}")
    return table[given]


@dataclasses.dataclass(frozen=True)
class Window:
    """The bins that are wanted, as slices without negative numbers: Window(azimuth=slice(0, None, 4))."""

    azimuth: slice = dataclasses.field(default_factory=lambda: slice(None))
    range: slice = dataclasses.field(default_factory=lambda: slice(None))

    def write(self, message: wire.BinWindow) -> None:
        """Into the message."""
        for axis in ("azimuth", "range"):
            run = getattr(self, axis)
            if not isinstance(run, slice) or not all(isinstance(part, (int, np.integer, type(None)))
                                                     for part in (run.start, run.stop, run.step)):
                raise TypeError(f"Window({axis}={run!r}); allowed: a slice of whole numbers, such as slice(100, 200)")
            first, step = run.start or 0, 1 if run.step is None else run.step
            if first < 0 or step < 1 or (run.stop is not None and run.stop <= first):
                raise ValueError(f"Window({axis}={run}): has no bins; allowed: 0 <= start < stop, step from 1")
            setattr(message, f"first_{axis}", first)
            setattr(message, f"n_{axis}", 0 if run.stop is None else run.stop - first)
            setattr(message, f"{axis}_step", step)


class Run(NamedTuple):
    """Bins first, first + step, ... of one axis: n of them."""

    first: int
    step: int
    n: int

    @staticmethod
    def cut(first: int, spanned: int, step: int, bins: int) -> Run:
        """Of `spanned` bins from `first` on, 0: all, each step-th."""
        step = max(1, step)
        spanned = min(spanned, bins - first) if spanned else bins - first
        return Run(first, step, max(0, -(-spanned // step)))

    def place(self, first: int, n: int, step: int) -> int | None:
        """Where a block's bins stand among these, or None."""
        if (step or 1) != self.step:
            return None
        at = first - self.first
        if self.step != 1:
            at, rest = divmod(at, self.step)
            if rest:
                return None
        return at if 0 <= at <= self.n - n else None

    def indices(self) -> npt.NDArray[np.int64]:
        """All of them."""
        return self.first + self.step * np.arange(self.n)


class Scaled(NamedTuple):
    """Values that are integers times a scale, [n_azimuth, n_range]."""

    integers: npt.NDArray[Any]  # [n_azimuth, 2 n_range]
    scale: np.float64

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of the values."""
        return TYPES["iq"]

    @property
    def size(self) -> int:
        """How many values."""
        return self.integers.size // 2

    def into(self, array: npt.NDArray[Any]) -> None:
        """Writes the values."""
        # In double, then rounded once, as the C++ client does: the same bits. In three steps, each of which numpy does
        # many values at a time; one that converts as it multiplies takes nearly twice as long.
        scaled = self.integers.astype(np.float64)
        scaled *= self.scale
        array.view("<f4")[...] = scaled


def plain(block: wire.WedgeBlock, data: bytes | memoryview) -> npt.NDArray[Any] | Scaled:
    """The values of a block's rectangle, [n_azimuth, n_range], of pulses [n_pulses, n_range]: an array, or Scaled. BadStream
    where sizes or codings are not possible."""
    name = NAMES.get(block.plane)
    if name is None:
        raise BadStream(f"a data block of plane {block.plane}; allowed: {', '.join(map(str, sorted(NAMES)))}")
    if block.iq_encoding not in (0, 1) or block.compression not in (0, 1):
        raise BadStream(f"a data block in encoding {block.iq_encoding}, compression {block.compression}; allowed: 0 or 1")
    n, n_range, compression = block.n_azimuth, block.n_range, block.compression
    if name == "pulses":
        n = block.n_pulses
    bins = n * n_range
    size = block.plain_bytes if compression else len(data)
    integers = name in ("iq", "pulses") and block.iq_encoding == 1
    kind: np.dtype[Any] | None
    if name == "video":
        kind = VIDEO_TYPES.get(size // bins if bins else 1)
    else:
        kind = np.dtype("<i2") if integers else TYPES[name]
    per_bin = (2 if integers else 1) * (kind.itemsize if kind else 0)
    if kind is None or size != bins * per_bin or size > MOST_PLANE:
        raise BadStream(f"a data block of {bins} bins of {name} has the wrong size: found {size} bytes")
    if compression:
        data = _unpack(data, size)
    if not integers:
        return np.ndarray((n, n_range), kind, data)
    if not 0 <= block.scale <= float(np.finfo(np.float32).max) / 32767:
        raise BadStream(f"a data block's scale: found {block.scale}; allowed: from 0")
    return Scaled(np.ndarray((n, 2 * n_range), kind, data), np.float64(block.scale))


def need_zstd() -> types.ModuleType:
    """zstandard, or how to get it."""
    try:
        import zstandard
    except ImportError:
        raise ImportError("compress='zstd' needs zstandard: pip install 'obliq[zstd]'") from None
    return zstandard  # type: ignore[no-any-return, unused-ignore]


def _unpack(data: bytes | memoryview, size: int) -> bytes:
    zstandard = need_zstd()
    # What the bytes claim decides nothing about memory.
    try:
        if zstandard.frame_content_size(data) not in (-1, size):
            raise BadStream(f"a compressed data block is damaged: its plain_bytes are {size}")
        values: bytes = zstandard.ZstdDecompressor().decompress(data, max_output_size=max(1, size))
    except zstandard.ZstdError as error:
        raise BadStream(f"a compressed data block is damaged: {error}") from None
    if len(values) != size:
        raise BadStream(f"a compressed data block is damaged: {len(values)} bytes; its plain_bytes are {size}")
    return values


def write_choice(request: wire.Subscribe | wire.RenderOnce, planes: Planes, encoding: str, compress: str | None,
                 window: Window | None) -> tuple[str, ...]:
    """Which planes, how they are sent, which bins: fields that Subscribe and RenderOnce share."""
    names = plane_names(planes)
    request.planes.extend(cast(wire.PlaneKind, NUMBERS[name]) for name in names)
    if "video16" in _words(planes):
        request.video_bits = 16
    request.iq_encoding = cast(wire.IqEncodingKind, choice("encoding", ENCODINGS, encoding))
    request.compression = cast(wire.CompressionKind, choice("compress", COMPRESSIONS, compress))
    if request.compression:
        need_zstd()
    if window is not None:
        if not isinstance(window, Window):
            raise TypeError(f"window: found {type(window).__name__}; allowed: obliq.Window")
        window.write(request.window)
    return names
