"""Doppler of ground over real relief against sums over facets by hand.

A canceller without a beam leaves of each sharp bin (2 sin(pi f / PRF))^2 / 2 of its power: at a PRF above all frequencies that says the
f at which the program takes it. The oracle takes each facet of the bilinear elevation model at its own line of sight.
"""
import math
import tempfile
import unittest

import numpy as np

import support
import obliq
from relief_test import LACKING, MODELS, SCENE, SHARED, Elevation, lit_facets, shutil

VELOCITY_M_S = (90.0, 120.0, -4.0)  # north, east, up
WAVELENGTH_M = 299792458.0 / 9.4e9
PRF_HZ = 40000.0
BEAM_DEG = 3.0


def doppler_hz(azimuth, sine):
    level = np.sqrt(1 - sine ** 2)
    return 2 / WAVELENGTH_M * (level * (VELOCITY_M_S[0] * np.cos(azimuth) + VELOCITY_M_S[1] * np.sin(azimuth)) + VELOCITY_M_S[2] * sine)


@unittest.skipIf(LACKING or not shutil.which("gdal_translate"), f"no {LACKING[0] if LACKING else 'gdal_translate'}")
class DopplerOverRelief(unittest.TestCase):
    def check_model(self, name, about):
        generator = np.random.default_rng(11)
        latitude, longitude = about["at"]
        antenna = (latitude, longitude, about["height"])
        text = SCENE.split("[beam]")[0].format(dem=SHARED / name, cell=about["cell"], area=", ".join(map(str, about["area"])),
                                               latitude=latitude, longitude=longitude, height=about["height"], bearing=about["bearing"])
        text = text.replace("[antenna]", "[antenna]\nvelocity_north_m_s = %g\nvelocity_east_m_s = %g\nvelocity_up_m_s = %g" % VELOCITY_M_S)
        sharp = {"beam_pattern": "off", "pulse_kind": "off", "prf_hz": PRF_HZ, "canceller": 1}
        with tempfile.TemporaryDirectory() as folder, support.daemon(text) as address, obliq.connect(address) as server:
            ground = Elevation(SHARED / name, folder)
            radar = server.info.radars[0]
            still = server.render(planes="power", as_live=True, radar=radar, settings={**sharp, "mode": "map"}).power
            left = server.render(planes="power", as_live=True, radar=radar, settings={**sharp, "mode": "mti"}).power
            n_azimuth, n_range = still.shape
            bearings = about["bearing"] - 30 + (np.arange(n_azimuth) + 0.5) * 60 / n_azimuth
            ranges = 3000 + (np.arange(n_range) + 0.5) * 17000 / n_range
            worst_hz, places, spread_hz = 0.0, 0, []
            while places < 10:
                k, m = generator.integers(40, n_azimuth - 40), generator.integers(200, n_range - 200)
                rows = slice(k - 20, k + 21)
                gates = slice(m - 2, m + 3)
                if not np.all(still[k, gates] > 0):
                    continue
                places += 1
                # Of the program: each sharp bin's Doppler, through a beam.
                with np.errstate(divide="ignore", invalid="ignore"):
                    own_hz = np.arcsin(np.sqrt(np.clip(left[rows, gates] / still[rows, gates] / 2, 0, 1))) * PRF_HZ / math.pi
                off = np.arcsin(np.sin(np.radians(bearings[rows] - bearings[k])))[:, None]
                beam = np.exp(-8 * math.log(2) * (np.degrees(off) / BEAM_DEG) ** 2)
                power = still[rows, gates] * beam
                found_hz = np.nansum(np.where(power > 0, power * own_hz, 0)) / np.sum(power)
                # By hand.
                edge_deg = 20.5 * 60 / n_azimuth
                azimuth, r, sine, area = lit_facets(ground, antenna, bearings[k] + np.arange(-edge_deg, edge_deg, 0.02),
                                                    ranges[m - 2] - 20, ranges[m + 2] + 20)
                half_m = 17000 / n_range / 2
                inside = (r >= ranges[m - 2] - half_m) & (r < ranges[m + 2] + half_m)
                row = np.floor((np.degrees(azimuth) - about["bearing"] + 30) / (60 / n_azimuth)).astype(int)
                beam_by_row = np.exp(-8 * math.log(2) * ((row + 0.5) * 60 / n_azimuth - 30 + about["bearing"] - bearings[k]) ** 2 /
                                     BEAM_DEG ** 2)
                weight = area * inside * beam_by_row / r ** 4
                hz = doppler_hz(azimuth, sine)
                wanted_hz = np.sum(weight * hz) / np.sum(weight)
                spread_hz.append(math.sqrt(np.sum(weight * (hz - wanted_hz) ** 2) / np.sum(weight)))
                worst_hz = max(worst_hz, abs(found_hz - abs(wanted_hz)))
                # What level ground would say there.
                print(f"    {bearings[k]:.1f} deg {ranges[m]:.0f} m: {found_hz:.1f} Hz, by hand {wanted_hz:.1f}", flush=True)
        print(f"{name}: centroid of the beam's Doppler off by {worst_hz:.2f} Hz at most, width {np.mean(spread_hz):.0f} Hz", flush=True)
        self.assertLess(worst_hz, 5)

    def test_centroids_over_two_mountain_models(self):
        for name, about in MODELS.items():
            with self.subTest(name):
                self.check_model(name, about)


if __name__ == "__main__":
    unittest.main()
