"""A daemon of one's own: started, used, stopped, whatever happens."""
import io
import os
import pathlib
import signal
import subprocess
import sys
import time
import types
import unittest
from unittest import mock

import support
from support import OBLIQ, OBLIQD, Folder, obliq, scene


def daemons_of(config):
    """Process ids of obliqd with that scene file."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if os.path.basename(words[0]) == b"obliqd" and str(config).encode() in words:
            found.append(int(pid))
    return found


def gone(config, within_s=20):
    end = time.monotonic() + within_s
    while daemons_of(config) and time.monotonic() < end:
        time.sleep(0.05)
    return not daemons_of(config)


class Local(Folder):
    def test_it_is_there_and_then_it_is_not(self):
        config = scene(self.folder)
        with obliq.local(config, obliqd=OBLIQD, settings={"bins.range": 48}) as server:
            self.assertEqual(server.radar("main").frame(planes="state").shape, (64, 48))
            self.assertEqual(len(daemons_of(config)), 1)
        self.assertTrue(gone(config, 0))

    def test_programs_of_a_package_are_found_with_their_environment(self):
        package = types.ModuleType("obliq_server")
        package.program = lambda name: pathlib.Path(OBLIQD).with_name(name)
        package.environment = lambda: {**os.environ, "OBLIQ_OF_THE_PACKAGE": "1"}
        elsewhere = {key: value for key, value in os.environ.items() if key != "OBLIQD"}
        with mock.patch.dict("sys.modules", obliq_server=package), mock.patch.dict("os.environ", elsewhere, clear=True):
            config = scene(self.folder)
            with obliq.local(config) as server:
                self.assertEqual(server.radar("main").frame(planes="state").shape[0], 64)
                pid, = daemons_of(config)
                self.assertIn(b"OBLIQ_OF_THE_PACKAGE=1", pathlib.Path(f"/proc/{pid}/environ").read_bytes())

    def test_the_demo_makes_a_picture_or_says_why_not(self):
        from obliq import demo

        picture = self.folder / "out.png"
        with mock.patch.dict("os.environ", OBLIQ=OBLIQ), mock.patch("sys.stdout", io.StringIO()):
            self.assertEqual(demo.main([str(picture), "--range", "6000"]), 0)
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        with mock.patch.dict("os.environ", OBLIQ=OBLIQ), mock.patch("sys.stderr", io.StringIO()) as said:
            self.assertEqual(demo.main([str(picture), "--dem", str(self.folder / "none.tif")]), 1)
        self.assertIn("none.tif", said.getvalue())

    def test_it_stops_after_an_exception(self):
        config = scene(self.folder)
        with self.assertRaises(KeyError):
            with obliq.local(config, obliqd=OBLIQD):
                raise KeyError
        self.assertTrue(gone(config, 0))

    def test_it_ends_with_a_process_that_is_killed(self):
        config = scene(self.folder)
        code = ("import sys, time, obliq\n"
                "with obliq.local(sys.argv[1], obliqd=sys.argv[2]) as server:\n"
                "    print('up', flush=True); time.sleep(100)\n")
        scratch = self.folder / "tmp"
        scratch.mkdir()
        for how in (signal.SIGKILL, signal.SIGTERM):
            child = subprocess.Popen([sys.executable, "-c", code, str(config), OBLIQD], stdout=subprocess.PIPE, text=True,
                                     env={**os.environ, "PYTHONPATH": str(support.ROOT / "client/python/src"),
                                          "TMPDIR": str(scratch)})
            with child.stdout:
                self.assertEqual(child.stdout.readline(), "up\n")
                self.assertEqual(len(daemons_of(config)), 1)
                child.send_signal(how)
                child.wait()
            self.assertTrue(gone(config))
        self.assertEqual(list(scratch.iterdir()), [])  # nor does its log stay

    def test_its_log_can_be_read(self):
        running = obliq.local_daemon(scene(self.folder), obliqd=OBLIQD)
        try:
            self.assertEqual(running.log(), running.log())
            self.assertIn("ready: ", running.log())
        finally:
            running.stop()

    def test_a_bad_scene_brings_the_daemons_own_words(self):
        with self.assertRaisesRegex(obliq.CannotConnect, "terrain.cell_m"):
            with obliq.local(scene(self.folder, support.SCENE.replace("60.0", "-1.0", 1)), obliqd=OBLIQD):
                pass
        with self.assertRaises(FileNotFoundError):
            with obliq.local(self.folder / "none.toml", obliqd=OBLIQD):
                pass
        with self.assertRaisesRegex(FileNotFoundError, "variable OBLIQD"):
            with obliq.local(scene(self.folder), obliqd="/no/such/program"):
                pass


if __name__ == "__main__":
    unittest.main()
