"""`obliq fly` by datagrams: a radar rides on a simulator's own aircraft."""
import re
import signal
import socket
import struct
import subprocess
import time
import unittest

import support
from support import OBLIQ, obliq
import numpy as np

A, F = 6378137.0, 1 / 298.257223563  # WGS84


def pose_datagram(latitude, longitude, height, bearing, sim_time_ns=0, pose_id=0, magic=b"OBLP", version=1):
    """server/apps/dis/README.md"""
    return struct.pack("<4sHHqddddQ", magic, version, 0, sim_time_ns, latitude, longitude, height, bearing, pose_id)


def axes(latitude, longitude):
    """North, east, down at a place, in earth-centred axes."""
    phi, lam = np.radians(latitude), np.radians(longitude)
    north = np.array([-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)])
    east = np.array([-np.sin(lam), np.cos(lam), 0.0])
    return north, east, -np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])


def earth_centred(latitude, longitude, height):
    phi = np.radians(latitude)
    e2 = F * (2 - F)
    n = A / np.sqrt(1 - e2 * np.sin(phi) ** 2)
    lam = np.radians(longitude)
    return np.array([(n + height) * np.cos(phi) * np.cos(lam), (n + height) * np.cos(phi) * np.sin(lam),
                     (n * (1 - e2) + height) * np.sin(phi)])


FROZEN, DEACTIVATED = 1 << 21, 1 << 23  # of an entity's appearance: SISO-REF-010
REMOVE, RESUME, STOP = 12, 13, 14  # IEEE 1278.1-2012, 7.5


def order(kind, receiver=(1, 2, 3), exercise=7):
    """A PDU of a simulation's manager, at its size."""
    size = {REMOVE: 28, RESUME: 44, STOP: 40}[kind]
    head = struct.pack(">BBBBIHBB", 7, exercise, kind, 5, 0, size, 0, 0) + struct.pack(">6H", 9, 9, 9, *receiver)
    return head + bytes(size - len(head))


def entity_state(latitude, longitude, height, heading, pitch=0.0, speed=0.0, entity=(1, 2, 3), algorithm=2, exercise=7, appearance=0, roll=0.0):
    """An Entity State PDU of 144 bytes: IEEE 1278.1-2012, 7.2.2."""
    north, east, down = axes(latitude, longitude)
    h, p = np.radians(heading), np.radians(pitch)
    forward = np.cos(p) * (np.cos(h) * north + np.sin(h) * east) - np.sin(p) * down
    level = np.cos(h) * east - np.sin(h) * north
    below, r = np.cross(forward, level), np.radians(roll)
    right, under = np.cos(r) * level + np.sin(r) * below, np.cos(r) * below - np.sin(r) * level
    psi, theta, phi = np.arctan2(forward[1], forward[0]), -np.arcsin(forward[2]), np.arctan2(right[2], under[2])
    velocity = (speed, 0, 0) if 6 <= algorithm <= 9 else speed * forward  # along the body's axes, along the earth's
    pdu = struct.pack(">BBBBIHBB", 7, exercise, 1, 1, 0, 144, 0, 0) + struct.pack(">HHHBB", *entity, 1, 0) + bytes(16)
    pdu += struct.pack(">3f", *velocity) + struct.pack(">3d", *earth_centred(latitude, longitude, height))
    pdu += struct.pack(">3f", psi, theta, phi) + struct.pack(">I", appearance) + struct.pack(">B", algorithm) + bytes(15) + bytes(24) + bytes(16)
    assert len(pdu) == 144
    return pdu


