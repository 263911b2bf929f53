"""Live radars: streams, wedges, control, losses, against a daemon."""
import time
import unittest

import support
from support import Folder, obliq, programs
import numpy as np


class Live(unittest.TestCase):
    def setUp(self):
        self.server = obliq.connect(support.shared_daemon(), name="test")
        self.addCleanup(self.server.close)
        self.radar = self.server.radar("main")

    def test_frames_follow_each_other(self):
        with self.radar.stream(rate_hz=50, planes="state") as frames:
            ids = [next(frames).frame_id for _ in range(5)]
        self.assertEqual(ids, sorted(set(ids)))
        self.radar.info()  # the connection goes on
        self.assertEqual(self.server.status().radars[0].subscribers, 0)

    def test_a_loop_that_is_left_ends_its_subscription(self):
        for _ in self.radar.stream(rate_hz=50, planes="state"):
            break
        self.assertEqual(self.radar.info().watchers, 0)

    def test_arrays_are_used_again_where_no_copy_is_wanted(self):
        with self.radar.stream(rate_hz=50, planes="iq", copy=False) as frames:
            first = next(frames)
            kept = first.copy()
            places = {next(frames).iq.ctypes.data for _ in range(20)}
        self.assertLessEqual(len(places), 3)
        np.testing.assert_array_equal(kept.iq, self.radar.frame(planes="iq").iq)

    def test_wedges_make_the_frame(self):
        whole = self.radar.frame()
        seen = np.zeros_like(whole.iq)
        rows = []
        with self.radar.wedges(rate_hz=10) as wedges:
            for wedge in wedges:
                rows.append(wedge.azimuth)
                seen[wedge.azimuth] = wedge.iq
                self.assertEqual(wedge.pose.bearing_deg, 60.0)
                self.assertGreaterEqual(wedge.pose_age_s, wedge.latency_s - 1e-3)
                self.assertEqual(len(wedge.azimuth_deg), wedge.iq.shape[0])
                if len(rows) == 8:
                    break
        self.assertEqual(sorted(part.start for part in rows), list(range(0, 64, 8)))
        np.testing.assert_array_equal(seen, whole.iq)

    def test_a_second_stream_of_a_radar_ends_the_first_with_a_sentence(self):
        first = self.radar.stream(rate_hz=10, planes="state")
        next(first)
        second = self.radar.stream(rate_hz=10, planes="iq")
        self.assertEqual(set(next(second).planes()), {"iq"})
        with self.assertRaisesRegex(obliq.ObliqError, "another stream of radar main"):
            for _ in range(3):
                next(first)
        self.assertEqual(set(next(second).planes()), {"iq"})
        second.close()

    def test_requests_and_two_streams_share_a_connection(self):
        with self.radar.stream(rate_hz=30, planes="state") as one, self.server.radar("scan").stream(planes="state") as two:
            for _ in range(3):
                self.assertEqual(next(one).radar, "main")
                self.assertEqual(self.server.render(self.radar.settings, self.radar.pose, planes="iq").shape, (64, 96))
                self.assertEqual(next(two).radar, "scan")

    def test_a_controller_moves_and_sets_and_everything_is_released(self):
        before = self.radar.info()
        with self.radar.control() as control:
            self.assertTrue(self.radar.info().controlled_by_me)
            accepted = control.set_pose(bearing_deg=0.0)
            self.assertEqual(accepted.coverage, 1.0)
            control.set(r_max_m=9000.0)
            frame = self.radar.frame()
            self.assertEqual((frame.pose.bearing_deg, frame.settings.r_max_m), (0.0, 9000.0))
            control.set_state(freeze=True)
            self.assertTrue(self.radar.info().frozen)
            control.set_state(freeze=False)
            control.set(before.settings)
            control.set_pose(before.pose.replace(sim_time_ns=None, pose_id=None))
        self.assertEqual(self.radar.info().controller, "")
        self.assertEqual(self.radar.frame().pose.bearing_deg, 60.0)

    def test_sent_poses_move_the_antenna_and_refusals_are_told(self):
        before = self.radar.pose.replace(sim_time_ns=None, pose_id=None)
        with self.radar.control() as control:
            for bearing_deg in range(200):
                control.send_pose(bearing_deg=float(bearing_deg))
            self.assertEqual(self.radar.pose.bearing_deg, 199.0)  # an answer comes behind those of all that was sent
            told = []
            control.send_pose(bearing_deg=1e9, on_refused=told.append)
            self.radar.info()
            self.assertIsInstance(told[0], obliq.InvalidValue)
            control.send_pose(height_m=1e9)
            self.radar.info()
            with self.assertRaises(obliq.InvalidValue) as caught:
                control.send_pose(bearing_deg=5.0)
            self.assertEqual([fault.argument for fault in caught.exception.faults], ["height_m"])
            control.send_pose(before)
            self.assertEqual(self.radar.pose.bearing_deg, before.bearing_deg)

    def test_control_is_released_after_an_exception(self):
        with self.assertRaises(KeyError):
            with self.radar.control():
                raise KeyError
        self.assertEqual(self.radar.info().controller, "")

    def test_who_holds_control_is_said(self):
        with obliq.connect(support.shared_daemon(), name="instructor") as other:
            with other.radar("main").control():
                with self.assertRaises(obliq.NotInControl) as caught:
                    with self.radar.control():
                        pass
                self.assertIn("instructor", caught.exception.holder)
                with self.radar.control(force=True) as mine:  # without tokens everybody is an admin
                    mine.set_pose(bearing_deg=60.0)
        self.assertEqual(self.radar.info().controller, "")

    def test_refused_values_name_the_argument(self):
        with self.radar.control() as control:
            with self.assertRaises(obliq.InvalidValue) as caught:
                control.set(r_min_m=-5.0)
            self.assertEqual([fault.argument for fault in caught.exception.faults], ["r_min_m"])
            self.assertIn("allowed", str(caught.exception))
            self.assertIsInstance(caught.exception, ValueError)
            with self.assertRaises(TypeError):
                control.set(r_minm=5)
        with self.assertRaises(obliq.InvalidValue):
            self.radar.frame(window=obliq.Window(azimuth=slice(1000, None)))
        with self.assertRaises(obliq.InvalidValue):
            self.radar.frame(rate_hz=1e9)
        with self.assertRaisesRegex(TypeError, "lacks latitude_deg"):
            self.server.render(None, obliq.Pose(bearing_deg=1))
        with self.assertRaises(obliq.UnknownRadar):
            self.server.radar("nord")
        with self.assertRaisesRegex(ValueError, "name one of main, scan"):
            self.server.radar()

    def test_a_frame_that_is_too_large_is_refused_by_its_limit(self):
        with support.daemon(settings={"server.max_bins": 6000}) as address, obliq.connect(address) as server:
            with self.assertRaises(obliq.OverLimit) as caught:
                server.render({"azimuth_bins": 100, "range_bins": 100}, self.radar.pose)
            self.assertEqual(caught.exception.limit, "max_bins")

    def test_no_frame_in_time_is_said_and_the_connection_goes_on(self):
        with support.daemon() as address, obliq.connect(address) as server:
            radar = server.radar("main")
            with radar.control() as control:
                control.set_state(transmit=False)
                started = time.monotonic()
                with self.assertRaises(TimeoutError):
                    radar.frame(timeout=0.5)
                self.assertLess(time.monotonic() - started, 20)
                control.set_state(transmit=True)
                self.assertEqual(radar.frame().radar, "main")

    def test_the_clocks_of_one_machine_agree(self):
        self.assertLess(abs(self.server.measure_clock()), 0.1)


