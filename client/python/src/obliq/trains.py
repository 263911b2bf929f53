"""Trains of pulses: what a radar's receiver gives out before anything is made of it. PROTOCOL.md, "Pulse trains"."""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire
from ._fields import hint
from .errors import BadStream
from .parameters import Pose

if TYPE_CHECKING:
    from .frame import Frame
    from .planes import Scaled

# Sums of cosines over a train: a[0] - a[1] cos x + a[2] cos 2x - ... (Harris 1978), sampled at (n + 1/2)/N as the server's.
WINDOWS = {"none": (1.0,), "hamming": (0.54, 0.46), "hann": (0.5, 0.5), "blackman_harris": (0.35875, 0.48829, 0.14128, 0.01168)}
MOST_PULSES = 1 << 12


class RangeDoppler(NamedTuple):
    """A range-Doppler map. map: complex64 [cell, gate]. velocity_m_s: of each cell, closing positive, rising. doppler_hz: the
    same as a frequency. range_m: of each gate."""

    map: npt.NDArray[np.complex64]
    velocity_m_s: npt.NDArray[np.float64]
    doppler_hz: npt.NDArray[np.float64]
    range_m: npt.NDArray[np.float64]


@dataclasses.dataclass
class Train:
    """One dwell's pulses.

    pulses: complex64 [pulse, gate], the unit of Frame.unit. azimuth: rows of the frame's arrays that it was sent along. pose: of
    its middle. period_ns: intervals from pulse to pulse, one after the other, round and round. boresight_start_deg: of the
    beam at pulse 0, clockwise from the antenna's true north; boresight_rate_deg_s: how it turns. range_m: slant range of each
    gate. wavelength_m: of the carrier. utc: of the beam where the antenna scans, else of the start of rendering; by the
    server's clock.
    """

    pulses: npt.NDArray[np.complex64]
    azimuth: slice
    pose: Pose
    period_ns: tuple[float, ...]
    boresight_start_deg: float
    boresight_rate_deg_s: float
    range_m: npt.NDArray[np.float64]
    wavelength_m: float
    utc: np.datetime64

    @property
    def times_s(self) -> npt.NDArray[np.float64]:
        """Of each pulse, 0 midway between the first and the last."""
        n = len(self.pulses)
        times = np.concatenate([[0.0], np.cumsum(np.resize(self.period_ns, max(0, n - 1)))]) * 1e-9
        return np.asarray(times[:n] - times[n - 1] / 2)

    @property
    def boresight_deg(self) -> npt.NDArray[np.float64]:
        """Of the beam at each pulse, clockwise from the antenna's true north."""
        times = self.times_s
        return np.asarray(self.boresight_start_deg + self.boresight_rate_deg_s * (times - times[0]))

    def range_doppler(self, window: str | npt.ArrayLike = "hamming", cells: int | None = None) -> RangeDoppler:
        """Its Doppler spectrum at each gate. window: "none", "hamming", "hann" or "blackman_harris", or a weight for each pulse.
        cells: Doppler cells, the number of pulses or more; None: as many as pulses. An echo of one velocity keeps its level: the
        weights' sum is 1. Of staggered pulses the sum is over their own times, and its cells go as far as the mean interval's."""
        n = len(self.pulses)
        n_cells = n if cells is None else int(cells)
        if n_cells < n:
            raise ValueError(f"cells: found {cells}; allowed: from {n}, the number of pulses")
        weights = _weights(window, n)
        weights = weights / weights.sum()
        mean_s = float(np.mean(self.period_ns)) * 1e-9
        number = np.arange(n_cells) - n_cells // 2
        doppler_hz = number / (n_cells * mean_s)
        weighed = self.pulses * weights[:, None].astype(np.float32)
        if len(set(self.period_ns)) == 1:
            spectrum = np.fft.fftshift(np.fft.fft(weighed, n_cells, axis=0), axes=0)
            # As of pulses about time 0.
            spectrum = spectrum * np.exp(2j * np.pi * doppler_hz * mean_s * (n - 1) / 2)[:, None]
        else:
            spectrum = np.exp(-2j * np.pi * np.outer(doppler_hz, self.times_s)) @ weighed
        return RangeDoppler(spectrum.astype(np.complex64), doppler_hz * self.wavelength_m / 2, doppler_hz, self.range_m)


def _weights(window: str | npt.ArrayLike, n: int) -> npt.NDArray[np.float64]:
    if isinstance(window, str):
        if window not in WINDOWS:
            raise ValueError(f"window: found {window!r}{hint(window, WINDOWS)}")
        at = 2 * np.pi * (np.arange(n) + 0.5) / n
        return np.asarray(sum((-1) ** k * a * np.cos(k * at) for k, a in enumerate(WINDOWS[window])) * np.ones(n))
    weights = np.asarray(window, float)
    if weights.shape != (n,) or not np.isfinite(weights).all() or weights.sum() == 0:
        raise ValueError(f"window: found shape {weights.shape}; allowed: a name, or {n} finite weights whose sum is not 0")
    return weights


