"""Targets over real relief against sums by hand: ranges, bearings, the share that is seen, signal to noise.

The oracle is this file: heights by bilinear interpolation of the elevation model as GDAL writes it out, a vertical profile
from antenna to target over an earth of 4/3 of its radius, the radar equation. Cells are finer
than the posts: then the ground of the frames is the bilinear surface between these, too. Skipped without the shared elevation models
or gdal_translate.
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import support
import obliq

SHARED = pathlib.Path(os.environ.get("OBLIQ_SHARED", support.ROOT.parent / "shared")) / "data"
MODELS = {
    "nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif": {"at": (36.305, -107.585), "height": 2900.0, "bearing": 0.0, "cell": 5.0,
                                                     "area": (-107.705, 36.2965, -107.466, 36.5165)},
    "la_nasadem_30m/NASADEM_HGT_n34w119.tif": {"at": (34.22, -118.20), "height": 2200.0, "bearing": 10.0, "cell": 4.0,
                                               "area": (-118.38, 34.20, -118.02, 34.42)},
}
EQUATOR_M, FLATTENING, K = 6378137.0, 1 / 298.257223563, 4 / 3
TOP_M = 60.0
GAMMA = 10 ** -1.5  # of "terrain", as shipped
PULSE_M = 299792458.0 * 0.25e-6 / 2
SCENE = """
[terrain]
dem = ["{dem}"]
area = [{area}]
cell_m = {cell}
[antenna]
latitude_deg = {latitude}
longitude_deg = {longitude}
height_m = {height}
height_reference = "datum"
bearing_deg = {bearing}
[radar]
frequency_ghz = 9.4
power_w = 50e3
gain_db = 33.0
sector_deg = 60.0
r_min_m = 3000.0
r_max_m = 20000.0
[bins]
azimuth = 256
range = 2048
[frustum]
kind = "sweep"
planes_per_bin = 8
[beam]
pattern = "gaussian"
width_deg = 3.0
[pulse]
kind = "rectangular"
length_us = 0.25
[receiver]
noise = true
noise_figure_db = 4.0
"""


class Elevation:
    """A geographic elevation model, bilinear between the middles of its cells."""

    def __init__(self, path, folder):
        about = json.loads(subprocess.run(["gdalinfo", "-json", str(path)], check=True, capture_output=True).stdout)
        raw = pathlib.Path(folder) / "dem.bin"
        subprocess.run(["gdal_translate", "-q", "-of", "ENVI", "-ot", "Float64", str(path), str(raw)], check=True)
        self.heights = np.fromfile(raw, "<f8").reshape(about["size"][1], about["size"][0])
        self.west, self.dx, _, self.north, _, self.dy = about["geoTransform"]

    def at(self, latitude, longitude):
        column = (np.asarray(longitude) - self.west) / self.dx - 0.5
        row = (np.asarray(latitude) - self.north) / self.dy - 0.5
        i, j = np.floor(column).astype(int), np.floor(row).astype(int)
        u, v = column - i, row - j
        h = self.heights
        return (h[j, i] * (1 - u) + h[j, i + 1] * u) * (1 - v) + (h[j + 1, i] * (1 - u) + h[j + 1, i + 1] * u) * v


def earth_fixed(latitude, longitude, height):
    e2 = FLATTENING * (2 - FLATTENING)
    la, lo = np.radians(latitude), np.radians(longitude)
    n = EQUATOR_M / np.sqrt(1 - e2 * np.sin(la) ** 2)
    return np.stack([(n + height) * np.cos(la) * np.cos(lo), (n + height) * np.cos(la) * np.sin(lo),
                     (n * (1 - e2) + height) * np.sin(la)], -1)


def seen_from(antenna, latitude, longitude, height):
    """East, north and up of points in the antenna's own axes, with 1 - 1/k of the earth's fall taken out."""
    la, lo = math.radians(antenna[0]), math.radians(antenna[1])
    axes = np.array([[-math.sin(lo), math.cos(lo), 0],
                     [-math.sin(la) * math.cos(lo), -math.sin(la) * math.sin(lo), math.cos(la)],
                     [math.cos(la) * math.cos(lo), math.cos(la) * math.sin(lo), math.sin(la)]])
    own = (earth_fixed(latitude, longitude, height) - earth_fixed(*antenna)) @ axes.T
    fall = (own[..., 0] ** 2 + own[..., 1] ** 2) / (2 * 6.371e6)
    own[..., 2] += (1 - 1 / K) * fall
    return own


def lit_facets(ground, antenna, bearing_deg, from_m, to_m):
    """Facets of the ground along these bearings, between these slant ranges at least, as the antenna sees them: azimuth, slant range,
    sine of elevation, and area square to the line of sight, in m^2, 0 where what is nearer hides it. A few bearings at a time."""
    way = np.arange(60.0, to_m, 2.0)[None, :]
    first = np.searchsorted(way[0], math.sqrt(max(0.0, from_m ** 2 - (antenna[2] + 100) ** 2)))
    parts = [facets_from(ground, antenna, np.radians(bearing_deg[k:k + 17])[:, None], way, first)
             for k in range(0, len(bearing_deg) - 1, 16)]
    return [np.concatenate(part) for part in zip(*parts)]


def facets_from(ground, antenna, bearing, way, first):
    """lit_facets of neighbouring bearings, from step `first` of the way on: what lies before it only hides."""
    # Places on the ellipsoid by its two radii of curvature at the antenna, as far out as a beam's width matters.
    la = math.radians(antenna[0])
    e2 = FLATTENING * (2 - FLATTENING)
    along = EQUATOR_M * (1 - e2) / (1 - e2 * math.sin(la) ** 2) ** 1.5
    across = EQUATOR_M / math.sqrt(1 - e2 * math.sin(la) ** 2)
    latitude = antenna[0] + np.degrees(way * np.cos(bearing) / along)
    longitude = antenna[1] + np.degrees(way * np.sin(bearing) / (across * np.cos(np.radians((latitude + antenna[0]) / 2))))
    at = seen_from(antenna, latitude, longitude, ground.at(latitude, longitude))
    middle = (at[1:, 1:] + at[:-1, :-1] + at[:-1, 1:] + at[1:, :-1]) / 4
    slope = middle[..., 2] / np.hypot(middle[..., 0], middle[..., 1])
    is_seen = (slope >= np.maximum.accumulate(slope, axis=1))[:, first:]
    at, middle = at[:, first:], middle[:, first:]
    area = np.cross(at[1:, 1:] - at[:-1, :-1], at[:-1, 1:] - at[1:, :-1]) / 2
    area *= np.sign(area[..., 2:])  # upwards
    r = np.linalg.norm(middle, axis=-1)
    facing = np.maximum(0, -np.sum(area * middle, axis=-1) / r)
    return np.arctan2(middle[..., 0], middle[..., 1]), r, middle[..., 2] / r, facing * is_seen


def clutter_in(ground, antenna, boresight_deg, range_m):
    """Of a bin of the frame: gamma over each facet's area square to the line of sight, seen past all that is nearer, through
    beam and pulse, a cross section in m^2 at range_m."""
    azimuth, r, sine, area = lit_facets(ground, antenna, boresight_deg + np.arange(-4.5, 4.5001, 0.015),
                                        range_m - 2 * PULSE_M, range_m + 2 * PULSE_M)
    own = np.degrees(np.arcsin(np.sqrt(1 - sine ** 2) * np.sin(azimuth - math.radians(boresight_deg))))
    gain = np.exp(-4 * math.log(2) * (own / 3.0) ** 2)
    pulse = np.maximum(0, 1 - np.abs(r - range_m) / PULSE_M)
    return GAMMA * np.sum(area * gain ** 2 * pulse ** 2 * (range_m / r) ** 4)


LACKING = [name for name in MODELS if not (SHARED / name).is_file()]


class BaseRelief(unittest.TestCase):
    model = ""

    def check_model(self, name, about):
        generator = np.random.default_rng(7)
        with tempfile.TemporaryDirectory() as folder:
            ground = Elevation(SHARED / name, folder)
            latitude, longitude = about["at"]
            antenna = (latitude, longitude, about["height"])
            text = SCENE.format(dem=SHARED / name, cell=about["cell"], area=", ".join(map(str, about["area"])), latitude=latitude,
                                longitude=longitude, height=about["height"], bearing=about["bearing"])
            targets = []
            while len(targets) < 40:
                bearing = math.radians(about["bearing"] + generator.uniform(-28, 28))
                distance = generator.uniform(4000, 18500)
                at = (latitude + distance * math.cos(bearing) / 111000, longitude + distance * math.sin(bearing) /
                      (111320 * math.cos(math.radians(latitude))))
                if about["area"][1] + 0.002 < at[0] < about["area"][3] - 0.002 and \
                        about["area"][0] + 0.002 < at[1] < about["area"][2] - 0.002:
                    targets.append({"id": len(targets) + 1, "latitude_deg": at[0], "longitude_deg": at[1], "height_m": 0.0,
                                    "rcs_dbsm": 20.0, "swerling": 0, "top_m": TOP_M})
            with support.daemon(text) as address, obliq.connect(address) as server:
                frame = server.render(planes="power", as_live=True, radar=server.info.radars[0], targets=targets, truth=True)
                bare = server.render(planes="power", as_live=True, radar=server.info.radars[0])
        wavelength = 299792458.0 / 9.4e9
        noise_w = 1.380649e-23 * (290 + 290 * (10 ** 0.4 - 1)) / 0.25e-6
        constant = 50e3 * (10 ** 3.3) ** 2 * wavelength ** 2 / (4 * math.pi) ** 3
        partly, worst_share, worst_db, worst_m = 0, 0.0, 0.0, 0.0
        beside = []  # dB by which the ratio of a target to its bin's clutter is off
        for target, record in zip(targets, frame.targets):
            n = 12000
            share = np.linspace(0, 1, n, endpoint=False)[1:]
            la = latitude + share * (target["latitude_deg"] - latitude)
            lo = longitude + share * (target["longitude_deg"] - longitude)
            way = seen_from(antenna, la, lo, ground.at(la, lo))
            foot_h = float(ground.at(target["latitude_deg"], target["longitude_deg"]))
            foot = seen_from(antenna, np.array([target["latitude_deg"]]), np.array([target["longitude_deg"]]), foot_h)[0]
            d = math.hypot(foot[0], foot[1])
            slope = np.max(way[:, 2] / np.hypot(way[:, 0], way[:, 1]))
            seen = min(1.0, max(0.0, (TOP_M - max(0.0, slope * d - foot[2])) / TOP_M))
            range_m = float(np.linalg.norm(foot))
            worst_m = max(worst_m, abs(range_m - record["range_m"]))
            off_deg = (math.degrees(math.atan2(foot[0], foot[1])) - record["bearing_deg"] + 180) % 360 - 180
            self.assertLess(abs(off_deg), 0.01)
            worst_share = max(worst_share, abs(seen - record["share_seen"]))
            partly += 0.02 < seen < 0.98
            if seen > 0.1:
                snr = 10 * math.log10(constant * 100 * record["share_seen"] / range_m ** 4 / noise_w)
                worst_db = max(worst_db, abs(snr - record["snr_db"]))
                # And the power is in the bin that the truth names: with the loss of the beam and of the gate off their middles, at most 6 dB.
                at = record["azimuth_bin"], record["range_bin"]
                added = (frame.power[at] - bare.power[at]) / noise_w
                self.assertLess(abs(10 * math.log10(max(added, 1e-30)) - snr), 6.5, target)
            if seen > 0.5 and len(beside) < 10:
                beside.append(self.ratio_error_db(ground, antenna, about, frame, bare, target, record, foot, seen))
        print(f"{name}: {len(targets)} targets, {partly} seen in part: share off by {worst_share:.4f}, "
              f"SNR by {worst_db:.4f} dB, range by {worst_m:.2f} m, target to clutter of {len(beside)} by "
              f"{max(map(abs, beside)):.3f} dB", flush=True)
        self.assertGreater(partly, 0)
        self.assertEqual(len(beside), 10)
        self.assertLess(max(map(abs, beside)), 0.1)
        self.assertLess(worst_db, 0.1)
        self.assertLess(worst_share, 0.02)
        self.assertLess(worst_m, 2)

    @staticmethod
    def ratio_error_db(ground, antenna, about, frame, bare, target, record, foot, seen):
        """In the bin that the truth names: target over clutter of the frame, less that of sums by hand."""
        k, m = record["azimuth_bin"], record["range_bin"]
        boresight_deg = about["bearing"] - 30 + (k + 0.5) * 60 / frame.power.shape[0]
        range_m = 3000 + (m + 0.5) * 17000 / frame.power.shape[1]
        clutter_m2 = clutter_in(ground, antenna, boresight_deg, range_m)
        r = np.linalg.norm(foot)
        own = np.degrees(np.arcsin(math.hypot(foot[0], foot[1]) / r *
                                   np.sin(np.arctan2(foot[0], foot[1]) - math.radians(boresight_deg))))
        gain = np.exp(-4 * math.log(2) * (own / 3.0) ** 2)
        pulse = max(0, 1 - abs(r - range_m) / PULSE_M)
        echo_m2 = 10 ** (target["rcs_dbsm"] / 10) * seen * (gain * pulse) ** 2 * (range_m / r) ** 4
        found = (frame.power[k, m] - bare.power[k, m]) / bare.power[k, m]
        print(f"    {boresight_deg:.1f} deg {range_m:.0f} m: {10 * math.log10(found):.2f} dB in the frame, "
              f"{10 * math.log10(echo_m2 / clutter_m2):.2f} by hand, ground {10 * math.log10(clutter_m2):.1f} dBsm")
        return 10 * math.log10(found * clutter_m2 / echo_m2)

    def test_targets_over_mountains(self):
        self.check_model(self.model, MODELS[self.model])


# A class a model, so that ctest runs them side by side.
is_lacking = unittest.skipIf(LACKING or not shutil.which("gdal_translate"), f"no {LACKING[0] if LACKING else 'gdal_translate'}")


@is_lacking
class NewMexico(BaseRelief):
    model = list(MODELS)[0]


@is_lacking
class LosAngeles(BaseRelief):
    model = list(MODELS)[1]


del BaseRelief  # no test of its own

if __name__ == "__main__":
    unittest.main()
