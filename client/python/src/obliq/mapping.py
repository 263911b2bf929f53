"""A frame on a map: which bin lies under each pixel of a plane around the antenna, nearest bin, no interpolation.

The plane is azimuthal equidistant about the antenna, north up, in metres, as in the ground_map.tif of `obliq get`; ground
is taken to lie at `descriptor.map_reference_height_m`.
"""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire

from .places import A_M, F, STEPS, Floats, World, locate

if TYPE_CHECKING:
    from .frame import Frame

NO_VALUE = -9999.0
OUTSIDE, UNKNOWN = 255, 254  # states of pixels off the sector, and of bins without a state plane
# Pixels between exactly projected points: over 1 km the plane's curvature leaves (1 km)^2 / 8 R = 2 cm.
LATTICE = 16
MOST_PIXELS = 2048


def direct(latitude_deg: float, longitude_deg: float, east_m: Floats, north_m: Floats) -> tuple[Floats, Floats]:
    """The geodesic from a point: T. Vincenty, "Direct and inverse solutions of geodesics on the ellipsoid", Survey
    Review 23 (1975), within 0.1 mm."""
    s = np.hypot(east_m, north_m)
    alpha = np.arctan2(east_m, north_m)
    b = A_M * (1 - F)
    u1 = np.arctan((1 - F) * np.tan(np.radians(latitude_deg)))
    sigma1 = np.arctan2(np.tan(u1), np.cos(alpha))
    sin_alpha = np.cos(u1) * np.sin(alpha)
    cos2 = 1 - sin_alpha**2
    u2 = cos2 * (A_M**2 - b**2) / b**2
    aa = 1 + u2 / 16384 * (4096 + u2 * (-768 + u2 * (320 - 175 * u2)))
    bb = u2 / 1024 * (256 + u2 * (-128 + u2 * (74 - 47 * u2)))
    sigma = s / (b * aa)
    for _ in range(8):
        middle = np.cos(2 * sigma1 + sigma)
        sigma = s / (b * aa) + bb * np.sin(sigma) * (middle + bb / 4 * (
            np.cos(sigma) * (2 * middle**2 - 1) - bb / 6 * middle * (4 * np.sin(sigma)**2 - 3) * (4 * middle**2 - 3)))
    middle = np.cos(2 * sigma1 + sigma)
    latitude = np.arctan2(
        np.sin(u1) * np.cos(sigma) + np.cos(u1) * np.sin(sigma) * np.cos(alpha),
        (1 - F) * np.hypot(sin_alpha, np.sin(u1) * np.sin(sigma) - np.cos(u1) * np.cos(sigma) * np.cos(alpha)))
    lam = np.arctan2(np.sin(sigma) * np.sin(alpha), np.cos(u1) * np.cos(sigma) - np.sin(u1) * np.sin(sigma) * np.cos(alpha))
    c = F / 16 * cos2 * (4 + F * (4 - 3 * cos2))
    lam -= (1 - c) * F * sin_alpha * (sigma + c * np.sin(sigma) * (middle + c * np.cos(sigma) * (2 * middle**2 - 1)))
    return np.degrees(latitude), longitude_deg + np.degrees(lam)


def inverse(latitude_deg: float, longitude_deg: float, latitudes_deg: Floats, longitudes_deg: Floats) -> tuple[Floats, Floats]:
    """East and north of points within some 1,000 km: direct() turned round on the tangent plane of the first point, where
    nothing happens at a pole. A step leaves (s / R)^2 / 2 of the error: under a micrometre."""
    tangent = World(latitude_deg, longitude_deg, 1.0)
    x, _, z = tangent.world(latitudes_deg, longitudes_deg, 0.0)
    east, north = x, z
    for _ in range(STEPS):
        dx, _, dz = tangent.world(*direct(latitude_deg, longitude_deg, east, north), 0.0)
        east, north = east + x - dx, north + z - dz
    return east, north


@dataclasses.dataclass(frozen=True)
class Grid:
    """North up. left_m and top_m: the outer edges, from the antenna."""

    width: int
    height: int
    pixel_m: float
    left_m: float
    top_m: float

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """left, right, bottom, top."""
        return (self.left_m, self.left_m + self.width * self.pixel_m, self.top_m - self.height * self.pixel_m, self.top_m)


def sector(frame: Frame) -> tuple[float, float, float, float]:
    """Edges of the bins that the frame has, each of a window's bins standing for its step: start and width of an azimuth
    bin in degrees, start and spacing of a range bin in metres."""
    d, azimuth, ranges = frame.descriptor, frame.azimuth_run, frame.range_run
    return (d.azimuth_start_deg + azimuth.first * d.azimuth_width_deg, azimuth.step * d.azimuth_width_deg,
            d.range_start_m + ranges.first * d.range_spacing_m, ranges.step * d.range_spacing_m)


def north_up(frame: Frame, most: int = MOST_PIXELS) -> Grid:
    """The grid that just holds the sector, as fine as the range bins or `most` pixels allow."""
    start, width, r0, spacing = sector(frame)
    n_azimuth, n_range = frame.shape
    end, r1 = start + n_azimuth * width, r0 + n_range * spacing
    steps = int(np.ceil((end - start) / 2))
    bearings = np.unique(np.concatenate([np.linspace(start, end, steps + 1),
                                         np.arange(np.ceil(start / 90), end / 90 + 1e-12) * 90]))
    pose = frame.pose
    latitude, longitude, away = locate_exactly(frame.descriptor, bearings, np.array([r0, r1]))
    assert pose.latitude_deg is not None and pose.longitude_deg is not None
    if not away[:, 1].any():  # the swath does not reach the ground: as if the antenna stood on it
        east, north = (np.array([[r0, r1]]) * turn(np.radians(bearings))[:, None] for turn in (np.sin, np.cos))
    else:
        east, north = inverse(pose.latitude_deg, pose.longitude_deg, latitude, longitude)
    left, right, bottom, top = east.min(), east.max(), north.min(), north.max()
    extent = max(right - left, top - bottom)
    pixel = max(spacing, extent / most)

    def pixels(length: float) -> int:
        return int(np.clip(np.ceil(length / pixel - 1e-6), 1, most))

    return Grid(pixels(right - left), pixels(top - bottom), float(pixel), float(left), float(top))


