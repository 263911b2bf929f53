"""Data sets: the same frames, each once, however they were made and whichever worker was killed."""
import concurrent.futures
import json
import multiprocessing
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import unittest
import unittest.mock

import support
from support import OBLIQD, Folder, obliq
import numpy as np
from obliq._sets import batch as _batch, shards as _shards, world as _world

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(support.ROOT / "client/python/src")}
POSES = [{"id": f"p{k:03d}", "latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1200.0 + 10 * k, "bearing_deg": 7.0 * k}
         for k in range(30)]


def lines(folder, poses, name="poses.jsonl"):
    path = folder / name
    path.write_text("".join(json.dumps(pose) + "\n" for pose in poses))
    return path


class Batch(Folder):
    @classmethod
    def setUpClass(cls):
        cls.server = support.shared_daemon()

    def run_batch(self, out, poses=POSES, **options):
        return obliq.batch(poses, self.folder / out, server=self.server, shard_size=4, progress=False, **options)

    def command(self, out, *words, poses=POSES, **options):
        return subprocess.Popen([sys.executable, "-m", "obliq.batch", str(lines(self.folder, poses)), "--out",
                                 str(self.folder / out), "--shard-size", "4", *words], stderr=subprocess.PIPE, text=True,
                                env=ENVIRONMENT, **options)

    def whole(self):
        """id -> sha256, as one run makes them."""
        if not hasattr(Batch, "_whole"):
            self.run_batch("whole")
            Batch._whole = obliq.Dataset(self.folder / "whole").verify()
        return Batch._whole

    def assert_whole(self, out, wanted=None):
        data = obliq.Dataset(self.folder / out)
        self.assertEqual(data.missing, [])
        self.assertEqual(data.verify(), wanted or self.whole())
        self.assertEqual([path.name for path in (self.folder / out).glob(".*")], [])
        return data

    def test_one_run_makes_the_frames_that_render_makes(self):
        done = self.run_batch("one")
        self.assertEqual((done.frames, done.failed, done.parts, done.complete), (30, 0, 8, True))
        data = self.assert_whole("one")
        self.assertEqual(data.ids, [pose["id"] for pose in POSES])
        with obliq.connect(self.server) as server:
            settings = server.radar("main").settings
            for at in (0, 5, 29):
                pose = {key: value for key, value in POSES[at].items() if key != "id"}
                frame = server.render(settings, pose, planes="iq state")
                self.assertEqual(data[at].sha256(), frame.sha256())
                self.assertEqual(data.by_id(POSES[at]["id"]).pose.bearing_deg, POSES[at]["bearing_deg"])
                np.testing.assert_array_equal(data[at].places()[0], frame.places()[0])
        array = np.load(self.folder / "one" / "part-00001" / "iq.npy", mmap_mode="r")
        self.assertEqual((array.shape, array.dtype), ((4, 64, 96), np.dtype("<c8")))
        self.assertEqual(sum(1 for _ in data), 30)

    def test_shares_make_the_same_set_and_a_second_run_does_nothing(self):
        for share in ("2/3", "1/3", "3/3"):
            process = self.command("shares", "--server", self.server, "--shard", share)
            self.assertIn("parts are there", process.communicate()[1])
            self.assertEqual(process.returncode, 0)
        self.assert_whole("shares")
        before = {path: path.stat().st_mtime_ns for path in (self.folder / "shares").rglob("*.npy")}
        self.assertEqual(self.run_batch("shares").frames, 0)
        self.assertEqual({path: path.stat().st_mtime_ns for path in (self.folder / "shares").rglob("*.npy")}, before)
        # The indices of an Indexed Job begin at 0.
        for share in ("0/2", "1/2"):
            self.run_batch("pods", shard=share)
        self.assert_whole("pods")

    def test_kills_lose_no_finished_shard_and_make_no_id_twice(self):
        out = self.folder / "killed"
        poses = POSES * 1
        seen = {}
        for kill in range(5):
            process = self.command("killed", "--server", self.server)
            end = time.monotonic() + 30
            while len(list(out.glob("part-*"))) <= kill and process.poll() is None and time.monotonic() < end:
                time.sleep(0.002)
            process.send_signal(signal.SIGKILL)
            process.communicate()
            for part in out.glob("part-*"):
                made = (part / "frames.jsonl").stat()
                self.assertEqual(seen.setdefault(part.name, made.st_ino), made.st_ino, "rendered again")
            obliq.Dataset(out).verify()
        self.run_batch("killed", poses)
        data = self.assert_whole("killed")
        self.assertEqual(len(set(data.ids)), len(POSES))
        for name, inode in seen.items():
            self.assertEqual((out / name / "frames.jsonl").stat().st_ino, inode)

    def test_what_a_killed_worker_left_is_removed_also_before_its_parent_has_heard(self):
        ended = subprocess.Popen(["true"])
        while pathlib.Path(f"/proc/{ended.pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z":
            time.sleep(0.01)
        left, used = (self.folder / f".part-00001.{socket.gethostname()}.{pid}.0badcafe" for pid in (ended.pid, os.getpid()))
        left.mkdir()
        used.mkdir()
        _shards.sweep(self.folder)
        self.assertEqual((left.exists(), used.exists()), (False, True))
        ended.wait()

    def test_a_killed_worker_of_a_pool_costs_its_shard_alone(self):
        out = self.folder / "pool"
        spawn = multiprocessing.get_context("spawn")
        os.environ["PYTHONPATH"] = ENVIRONMENT["PYTHONPATH"]
        self.addCleanup(os.environ.pop, "PYTHONPATH")
        with concurrent.futures.ProcessPoolExecutor(2, mp_context=spawn) as executor:
            job = obliq.prepare(POSES, out, server=self.server, shard_size=4)
            futures = [executor.submit(job.run, number) for number in obliq.todo(job)]
            concurrent.futures.wait(futures, return_when=concurrent.futures.FIRST_COMPLETED)
            os.kill(next(iter(executor._processes)), signal.SIGKILL)
            concurrent.futures.wait(futures)
        finished = {path.name: path.stat().st_ino for path in out.glob("part-*")}
        self.assertTrue(finished)
        with concurrent.futures.ProcessPoolExecutor(2, mp_context=spawn) as executor:
            self.run_batch("pool", executor=executor)
        self.assert_whole("pool")
        for name, inode in finished.items():
            self.assertEqual((out / name).stat().st_ino, inode)

    def test_two_workers_on_the_same_shards_do_no_harm(self):
        with concurrent.futures.ThreadPoolExecutor(4) as executor:
            job = obliq.prepare(POSES, self.folder / "twice", server=self.server, shard_size=4)
            list(executor.map(job.run, [number for number in job.shards() for _ in range(2)]))
        self.assert_whole("twice")

    def test_a_shard_that_another_worker_makes_meanwhile_stays_once(self):
        job = obliq.prepare(POSES, self.folder / "meanwhile", server=self.server, shard_size=4)
        connected, others = type(job).connected, [0]

        def after_another(worker, scene):
            if others:
                worker.run(others.pop())
            return connected(worker, scene)
        with unittest.mock.patch.object(type(job), "connected", after_another):
            for number in job.shards():
                job.run(number)
        self.assert_whole("meanwhile")
        self.assertEqual(len(list((self.folder / "meanwhile").glob("part-*"))), len(job.shards()))

    def test_daemons_of_its_own_make_the_same_set(self):
        config = support.scene(self.folder)
        process = self.command("own", "--local", str(config), "--obliqd", OBLIQD, "--area", "scene")
        said = process.communicate()[1]
        self.assertEqual(process.returncode, 0, said)
        self.assert_whole("own")

    def test_refused_poses_are_listed_and_the_rest_goes_on(self):
        poses = list(POSES[:10])
        poses[3] = dict(poses[3], height_m=1e6)
        poses[7] = dict(poses[7], r_max_m=1.0)
        process = self.command("refused", "--server", self.server, poses=poses)
        process.communicate()
        self.assertEqual(process.returncode, 2)
        failed = [json.loads(line) for line in (self.folder / "refused" / "failed.jsonl").read_text().splitlines()]
        self.assertEqual([line["id"] for line in failed], ["p003", "p007"])
        self.assertEqual(failed[0]["faults"][0]["argument"], "height_m")
        wanted = {key: value for key, value in self.whole().items() if key in {p["id"] for p in POSES[:10]} - {"p003", "p007"}}
        self.assert_whole("refused", wanted)

    def test_a_pose_underground_is_named_by_its_line(self):
        poses = [dict(POSES[0], height_m=-50.0), POSES[1]]
        path = lines(self.folder, poses)
        path.write_text("\n" + path.read_text())  # an empty line counts
        done = subprocess.run([sys.executable, "-m", "obliq.batch", str(path), "--out", str(self.folder / "low"), "--server",
                               self.server], capture_output=True, text=True, env=ENVIRONMENT)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "1 refused, .*poses.jsonl, line 2: .*m below the ground")
        failed = [json.loads(line) for line in (self.folder / "low" / "failed.jsonl").read_text().splitlines()]
        self.assertEqual([(line["id"], line["line"]) for line in failed], [("p000", 2)])

    def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_rendered(self):
        taken = self.folder / "taken"
        taken.write_text("a file")
        for out, words in ((taken, "taken: found a file; allowed: a folder"), (taken / "in it", "found a file"),
                           ("/proc/self/set", "/proc/self/set: cannot be written")):  # root may write whatever modes say
            with self.assertRaisesRegex(OSError, words):
                obliq.batch(POSES, out, server=self.server)
        self.assertEqual(taken.read_text(), "a file")

    def test_another_run_in_the_same_folder_is_refused_by_what_differs(self):
        self.run_batch("mine", POSES[:4])
        for options, name in ((dict(poses=POSES[:5]), "poses"), (dict(planes="iq"), "planes"),
                              (dict(settings={"r_max_m": 9000.0}), "settings.r_max_m"), (dict(seed=1), "seed"),
                              (dict(speckle_per_frame=True), "speckle_per_frame")):
            options = {"poses": POSES[:4], **options}
            with self.assertRaisesRegex(ValueError, f"{name}: found"):
                self.run_batch("mine", **options)
        with self.assertRaisesRegex(ValueError, "shard_size: found 4"):
            obliq.batch(POSES[:4], self.folder / "mine", server=self.server, shard_size=3)
        with support.daemon(support.SCENE.replace("cell_m = 60.0", "cell_m = 50.0")) as other:
            with self.assertRaisesRegex(ValueError, "cell_m: found 50.0; allowed: 60.0"):
                obliq.batch(POSES[:4], self.folder / "mine", server=other, shard_size=4)
        (self.folder / "alien" / "part-00000").mkdir(parents=True)
        with self.assertRaisesRegex(ValueError, "not a data set"):
            self.run_batch("alien")

    def test_values_that_changed_on_the_disk_are_found(self):
        self.run_batch("changed", POSES[:4])
        path = self.folder / "changed" / "part-00000" / "iq.npy"
        data = bytearray(path.read_bytes())
        data[-5] ^= 1
        path.write_bytes(data)
        with self.assertRaisesRegex(obliq.BadStream, "frame 3, id 'p003'"):
            obliq.Dataset(self.folder / "changed").verify()

    def test_a_disk_that_is_full_leaves_no_part(self):
        job = obliq.prepare(POSES, self.folder / "full", server=self.server, shard_size=4)
        code = ("import pickle, resource, signal, sys\n"
                "job = pickle.load(sys.stdin.buffer)\n"
                "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
                "resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))\n"
                "try: job.run(0)\n"
                "except OSError as error: print('refused', error)\n")
        import pickle

        done = subprocess.run([sys.executable, "-c", code], input=pickle.dumps(job), capture_output=True, env=ENVIRONMENT)
        self.assertIn(b"refused", done.stdout, done.stderr)
        self.assertEqual([path.name for path in (self.folder / "full").iterdir()], [_world.MANIFEST])


class BadPoses(Folder):
    def test_each_is_refused_by_its_line(self):
        good = json.dumps(POSES[0])
        for text, words in (("", "found no pose"), ("{\n", "line 1: not JSON"), (good + "\n[1]\n", "line 2: found list"),
                            (good + "\n" + good, "line 2: id 'p000' stands in line 1 already"),
                            (good.replace("bearing_deg", "bearing"), "line 1: .*did you mean bearing_deg"),
                            ('{"id": 1, "latitude_deg": 3}', "line 1: lacks longitude_deg, height_m"),
                            (good.replace("33.0", '"x"'), "line 1: .*latitude_deg='x'; allowed: a number"),
                            (good.replace("33.0", "1e400"), "line 1: .*finite"),
                            (good.replace('"p000"', "[1]"), "line 1: id: found"),
                            (good + "\n" + good.replace("p000", "b").replace("}", ', "azimuth_bins": 8}'), "line 2: azimuth_bins")):
            (self.folder / "poses.jsonl").write_text(text)
            with self.assertRaisesRegex(ValueError, words, msg=text):
                _batch.read_poses(self.folder / "poses.jsonl")
        (self.folder / "poses.jsonl").write_bytes(good.encode() + b"\n\xff\xfesecret")
        with self.assertRaisesRegex(ValueError, "line 2: found bytes that are no UTF-8") as refused:
            _batch.read_poses(self.folder / "poses.jsonl")
        self.assertNotIn("secret", str(refused.exception))

    def test_poses_nested_too_deep_are_refused(self):
        (self.folder / "poses.jsonl").write_text("[" * 100000)
        with self.assertRaisesRegex(ValueError, "line 1: not JSON: nested too deep"):
            _batch.read_poses(self.folder / "poses.jsonl")

    def test_poses_from_a_pipe_are_waited_for_aloud(self):
        os.mkfifo(self.folder / "pipe")
        waiting = subprocess.Popen([sys.executable, "-m", "obliq.batch", str(self.folder / "pipe"), "--out",
                                    str(self.folder / "out"), "--server", "127.0.0.1:1"], stderr=subprocess.PIPE, text=True,
                                   env=ENVIRONMENT)
        with waiting.stderr:
            self.assertIn("waiting for poses", waiting.stderr.readline())  # before anybody writes
            (self.folder / "pipe").write_text(json.dumps(POSES[0]) + "\n")
            self.assertIn("Is obliqd running", waiting.stderr.read())
        self.assertEqual(waiting.wait(), 1)

    def test_what_is_no_part_of_ours_is_left_alone(self):
        for name in (".part-junk", ".part-00000.", ".part-00000.host.nopid.00000000"):
            (self.folder / name).mkdir()
        gone = self.folder / f".part-00003.{socket.gethostname()}.{2 ** 22 + 1}.0123abcd"  # above any process id
        gone.mkdir()
        _shards.sweep(self.folder)
        self.assertEqual(len(list(self.folder.glob(".part-*"))), 3)
        self.assertFalse(gone.exists())

    def test_the_command_says_it_in_one_line(self):
        for words, said in ((["--server", "127.0.0.1:1"], "Is obliqd running"), (["--local", "none.toml"], "no such scene file"),
                            (["--server", "x", "--set", "r_maxm=1"], "KEY=VALUE"), (["--server", "a", "--shard", "4/3"], "I/N"),
                            (["--server", "a", "--seed", "-1"], "seed: found -1; allowed: 0 to")):
            done = subprocess.run([sys.executable, "-m", "obliq.batch", str(lines(self.folder, POSES)), "--out",
                                   str(self.folder / "out"), *words], capture_output=True, text=True, env={**ENVIRONMENT,
                                                                                                      "OBLIQD": OBLIQD})
            self.assertIn(done.returncode, (1, 2))
            self.assertIn(said, done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_a_folder_that_is_none_of_ours(self):
        with self.assertRaisesRegex(FileNotFoundError, "no data set"):
            obliq.Dataset(self.folder)
        (self.folder / "manifest.json").write_text('{"format": 99}')
        with self.assertRaisesRegex(ValueError, "format: found 99"):
            obliq.Dataset(self.folder)


if __name__ == "__main__":
    unittest.main()
