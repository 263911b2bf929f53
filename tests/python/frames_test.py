"""Frames through the package against the files of `obliq get` and `obliq record`: the same bits."""
import json
import unittest

import support
from support import OBLIQ, Folder, obliq, run
import numpy as np

FILES = {"iq": "bins", **{name: name for name in ("power", "count", "state", "material", "building", "height", "returns")}}


def got(folder, *options):
    """What `obliq get` writes, by plane."""
    run(OBLIQ, "get", "--server", support.shared_daemon(), "--radar", "main", "--out", folder, *options)
    return {name: np.load(folder / f"{file}.npy") for name, file in FILES.items() if (folder / f"{file}.npy").exists()}


def bits(values):
    return np.ascontiguousarray(values).view("u1")


class Whole(Folder):
    def setUp(self):
        super().setUp()
        self.server = obliq.connect(support.shared_daemon())
        self.addCleanup(self.server.close)
        self.radar = self.server.radar("main")

    def assert_same(self, frame, planes):
        self.assertEqual(set(frame.planes()), set(planes))
        for name, values in frame.planes().items():
            self.assertEqual((values.dtype, values.shape), (planes[name].dtype, planes[name].shape))
            np.testing.assert_array_equal(bits(values), bits(planes[name]), err_msg=name)

    def test_four_planes_are_those_of_obliq_get(self):
        frame = self.radar.frame()
        self.assert_same(frame, got(self.folder))
        for values in frame.planes().values():
            self.assertTrue(values.flags.c_contiguous)
        told = json.loads((self.folder / "frame.json").read_text())
        np.testing.assert_allclose(frame.azimuth_deg, np.convolve(told["azimuth_edges_deg"], [0.5, 0.5], "valid"))
        np.testing.assert_allclose(frame.range_m, np.convolve(told["range_edges_m"], [0.5, 0.5], "valid"))

    def test_planes_that_are_not_asked_for_are_none(self):
        frame = self.radar.frame(planes="iq state")
        self.assert_same(frame, got(self.folder, "--planes", "iq,state"))
        self.assertIsNone(frame.power)

    def test_labels_are_those_of_obliq_get_and_say_what_the_ground_is(self):
        planes = "power state material building height returns"
        frame = self.radar.frame(planes=planes)
        self.assert_same(frame, got(self.folder, "--planes", planes.replace(" ", ",")))
        lit = frame.power > 0
        np.testing.assert_array_equal(frame.material, np.where(lit, 0, 255))  # bare ground
        np.testing.assert_array_equal(frame.building, 0)
        np.testing.assert_array_equal(np.isnan(frame.height), ~lit)
        ground = frame.descriptor.ground
        self.assertGreaterEqual(np.nanmin(frame.height), ground.lowest_m - 0.1)
        self.assertLessEqual(np.nanmax(frame.height), ground.highest_m + 0.1)
        np.testing.assert_array_equal(frame.returns > 0, frame.state == obliq.STATES.index("sampled"))

    def test_labels_of_a_window_and_of_a_frame_on_request_are_those_of_the_whole(self):
        whole = self.radar.frame(planes="material building height returns")
        window = obliq.Window(azimuth=slice(8, 40, 2), range=slice(10, 90, 3))
        part = self.server.render(self.radar.settings, self.radar.pose, planes="height returns", window=window)
        np.testing.assert_array_equal(part.height, whole.height[8:40:2, 10:90:3])
        np.testing.assert_array_equal(part.returns, whole.returns[8:40:2, 10:90:3])

    @support.needs("zstandard")
    def test_compressed_blocks_bring_the_same_bits(self):
        self.assert_same(self.radar.frame(compress="zstd"), got(self.folder))

    def test_sixteen_bit_integers_bring_the_bits_of_obliq_get_and_are_within_half_a_step(self):
        frame = self.radar.frame(planes="iq", encoding="ci16")
        self.assert_same(frame, got(self.folder, "--planes", "iq", "--encoding", "ci16_le"))
        exact = self.radar.frame(planes="iq").iq
        step = max(abs(exact.real).max(), abs(exact.imag).max()) / 32767  # no block has a larger one
        self.assertLessEqual(max(abs((frame.iq - exact).real).max(), abs((frame.iq - exact).imag).max()), 0.51 * step)
        self.assertFalse(np.array_equal(frame.iq, exact))

    def test_windows_with_steps_bring_those_bins(self):
        window = obliq.Window(azimuth=slice(3, 60, 7), range=slice(10, None, 3))
        frame = self.radar.frame(window=window)
        self.assert_same(frame, got(self.folder, "--azimuths", "3:60:7", "--ranges", "10::3"))
        whole = self.radar.frame()
        np.testing.assert_array_equal(bits(frame.iq), bits(whole.iq[3:60:7, 10::3]))
        np.testing.assert_allclose(frame.azimuth_deg, whole.azimuth_deg[3:60:7])
        np.testing.assert_allclose(frame.range_m, whole.range_m[10::3])
        np.testing.assert_array_equal(frame.azimuth_index, np.arange(64)[3:60:7])
        for mine, its in zip(frame.places(), whole.places()):
            np.testing.assert_allclose(mine, its[3:60:7, 10::3], atol=1e-6)

    def test_frames_of_each_frustum_are_those_of_obliq_get(self):
        for kind in ("sweep", "oblique", "symmetric"):
            settings = self.radar.settings.replace(frustum=kind)
            frame = self.server.render(settings, self.radar.pose)
            self.assert_same(frame, got(self.folder / kind, "--set", f"frustum.kind={kind}"))
            self.assertEqual(frame.settings.frustum, kind)

    def test_a_rendered_frame_is_the_live_frame(self):
        live = self.radar.frame()
        once = self.server.render(live.settings, live.pose)
        self.assertEqual(once.sha256(), live.sha256())
        self.assertNotEqual(once.sha256(), self.server.render(live.settings, live.pose.replace(bearing_deg=61)).sha256())

    def test_a_frame_as_the_live_radar_is_names_only_what_differs(self):
        whole = self.server.render(self.radar.settings.replace(azimuth_bins=8, sector_deg=12.0), self.radar.pose.replace(bearing_deg=33))
        named = self.server.render({"azimuth_bins": 8, "sector_deg": 12.0}, {"bearing_deg": 33}, radar="main", as_live=True)
        self.assertEqual(named.sha256(), whole.sha256())
        self.assertEqual(named.settings, whole.settings)
        several = self.server.render_many([{"bearing_deg": b} for b in (33, 34)], {"azimuth_bins": 8, "sector_deg": 12.0}, radar="main", as_live=True)
        self.assertEqual([frame.pose.bearing_deg for frame in several], [33, 34])
        with self.assertRaises(obliq.UnknownRadar):
            self.server.render({}, {}, radar="nobody", as_live=True)

    def test_planes_follow_the_bins_unless_columns_are_named(self):
        base = self.radar.settings.replace(frustum="sweep", planes_per_bin=3)
        self.assertIsNone(base.pixel_columns, "the server's to make")
        self.assertEqual(self.server.render(base.replace(azimuth_bins=8), self.radar.pose, planes="state").settings.pixel_columns, 24)
        fixed = self.server.render(base.replace(azimuth_bins=8, pixel_columns=40).replace(noise_frame=3), self.radar.pose, planes="state").settings
        self.assertEqual((fixed.pixel_columns, fixed.planes_per_bin), (40, 0))
        self.assertIsNotNone(base.replace(frustum="oblique", pixel_columns=64).pixel_columns)

    def test_many_renders_come_in_their_order(self):
        pose, settings = self.radar.pose, self.radar.settings
        bearings = [7 * k for k in range(11)]
        frames = list(self.server.render_many((pose.replace(bearing_deg=b) for b in bearings), settings, planes="iq"))
        self.assertEqual([frame.pose.bearing_deg for frame in frames], bearings)
        alone = self.server.render(settings, pose.replace(bearing_deg=21), planes="iq")
        self.assertEqual(frames[3].sha256(), alone.sha256())

    def test_a_refused_pose_among_many_stands_in_its_place(self):
        pose, settings = self.radar.pose, self.radar.settings
        poses = [pose, pose.replace(height_m=1e6), (pose, settings.replace(r_max_m=1)), pose]
        found = list(self.server.render_many(poses, settings, planes="state", return_exceptions=True))
        self.assertEqual([type(item) for item in found],
                         [obliq.Frame, obliq.InvalidValue, obliq.InvalidValue, obliq.Frame])
        self.assertEqual(found[1].faults[0].argument, "height_m")
        with self.assertRaises(obliq.InvalidValue):
            list(self.server.render_many(poses, settings, planes="state"))
        self.assertEqual(len(list(self.server.render_many([pose] * 5, settings, planes="state"))), 5)

    def test_a_pass_of_a_scanning_antenna_has_its_dwells(self):
        with self.server.radar("scan").stream(planes="iq state") as passes:
            frame = next(passes)
            back = next(passes)
        self.assertNotEqual(frame.scan.clockwise, back.scan.clockwise)
        rows = sorted(dwell.azimuth.start for dwell in frame.dwells)
        missed = sum(part.stop - part.start for part in frame.missed)
        self.assertEqual(8 * len(rows) + missed, 64)
        times = [dwell.utc for dwell in frame.dwells]
        self.assertEqual(times, sorted(times))
        # A dwell's bits are those of a whole frame at its pose.
        settings = frame.settings.replace(scan_mode="frame")
        whole = self.server.render(settings, frame.dwells[0].pose, planes="iq state")
        part = frame.dwells[0].azimuth
        np.testing.assert_array_equal(bits(frame.iq[part]), bits(whole.iq[part]))

    def test_a_recording_brings_the_frames_that_were_sent(self):
        file = self.folder / "r.obliq"
        run(OBLIQ, "record", "--server", support.shared_daemon(), "--radar", "main", "--rate", "20", "--frames", "5", "--out", file)
        recording = obliq.open(file)
        frames = list(recording)
        self.assertEqual(len(frames), 5)
        self.assertEqual([loss.kind for loss in recording.losses if loss.kind != "aborted"], [])
        self.assertEqual(len(list(recording)), 5)
        self.assertEqual({frame.sha256() for frame in frames}, {self.radar.frame().sha256()})
        self.assertEqual(sorted(frame.utc for frame in frames), [frame.utc for frame in frames])
        only = list(obliq.open(file, planes="state"))
        self.assertEqual(set(only[0].planes()), {"state"})

    def test_what_a_recording_lacks_is_said_and_the_rest_comes(self):
        file = self.folder / "r.obliq"
        run(OBLIQ, "record", "--server", support.shared_daemon(), "--radar", "main", "--rate", "20", "--frames", "6", "--out", file)
        data = file.read_bytes()
        third = data.index(b"OBLQ", len(data) // 2)  # a message in the middle of a frame
        for damaged, kinds, whole in (
                (data[: third + 20] + bytes([data[third + 20] ^ 1]) + data[third + 21:], {"damage", "frame"}, (5,)),
                (data[:third] + b"rubbish" + data[third:], {"damage", "frame"}, (5,)),
                (data[: third + 100], {"cut"}, (2, 3)),
                (data[:third] + data[third + 1000:], {"damage", "frame"}, (4, 5))):  # perhaps into the next one
            file.write_bytes(damaged)
            recording = obliq.open(file)
            self.assertIn(len(list(recording)), whole)
            self.assertEqual({loss.kind for loss in recording.losses} - {"aborted"}, kinds)

    def test_what_is_no_recording_is_refused(self):
        (self.folder / "x").write_bytes(b"nonsense" * 20)
        with self.assertRaisesRegex(obliq.BadStream, "not a recording"):
            obliq.open(self.folder / "x")
        (self.folder / "y").write_bytes(b"")
        with self.assertRaises(obliq.BadStream):
            obliq.open(self.folder / "y")
        with self.assertRaisesRegex(ValueError, "folder"):
            obliq.open(self.folder)


if __name__ == "__main__":
    unittest.main()