class Ride:
    """`obliq fly` beside a connected client."""

    def __init__(self, test, *words):
        self.process = subprocess.Popen([OBLIQ, "fly", "--server", support.shared_daemon(), "--radar", "main", "--udp", "0", *words],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        test.addCleanup(self.end)
        self.port = int(re.search(r"listening on [\d.]+:(\d+)", self.process.stdout.readline()).group(1))
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.server = obliq.connect(support.shared_daemon())

    def send(self, data):
        self.socket.sendto(data, ("127.0.0.1", self.port))

    def pose_where(self, holds):
        """The radar's pose, once it is so."""
        end = time.monotonic() + 20
        while True:
            pose = self.server.radar("main").pose
            if holds(pose) or time.monotonic() > end:
                return pose
            time.sleep(0.01)

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        if not self.process.stdout.closed:
            self.said = self.process.communicate(timeout=20)
            self.socket.close()
            self.server.close()
        return self.said


class FromHome(unittest.TestCase):
    """The radar of the shared daemon is where it was when a ride has ended."""

    def setUp(self):
        super().setUp()
        with obliq.connect(support.shared_daemon()) as server:
            self.home = server.radar("main").pose
        self.addCleanup(self.go_home)  # behind the ride's end

    def go_home(self):
        with obliq.connect(support.shared_daemon()) as server, server.radar("main").control() as control:
            control.set_pose(self.home.replace(sim_time_ns=None, pose_id=None))


class Datagrams(FromHome):
    def test_poses_are_taken_as_they_come(self):
        ride = Ride(self)
        ride.send(pose_datagram(33.01, -99.49, 1700.0, 80.0, 5_000_000_000, 41))
        pose = ride.pose_where(lambda pose: pose.pose_id == 41)
        self.assertEqual((pose.latitude_deg, pose.longitude_deg, pose.height_m, pose.bearing_deg, pose.sim_time_ns),
                         (33.01, -99.49, 1700.0, 80.0, 5_000_000_000))
        out, _ = ride.end()
        self.assertIn("1 poses, 0 datagrams that were none", out)
        self.assertEqual(ride.process.returncode, 0)

    def test_the_look_turns_the_sector_from_the_nose(self):
        ride = Ride(self, "--look", "90")
        ride.send(pose_datagram(33.0, -99.5, 1500.0, 350.0, pose_id=1))
        self.assertAlmostEqual(ride.pose_where(lambda pose: pose.pose_id == 1).bearing_deg, 80.0)

    def test_what_is_no_pose_is_told_and_the_next_one_counts(self):
        ride = Ride(self)
        good = pose_datagram(33.0, -99.5, 1500.0, 10.0, pose_id=9)
        for bad in (b"", b"x" * 500, good[:-1], pose_datagram(95.0, 0, 0, 0), pose_datagram(float("nan"), 0, 0, 0),
                    pose_datagram(33.0, -99.5, 1500.0, 0, magic=b"NONE"), pose_datagram(33.0, -99.5, 1500.0, 0, version=2),
                    pose_datagram(33.0, -99.5, 1500.0, 0, sim_time_ns=-(1 << 63))):
            ride.send(bad)
        ride.send(good)
        self.assertEqual(ride.pose_where(lambda pose: pose.pose_id == 9).bearing_deg, 10.0)
        out, err = ride.end()
        self.assertIn("1 poses, 8 datagrams that were none", out)
        for words in ("found 500 bytes; allowed: 56", "latitude: found 95", "latitude: found nan", 'no "OBLP"', "version: found 2",
                      "sim_time_ns: found -9223372036854775808"):
            self.assertIn(words, err)

    def test_an_entity_of_dis_is_the_ownship(self):
        ride = Ride(self, "--dis", "1:2:3", "--undulation", "-30")
        for heading in (0.0, 45.0, 137.0, 270.0):
            ride.send(entity_state(33.02, -99.48, 1800.0, heading, pitch=5.0))
            pose = ride.pose_where(lambda pose: abs((pose.bearing_deg - heading + 180) % 360 - 180) < 1e-3)
            # Angles are single floats in a PDU: 2e-7 rad of up to pi.
            self.assertAlmostEqual((pose.bearing_deg - heading + 180) % 360 - 180, 0, delta=1e-4)
            self.assertAlmostEqual(pose.latitude_deg, 33.02, delta=1e-9)
            self.assertAlmostEqual(pose.longitude_deg, -99.48, delta=1e-9)
            self.assertAlmostEqual(pose.height_m, 1800.0, delta=1e-5)
            self.assertEqual((pose.height_reference, pose.geoid_undulation_m), ("ellipsoid", -30.0))

    def test_between_pdus_it_goes_on(self):
        ride = Ride(self, "--dis", "1:2:3", "--rate", "50")
        # 2,000 m/s north: 0.018 degrees a second.
        ride.send(entity_state(33.0, -99.5, 1500.0, 0.0, speed=2000.0))
        first = ride.pose_where(lambda pose: pose.latitude_deg > 33.001)
        later = ride.pose_where(lambda pose: pose.latitude_deg > 33.01)
        metres = np.radians(later.latitude_deg - first.latitude_deg) * 6.357e6
        seconds = (later.sim_time_ns - first.sim_time_ns) * 1e-9
        self.assertAlmostEqual(metres / seconds, 2000.0, delta=20.0)  # the meridian's radius differs by less than 1 %

    def poses_later(self, ride, count=5):
        """Its pose when so many more have been sent."""
        first = ride.pose_where(lambda pose: True).pose_id
        return ride.pose_where(lambda pose: pose.pose_id >= first + count)

    def test_a_frozen_entity_stands_and_a_deactivated_one_has_left(self):
        ride = Ride(self, "--dis", "1:2:3", "--rate", "50")
        ride.send(entity_state(33.0, -99.5, 1500.0, 0.0, speed=2000.0))
        ride.pose_where(lambda pose: pose.latitude_deg > 33.001)
        ride.send(entity_state(33.2, -99.5, 1500.0, 0.0, speed=2000.0, appearance=FROZEN))
        ride.pose_where(lambda pose: abs(pose.latitude_deg - 33.2) < 1e-9)
        self.assertAlmostEqual(self.poses_later(ride).latitude_deg, 33.2, delta=1e-9)
        ride.send(entity_state(33.3, -99.5, 1500.0, 0.0, speed=2000.0, appearance=DEACTIVATED))
        ride.send(entity_state(33.4, -99.5, 1500.0, 0.0))
        self.assertAlmostEqual(ride.pose_where(lambda pose: pose.latitude_deg > 33.25).latitude_deg, 33.4, delta=1e-9)
        _, err = ride.end()
        self.assertIn("1:2:3 is deactivated: the radar stays where it is", err)

    def test_stop_freezes_the_radar_and_start_thaws_it(self):
        ride = Ride(self, "--dis", "1:2:3", "--exercise", "7", "--rate", "50")
        ride.send(entity_state(33.0, -99.5, 1500.0, 0.0, speed=2000.0))
        ride.pose_where(lambda pose: pose.latitude_deg > 33.001)
        frozen = lambda: ride.server.radar("main").info().frozen  # noqa: E731
        for other in (order(STOP, (1, 2, 4)), order(STOP, (2, 65535, 65535)), order(STOP, exercise=8), order(STOP)[:39]):
            ride.send(other)
        self.poses_later(ride)
        self.assertFalse(frozen())
        for receiver in ((65535, 65535, 65535), (1, 2, 0)):
            ride.send(order(STOP, receiver))
            support.wait_until(frozen)
            stood = ride.pose_where(lambda pose: True)
            ride.send(order(RESUME, receiver))
            support.wait_until(lambda: not frozen())
            self.assertLess(self.poses_later(ride, 2).latitude_deg - stood.latitude_deg, 1.0)
        ride.send(order(REMOVE))
        ride.send(entity_state(34.0, -99.5, 1500.0, 0.0))
        ride.pose_where(lambda pose: abs(pose.latitude_deg - 34.0) < 1e-9)
        out, err = ride.end()
        self.assertIn("1:2:3: stopped by its simulation's manager", err)
        self.assertIn("1:2:3 was removed", err)
        self.assertIn("1 datagrams that were none", out)

    def test_a_radar_whose_settings_another_holds_stands_and_is_not_frozen(self):
        ride = Ride(self, "--dis", "1:2:3", "--rate", "50")
        with obliq.connect(support.shared_daemon()) as server, server.radar("main").control(claims="settings") as hand:
            ride.send(entity_state(33.0, -99.5, 1500.0, 0.0, speed=2000.0))
            ride.pose_where(lambda pose: pose.latitude_deg > 33.001)
            hand.set(power_w=7.0)
            hand.set_pose(tilt_deg=-6.0)
            self.assertEqual(self.poses_later(ride).tilt_deg, -6.0)
            ride.send(order(STOP))

            def stands():
                before = ride.server.radar("main").pose.pose_id
                time.sleep(0.2)  # ten poses, if it flew
                return ride.server.radar("main").pose.pose_id == before

            support.wait_until(stands)
            ride.send(order(RESUME))
            self.assertFalse(self.poses_later(ride) is None or server.radar("main").info().frozen)
        _, err = ride.end()
        self.assertIn("main is not frozen", err)
        self.assertIn("settings are held by", err)

    def test_the_port_is_shared_and_a_group_is_joined(self):
        # The group's datagrams stay on the loopback.
        words = ["--listen", "239.255.77.7", "--interface", "127.0.0.1", "--dis", "1:2:3"]
        ride = Ride(self, *words, "--rate", "0")
        other = subprocess.Popen([OBLIQ, "fly", "--server", support.shared_daemon(), "--radar", "scan", *words, "--udp", str(ride.port)],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(other.communicate)
        self.addCleanup(other.send_signal, signal.SIGINT)
        self.assertIn("listening on 239.255.77.7", other.stdout.readline())
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(sender.close)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        end = time.monotonic() + 20
        while time.monotonic() < end:
            sender.sendto(entity_state(33.05, -99.5, 1500.0, 15.0), ("239.255.77.7", ride.port))
            poses = [ride.server.radar(name).pose for name in ("main", "scan")]
            if all(abs(pose.latitude_deg - 33.05) < 1e-9 for pose in poses):
                break
            time.sleep(0.02)
        self.assertEqual([round(pose.latitude_deg, 9) for pose in poses], [33.05, 33.05])

    def test_others_are_none_of_its_business(self):
        ride = Ride(self, "--dis", "1:2:3", "--exercise", "7", "--rate", "0")
        ride.send(entity_state(33.3, -99.5, 1500.0, 10.0, entity=(1, 2, 4)))
        ride.send(entity_state(33.3, -99.5, 1500.0, 10.0, exercise=8))
        ride.send(entity_state(33.0, -99.5, 1500.0, 20.0)[:100])
        ride.send(struct.pack(">BBBBIHBB", 7, 7, 2, 2, 0, 144, 0, 0) + bytes(132))  # Fire
        ride.send(entity_state(33.0, -99.5, 1500.0, float("nan")))
        ride.send(entity_state(33.0, -99.5, 9e9, 20.0))
        ride.send(entity_state(33.0, -99.5, 1500.0, 20.0))
        self.assertAlmostEqual(ride.pose_where(lambda pose: abs(pose.bearing_deg - 20) < 1).bearing_deg, 20.0, delta=1e-4)
        out, err = ride.end()
        self.assertIn("1 poses, 4 datagrams that were none", out)
        self.assertIn("PDU type: found 2", err)

    def test_wrong_arguments_are_named(self):
        for words, said in ((["--udp", "70000"], "--udp"), (["--dis", "1:2"], "SITE:APP:ENTITY"), ([], "no TRACK"),
                            (["track.csv", "--udp", "0"], "TRACK and --udp"), (["--udp", "0", "--listen", "x"], "--listen"),
                            (["--udp", "0", "--look", "nan"], "--look")):
            done = subprocess.run([OBLIQ, "fly", "--server", support.shared_daemon(), "--radar", "main", *words],
                                  capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
