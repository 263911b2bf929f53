"""A frame: planes as arrays [azimuth, range], and where their bins lie."""
from __future__ import annotations

import dataclasses
import functools
import hashlib

import numpy as np

from . import obliq_pb2 as wire
from . import places as _places
from .errors import printable
from .parameters import Pose, Settings
from .planes import NAMES


@dataclasses.dataclass(frozen=True)
class Dwell:
    """Azimuths that were rendered for one pose."""

    azimuth: slice  # rows of the frame's arrays
    pose: Pose
    utc: np.datetime64  # of the beam where the antenna scans, else of the start of rendering; by the server's clock

    @staticmethod
    def pose_of(block):
        return Pose.read(block.pose)

    @staticmethod
    def of(rows, block, utc_ns):
        then_ns = utc_ns - (block.send_ns - (block.beam_ns or block.render_start_ns))
        return Dwell(rows, Dwell.pose_of(block), np.datetime64(then_ns, "ns"))


class Frame:
    """Planes that were asked for; the others are None. Arrays are C-contiguous and little-endian.

    iq: complex64, unit `unit`.  power: float64, `power_unit`.  count: uint32, samples.  state: uint8, obliq.STATES.
    video: uint8 or uint16.
    """

    iq = power = count = state = video = None

    def __init__(self, assembler, begin, utc_ns):
        self.descriptor = begin.frame  # the message, wire.FrameDescriptor
        self.frame_id = begin.frame_id
        self.request_id = begin.request_id
        self.frames_skipped = begin.frames_skipped  # that the server left out before this one
        self.scan = begin.scan if begin.HasField("scan") else None
        self.utc = np.datetime64(utc_ns, "ns")  # of its FrameBegin
        self.summary = None  # the message, when the frame is complete
        self.render_s = 0.0
        self.waited_s = 0.0
        self.missed = ()  # rows that a scanning antenna did not render, as slices
        self._azimuth, self._range = assembler.azimuth, assembler.range
        self._blocks = []

    # What arrives.

    def _note_dwell(self, rows, block, utc_ns):
        self._blocks.append((rows, block, utc_ns))

    def _finish(self, end, missed):
        self.summary, self.render_s, self.waited_s, self.missed = end.summary, end.render_s, end.waited_s, missed

    @property
    def dwells(self):
        """In the order in which they came: rows, pose and time of each wedge."""
        return tuple(Dwell.of(*block) for block in self._blocks)

    # What it is.

    def __repr__(self):
        planes = " ".join(self.planes())
        return printable(f"<obliq.Frame {self.frame_id} of {self.radar}: {self.shape[0]} x {self.shape[1]} bins, {planes}>")

    def planes(self):
        """Name -> array of the planes that are there."""
        return {name: getattr(self, name) for name in NAMES.values() if getattr(self, name) is not None}

    @property
    def shape(self):
        return self._azimuth.n, self._range.n

    @property
    def radar(self):
        return self.descriptor.radar

    @property
    def pose(self):
        return Pose.read(self.descriptor.pose)

    @property
    def settings(self):
        return Settings.read(self.descriptor.settings)

    @property
    def warnings(self):
        """Of the descriptor and the summary."""
        return tuple(self.descriptor.warnings) + (tuple(self.summary.warnings) if self.summary else ())

    @property
    def unit(self):
        return "sqrt(W) m^2" if self.descriptor.settings.range_normalisation else self.descriptor.unit

    @property
    def power_unit(self):
        return self.descriptor.power_unit or ("W m^4" if self.descriptor.settings.range_normalisation else "W")

    # Where its bins lie.

    @property
    def azimuth_index(self):
        """Of each row: the azimuth bin of the whole frame."""
        return self._azimuth.indices()

    @property
    def range_index(self):
        return self._range.indices()

    @functools.cached_property
    def azimuth_deg(self):
        """Centres of the azimuth bins: true bearing at the antenna, rising, so perhaps negative or above 360."""
        d = self.descriptor
        return d.azimuth_start_deg + (self.azimuth_index + 0.5) * d.azimuth_width_deg

    @functools.cached_property
    def range_m(self):
        """Centres of the range bins: slant range."""
        d = self.descriptor
        return d.range_start_m + (self.range_index + 0.5) * d.range_spacing_m

    @functools.cached_property
    def ground_range_m(self):
        """Along the ground at the reference height, under the middle azimuth, [range]."""
        middle = self.azimuth_deg[self.shape[0] // 2]
        return _places.locate(self.descriptor, np.array([middle]), self.range_m)[2][0]

    def places(self):
        """Latitude and longitude of the bins' centres in degrees, each [azimuth, range], for ground that is everywhere
        at `descriptor.map_reference_height_m` (PROTOCOL.md, "Where a bin lies"). Within 0.1 m of that formula."""
        latitude, longitude, _ = _places.locate(self.descriptor, self.azimuth_deg, self.range_m)
        return latitude, longitude

    # What may be done with it.

    def sha256(self):
        """Over names, types, shapes and values of all planes."""
        digest = hashlib.sha256()
        for name, values in self.planes().items():
            digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
            digest.update(np.ascontiguousarray(values))
        return digest.hexdigest()

    def copy(self):
        """A frame of its own arrays, for frames of a stream with copy=False."""
        other = object.__new__(Frame)
        other.__dict__.update(self.__dict__)
        for name, values in self.planes().items():
            setattr(other, name, values.copy())
        return other

    def to_xarray(self):
        """An xarray.Dataset with coordinates, units and attributes after the CF conventions."""
        from . import xarrays

        return xarrays.to_xarray(self)

    def save(self, path):
        """By suffix: .npz and .nc (obliq.load gives the same bits back), .tif (a map, as `obliq get` writes), .png."""
        from . import files

        files.save(self, path)

    def plot(self, kind="ppi", ax=None, range_db=None):
        """A matplotlib picture: "ppi", north up and to scale, or "bscan", azimuth by range. Returns the axes."""
        from . import plotting

        return plotting.plot(self, kind, ax, range_db)


def restore(planes, descriptor, summary=b"", utc_ns=0, frame_id=None, missed=()):
    """A frame from arrays and messages, as files have them."""
    from ._assembly import Assembler
    from ._wire import Header

    begin = wire.FrameBegin(frame=wire.FrameDescriptor.FromString(descriptor))
    begin.frame_id = begin.frame.frame_id if frame_id is None else frame_id
    frame = Assembler(begin, Header(48, 48, 0, 0, 0, utc_ns, 0), ()).frame
    for name, values in planes.items():
        if values.shape != frame.shape:
            raise ValueError(f"{name}: found shape {values.shape}; allowed: {frame.shape}")
        setattr(frame, name, values)
    frame.summary = wire.FrameSummary.FromString(summary)
    frame.missed = tuple(slice(*rows) for rows in missed)
    return frame
