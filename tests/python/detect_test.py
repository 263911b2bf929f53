"""client/examples/detect.py counts what theory says, and `obliq explain` says the same of the same scene."""
import os
import re
import subprocess
import sys
import unittest

import support

SCENE = support.ROOT / "deploy" / "scenes" / "targets_check.toml"
SENTENCE = "10 m^2 at 10.00 km: 34.04 dB; Pd 0.9 to 33.2 km (Swerling 0), 21.0 km (1)"


class Detect(unittest.TestCase):
    def test_counts_in_iq_what_swerling_and_marcum_say(self):
        with support.daemon(SCENE.read_text()) as address:
            done = subprocess.run([sys.executable, support.ROOT / "client" / "examples" / "detect.py", "--looks", "1200",
                                   "--server", address], capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": str(support.ROOT / "client" / "python" / "src")})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("Swerling 3", done.stdout)
        first = re.search(r"10 m\^2 at 10\.0\d km: (\d+\.\d+) dB in the middle", done.stdout)
        self.assertIsNotNone(first, done.stdout)
        self.assertAlmostEqual(float(first[1]), 34.04, 1)

    def test_explain_says_how_far(self):
        said = support.run(support.OBLIQ, "explain", SCENE)
        self.assertIn(SENTENCE, re.sub(r"\s+", " ", said))


if __name__ == "__main__":
    unittest.main()