class Lost(Folder):
    def test_a_daemon_that_is_killed_is_a_lost_connection(self):
        with programs.daemon(support.scene(self.folder)) as daemon:
            server = obliq.connect(daemon.address)
            stream = server.radar("main").stream(rate_hz=20, planes="state")
            next(stream)
            daemon.kill()
            with self.assertRaises(obliq.ConnectionLost):
                for _ in range(100):
                    next(stream)
            with self.assertRaises(ConnectionError):
                server.status()

    def test_a_stream_goes_on_when_the_daemon_is_back(self):
        port = {}
        with support.daemon() as address:
            port["server.port"] = address.split(":")[1]
            server = obliq.connect(address)
            stream = server.radar("main").stream(rate_hz=20, planes="state", reconnect=60)
            before = next(stream)
        # Stopped. Another takes its place while the client tries.
        with support.daemon(settings=port) as address:
            self.assertEqual(address.split(":")[1], port["server.port"])
            after = None
            for _ in range(5):
                after = next(stream)
            self.assertEqual(after.sha256(), before.sha256())
            self.assertEqual(server.status().clients, 1)
            stream.close()
            server.close()

    def test_patience_ends_with_the_loss(self):
        with support.daemon() as address:
            server = obliq.connect(address)
            stream = server.radar("main").stream(rate_hz=20, planes="state", reconnect=0.5)
            next(stream)
        with self.assertRaises((obliq.ConnectionLost, obliq.ServerStopping)):
            for _ in range(1000):
                next(stream)
        server.close()

    def test_memory_is_flat_after_the_second_frame(self):
        def resident_kb():
            with open("/proc/self/statm") as file:
                return int(file.read().split()[1]) * 4

        with obliq.connect(support.shared_daemon()) as server:
            with server.radar("main").stream(rate_hz=100, copy=False) as frames:
                for _ in range(50):
                    next(frames)
                before = resident_kb()
                for _ in range(300):
                    next(frames)
                grown = resident_kb() - before
        # A frame is 64 x 96 bins x 21 bytes = 126 kB: 300 that were kept would be 38 MB.
        self.assertLess(grown, 8000)


if __name__ == "__main__":
    unittest.main()
