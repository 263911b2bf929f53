"""Velocity, roll and pitch: in poses of frames and dwells, in tracks and datagrams, and what they do not change."""
import re
import struct
import subprocess
import unittest

import support
from fly_test import FromHome, Ride, entity_state, pose_datagram
from support import OBLIQ, Folder, obliq, run
import numpy as np


def motion_datagram(north, east, up, roll, pitch, has=3, latitude=33.0, number=1, version=2):
    """server/apps/dis/README.md"""
    return struct.pack("<4sHHqddddQ5d", b"OBLP", version, has, 5_000_000_000 + number, latitude, -99.5, 1500.0, 10.0, number,
                       north, east, up, roll, pitch)


def velocity(pose):
    return pose.velocity_north_m_s, pose.velocity_east_m_s, pose.velocity_up_m_s


class Frames(unittest.TestCase):
    def test_no_bit_moves_with_velocity_roll_and_pitch(self):
        # Beam, pencil in elevation, pulse, noise: all that could look at an attitude, and both ways to sample.
        settings = {"beam_pattern": "gaussian", "beam_width_deg": 3.0, "beam_elevation": "gaussian", "beam_elevation_width_deg": 4.0,
                    "noise": True, "azimuth_bins": 48, "range_bins": 64}
        with obliq.connect(support.shared_daemon()) as server:
            for sampling in ({}, {"frustum": "oblique", "pixel_columns": 128, "pixel_rows": 128}):
                home = server.radar("main").pose.replace(tilt_deg=-10.0)
                level = server.render({**settings, **sampling}, home, radar="main", as_live=True)
                moved = server.render({**settings, **sampling}, radar="main", as_live=True,
                                      pose=home.replace(roll_deg=-55.0, pitch_deg=35.0, velocity_north_m_s=250.0, velocity_up_m_s=-9.0))
                self.assertGreater(np.count_nonzero(level.power), 100)
                self.assertEqual(level.sha256(), moved.sha256())
                self.assertEqual(velocity(level.pose), (None, None, None))
                self.assertEqual(velocity(moved.pose), (250.0, 0.0, -9.0))
                self.assertEqual((moved.pose.roll_deg, moved.pose.pitch_deg), (-55.0, 35.0))

    def test_limits_are_named(self):
        with obliq.connect(support.shared_daemon()) as server, server.radar("main").control() as control:
            for field, value in (("roll_deg", 60.5), ("pitch_deg", -60.5), ("velocity_up_m_s", 3e4)):
                with self.assertRaisesRegex(obliq.ObliqError, f"{field}: found"):
                    control.set_pose(**{field: value})
            with self.assertRaisesRegex(ValueError, "pitch_deg=nan"):
                control.set_pose(pitch_deg=float("nan"))