def locate_exactly(descriptor: wire.FrameDescriptor, bearings: Floats, ranges: Floats) -> tuple[Floats, Floats, Floats]:
    """As places.locate(), without its interpolation."""
    parts = [locate(descriptor, np.array([bearing]), ranges) for bearing in bearings]
    latitude, longitude, away = (np.concatenate([part[i] for part in parts]) for i in range(3))
    return latitude, longitude, away


def bins_on(frame: Frame, grid: Grid) -> npt.NDArray[np.int64]:
    """[height, width]: azimuth row * range bins + range column of each pixel; -1 off the sector."""
    d, pose = frame.descriptor, frame.pose
    world = World(d.origin_latitude_deg, d.origin_longitude_deg, d.radius_factor)
    columns = np.arange(0, grid.width + LATTICE, LATTICE)
    rows = np.arange(0, grid.height + LATTICE, LATTICE)
    east = grid.left_m + (columns + 0.5) * grid.pixel_m
    north = grid.top_m - (rows + 0.5) * grid.pixel_m
    assert pose.latitude_deg is not None and pose.longitude_deg is not None
    latitude, longitude = direct(pose.latitude_deg, pose.longitude_deg, *np.meshgrid(east, north))
    x, y, z = world.world(latitude, longitude, d.map_reference_height_m)
    start, width, r0, spacing = sector(frame)
    n_azimuth, n_range = frame.shape
    found = np.empty((grid.height, grid.width), np.int64)
    for top in range(0, grid.height, 256):  # strips: no great arrays
        strip = slice(top, min(grid.height, top + 256))
        dx, dy, dz = (_between(values, strip, grid.width) for values in
                      (x - d.antenna_x_m, y - d.antenna_y_m, z - d.antenna_z_m))
        k = np.floor((np.sqrt(dx * dx + dy * dy + dz * dz) - r0) / spacing)
        turns = (np.degrees(np.arctan2(dx, dz) - d.north_rad) - start) % 360
        i = np.floor(turns / width)
        if n_azimuth * width > 359.999:
            i = np.minimum(i, n_azimuth - 1)
        inside = (i < n_azimuth) & (k >= 0) & (k < n_range)
        found[strip] = np.where(inside, i * n_range + k, -1)
    return found


def _between(values: Floats, strip: slice, width: int) -> Any:
    """Values on the lattice, bilinearly, at the pixels of some rows."""
    row, column = np.arange(strip.start, strip.stop), np.arange(width)
    r, c = row // LATTICE, column // LATTICE
    v, u = ((row % LATTICE) / LATTICE)[:, None], ((column % LATTICE) / LATTICE)[None, :]
    left = (1 - v) * values[r][:, c] + v * values[r + 1][:, c]
    right = (1 - v) * values[r][:, c + 1] + v * values[r + 1][:, c + 1]
    return (1 - u) * left + u * right


def is_ideal(frame: Frame) -> bool:
    """No receiver has added anything to the echoes or changed their law in range: a bin without a sample has no value, and a
    picture may make up for the range. As in `obliq get`."""
    return all(getattr(frame.settings, name) in (None, value) for name, value in frame.settings.ideal.items())


def levels(frame: Frame) -> npt.NDArray[np.float32]:
    """dB of |iq|, or of power where there is no iq, or of the video; NO_VALUE where that is 0. [azimuth, range], float32."""
    power: npt.NDArray[np.float64]
    if frame.iq is not None:
        power = frame.iq.real.astype("f8")**2 + frame.iq.imag.astype("f8")**2
    elif frame.power is not None:
        power = frame.power
    elif frame.video is not None:
        steps = np.iinfo(frame.video.dtype).max - 1
        span_db, floor_db = frame.descriptor.settings.video_span_db, frame.descriptor.video_floor_db
        return np.where(frame.video > 0, floor_db + (frame.video.astype("f8") - 1) * span_db / steps, NO_VALUE).astype("f4")
    else:
        raise ValueError("the frame has neither iq, power nor video: nothing to draw")
    there = (power >= np.finfo("f8").tiny) & np.isfinite(power)
    if frame.count is not None and is_ideal(frame):
        there &= frame.count > 0
    return np.where(there, 10 * np.log10(np.where(there, power, 1)), NO_VALUE).astype("f4")


def level_name(frame: Frame) -> str:
    """Of levels(), with its unit."""
    if frame.iq is not None:
        return f"magnitude, dB re {frame.unit}"
    return f"{'video' if frame.power is None else 'power'}, dB re {frame.power_unit}"


def levels_on(frame: Frame, grid: Grid) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
    """Level (float32) and state (uint8) of each pixel."""
    bins = bins_on(frame, grid)
    inside = bins >= 0
    flat = levels(frame).ravel()
    level = np.where(inside, flat[bins], np.float32(NO_VALUE)).astype("f4")
    if frame.state is not None:
        state = np.where(inside, frame.state.ravel()[bins], OUTSIDE)
    else:
        state = np.where(inside, np.where(level == NO_VALUE, UNKNOWN, 1), OUTSIDE)
    return level, state.astype("u1")
