"""Trains of pulses as a Python program gets them: live and once, recorded and replayed, saved, in data sets, and their
range-Doppler map."""
import contextlib
import dataclasses
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import support
from support import obliq, programs
from targets_test import north_of

LIGHT_M_S = 299792458.0
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1500.0
velocity_east_m_s = 120.0
[radar]
name = "one"
mode = "pulses"
frequency_ghz = 9.4
power_w = 20e3
gain_db = 33.0
sector_deg = 24.0
r_min_m = 3000.0
r_max_m = 9000.0
[beam]
pattern = "gaussian"
width_deg = 3.0
[pulse]
kind = "rectangular"
length_us = 0.25
prf_hz = 4000.0
[doppler]
pulses = 32
[receiver]
noise = true
[bins]
azimuth = 96
range = 160
[scan]
dwell_bins = 24
rate_deg_s = 60.0
"""
SCANNING = SCENE + 'mode = "sector"\n'


@contextlib.contextmanager
def server_of(text):
    """A client of an obliqd of our own."""
    with support.daemon(text) as address, obliq.connect(address) as server:
        yield server


@contextlib.contextmanager
def replay_of(recording):
    """A client of a replay that begins anew at the end."""
    with programs.replay(recording, "--loop") as replay, obliq.connect(replay.address) as server:
        yield server


class Pulses(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_mover_stands_at_its_velocity(self):
        with server_of(SCENE) as server:
            pose = {"velocity_east_m_s": 0.0}
            target = {"id": 3, "rcs_dbsm": 60, "swerling": 0, **north_of(6000, 200), "height_reference": "datum",
                      "velocity_north_m_s": -15.0}
            target["height_m"] = 1400.0
            frame = server.render({"noise": False}, pose, radar="one", as_live=True, planes="pulses power", targets=[target], truth=True)
            dwell, = frame.trains
            self.assertEqual(dwell.pulses.shape, (32, 160))
            self.assertEqual(frame.power.shape, (96, 160))
            truth = frame.targets[0]
            found = dwell.range_doppler(cells=256)
            self.assertEqual(found.map.shape, (256, 160))
            cell, gate = np.unravel_index(np.argmax(np.abs(found.map)), found.map.shape)
            self.assertAlmostEqual(found.velocity_m_s[cell], truth["closing_m_s"], delta=0.3)
            self.assertLess(abs(found.range_m[gate] - truth["range_m"]), 40)
            # Its level is that of the pulses: a window's weights add up to 1.
            self.assertAlmostEqual(abs(found.map[cell, gate]) / abs(dwell.pulses[16, gate]), 1, delta=0.05)
            self.assertAlmostEqual(dwell.times_s[0], -31 / 2 / 4000, places=12)
            # A direct sum over the pulses' own times says the same.
            direct = dataclasses.replace(dwell, period_ns=(250000.0, 250000.000001)).range_doppler(cells=256)
            self.assertLess(np.abs(direct.map - found.map).max(), 1e-4 * np.abs(found.map).max())
            for window in ("none", "hann", "blackman_harris", np.ones(32)):
                dwell.range_doppler(window)
            for bad in ("triangle", np.ones(31), np.zeros(32), np.full(32, np.nan)):
                with self.assertRaisesRegex(ValueError, "window"):
                    dwell.range_doppler(bad)
            with self.assertRaisesRegex(ValueError, "cells"):
                dwell.range_doppler(cells=31)

    def test_the_same_request_has_the_same_bits_in_both_encodings_and_windows(self):
        with server_of(SCENE) as server:
            one = server.render(radar="one", as_live=True, planes="pulses")
            self.assertEqual(one.planes(), {})
            again = server.render(radar="one", as_live=True, planes="pulses power state")
            self.assertEqual(one.trains[0].pulses.tobytes(), again.trains[0].pulses.tobytes())
            packed = server.render(radar="one", as_live=True, planes="pulses", encoding="ci16").trains[0].pulses
            self.assertLess(np.abs(packed - one.trains[0].pulses).max(), 1e-4 * np.abs(one.trains[0].pulses).max())
            part = server.render(radar="one", as_live=True, planes="pulses", window=obliq.Window(range=slice(20, 100, 4))).trains[0]
            self.assertEqual(part.pulses.tobytes(), np.ascontiguousarray(one.trains[0].pulses[:, 20:100:4]).tobytes())
            self.assertEqual(part.range_m.shape, (20,))
            other = server.render(radar="one", as_live=True, planes="pulses", settings={"noise_frame": 5}).trains[0].pulses
            self.assertNotEqual(other.tobytes(), one.trains[0].pulses.tobytes())
            long = server.render(radar="one", as_live=True, planes="pulses", settings={"doppler_pulses": 1024, "prf_hz": 15000.0, "range_bins": 1500},
                                 pose={"velocity_east_m_s": 0.0}).trains[0]
            self.assertEqual(long.pulses.shape, (1024, 1500))

    def test_what_no_train_can_be_made_of_is_refused(self):
        with server_of(SCENE) as server:
            for field, settings, words in (("prf_hz", {"prf_hz": 20000.0}, "at most 16655"),
                                           ("prf_hz", {"pulse_stagger": [1, 0.5], "prf_hz": 10000.0}, "at most 8327"),
                                           ("speckle", {"speckle": "none"}, "independent"),
                                           ("mode", {"beam_pattern": "off"}, "a beam"),
                                           ("doppler_pulses", {"doppler_pulses": 1024}, "at most"),
                                           ("pulse_stagger", {"pulse_stagger": [0.1]}, "0.5")):
                with self.subTest(settings=settings), self.assertRaises(obliq.InvalidValue) as refused:
                    server.render(radar="one", as_live=True, planes="pulses", settings=settings)
                self.assertIn(field, str(refused.exception))
                self.assertIn(words, str(refused.exception))
            with self.assertRaisesRegex(obliq.InvalidValue, "planes"):
                server.render(radar="one", as_live=True, planes="pulses", settings={"mode": "map"})

    def test_a_pass_has_a_train_each_dwell(self):
        with server_of(SCANNING) as server:
            with server.radar("one").stream(planes="pulses power", timeout=60) as frames:
                taken = [next(frames) for _ in range(2)]
            for frame in taken:
                rows = {(train.azimuth.start, train.azimuth.stop) for train in frame.trains}
                self.assertTrue(rows <= {(0, 24), (24, 48), (48, 72), (72, 96)} and rows, rows)
                for train in frame.trains:
                    middle = frame.azimuth_deg[train.azimuth].mean()
                    self.assertAlmostEqual(np.interp(0, train.times_s, train.boresight_deg), middle, places=6)
                    self.assertEqual(abs(train.boresight_rate_deg_s), 60)
                    self.assertEqual(train.boresight_rate_deg_s > 0, frame.scan.clockwise)
            with server.radar("one").wedges(planes="pulses", timeout=60) as parts:
                part = next(parts)
                self.assertEqual(part.train.pulses.shape, (32, 160))
                self.assertIsNone(part.power)
            # Bins alone, and a client that has never heard of pulses.
            frame = server.radar("one").frame(timeout=60)
            self.assertEqual(frame.trains, ())
            self.assertEqual(set(frame.planes()), {"iq", "power", "count", "state"})

    def test_recorded_replayed_and_saved_it_is_the_same(self):
        recording = self.folder / "pulses.obliq"
        with support.daemon(SCANNING) as address:
            subprocess.run([support.BIN / "obliq", "record", address, "--out", recording, "--planes", "pulses,power", "--frames", "2"],
                           check=True, capture_output=True)
        frames = list(obliq.open(recording))
        self.assertEqual(len(frames), 2)
        self.assertTrue(all(frame.trains for frame in frames))
        with replay_of(recording) as server:
            with server.radar("one").stream(planes="pulses power", timeout=60) as replayed:
                again = next(replayed)
        same = next(frame for frame in frames if frame.descriptor.frame_id == again.descriptor.frame_id)
        ours = {train.azimuth.start: train for train in same.trains}
        self.assertEqual(len(ours), len(again.trains))
        for train in again.trains:
            recorded = ours[train.azimuth.start]
            self.assertEqual(train.pulses.tobytes(), recorded.pulses.tobytes())
            self.assertEqual(train.pose, recorded.pose)
            self.assertEqual(train.period_ns, recorded.period_ns)
            self.assertEqual(train.boresight_start_deg, recorded.boresight_start_deg)
        self.is_kept(same, ".npz")

    @support.needs("netCDF4", "zstandard")
    def test_netcdf_and_zstd_keep_them(self):
        with server_of(SCENE) as server:
            frame = server.render(radar="one", as_live=True, planes="pulses power", compress="zstd")
            plain = server.render(radar="one", as_live=True, planes="pulses power")
        self.assertEqual(frame.sha256(), plain.sha256())
        self.is_kept(frame, ".nc")
        frame.power = None
        self.is_kept(frame, ".nc")

    def is_kept(self, frame, suffix):
        """In a file of that kind."""
        path = self.folder / f"frame{suffix}"
        frame.save(path)
        loaded = obliq.load(path)
        self.assertEqual(loaded.sha256(), frame.sha256())
        for one, other in zip(loaded.trains, frame.trains, strict=True):
            self.assertEqual((one.pose, one.period_ns, one.azimuth), (other.pose, other.period_ns, other.azimuth))
            np.testing.assert_array_equal(one.boresight_deg, other.boresight_deg)

    def test_a_data_set_has_them(self):
        poses = [{"latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1500.0 + 10 * k, "bearing_deg": 30.0 * k,
                  "velocity_east_m_s": 90.0} for k in range(3)]
        with support.daemon(SCENE) as server:
            obliq.batch(poses, self.folder / "set", server=server, planes="pulses power", progress=False)
        data = obliq.Dataset(self.folder / "set")
        self.assertEqual(data.arrays(0)["pulses"].shape, (32, 160))
        train, = data[1].trains
        self.assertEqual(train.period_ns, (250000.0,))
        self.assertAlmostEqual(train.boresight_start_deg, 30.0)
        self.assertEqual(train.pose.velocity_east_m_s, 90.0)


if __name__ == "__main__":
    unittest.main()
