"""A platform with two radars: flown by the command, held and moved by Python, its radars' antennas turned by their operators."""
import contextlib
import subprocess
import unittest

import support
from support import OBLIQ, Folder, obliq

SCENE = """
[terrain]
synthetic = "flat"
[[platform]]
name = "ship"
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 100.0
heading_deg = 90.0
""" + "".join(f"""[[radar]]
name = "{name}"
platform = "ship"
sector_deg = 60.0
r_min_m = 1000.0
r_max_m = 3000.0
mount = {{ forward_m = {forward_m}, look_deg = {look_deg}, azimuth_max_deg = 60.0 }}
""" for name, forward_m, look_deg in (("forward", 40.0, 0.0), ("aft", -40.0, 180.0)))
METRES_A_DEGREE = 6378137.0 * 3.14159265358979 / 180  # of longitude at the equator; at 33 degrees 0.8396 of it and a little


class Platform(Folder):
    def setUp(self):
        super().setUp()
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        self.address = stack.enter_context(support.daemon(SCENE))

    def command(self, *words):
        return subprocess.run([OBLIQ, *words, "--server", self.address], capture_output=True, text=True)

    def test_a_track_moves_both_and_each_antenna_is_its_operators(self):
        track = self.folder / "t.csv"
        track.write_text("time,lat,lon,alt,heading\n0,33.0,-99.5,100,90\n0.2,33.0,-99.49,120,100\n")
        self.assertIn("ship: flown", self.command("fly", str(track), "--radar", "ship").stdout)
        with obliq.connect(self.address) as server:
            ship, forward, aft = server.platform().pose, server.radar("forward").pose, server.radar("aft").pose
            self.assertEqual((ship.longitude_deg, ship.height_m, ship.heading_deg), (-99.49, 120.0, 100.0))
            self.assertAlmostEqual((forward.longitude_deg - aft.longitude_deg) * METRES_A_DEGREE * 0.8396, 80 * 0.9848, delta=0.2)
            self.assertAlmostEqual(aft.bearing_deg, -80.0)
            self.assertEqual(server.status().radars[1].platform, "ship")
        self.assertEqual(self.command("pose", "--radar", "aft", "--bearing", "30", "--tilt", "-4").returncode, 0)
        refused = self.command("pose", "--radar", "aft", "--height", "50")
        self.assertIn("aft, which rides on platform ship", refused.stderr)
        self.assertIn("allowed: forward, aft, ship", self.command("pose", "--radar", "shop").stderr)
        self.assertIn("allowed: forward, aft\n", self.command("set", "--radar", "ship", "radar.power_w=3").stderr)
        with obliq.connect(self.address) as server:
            self.assertEqual((server.radar("aft").pose.bearing_deg, server.radar("aft").pose.tilt_deg), (30.0, -4.0))
            self.assertEqual(server.radar("aft").pose.height_m, aft.height_m)

    def test_bars_and_what_a_gimbal_holds_back(self):
        self.assertEqual(self.command("set", "--radar", "aft", "scan.bars=[-2,-5.5]", "scan.mode=sector").returncode, 0)
        self.assertIn("bars at -2 -5.5 degrees", self.command("status").stdout)
        with obliq.connect(self.address) as server:
            aft = server.radar("aft")
            self.assertEqual(aft.settings.scan_bars, (-2.0, -5.5))
            self.assertEqual(aft.info().gimbal, "")
            with aft.control() as knobs:
                knobs.set(scan_bars=[-3], r_max_m=2500.0)
                self.assertEqual(aft.settings.scan_bars, (-3.0,))
                knobs.set(scan_bars=())
                self.assertEqual(aft.settings.scan_bars, ())
                with self.assertRaisesRegex(obliq.ObliqError, r"scan.bars: found \[91.0\]; allowed: a list of up to 16 numbers, -90 to 90 deg"):
                    knobs.set(scan_bars=(91,))
                with self.assertRaisesRegex(TypeError, "scan_bars='up'; allowed: a sequence of numbers"):
                    knobs.set(scan_bars="up")
                with self.assertRaisesRegex(ValueError, "finite"):
                    knobs.set(scan_bars=[float("nan")])
                knobs.set_pose(bearing_deg=90.0 + 180.0 + 70.0)
            self.assertEqual(aft.info().gimbal, "azimuth at its limit of 60 deg, 40.0 deg short")
            self.assertAlmostEqual(aft.frame().pose.bearing_deg, -60.0)
            self.assertAlmostEqual(aft.pose.bearing_deg, 340.0)  # as it was asked
        self.assertIn("gimbal: azimuth at its limit of 60 deg, 40.0 deg short", self.command("status").stdout)

    def test_python_holds_and_moves_it_while_another_turns_a_radars_knobs(self):
        with obliq.connect(self.address) as host, obliq.connect(self.address) as hand:
            with host.platform("ship").control() as flight, hand.radar("aft").control(claims="settings") as knobs:
                flight.set_pose(heading_deg=0.0, roll_deg=10.0)
                knobs.set_pose(bearing_deg=150.0)
                flight.set_pose(heading_deg=20.0)
                self.assertAlmostEqual(hand.radar("aft").pose.bearing_deg, 170.0)
                self.assertEqual(hand.radar("forward").pose.roll_deg, 10.0)
                with self.assertRaises(obliq.ObliqError):
                    knobs.set_pose(height_m=3.0)
                with self.assertRaises(obliq.ObliqError), hand.platform().control():
                    pass
            with self.assertRaisesRegex(obliq.ObliqError, "unknown platform"):
                host.platform("forward")
        with obliq.connect(support.shared_daemon()) as server, self.assertRaisesRegex(ValueError, "platform: the server has 0"):
            server.platform()


if __name__ == "__main__":
    unittest.main()
