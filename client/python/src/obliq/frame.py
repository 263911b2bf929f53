"""A frame: planes as arrays [azimuth, range], and where their bins lie."""
from __future__ import annotations

import dataclasses
import functools
import hashlib
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire
from . import places as _places
from .errors import printable
from .parameters import Pose, Settings
from .planes import BINS, Run
from .trains import Train, block_of_frame, train_of

if TYPE_CHECKING:
    import matplotlib.axes
    import xarray


@dataclasses.dataclass(frozen=True)
class Dwell:
    """Azimuths that were rendered for one pose. azimuth: rows of the frame's arrays. utc: of the beam where the antenna scans,
    else of the start of rendering; by the server's clock."""

    azimuth: slice
    pose: Pose
    utc: np.datetime64

    @staticmethod
    def pose_of(block: wire.WedgeBlock) -> Pose:
        """The pose that a block was rendered for."""
        return Pose.read(block.pose)

    @staticmethod
    def of(rows: slice, block: wire.WedgeBlock, utc_ns: int) -> Dwell:
        """Of a block that was sent at a time."""
        then_ns = utc_ns - (block.send_ns - (block.beam_ns or block.render_start_ns))
        return Dwell(rows, Dwell.pose_of(block), np.datetime64(then_ns, "ns"))


def runs_of(descriptor: wire.FrameDescriptor) -> tuple[Run, Run]:
    """The azimuth and the range bins that a frame has of all that its settings name."""
    settings, window = descriptor.settings, descriptor.window
    return (Run.cut(window.first_azimuth, window.n_azimuth, window.azimuth_step, settings.azimuth_bins),
            Run.cut(window.first_range, window.n_range, window.range_step, settings.range_bins))


