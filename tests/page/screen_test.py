"""Twenty seconds of a scanning radar that flies, on the page: figures are printed, the heap must stay. tests/bench/screen.py
measures more, for longer."""
import os
import sys
import unittest

import support

sys.path.insert(0, str(support.ROOT / "tests" / "bench"))
import screen  # noqa: E402

SECONDS = 20
HEAP_MB = 7  # that a heap may grow: it is as the collector left it
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
height_m = 3000.0
tilt_deg = -8.0
[radar]
name = "x_band"
frequency_ghz = 9.4
power_w = 50e3
gain_db = 33.0
sector_deg = 360.0
r_min_m = 3500.0
r_max_m = 10000.0
[beam]
pattern = "gaussian"
width_deg = 3.0
[receiver]
noise = true
[video]
looks = 8
[scan]
mode = "circular"
rate_deg_s = 120.0
dwell_bins = 32
[bins]
azimuth = 1024
range = 512
"""


class Screen(unittest.TestCase):
    def test_twenty_seconds_of_flight(self):
        print(f"  load {os.getloadavg()[0]:.1f}")
        before, after, passes = screen.scanning("hills", SECONDS, SCENE)
        self.assertGreater(passes, 2)
        self.assertLess(after - before, HEAP_MB, "MB by which the page's heap grew")


if __name__ == "__main__":
    unittest.main()
