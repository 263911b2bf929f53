"""Where the page puts a bin, and the Python package, from the equator to the poles: beside geodesics that are integrated here
step by step on the ellipsoid, in Earth-centred axes, which know no pole."""
import base64
import re
import unittest

import numpy as np

import support
from obliq import mapping

A_M, F = 6378137.0, 1 / 298.257223563  # WGS84
B_M = A_M * (1 - F)
K = 4 / 3          # the effective earth's radii
ANTENNA_M = 3000.0
REFERENCE_M = 350.0
STEP_M = 2000.0    # leaves (step / R)^4, 1e-14 of the length
# Antenna, and scene origin where that is elsewhere: (latitude, longitude).
PLACES = [((34.0, -118.0), (34.1, -117.9)), ((0.0, 179.9), (0.0, -179.9)), ((85.0, 10.0), (84.9, 12.0)), ((88.5, -75.0), (88.4, -70.0)),
          ((89.5, 179.9), (89.4, -179.0)), ((89.9, 45.0), (89.8, 120.0)), ((90.0, 0.0), (90.0, 0.0)), ((90.0, 30.0), (89.9, 100.0)),
          ((-85.0, 10.0), (-85.1, 8.0)), ((-89.5, -179.9), (-89.4, 179.0)), ((-89.9, 60.0), (-89.85, 0.0)), ((-90.0, 0.0), (-90.0, 0.0))]
GROUND_RANGES_M = [5e3, 12e3, 37e3, 100e3, 300e3]
BEARINGS_DEG = [0.0, 33.0, 90.0, 145.0, 180.0, 271.0, 359.5]
READ = """
const [source, descriptor, asked] = arguments, done = arguments[arguments.length - 1];
import(source).then(({ Placement }) => {
  const placement = new Placement(descriptor);
  done([asked.map(([bearing, slant]) => [...placement.place(bearing, slant), placement.located(bearing, slant)]), placement.hasGround]);
}).catch((error) => done(String(error)));
"""


def axes(latitude_deg, longitude_deg):
    """East, north, up in Earth-centred axes."""
    f, g = np.radians([latitude_deg, longitude_deg])
    return (np.array([-np.sin(g), np.cos(g), 0]), np.array([-np.sin(f) * np.cos(g), -np.sin(f) * np.sin(g), np.cos(f)]),
            np.array([np.cos(f) * np.cos(g), np.cos(f) * np.sin(g), np.sin(f)]))


def on_ellipsoid(latitude_deg, longitude_deg):
    up = axes(latitude_deg, longitude_deg)[2]
    squares = np.array([A_M, A_M, B_M]) ** 2
    return squares * up / np.sqrt((squares * up * up).sum())