class Frame:
    """Planes that were asked for; the others are None. Arrays are C-contiguous and little-endian.

    iq: complex64, unit `unit`.  power: float64, `power_unit`.  count: uint32, samples.  state: uint8, obliq.STATES.
    video: uint8 or uint16.

    Labels, of what the bin's mean power comes from (PROTOCOL.md, "Labels").  material: uint8, an index of
    `descriptor.materials`, of the greatest sum of power; 255: none.  building: float32, share of the power that buildings give.
    height: float32, m above the datum, weighed by power; NaN: no power.  returns: uint8, separate stretches of visible surface
    in the bin: above 1 is layover.

    target: uint32, of the target whose mean power is the greatest in the bin the last 32 bits of its id; 0: none.

    trains: of a radar that gives out its pulses (radar.mode = "pulses", plane "pulses"), obliq.Train for each dwell.

    targets: where truth was asked for, a structured array of obliq.targets.RECORD, a record a target: id, latitude_deg,
    longitude_deg, height_m (above the datum), bearing_deg, range_m (slant), elevation_deg, closing_m_s, snr_db (in the middle of
    beam and pulse; with is_power the echo's power, dBW), rcs_dbsm (as drawn), share_seen, azimuth_bin and range_bin (of the
    whole frame; -1: none), hidden_by (index into obliq.targets.HIDDEN_BY). None: not asked for.

    descriptor: the message, wire.FrameDescriptor. summary: the message, wire.FrameSummary, when the frame is complete.
    frames_skipped: that the server left out before this one. utc: of its FrameBegin. scan: the message ScanPass, of an antenna
    that scans. missed: rows that a scanning antenna did not render. id, split, scene, meta: of its line
    in a data set.
    """

    iq: npt.NDArray[np.complex64] | None = None
    power: npt.NDArray[np.float64] | None = None
    count: npt.NDArray[np.uint32] | None = None
    state: npt.NDArray[np.uint8] | None = None
    video: npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | None = None
    material: npt.NDArray[np.uint8] | None = None
    building: npt.NDArray[np.float32] | None = None
    height: npt.NDArray[np.float32] | None = None
    returns: npt.NDArray[np.uint8] | None = None
    target: npt.NDArray[np.uint32] | None = None
    targets: npt.NDArray[Any] | None = None
    trains: tuple[Train, ...] = ()
    id: str | int | None = None
    split: str = ""
    scene: str = ""

    def __init__(self, begin: wire.FrameBegin, utc_ns: int):
        self.descriptor: wire.FrameDescriptor = begin.frame
        self.frame_id: int = begin.frame_id
        self.request_id: int = begin.request_id
        self.frames_skipped: int = begin.frames_skipped
        self.scan: wire.ScanPass | None = begin.scan if begin.HasField("scan") else None
        self.utc = np.datetime64(utc_ns, "ns")
        self.summary: wire.FrameSummary | None = None
        self.render_s = 0.0
        self.waited_s = 0.0
        self.missed: tuple[slice, ...] = ()
        self.meta: dict[str, Any] = {}
        self.azimuth_run, self.range_run = runs_of(self.descriptor)
        self._blocks: list[tuple[slice, wire.WedgeBlock, int]] = []

    # What arrives.

    def _note_dwell(self, rows: slice, block: wire.WedgeBlock, utc_ns: int) -> None:
        self._blocks.append((rows, block, utc_ns))

    def _finish(self, end: wire.FrameEnd, missed: tuple[slice, ...]) -> None:
        self.summary, self.render_s, self.waited_s, self.missed = end.summary, end.render_s, end.waited_s, missed

    @property
    def dwells(self) -> tuple[Dwell, ...]:
        """In the order in which they came: rows, pose and time of each wedge."""
        return tuple(Dwell.of(*block) for block in self._blocks)

    # What it is.

    def __repr__(self) -> str:
        planes = " ".join([*self.planes(), *(["pulses"] if self.trains else [])])
        return printable(f"<obliq.Frame {self.frame_id} of {self.radar}: {self.shape[0]} x {self.shape[1]} bins, {planes}>")

    def planes(self) -> dict[str, npt.NDArray[Any]]:
        """Name -> array of the planes that are there."""
        return {name: getattr(self, name) for name in BINS if getattr(self, name) is not None}

    @overload
    def plane(self, name: Literal["iq"]) -> npt.NDArray[np.complex64]: ...
    @overload
    def plane(self, name: Literal["power"]) -> npt.NDArray[np.float64]: ...
    @overload
    def plane(self, name: Literal["count", "target"]) -> npt.NDArray[np.uint32]: ...
    @overload
    def plane(self, name: Literal["state", "material", "returns"]) -> npt.NDArray[np.uint8]: ...
    @overload
    def plane(self, name: Literal["building", "height"]) -> npt.NDArray[np.float32]: ...
    @overload
    def plane(self, name: str) -> npt.NDArray[Any]: ...

    def plane(self, name: str) -> npt.NDArray[Any]:
        """A plane that must be there: KeyError where it was not asked for."""
        there = self.planes()
        if name not in there:
            raise KeyError(f"plane: found {name!r}; this frame has {', '.join(there)}")
        return there[name]

    @property
    def shape(self) -> tuple[int, int]:
        """Azimuth and range bins."""
        return self.azimuth_run.n, self.range_run.n

    @property
    def radar(self) -> str:
        """Name of the radar."""
        return self.descriptor.radar

    @property
    def pose(self) -> Pose:
        """Of the antenna, at the beginning of the frame."""
        return Pose.read(self.descriptor.pose)

    @property
    def settings(self) -> Settings:
        """That the frame was rendered with."""
        return Settings.read(self.descriptor.settings)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of the descriptor and the summary."""
        return tuple(self.descriptor.warnings) + (tuple(self.summary.warnings) if self.summary else ())

    @property
    def unit(self) -> str:
        """Of iq."""
        return "sqrt(W) m^2" if self.descriptor.settings.range_normalisation else self.descriptor.unit

    @property
    def power_unit(self) -> str:
        """Of power."""
        return self.descriptor.power_unit or ("W m^4" if self.descriptor.settings.range_normalisation else "W")

    # Where its bins lie.

    @property
    def azimuth_index(self) -> npt.NDArray[np.int64]:
        """Of each row: the azimuth bin of the whole frame."""
        return self.azimuth_run.indices()

    @property
    def range_index(self) -> npt.NDArray[np.int64]:
        """Of each column: the range bin of the whole frame."""
        return self.range_run.indices()

    @functools.cached_property
    def azimuth_deg(self) -> npt.NDArray[np.float64]:
        """Centres of the azimuth bins: true bearing at the antenna, rising, so perhaps negative or above 360."""
        d = self.descriptor
        return np.asarray(d.azimuth_start_deg + (self.azimuth_index + 0.5) * d.azimuth_width_deg)

    @functools.cached_property
    def offset_deg(self) -> npt.NDArray[np.float64]:
        """Centres of the azimuth bins, clockwise from the sector's centre: the same in all frames of one shape."""
        d = self.descriptor
        return np.asarray((self.azimuth_index + 0.5 - d.settings.azimuth_bins / 2) * d.azimuth_width_deg)

    @functools.cached_property
    def range_m(self) -> npt.NDArray[np.float64]:
        """Centres of the range bins: slant range."""
        d = self.descriptor
        return np.asarray(d.range_start_m + (self.range_index + 0.5) * d.range_spacing_m)

    @functools.cached_property
    def ground_range_m(self) -> npt.NDArray[np.float64]:
        """Along the ground at the reference height, under the middle azimuth, [range]."""
        middle = self.azimuth_deg[self.shape[0] // 2]
        return np.asarray(_places.locate(self.descriptor, np.array([middle]), self.range_m)[2][0])

    def places(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Latitude and longitude of the bins' centres in degrees, each [azimuth, range], for ground that is everywhere
        at `descriptor.map_reference_height_m` (PROTOCOL.md, "Where a bin lies"). Within 0.1 m of that formula."""
        latitude, longitude, _ = _places.locate(self.descriptor, self.azimuth_deg, self.range_m)
        return latitude, longitude

    # What may be done with it.

    def sha256(self) -> str:
        """Over names, types, shapes and values of all planes."""
        digest = hashlib.sha256()
        for name, values in self.planes().items():
            digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
            digest.update(memoryview(np.ascontiguousarray(values)))  # type: ignore[arg-type, unused-ignore]
        for train in self.trains:
            digest.update(f"pulses {train.pulses.shape}\n".encode())
            digest.update(memoryview(np.ascontiguousarray(train.pulses)))  # type: ignore[arg-type, unused-ignore]
        return digest.hexdigest()

    def copy(self) -> Frame:
        """A frame of its own arrays, for frames of a stream with copy=False."""
        other = object.__new__(Frame)
        other.__dict__.update(self.__dict__)
        for name, values in self.planes().items():
            setattr(other, name, values.copy())
        return other

    def to_xarray(self) -> xarray.Dataset:
        """An xarray.Dataset with coordinates, units and attributes after the CF conventions. Its azimuth counts from the
        sector's centre, so that frames stack; `bearing` is the true one."""
        from . import xarrays

        return xarrays.to_xarray(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """By suffix: .npz and .nc (obliq.load gives the same bits back), .tif (a map, as `obliq get` writes), .png."""
        from ._saving import save

        save(self, path)

    def plot(self, kind: Literal["ppi", "bscan"] = "ppi", ax: matplotlib.axes.Axes | None = None,
             range_db: tuple[float, float] | None = None, cmap: str = "gray") -> matplotlib.axes.Axes:
        """A matplotlib picture: "ppi", north up and to scale, or "bscan", azimuth by range. range_db: what is black and what
        white; cmap: matplotlib's name of other colours. Returns the axes."""
        from . import plotting

        return plotting.plot(self, kind, ax, range_db, cmap)

    def _repr_html_(self) -> str:
        import html

        rows = {"frame": f"{self.frame_id} of {self.radar}", "bins": f"{self.shape[0]} x {self.shape[1]} (azimuth x range)",
                "planes": ", ".join(f"{name} {values.dtype}" for name, values in self.planes().items()),
                "range": f"{self.range_m[0]:.0f} to {self.range_m[-1]:.0f} m",
                "bearing": f"{self.azimuth_deg[0]:.2f} to {self.azimuth_deg[-1]:.2f} degrees"}
        cells = "".join(f"<tr><th>{name}</th><td>{html.escape(printable(text))}</td></tr>" for name, text in rows.items())
        return f"<table>{cells}</table>"


def restore(planes: Mapping[str, npt.NDArray[Any]], descriptor: bytes, summary: bytes = b"", utc_ns: int = 0,
            frame_id: int | None = None, missed: Iterable[tuple[int, int]] = ()) -> Frame:
    """A frame from arrays and messages, as files have them."""
    begin = wire.FrameBegin(frame=wire.FrameDescriptor.FromString(descriptor))
    begin.frame_id = begin.frame.frame_id if frame_id is None else frame_id
    frame = Frame(begin, utc_ns)
    for name, values in planes.items():
        if name == "pulses":  # of a data set: of a frame whose one train is along all of its azimuths
            frame.trains = (train_of(frame, block_of_frame(frame), np.asarray(values), utc_ns),)
            continue
        if values.shape != frame.shape:
            raise ValueError(f"{name}: found shape {values.shape}; allowed: {frame.shape}")
        setattr(frame, name, values)
    frame.summary = wire.FrameSummary.FromString(summary)
    frame.missed = tuple(slice(*rows) for rows in missed)
    return frame
