"""Data sets: columns, splits, scenes, coverage, poses that are judged and taken up again, sums, and other programs' formats."""
import json
import os
import pickle
import subprocess
import sys
import tarfile
import types
import unittest
import warnings

import support
from support import OBLIQD, Folder, needs, obliq
import numpy as np
from obliq._sets import area as _area, poses as _poses, self_test as _self_test, world as _world

warnings.filterwarnings("ignore", message=".*without a scene hash.*")
SMALL = support.SCENE.replace("azimuth = 64\nrange = 96", "azimuth = 8\nrange = 16")
PLACE = {"latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1200.0}


def poses(n, **more):
    return [{"id": f"p{k}", **PLACE, "bearing_deg": 40.0 * k, **more} for k in range(n)]


class Sets(Folder):
    @classmethod
    def setUpClass(cls):
        cls.server = support.shared_daemon()

    def make(self, out, wanted, **options):
        options = {"server": self.server, "shard_size": 3, "progress": False,
                   "settings": {"azimuth_bins": 8, "range_bins": 16, "pixel_columns": 8}, **options}
        return obliq.batch(wanted, self.folder / out, **options)

    def local(self, out, wanted, text=SMALL, **options):
        return self.make(out, wanted, server=None, local=support.scene(self.folder, text), obliqd=OBLIQD, settings=None, **options)

    # ---- Columns, splits, selection ----

    def test_columns_of_a_line_come_back_with_its_frame(self):
        wanted = [dict(pose, split="train" if k % 2 else "test", meta={"weather": "dry", "k": k}) for k, pose in enumerate(poses(7))]
        self.make("columns", wanted)
        data = obliq.Dataset(self.folder / "columns")
        self.assertEqual([frame.meta["k"] for frame in data], list(range(7)))
        self.assertEqual((data[3].split, data[4].split), ("train", "test"))
        train = data.select(split="train")
        self.assertEqual(train.ids, ["p1", "p3", "p5"])
        self.assertEqual(train.select(lambda row: row["k"] > 2).ids, ["p3", "p5"])
        self.assertEqual(data[2:4].ids, ["p2", "p3"])
        np.testing.assert_array_equal(train[1].iq, data.by_id("p3").iq)
        self.assertEqual(train.verify()["p5"], data.by_id("p5").sha256())
        with self.assertRaisesRegex(KeyError, "splitt.*allowed: .*split"):
            data.select(splitt="train")

    def test_a_column_that_is_not_known_is_refused_by_file_and_line(self):
        path = self.folder / "poses.jsonl"
        for row, words in (({"splitt": "x"}, "line 2: found 'splitt'; did you mean split"),
                           ({"weather": "dry"}, "line 2: found 'weather'.*\"meta\": {\"weather\": ...}"),
                           ({"meta": [1]}, "line 2: meta: found list"), ({"split": 1}, "line 2: split: found 1")):
            path.write_text("".join(json.dumps(line) + "\n" for line in (poses(1)[0], dict(poses(2)[1], **row))))
            with self.assertRaisesRegex(ValueError, f"poses.jsonl, {words}"):
                _poses.read_poses(path)

    # ---- Several scenes ----

    def test_several_scenes_make_one_set(self):
        (self.folder / "b.toml").write_text(SMALL.replace("cell_m = 60.0", "cell_m = 90.0"))
        wanted = [dict(pose, **({"scene": "b.toml"} if k % 2 else {})) for k, pose in enumerate(poses(6))]
        path = self.folder / "poses.jsonl"
        path.write_text("".join(json.dumps(line) + "\n" for line in wanted))
        done = self.local("two", path, shard_size=2)
        self.assertEqual((done.frames, done.parts, done.complete), (6, 4, True))
        data = obliq.Dataset(self.folder / "two")
        self.assertEqual(data.ids, [f"p{k}" for k in range(6)])
        self.assertEqual([frame.descriptor.cell_m for frame in data], [60.0, 90.0] * 3)
        self.assertEqual(data.select(scene="b.toml").ids, ["p1", "p3", "p5"])
        self.assertEqual(sorted(_world.worlds_in(data.manifest)), ["", "b.toml"])
        self.assertEqual((self.folder / "two" / "scene-1.toml").read_text(), (self.folder / "b.toml").read_text())
        self.assertEqual(self.local("two", path, shard_size=2).frames, 0)

    def test_a_scene_that_is_no_file_is_refused_by_file_and_line(self):
        path = self.folder / "poses.jsonl"
        path.write_text(json.dumps(poses(1)[0]) + "\n" + json.dumps(dict(poses(2)[1], scene="none.toml")) + "\n")
        with self.assertRaisesRegex(ValueError, "poses.jsonl, line 2: scene: found 'none.toml'"):
            self.local("none", path)
        with self.assertRaisesRegex(ValueError, "poses.jsonl, line 2: scene: .*a server has one scene"):
            self.make("none", path)

    def test_several_folders_read_as_one(self):
        self.make("a", poses(2))
        self.make("b", [dict(pose, id=f"q{k}") for k, pose in enumerate(poses(3))])
        data = obliq.Dataset([self.folder / "a", self.folder / "b"])
        self.assertEqual(data.ids, ["p0", "p1", "q0", "q1", "q2"])
        self.assertEqual(len(data.verify()), 5)

    # ---- Ground ----

    def test_the_ground_is_loaded_where_the_poses_are(self):
        far = [dict(pose, latitude_deg=33.6, longitude_deg=-98.9) for pose in poses(3)]  # 87 km from the scene's antenna
        self.local("far", far, planes="iq state", area="scene")
        self.assertLess(max(frame.summary.coverage for frame in obliq.Dataset(self.folder / "far")), 0.01)
        self.local("loaded", far, planes="iq state")
        self.assertEqual([frame.summary.coverage for frame in obliq.Dataset(self.folder / "loaded")], [1.0] * 3)

    def test_an_area_from_poses_makes_the_frames_of_the_usual_one_but_for_rounding(self):
        self.local("usual", poses(4), area="scene")
        self.local("mine", poses(4))
        for one, other in zip(obliq.Dataset(self.folder / "usual"), obliq.Dataset(self.folder / "mine")):
            np.testing.assert_array_equal(one.state, other.state)
            np.testing.assert_allclose(one.iq, other.iq, rtol=1e-5)

    def test_an_area_holds_every_disc_and_the_scenes_own_stays(self):
        lines = _poses.read_poses(poses(3, r_max_m=30e3) + [dict(PLACE, longitude_deg=179.9), dict(PLACE, longitude_deg=-179.9)])
        found = _area.area_of(lines[3:], {"r_max_m": 20e3}, "")
        self.assertLess(max(x for x, _ in found) - min(x for x, _ in found), 1.0)  # not round the earth
        self.assertGreater(max(x for x, _ in found), 180.2)
        north = max(y for _, y in _area.area_of(lines[:3], {}, "r_max_m = 10000.0"))
        self.assertGreater((north - 33.0) * 110.9e3, 30e3)
        self.assertIsNone(_area.area_of(lines, {}, "area = [1, 2, 3, 4]  # Area to load."))

    def test_frames_with_little_ground_fail_where_a_coverage_is_wanted(self):
        edge = [poses(1)[0], dict(poses(2)[1], latitude_deg=33.12, bearing_deg=0.0), dict(poses(3)[2], latitude_deg=33.6)]
        done = self.make("covered", edge, min_coverage=0.95)
        self.assertEqual((done.frames, done.failed), (1, 2))
        self.assertRegex(done.first_failed["text"], "coverage: found 0.*; allowed: from 0.95")
        self.assertEqual(done.first_failed["line"], 2)

    def test_all_poses_are_judged_and_none_is_rendered(self):
        path = self.folder / "poses.jsonl"
        bad = [poses(1)[0], dict(poses(2)[1], height_m=-50.0), dict(poses(3)[2], latitude_deg=33.6), dict(poses(4)[3], r_max_m=1.0)]
        path.write_text("".join(json.dumps(line) + "\n" for line in bad))
        words = [sys.executable, "-W", "ignore", "-m", "obliq.batch", str(path), "--check", "--server", self.server]
        environment = {"PYTHONPATH": str(support.ROOT / "client/python/src")}
        done = subprocess.run([*words, "--min-coverage", "0.9"], capture_output=True, text=True, env=environment, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, "3 of 4 poses would be refused: .*poses.jsonl, line 2: .*below the ground.*coverage is 0.00")
        path.write_text(json.dumps(bad[0]) + "\n")
        done = subprocess.run(words, capture_output=True, text=True, env=environment, check=False)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1), done.stderr)
        self.assertIn("1 poses are good", done.stderr)
        self.assertEqual([name.name for name in self.folder.iterdir()], ["poses.jsonl"])

    def test_poses_off_the_ground_are_told_before_the_first_frame(self):
        path = self.folder / "poses.jsonl"
        path.write_text(json.dumps(poses(1)[0]) + "\n" + json.dumps(dict(poses(2)[1], latitude_deg=35.0)) + "\n")
        code = "import sys, obliq; obliq.prepare(sys.argv[1], sys.argv[2], server=sys.argv[3])"
        done = subprocess.run([sys.executable, "-c", code, str(path), str(self.folder / "off"), self.server], check=True,
                              capture_output=True, text=True, env={"PYTHONPATH": str(support.ROOT / "client/python/src")})
        self.assertRegex(done.stderr, "1 of 2 poses stand where no ground is loaded: .*poses.jsonl, line 2")

    # ---- Another world ----

    def test_poses_that_failed_are_taken_up_when_the_scene_is_cured(self):
        wanted = [dict(pose, height_m=100.0, height_reference="ground", latitude_deg=33.6 if k in (1, 3) else 33.0)
                  for k, pose in enumerate(poses(5))]
        here = SMALL.replace("cell_m = 60.0", "cell_m = 60.0\narea = [-99.8, 32.8, -99.2, 33.2]")
        done = self.local("cured", wanted, here)
        self.assertEqual((done.frames, done.failed), (3, 2))
        before = {path: path.read_bytes() for path in (self.folder / "cured").glob("part-*/*")}
        self.assertEqual(self.local("cured", wanted, here).failed, 2)
        self.assertEqual(len(list((self.folder / "cured").glob("part-*"))), 2)
        cured = here.replace("33.2]", "33.9]")
        done = self.local("cured", wanted, cured)
        self.assertEqual((done.frames, done.failed, done.complete), (2, 0, True))
        data = obliq.Dataset(self.folder / "cured")
        self.assertEqual(data.ids, ["p0", "p1", "p2", "p3", "p4"])
        self.assertEqual({path: path.read_bytes() for path in before}, before)
        self.local("at once", wanted, cured)
        self.assertEqual([frame.settings.noise_frame for frame in data],
                         [frame.settings.noise_frame for frame in obliq.Dataset(self.folder / "at once")])
        self.assertEqual(self.local("cured", wanted, cured).frames, 0)
        self.sums("cured")

    def test_other_ground_under_the_same_name_is_refused_by_name(self):
        with support.daemon(SMALL + "\n[[prisms]]\nper_km2 = 40.0\nheight_m = [4.0, 25.0]\n") as one:
            self.make("world", poses(2), server=one)
            if not obliq.Dataset(self.folder / "world").manifest["world"]["scene_hash"]:
                self.skipTest("this obliqd has no scene hash")
        before = {path: path.stat().st_mtime_ns for path in (self.folder / "world").rglob("*.npy")}
        with support.daemon(SMALL + "\n[[prisms]]\nper_km2 = 40.0\nheight_m = [40.0, 60.0]\n") as other:
            with self.assertRaisesRegex(ValueError, r"manifest.json: scene_hash: found '\w{32}'; allowed: '\w{32}'.*The ground"):
                self.make("world", poses(2), server=other)
        self.assertEqual({path: path.stat().st_mtime_ns for path in (self.folder / "world").rglob("*.npy")}, before)

    def test_what_was_made_before_there_were_hashes_is_read_with_a_warning(self):
        self.make("old", poses(2))
        path = self.folder / "old" / "manifest.json"
        manifest = json.loads(path.read_text())
        manifest["world"].pop("scene_hash")
        manifest["world"]["server_version"] = manifest["world"].pop("build")
        for name in ("parts", "provenance", "min_coverage"):
            manifest.pop(name)
        path.write_text(json.dumps(manifest))
        with self.assertWarnsRegex(UserWarning, "old: made without a scene hash"):
            self.assertEqual(len(obliq.Dataset(self.folder / "old").verify()), 2)
        self.assertEqual(self.make("old", poses(2)).frames, 0)

    def test_another_build_is_refused_by_name(self):
        for wanted, found, words in (({"build": "0.1.0+g1"}, {"build": "0.1.0+g2"}, "build: found '0.1.0.g2'"),
                                     ({"server_version": "0.1.0"}, {"build": "0.2.0"}, "server_version: found '0.2.0'"),
                                     ({"scene_hash": "a"}, {"scene_hash": ""}, "scene_hash: found ''")):
            with self.assertRaisesRegex(ValueError, f"here: {words}"):
                _world.same_world(wanted, found, "here")
        _world.same_world({"scene_hash": "a", "buildings": 7}, {"scene_hash": "a", "buildings": 9}, "here")
        with self.assertRaisesRegex(ValueError, "buildings"):
            _world.same_world({"scene_hash": "", "buildings": 7}, {"scene_hash": "", "buildings": 9}, "here")

    # ---- Files ----

    def sums(self, out):
        done = subprocess.run(["sha256sum", "-c", "--quiet", "SHA256SUMS"], cwd=self.folder / out, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return (self.folder / out / "SHA256SUMS").read_text()

    def test_sums_are_those_of_sha256sum_and_the_same_again(self):
        wanted = [dict(pose, height_m=1e6 if k == 1 else 1200.0) for k, pose in enumerate(poses(5))]
        self.make("first", wanted)
        self.make("second", wanted, shard="1/2")
        self.make("second", wanted, shard="2/2")
        first, second = (self.sums(out).splitlines() for out in ("first", "second"))
        self.assertEqual([line for line in first if "manifest" not in line], [line for line in second if "manifest" not in line])
        for name in ("manifest.json", "failed.jsonl", "part-00000/iq.npy", "part-00001/frames.jsonl"):
            self.assertTrue(any(line.endswith(f"  {name}") for line in first), name)
        subprocess.run(["sha256sum", "-c", "--quiet", "SHA256SUMS"], cwd=self.folder / "first" / "part-00000", check=True)

    def test_a_line_that_changed_on_the_disk_is_found(self):
        self.make("changed", [dict(pose, meta={"k": 1}) for pose in poses(2)])
        path = self.folder / "changed" / "part-00000" / "frames.jsonl"
        path.write_text(path.read_text().replace('"k": 1', '"k": 2'))
        with self.assertRaisesRegex(obliq.BadStream, "frames.jsonl: it is not what was written"):
            obliq.Dataset(self.folder / "changed").verify()

    def test_a_file_that_is_gone_is_named(self):
        self.make("gone", poses(2))
        data = obliq.Dataset(self.folder / "gone")
        (self.folder / "gone" / "part-00000" / "log.jsonl").unlink()
        self.assertEqual(data[1].utc.astype("i8"), 0)  # when it was rendered is all that the log has
        (self.folder / "gone" / "part-00000" / "frames.jsonl").unlink()
        with self.assertRaisesRegex(FileNotFoundError, "part-00000/frames.jsonl"):
            obliq.Dataset(self.folder / "gone")

    def test_a_manifest_says_by_what_when_and_of_what_words_it_was_made(self):
        self.local("told", poses(2))
        told = obliq.Dataset(self.folder / "told").manifest["provenance"]
        self.assertEqual(told["client"], obliq.__version__)
        self.assertRegex(told["date"], r"^20\d\d-\d\d-\d\dT")
        self.assertEqual((self.folder / "told" / told["scenes"][""]).read_text(), SMALL)
        self.assertTrue(told["areas"][""])

    def test_progress_is_told_to_a_callable(self):
        told = []
        self.make("progress", poses(7), progress=lambda done, total: told.append((done, total)))
        self.assertEqual(told, [(3, 7), (6, 7), (7, 7)])

    def test_a_pickled_set_is_small_and_reads_the_same(self):
        self.make("pickled", poses(7))
        data = obliq.Dataset(self.folder / "pickled").select(lambda row: row["id"] != "p2")
        for frame in data:
            frame.iq.sum()
        text = pickle.dumps(data)
        self.assertLess(len(text), 1000)
        again = pickle.loads(text)
        self.assertEqual(again.ids, data.ids)
        np.testing.assert_array_equal(again[3].iq, data[3].iq)

    # ---- Other programs ----

    @needs("xarray", "dask")
    def test_frames_stack_in_xarray(self):
        import xarray

        self.make("stacked", [dict(pose, meta={"weather": "dry"}) for pose in poses(5)])
        data = obliq.Dataset(self.folder / "stacked")
        one = xarray.concat([frame.to_xarray() for frame in data], "frame", coords="different", compat="equals",
                            combine_attrs="drop_conflicts")
        self.assertEqual(one.iq.shape, (5, 8, 16))
        for lazy in (False, True):
            every = data.to_xarray(lazy=lazy)
            self.assertEqual(every.iq.shape, (5, 8, 16))
            self.assertEqual(bool(every.iq.chunks), lazy)
            np.testing.assert_array_equal(every.iq.values, one.iq.values)
            np.testing.assert_array_equal(every.azimuth.values, data[0].offset_deg)
            self.assertAlmostEqual(float(every.azimuth.mean()), 0.0)
            np.testing.assert_allclose(every.bearing.values[2], data[2].azimuth_deg % 360)
            self.assertEqual(every.weather.values.tolist(), ["dry"] * 5)
            self.assertEqual(every.frame.values.tolist(), data.ids)

    @needs("xarray", "dask", "zarr")
    def test_a_zarr_store_has_every_value(self):
        import xarray

        self.make("zarr", poses(4))
        data = obliq.Dataset(self.folder / "zarr")
        data.to_zarr(self.folder / "set.zarr")
        back = xarray.open_zarr(self.folder / "set.zarr", consolidated=False)
        np.testing.assert_array_equal(back.iq.values, np.stack([frame.iq for frame in data]))
        np.testing.assert_array_equal(back.state.values, np.stack([frame.state for frame in data]))

    def test_a_webdataset_has_a_sample_for_each_frame(self):
        self.make("web", [dict(pose, split="train") for pose in poses(5)])
        data = obliq.Dataset(self.folder / "web")
        made = data.to_webdataset(str(self.folder / "web-%05d.tar"), frames=3)
        self.assertEqual([path.name for path in made], ["web-00000.tar", "web-00001.tar"])
        with tarfile.open(made[1]) as archive:
            self.assertEqual(archive.getnames(), [f"{at:09d}.{name}" for at in (3, 4) for name in ("iq.npy", "state.npy", "json")])
            told = json.load(archive.extractfile("000000004.json"))
            self.assertEqual((told["id"], told["split"], told["pose"]["bearing_deg"]), ("p4", "train", 160.0))
            path = self.folder / "iq.npy"
            path.write_bytes(archive.extractfile("000000004.iq.npy").read())
            np.testing.assert_array_equal(np.load(path), data[4].iq)
        with self.assertRaisesRegex(ValueError, "a name with a number"):
            data.to_webdataset("web.tar", frames=3)

    def test_a_torch_data_set_gives_tensors_by_number(self):
        try:
            import torch
        except ImportError:  # what of it is used
            torch = types.ModuleType("torch")
            torch.from_numpy = lambda values: values
            torch.utils = types.ModuleType("torch.utils")
            torch.utils.data = types.ModuleType("torch.utils.data")
            torch.utils.data.Dataset = object
            for module in (torch, torch.utils, torch.utils.data):
                sys.modules[module.__name__] = module
                self.addCleanup(sys.modules.pop, module.__name__)
        import obliq.torch

        self.addCleanup(sys.modules.pop, "obliq.torch")
        self.make("torch", [dict(pose, meta={"k": k}) for k, pose in enumerate(poses(4))], planes="iq count")
        data = obliq.Dataset(self.folder / "torch")
        made = obliq.torch.RadarDataset(data, transform=lambda sample: {**sample, "seen": True})
        self.assertEqual((len(made), made[2]["id"], made[2]["k"], made[2]["seen"]), (4, "p2", 2, True))
        np.testing.assert_array_equal(np.asarray(made[2]["iq"]), data[2].iq)
        np.testing.assert_array_equal(np.asarray(made[2]["count"]), data[2].count)
        self.assertLess(len(pickle.dumps(obliq.torch.RadarDataset(data))), 2000)
        with self.assertRaisesRegex(ValueError, "planes: found 'state'; allowed: iq, count"):
            obliq.torch.RadarDataset(data, planes="state")

    def test_noise_of_two_frames_is_alike_by_chance_alone(self):
        good, sentence = _self_test.labels(self.folder, OBLIQD)
        self.assertTrue(good, sentence)
        good, sentence = _self_test.noise(self.folder, OBLIQD)
        self.assertTrue(good, sentence)
        self.assertRegex(sentence, "largest correlation of two of 24 frames is 0.0.* by chance 0.0302")
        print(sentence)


    def test_the_notebook_of_labels_learns_more_than_a_threshold(self):
        cells = json.loads((support.ROOT / "client/python/labels.ipynb").read_text())["cells"]
        code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                              env={**os.environ, "OBLIQD": OBLIQD, "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr)
        print(done.stdout)


if __name__ == "__main__":
    unittest.main()
