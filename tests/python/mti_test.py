"""client/examples/mti_check.py measures what closed forms say, and client/examples/mti.py finds a convoy where it is."""
import os
import re
import subprocess
import sys
import unittest

import support

EXAMPLES = support.ROOT / "client" / "examples"
SCENES = support.ROOT / "deploy" / "scenes"


def example(name, scene):
    """What an example prints of an obliqd of ours."""
    with support.daemon((SCENES / scene).read_text()) as address:
        done = subprocess.run([sys.executable, EXAMPLES / name, "--server", address], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(support.ROOT / "client" / "python" / "src")})
    return done


class Doppler(unittest.TestCase):
    def test_frames_have_the_closed_forms_of_mti_and_dbs(self):
        done = example("mti_check.py", "targets_check.toml")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"^single 24\.\d, double 46\.\d dB \(24\.61, 46\.22\), noise changed -?0\.\d\d dB; "
                                      r"DBS ratio 15\.\d \(15\.76\); mover 4\.\d\d deg \(4\.411\)\n$")

    def test_a_convoy_is_found_with_mti_alone(self):
        done = example("mti.py", "mti_convoy.toml")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        said = re.findall(r"^radar\.mode = \"(\w+)\": found (\d) of 5, and (\d+) places where none is", done.stdout, re.M)
        found = {mode: (int(trucks), int(others)) for mode, trucks, others in said}
        # The convoy drives on while a busy machine starts: a truck may pass a farm, or fade.
        self.assertLessEqual(found["map"][0], 1, done.stdout)
        self.assertGreaterEqual(found["mti"][0], 4, done.stdout)
        self.assertLessEqual(found["mti"][1], 2, done.stdout)


if __name__ == "__main__":
    unittest.main()