def geodesic_end(start, towards, length_m):
    """The acceleration of a geodesic is normal to the surface (Bomford, Geodesy, 4th ed., appendix B); Runge and Kutta's steps."""
    inverse_squares = 1 / np.array([A_M, A_M, B_M]) ** 2

    def slope(state):
        p, v = state
        normal = inverse_squares * p
        return np.array([v, -(inverse_squares * v * v).sum() / (normal * normal).sum() * normal])

    state, count = np.array([start, towards]), int(np.ceil(length_m / STEP_M))
    h = length_m / count
    for _ in range(count):
        k1 = slope(state)
        k2 = slope(state + h / 2 * k1)
        k3 = slope(state + h / 2 * k2)
        k4 = slope(state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state[0]


class World:
    """PROTOCOL.md's frame, with y0 as the root of the ellipsoid's own equation along the origin's vertical."""

    def __init__(self, latitude_deg, longitude_deg):
        self.origin = on_ellipsoid(latitude_deg, longitude_deg)
        self.east, self.north, self.up = axes(latitude_deg, longitude_deg)

    def of(self, point):
        d = point - self.origin
        x, z = d @ self.east, d @ self.north
        foot, w = self.origin + x * self.east + z * self.north, 1 / np.array([A_M, A_M, B_M]) ** 2
        a, b, c = (w * self.up ** 2).sum(), (w * self.up * foot).sum(), (w * foot ** 2).sum() - 1
        y0 = -c / (b + np.sqrt(b * b - a * c))
        return np.array([x, d @ self.up - (1 - 1 / K) * y0, z])


def lifted(point, height_m):
    normal = point / np.array([A_M, A_M, B_M]) ** 2
    return point + height_m * normal / np.linalg.norm(normal)


def scene(antenna, origin):
    """A descriptor, and (east, north) of places with the bearing and slant range at which the antenna has them."""
    world, start = World(*origin), on_ellipsoid(*antenna)
    at = world.of(lifted(start, ANTENNA_M))
    east, north, _ = axes(*antenna)
    north_rad = np.arctan2(north @ world.east, north @ world.north)
    asked, wanted = [], []
    for bearing_deg in BEARINGS_DEG:
        u = np.radians(bearing_deg)
        for length_m in GROUND_RANGES_M:
            end = geodesic_end(start, np.sin(u) * east + np.cos(u) * north, length_m)
            d = world.of(lifted(end, REFERENCE_M)) - at
            asked.append([float(np.degrees(np.arctan2(d[0], d[2]) - north_rad)), float(np.linalg.norm(d))])
            wanted.append((length_m * np.sin(u), length_m * np.cos(u), end))
    descriptor = {"azimuth_start_deg": 0, "azimuth_width_deg": 1, "range_start_m": 4000, "range_spacing_m": 400, "map_reference_height_m": REFERENCE_M,
                  "settings": {"azimuth_bins": 360, "range_bins": 240}, "north_rad": float(north_rad), "radius_factor": K,
                  "antenna_x_m": float(at[0]), "antenna_y_m": float(at[1]), "antenna_z_m": float(at[2]),
                  "pose": {"latitude_deg": antenna[0], "longitude_deg": antenna[1], "bearing_deg": 180},
                  "origin_latitude_deg": origin[0], "origin_longitude_deg": origin[1]}
    return descriptor, asked, wanted


def block_of_the_protocol(kind):
    text = (support.ROOT / "proto" / "PROTOCOL.md").read_text()
    lines = re.search(rf"^```{kind}\n(.*?)^```", text, re.M | re.S).group(1).splitlines()
    return {name: float(value) for name, value in (line.split() for line in lines)}


class Placement(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = support.Page()
        source = (support.ROOT / "server" / "http" / "page" / "picture" / "placement.js").read_bytes()
        cls.source = "data:text/javascript;base64," + base64.b64encode(source).decode()

    def ask(self, descriptor, asked):
        answer = self.page.driver.execute_async_script(READ, self.source, descriptor, asked)
        self.assertNotIsInstance(answer, str, answer)
        return answer

    def test_bins_lie_on_the_plane_where_geodesics_end_up_to_the_poles(self):
        for antenna, origin in PLACES:
            with self.subTest(antenna=antenna):
                descriptor, asked, wanted = scene(antenna, origin)
                found, has_ground = self.ask(descriptor, asked)
                self.assertTrue(has_ground, "the farthest bins meet no ground")
                off = [np.hypot(east - e, north - n) for (east, north, _), (e, n, _) in zip(found, wanted)]
                places = [np.linalg.norm(on_ellipsoid(at["latitude_deg"], at["longitude_deg"]) - end)
                          for (_, _, at), (_, _, end) in zip(found, wanted)]
                print(f"  {antenna}: at most {1000 * max(off):.3f} mm on the plane, {1000 * max(places):.3f} mm on the ground")
                # Vincenty's own 0.1 mm, and places to a micrometre; a millimetre is a thousandth of the finest bins.
                self.assertLess(max(off), 1e-3, "metres on the plane")
                self.assertLess(max(places), 1e-3, "metres on the ground")

    def test_pythons_pictures_have_the_same_plane(self):
        for antenna, origin in PLACES:
            with self.subTest(antenna=antenna):
                wanted = scene(antenna, origin)[2]
                up = np.array([end / np.array([A_M, A_M, B_M]) ** 2 for _, _, end in wanted])
                latitude = np.degrees(np.arctan2(up[:, 2], np.hypot(up[:, 0], up[:, 1])))
                east, north = mapping.inverse(*antenna, latitude, np.degrees(np.arctan2(up[:, 1], up[:, 0])))
                self.assertLess(max(np.hypot(east - [e for e, _, _ in wanted], north - [n for _, n, _ in wanted])), 1e-3)

    def test_the_worked_bin_of_the_protocol(self):
        given, place = block_of_the_protocol("bin"), block_of_the_protocol("place")
        descriptor = {**given, "settings": {"azimuth_bins": 240, "range_bins": 1000}, "pose": {}}
        bearing = given["azimuth_start_deg"] + (given["azimuth_bin"] + 0.5) * given["azimuth_width_deg"]
        slant = given["range_start_m"] + (given["range_bin"] + 0.5) * given["range_spacing_m"]
        at = self.ask(descriptor, [[bearing, slant]])[0][0][2]
        self.assertLess(abs(at["ground_m"] - place["ground_range_m"]), 1e-3)
        for name in ("latitude_deg", "longitude_deg"):
            self.assertLess(abs(at[name] - place[name]), 0.6e-9)  # as printed


if __name__ == "__main__":
    unittest.main()
