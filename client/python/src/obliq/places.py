"""Where a bin lies. PROTOCOL.md has the formula, its error and a worked bin.

World frame: x east, y up, z north of the scene's origin on the WGS84 ellipsoid, metres, refraction in y.
"""
from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire

Floats = npt.NDArray[np.float64]

A_M = 6378137.0  # WGS84
F = 1 / 298.257223563
E2 = F * (2 - F)
STEPS = 5  # leave less than a micrometre
# Ground range is found on azimuths at most so far apart and interpolated between: within 0.05 m for an antenna 50 km
# from the origin, since the earth's fall along a circle of bins is nearly a sine of azimuth.
MOST_ROWS_DEG = 1.0


class World:
    """The frame of one scene origin. Arrays of any one shape go in and come out."""

    def __init__(self, latitude_deg: float, longitude_deg: float, radius_factor: float):
        phi, lam = np.radians(latitude_deg), np.radians(longitude_deg)
        self._k = radius_factor
        self._sin, self._cos = np.sin(phi), np.cos(phi)
        self._n = A_M / np.sqrt(1 - E2 * self._sin**2)
        self._lam = lam
        self._longitude_deg = longitude_deg

    def ellipsoid_y_m(self, x: Any, z: Any) -> Any:
        """The ellipsoid's own y, before refraction."""
        w = 1 / (1 - E2)
        uu = self._cos**2 + w * self._sin**2
        h = self._n + (w - 1) * self._sin * self._cos * z
        c = x**2 + (self._sin**2 + w * self._cos**2) * z**2
        return -c / (h + np.sqrt(np.maximum(0, h**2 - uu * c)))

    def geodetic(self, x: Any, y: Any, z: Any) -> tuple[Any, Any, Any]:
        """Latitude and longitude in degrees, height above the ellipsoid in metres."""
        up = y + (1 - 1 / self._k) * self.ellipsoid_y_m(x, z)
        # Earth-centred axes turned so that the origin's meridian is the first.
        along = self._n + up
        first = along * self._cos - z * self._sin
        third = (self._n * (1 - E2) + up) * self._sin + z * self._cos
        p = np.hypot(first, x)
        # Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23 (1976), one step: within
        # 1e-10 m below 10 km.
        b = A_M * (1 - F)
        theta = np.arctan2(third * A_M, p * b)
        latitude = np.arctan2(third + E2 / (1 - E2) * b * np.sin(theta)**3, p - E2 * A_M * np.cos(theta)**3)
        sine = np.sin(latitude)
        height = p * np.cos(latitude) + third * sine - A_M * np.sqrt(1 - E2 * sine**2)
        longitude = self._longitude_deg + np.degrees(np.arctan2(x, first))
        return np.degrees(latitude), (longitude + 180) % 360 - 180, height

    def world(self, latitude_deg: Any, longitude_deg: Any, height_m: Any) -> tuple[Any, Any, Any]:
        """x, y, z of a geodetic position."""
        phi, lam = np.radians(latitude_deg), np.radians(longitude_deg) - self._lam
        n = A_M / np.sqrt(1 - E2 * np.sin(phi)**2)
        p = (n + height_m) * np.cos(phi)
        first, x = p * np.cos(lam), p * np.sin(lam)
        third = (n * (1 - E2) + height_m) * np.sin(phi)
        d1, d3 = first - self._n * self._cos, third - self._n * (1 - E2) * self._sin
        z = d3 * self._cos - d1 * self._sin
        up = d1 * self._cos + d3 * self._sin
        return x, up - (1 - 1 / self._k) * self.ellipsoid_y_m(x, z), z


def locate(descriptor: wire.FrameDescriptor, azimuth_deg: Floats, range_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Latitude, longitude (degrees) and ground range (m), each [azimuth, range], of bin centres."""
    d = descriptor
    world = World(d.origin_latitude_deg, d.origin_longitude_deg, d.radius_factor)
    azimuth = np.radians(azimuth_deg) + d.north_rad
    span = azimuth[-1] - azimuth[0]
    n = min(len(azimuth), 2 + int(np.degrees(abs(span)) / MOST_ROWS_DEG))
    rows = np.linspace(azimuth[0], azimuth[-1], n)[:, None]
    y = np.full((n, len(range_m)), d.map_reference_height_m)
    for _ in range(STEPS):
        away = np.sqrt(np.maximum(0, range_m**2 - (d.antenna_y_m - y)**2))
        x, z = d.antenna_x_m + away * np.sin(rows), d.antenna_z_m + away * np.cos(rows)
        y = y + d.map_reference_height_m - world.geodetic(x, y, z)[2]
    if n < len(azimuth):
        part = (azimuth - azimuth[0]) / span * (n - 1)
        left = np.minimum(part.astype(int), n - 2)
        part = (part - left)[:, None]
        away, y = ((1 - part) * values[left] + part * values[left + 1] for values in (away, y))
    azimuth = azimuth[:, None]
    latitude, longitude, _ = world.geodetic(d.antenna_x_m + away * np.sin(azimuth), y,
                                            d.antenna_z_m + away * np.cos(azimuth))
    return latitude, longitude, away
