"""Frames to files and back, places, pictures."""
import json
import os
import subprocess
import sys
import unittest

import support
from support import OBLIQ, Folder, obliq, run
import numpy as np
from obliq import mapping
from obliq.places import World

GDAL_TRANSLATE = "/usr/bin/gdal_translate"

class Saved(Folder):
    @classmethod
    def setUpClass(cls):
        with obliq.connect(support.shared_daemon()) as server:
            cls.frame = server.radar("main").frame()
            cls.labels = server.radar("main").frame(planes="power material building height returns")
            cls.window = server.radar("main").frame(planes="iq power", window=obliq.Window(azimuth=slice(8, 40, 2)))

    def test_npz_holds_every_bit(self):
        for frame in (self.frame, self.window, self.labels):
            frame.save(self.folder / "f.npz")
            back = obliq.load(self.folder / "f.npz")
            self.assertEqual(back.sha256(), frame.sha256())
            self.assertEqual((back.utc, back.frame_id, back.descriptor, back.summary),
                             (frame.utc, frame.frame_id, frame.descriptor, frame.summary))
            np.testing.assert_array_equal(back.azimuth_deg, frame.azimuth_deg)

    @support.needs("netCDF4")
    def test_netcdf_holds_every_bit(self):
        for frame in (self.frame, self.window, self.labels):
            frame.save(self.folder / "f.nc")
            back = obliq.load(self.folder / "f.nc")
            self.assertEqual(back.sha256(), frame.sha256())
            self.assertEqual((back.utc, back.frame_id, back.descriptor), (frame.utc, frame.frame_id, frame.descriptor))

    @support.needs("xarray")
    def test_xarray_has_coordinates_units_and_every_setting(self):
        data = self.frame.to_xarray()
        np.testing.assert_array_equal(data.iq.values, self.frame.iq)
        self.assertEqual(data.iq.dims, ("azimuth", "range"))
        self.assertEqual(data.latitude.attrs["units"], "degrees_north")
        self.assertEqual(data.power.attrs["units"], "W")
        self.assertEqual(data.attrs["setting_r_max_m"], 12000.0)
        self.assertEqual(data.attrs["pose_bearing_deg"], 60.0)
        self.assertTrue((np.diff(data.azimuth) > 0).all())
        self.assertIn("shadow", data.state.attrs["flag_meanings"].split())
        self.assertGreater(float(data.iq.sel(azimuth=0, method="nearest").real.std()), 0)

    @support.needs("xarray")
    def test_xarray_names_the_materials_of_labels(self):
        data = self.labels.to_xarray()
        names = data.material.attrs["flag_meanings"].split()
        self.assertEqual(names[0], "terrain")
        self.assertEqual(names[-1], "none")
        self.assertEqual(len(names), data.material.attrs["flag_values"].size)
        self.assertEqual(data.height.attrs["units"], "m")

    @support.needs("rasterio")
    def test_a_geotiff_has_the_pixels_of_obliq_get(self):
        import rasterio

        run(OBLIQ, "get", "--server", support.shared_daemon(), "--radar", "main", "--out", self.folder)
        self.frame.save(self.folder / "mine.tif")
        with rasterio.open(self.folder / "mine.tif") as mine, rasterio.open(self.folder / "ground_map.tif") as its:
            self.assertEqual((mine.shape, mine.crs, mine.nodata), (its.shape, its.crs, its.nodata))
            np.testing.assert_allclose(mine.transform, its.transform, atol=1e-3)
            for band in (1, 2):
                # Pixels whose centre lies within rounding of a bin's edge may differ.
                self.assertGreater((mine.read(band) == its.read(band)).mean(), 0.9999)

    @support.needs("matplotlib")
    def test_a_png_is_a_picture(self):
        self.frame.save(self.folder / "f.png")
        from matplotlib.image import imread

        picture = imread(self.folder / "f.png")
        self.assertGreater(picture.shape[0], 500)
        self.assertGreater(picture[..., 0].std(), 0.1)

    @support.needs("matplotlib")
    def test_plots_are_drawn_into_axes_and_refuse_unknown_kinds(self):
        from matplotlib.figure import Figure

        for kind, aspect in (("ppi", 1), ("bscan", "auto")):  # a map is to scale; degrees and km have none in common
            axes = Figure().add_subplot()
            self.assertIs(self.frame.plot(kind, axes, (-20, 30)), axes)
            self.assertEqual(axes.get_aspect(), aspect)
        with self.assertRaisesRegex(ValueError, "'ppi', 'bscan'"):
            self.frame.plot("polar")

    def test_a_suffix_that_is_none_of_ours_is_refused_by_name(self):
        for path in ("a.exr", "a"):
            with self.assertRaisesRegex(ValueError, "allowed: .npz"):
                self.frame.save(self.folder / path)
        with self.assertRaisesRegex(ValueError, "allowed: .npz"):
            obliq.load(self.folder / "a.tif")

    def test_what_is_damaged_or_not_ours_is_refused(self):
        np.savez(self.folder / "other.npz", a=np.zeros(3))
        (self.folder / "cut.npz").write_bytes(b"PK\3\4nonsense")
        for name in ("other.npz", "cut.npz"):
            with self.assertRaises(ValueError):
                obliq.load(self.folder / name)
        with self.assertRaises(FileNotFoundError):
            obliq.load(self.folder / "none.npz")

    def test_a_file_that_cannot_be_written_leaves_the_old_one(self):
        path = self.folder / "f.npz"
        self.frame.save(path)
        before = path.read_bytes()
        broken = self.frame.copy()
        broken.missed = object()
        with self.assertRaises(TypeError):
            broken.save(path)
        self.assertEqual(path.read_bytes(), before)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["f.npz"])

    def test_a_place_that_cannot_be_written_is_named(self):
        (self.folder / "taken").write_text("a file")
        for path in (self.folder / "taken" / "f.npz", self.folder / "none" / "f.npz", "/proc/f.npz"):
            with self.assertRaises(OSError) as caught:
                self.frame.save(path)
            self.assertEqual(caught.exception.filename, str(path))

    def test_missing_extras_are_named(self):
        code = ("import sys, runpy; sys.modules['xarray'] = None; import obliq\n"
                "try: obliq.load(sys.argv[1]).to_xarray()\nexcept ImportError as error: print(error)")
        self.frame.save(self.folder / "f.npz")
        said = subprocess.run([sys.executable, "-c", code, str(self.folder / "f.npz")], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(support.ROOT / "client/python/src")})
        self.assertIn("frame.to_xarray() needs xarray: pip install 'obliq[xarray]'", said.stdout)