class Trains:
    """Puts a frame's trains together: their blocks come in the order of the pulses, one train behind the other."""

    def __init__(self, frame: Frame):
        self._frame = frame
        self._rows: list[npt.NDArray[np.complex64]] = []  # values of the train that is coming, in their order
        self._values = 0
        self._first: wire.WedgeBlock | None = None
        self.bytes = 0

    def add(self, block: wire.WedgeBlock, values: npt.NDArray[Any] | Scaled, utc_ns: int) -> slice | None:
        """Takes a block of [n_pulses, n_range]; the rows of the frame that its train is along, when it is whole."""
        run, settings = self._frame.range_run, self._frame.descriptor.settings
        n_pulses, whole = settings.doppler_pulses, settings.doppler_pulses * run.n
        first = self._first if self._first is not None else block
        fits = (1 <= n_pulses <= MOST_PULSES and block.n_azimuth >= 1 and block.first_azimuth == first.first_azimuth
                and block.n_azimuth == first.n_azimuth and block.first_azimuth + block.n_azimuth <= settings.azimuth_bins
                and len(self._frame.trains) < settings.azimuth_bins
                and block.first_pulse * run.n + (run.place(block.first_range, block.n_range, block.range_step) or 0) == self._values
                and run.place(block.first_range, block.n_range, block.range_step) is not None
                and (block.n_range == run.n or block.n_pulses == 1) and self._values + values.size <= whole and values.size)
        if not fits:
            raise BadStream("a block of pulses overlaps another or leaves a gap")
        self._first = first
        if hasattr(values, "into"):
            array = np.empty((block.n_pulses, block.n_range), np.complex64)
            values.into(array)
        else:
            array = np.array(values, np.complex64)
        self._rows.append(array.reshape(-1))
        self._values += array.size
        self.bytes += array.nbytes
        if self._values < whole:
            return None
        pulses = np.concatenate(self._rows).reshape(n_pulses, run.n)
        self._rows, self._values, self._first = [], 0, None
        train = train_of(self._frame, first, pulses, utc_ns)
        self._frame.trains += (train,)
        return train.azimuth

    def end(self) -> None:
        """The frame has ended."""
        if self._values:
            raise BadStream("the frame ended within a train of pulses")


def train_of(frame: Frame, block: wire.WedgeBlock, pulses: npt.NDArray[np.complex64], utc_ns: int) -> Train:
    """As a block of it says. Its message is kept, for files."""
    run = frame.azimuth_run
    first = max(0, -(-(block.first_azimuth - run.first) // run.step))
    past = max(0, -(-(block.first_azimuth + block.n_azimuth - run.first) // run.step))
    then_ns = utc_ns - (block.send_ns - (block.beam_ns or block.render_start_ns))
    train = Train(pulses, slice(min(first, run.n), min(past, run.n)), Pose.read(block.pose), tuple(block.pulse_period_ns),
                  block.boresight_start_deg, block.boresight_rate_deg_s, frame.range_m, frame.descriptor.wavelength_m,
                  np.datetime64(then_ns, "ns"))
    train._message = block  # type: ignore[attr-defined]
    return train


def messages_of(trains: tuple[Train, ...]) -> dict[str, npt.NDArray[Any]]:
    """What a file keeps of them, as arrays: the samples, [train, pulse, gate], and each train's message."""
    messages = [train._message.SerializeToString() for train in trains]  # type: ignore[attr-defined]
    return {"pulses": np.stack([train.pulses for train in trains]),
            "trains": np.frombuffer(b"".join(messages), "u1"), "train_bytes": np.array([len(each) for each in messages], "i8")}


def restore_trains(frame: Frame, pulses: npt.NDArray[np.complex64], messages: bytes, sizes: npt.NDArray[np.int64]) -> None:
    """messages_of(), turned round."""
    at = 0
    for values, size in zip(pulses, sizes):
        block = wire.WedgeBlock.FromString(messages[at:at + int(size)])
        frame.trains += (train_of(frame, block, np.ascontiguousarray(values), block.send_ns),)
        at += int(size)


def block_of_frame(frame: Frame) -> wire.WedgeBlock:
    """What is said of the one train of a RenderOnce, as its settings have it."""
    settings = frame.descriptor.settings
    ratios = tuple(settings.pulse_stagger.ratio) or (1.0,)
    block = wire.WedgeBlock(n_azimuth=settings.azimuth_bins, pose=frame.descriptor.pose,
                            pulse_period_ns=[1e9 * ratio / settings.prf_hz for ratio in ratios])
    if settings.scan_mode:
        block.boresight_rate_deg_s = settings.scan_rate_deg_s
    probe = Train(np.empty((settings.doppler_pulses, 0), np.complex64), slice(0), frame.pose, tuple(block.pulse_period_ns), 0.0,
                  block.boresight_rate_deg_s, frame.range_m, frame.descriptor.wavelength_m, frame.utc)
    block.boresight_start_deg = frame.descriptor.pose.bearing_deg + block.boresight_rate_deg_s * probe.times_s[0]
    return block
