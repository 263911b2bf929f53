"""weather_itur.py: reads the lines of weather_table and compares them with the program itur."""
import sys

import itur
from itur.models import itu676, itu838

itu676.change_version(12)
itu838.change_version(3)
worst, n = 0.0, 0
for line in sys.stdin:
    kind, f, rain, ours = line.split()
    f, rain, ours = float(f), float(rain), float(ours)
    if kind == "gas":
        theirs = itu676.gamma_exact(f, 1013.25, 7.5, 288.15).value
    else:
        theirs = itu838.rain_specific_attenuation(rain, f, 0, 0 if kind == "H" else 90).value
    error = abs(ours / float(theirs) - 1)
    worst, n = max(worst, error), n + 1
    # A path along the ground has k and alpha of its own polarisation; cos(90 deg) is not quite 0.
    if error > 1e-6:
        sys.exit(f"{kind} at {f} GHz, {rain} mm/h: {ours} dB/km; itur {itur.__version__}: {theirs}")
if n < 100:
    sys.exit(f"{n} lines; at least 100 expected")
print(f"{n} attenuations agree with itur {itur.__version__} to {worst:.1e}")