class Places(Folder):
    """places() against the pixels of ground_map.tif, which another program has placed."""

    def check(self, text, planes=None):
        """The share of bins whose centre lies in a pixel with their own value."""
        with support.daemon(text) as address:
            run(OBLIQ, "get", "--server", address, "--radar", "main", "--out", self.folder, *(
                ["--planes", planes] if planes else []))
            told = json.loads((self.folder / "frame.json").read_text())
            with obliq.connect(address) as server:
                # The frame that was got, noise and all, where it has any.
                radar = server.radar("main")
                settings = radar.settings.replace(noise_frame=int(told.get("noise_counter", 0)), scan_mode="frame")
                frame = server.render(settings, radar.pose, planes=planes, radar="main")
        run(GDAL_TRANSLATE, "-q", "-of", "ENVI", "-b", "1", self.folder / "ground_map.tif", self.folder / "map.bin")
        about = json.loads(run("/usr/bin/gdalinfo", "-json", self.folder / "ground_map.tif"))
        width, height = about["size"]
        left, pixel, _, top, _, _ = about["geoTransform"]
        level = np.fromfile(self.folder / "map.bin", "<f4").reshape(height, width)
        east, north = mapping.inverse(frame.pose.latitude_deg, frame.pose.longitude_deg, *frame.places())
        column = np.floor((east - left) / pixel).astype(int)
        row = np.floor((top - north) / pixel).astype(int)
        mine = mapping.levels(frame)
        # Bins at least two pixels wide, with a value.
        arc = np.radians(frame.descriptor.azimuth_width_deg) * frame.ground_range_m
        steep = np.gradient(frame.ground_range_m) / pixel
        wide = np.broadcast_to((arc >= 2 * pixel) & (steep > 0.9), mine.shape) & (mine != mapping.NO_VALUE)
        inside = wide & (column >= 0) & (column < width) & (row >= 0) & (row < height)
        self.assertGreater(inside.sum(), 500)
        same = level[row[inside], column[inside]] == mine[inside]
        return same.mean()

    @unittest.skipUnless(os.path.exists(GDAL_TRANSLATE), "gdal-bin is not installed")
    def test_bins_lie_where_the_map_has_them(self):
        for name, text in {
            "4/3 earth": support.SCENE,
            "flat": support.SCENE.replace("1.3333333333333333", "inf"),
            "all round": support.SCENE.replace("sector_deg = 90.0\nr_min_m = 2000.0", "sector_deg = 360.0\nr_min_m = 2000.0", 1),
        }.items():
            with self.subTest(name):
                self.assertGreater(self.check(text), 0.9)

    @unittest.skipUnless(os.path.exists(GDAL_TRANSLATE), "gdal-bin is not installed")
    def test_maps_of_what_a_receiver_gives_out_are_those_of_obliq_get(self):
        text = support.SCENE + """
[beam]
pattern = "gaussian"
width_deg = 5.0
[receiver]
noise = true
"""
        for planes in (None, "video"):
            with self.subTest(planes):
                self.assertGreater(self.check(text, planes), 0.9)

    @unittest.skipUnless(os.path.exists(GDAL_TRANSLATE), "gdal-bin is not installed")
    def test_also_far_from_the_scenes_origin(self):
        with support.daemon() as address:
            with obliq.connect(address) as server:
                pose = server.radar("main").pose
                pose = pose.replace(latitude_deg=pose.latitude_deg + 0.09, longitude_deg=pose.longitude_deg - 0.12)
                frame = server.render(server.radar("main").settings, pose)
        d = frame.descriptor
        self.assertGreater(np.hypot(d.antenna_x_m, d.antenna_z_m), 14000)
        # By definition: at the reference height, at the bin's slant range and bearing from the antenna.
        latitude, longitude = frame.places()
        x, y, z = World(d.origin_latitude_deg, d.origin_longitude_deg, d.radius_factor).world(
            latitude, longitude, d.map_reference_height_m)
        dx, dy, dz = x - d.antenna_x_m, y - d.antenna_y_m, z - d.antenna_z_m
        np.testing.assert_allclose(np.sqrt(dx * dx + dy * dy + dz * dz), np.broadcast_to(frame.range_m, x.shape), atol=0.1)
        across = (np.degrees(np.arctan2(dx, dz) - d.north_rad) - frame.azimuth_deg[:, None] + 180) % 360 - 180
        self.assertLess(np.abs(np.radians(across) * frame.range_m).max(), 0.1)


if __name__ == "__main__":
    unittest.main()