class Doors(FromHome, Folder):
    """Of `obliq fly`: version 2 of the datagram, DIS, tracks."""

    def test_datagrams_of_version_2_carry_velocity_and_attitude(self):
        ride = Ride(self)
        ride.send(motion_datagram(210.0, -20.0, 3.5, 25.0, -4.0))
        pose = ride.pose_where(lambda pose: pose.pose_id == 1)
        self.assertEqual((*velocity(pose), pose.roll_deg, pose.pitch_deg), (210.0, -20.0, 3.5, 25.0, -4.0))
        ride.send(motion_datagram(1.0, 2.0, 3.0, 8.0, 9.0, has=2, number=2))
        pose = ride.pose_where(lambda pose: pose.pose_id == 2)
        self.assertEqual((*velocity(pose), pose.roll_deg, pose.pitch_deg), (None, None, None, 8.0, 9.0))
        ride.send(motion_datagram(1.0, 2.0, 3.0, 90.0, float("nan"), has=1, number=3))
        pose = ride.pose_where(lambda pose: pose.pose_id == 3)
        self.assertEqual((*velocity(pose), pose.roll_deg, pose.pitch_deg), (1.0, 2.0, 3.0, 8.0, 9.0))
        nan, good = float("nan"), motion_datagram(0.0, 0.0, 0.0, 0.0, 0.0, number=9)
        for bad in (motion_datagram(nan, 0, 0, 0, 0), motion_datagram(0, 0, 2e4 + 1, 0, 0), motion_datagram(0, 0, 0, 61, 0),
                    motion_datagram(0, 0, 0, 0, nan), good[:-1], motion_datagram(0, 0, 0, 0, 0, version=1),
                    pose_datagram(33.0, -99.5, 1500.0, 0, version=2)):
            ride.send(bad)
        ride.send(good)
        ride.pose_where(lambda pose: pose.pose_id == 9)
        out, err = ride.end()
        self.assertIn("4 poses, 7 datagrams that were none", out)
        for words in ("velocity north: found nan", "velocity up: found 20001", "roll: found 61; allowed: -60 to 60", "pitch: found nan",
                      "found 95 bytes; allowed: 56 of version 1, 96 of version 2", "version: found 1 in 96 bytes", "version: found 2 in 56"):
            self.assertIn(words, err)

    def test_an_entity_of_dis_has_attitude_and_velocity(self):
        ride = Ride(self, "--dis", "1:2:3", "--rate", "50")
        for heading, pitch, roll, algorithm in ((0.0, 0.0, 0.0, 2), (45.0, 20.0, -50.0, 2), (200.0, -59.0, 30.0, 8), (300.0, 5.0, 59.9, 1)):
            with self.subTest(heading=heading):
                ride.send(entity_state(33.02, -99.48, 1800.0, heading, pitch=pitch, roll=roll, speed=100.0, algorithm=algorithm))
                pose = ride.pose_where(lambda pose: abs((pose.heading_deg - heading + 180) % 360 - 180) < 0.01 and pose.pose_id)
                # Angles are single floats in a PDU: 2e-7 rad of up to pi.
                self.assertAlmostEqual(pose.pitch_deg, pitch, delta=1e-4)
                self.assertAlmostEqual(pose.roll_deg, roll, delta=1e-4)
                h, p = np.radians(heading), np.radians(pitch)
                np.testing.assert_allclose(velocity(pose), 100 * np.array([np.cos(p) * np.cos(h), np.cos(p) * np.sin(h), np.sin(p)]), atol=0.02)

    def test_an_attitude_beyond_the_limits_is_left_out_and_the_flight_goes_on(self):
        ride = Ride(self, "--dis", "1:2:3", "--rate", "50")
        ride.send(entity_state(33.02, -99.48, 1800.0, 10.0, roll=-20.0))
        ride.pose_where(lambda pose: abs(pose.roll_deg + 20) < 1e-3)
        ride.send(entity_state(33.04, -99.48, 1800.0, 80.0, roll=170.0))
        pose = ride.pose_where(lambda pose: abs(pose.latitude_deg - 33.04) < 1e-6)
        self.assertAlmostEqual(pose.heading_deg, 80.0, delta=1e-3)
        self.assertAlmostEqual(pose.roll_deg, -20.0, delta=1e-3)
        _, err = ride.end()
        self.assertIn("roll and pitch are not taken, roll is beyond -60 to 60 degrees", err)

    def test_tracks_have_columns_of_motion(self):
        track = self.folder / "track.csv"
        head = "time,latitude,longitude,height,bearing,remark,roll_deg,velocity_north_m_s,velocity_up_m_s"
        track.write_text(f"{head}\n0,33.0,-99.5,1500,0,x,10,100,\n0.2,33.0002,-99.5,1500,0,x,30,110,-4\n")
        run(OBLIQ, "fly", str(track), "--server", support.shared_daemon(), "--radar", "main", "--speed", "2", "--rate", "0")
        with obliq.connect(support.shared_daemon()) as server:
            pose = server.radar("main").pose
        self.assertEqual((*velocity(pose), pose.roll_deg), (220.0, 0.0, -8.0, 30.0))
        for cell, said in (("61", "roll_deg: found \"61\"; allowed: number -60 to 60 deg"), ("x", "roll_deg: found \"x\"")):
            track.write_text(f"{head}\n0,33.0,-99.5,1500,0,x,{cell},100,\n")
            done = subprocess.run([OBLIQ, "fly", str(track), "--server", support.shared_daemon(), "--radar", "main"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, re.escape(f"track.csv:2: {said}"))

    def test_tracks_and_datagrams_may_be_in_feet_and_knots(self):
        track = self.folder / "feet.csv"
        for head, flags in (("time,lat,lon,Altitude (ft),heading,velocity_north_kt", ()),
                            ("time,lat,lon,alt,heading,velocity_north_kt", ("--height-unit", "ft")),
                            ("time,lat,lon,alt_ft,heading,velocity_north_kt", ("--height-unit", "m"))):
            with self.subTest(head=head):
                track.write_text(f"{head}\n0,33.0,-99.5,5000,0,120\n")
                run(OBLIQ, "fly", str(track), "--server", support.shared_daemon(), "--radar", "main", *flags)
                with obliq.connect(support.shared_daemon()) as server:
                    pose = server.radar("main").pose
                self.assertAlmostEqual(pose.height_m, 1524.0, places=9)
                self.assertAlmostEqual(pose.velocity_north_m_s, 120 * 1852 / 3600, places=9)
        track.write_text("time,lat,lon,alt_ft,heading\n0,33.0,-99.5,400000,0\n")
        done = subprocess.run([OBLIQ, "fly", str(track), "--server", support.shared_daemon(), "--radar", "main"], capture_output=True, text=True)
        self.assertIn('height: found "400000"; allowed: number -1000 to 100000 m', done.stderr)
        ride = Ride(self, "--height-unit", "ft", "--time-rate", "10")
        ride.send(pose_datagram(33.0, -99.5, 5000.0, 10.0))
        pose = ride.pose_where(lambda pose: pose.heading_deg == 10.0)
        self.assertAlmostEqual(pose.height_m, 1524.0, places=9)
        self.assertEqual(pose.time_rate, 10.0)
        ride.end()
        done = subprocess.run([OBLIQ, "fly", "--dis", "1:2:3", "--height-unit", "ft", "--server", support.shared_daemon()], capture_output=True, text=True)
        self.assertIn("--height-unit: found ft with --dis", done.stderr)


if __name__ == "__main__":
    unittest.main()
