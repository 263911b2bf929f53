"""A host that commands the beam: the same mission gives the same sums, whenever it is flown, in C++ and in Python."""
import os
import re
import subprocess
import sys
import unittest

import support
from support import BIN, ROOT, run

# With a beam, a pulse and noise, as a radar has them; the live radar scans, which is none of a dwell's business.
SCENE = support.SCENE.split("[[radar]]")[0] + """
[radar]
sector_deg = 64.0
r_min_m = 2000.0
r_max_m = 12000.0
[beam]
pattern = "gaussian"
width_deg = 3.0
elevation = "cosecant"
elevation_width_deg = 6.0
cosecant_to_deg = 35.0
[pulse]
kind = "rectangular"
length_us = 0.5
[receiver]
noise = true
[scan]
mode = "sector"
rate_deg_s = 60.0
"""
DWELLS = 40


class Dwells(unittest.TestCase):
    def fly(self, command, plane):
        said = run(*command, self.address, "main", DWELLS, plane)
        self.assertIn(f"{DWELLS} dwells, ", said)
        return re.search("^sum ([0-9a-f]{16})$", said, re.MULTILINE).group(1)

    def test_a_mission_has_the_same_sums_each_time_and_in_both_languages(self):
        os.environ["PYTHONPATH"] = str(ROOT / "client" / "python" / "src")
        self.addCleanup(os.environ.pop, "PYTHONPATH")
        python = [sys.executable, str(ROOT / "client" / "python" / "examples" / "dwell.py")]
        with support.daemon(SCENE) as self.address:
            for plane in ("iq", "video"):
                first = self.fly([BIN / "dwell"], plane)
                self.assertEqual(self.fly([BIN / "dwell"], plane), first)
                self.assertEqual(self.fly(python, plane), first)
        # The sum sees the noise: with another seed the mission is another.
        with support.daemon(SCENE.replace("noise = true", "noise = true\nnoise_seed = 5")) as self.address:
            self.assertNotEqual(self.fly([BIN / "dwell"], "video"), first)

    def test_wrong_words_are_answered_by_the_usage(self):
        for words in (["127.0.0.1", "main", "0"], ["127.0.0.1", "main", "5", "power"]):
            done = subprocess.run([BIN / "dwell", *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("usage: dwell", done.stderr)


if __name__ == "__main__":
    unittest.main()
