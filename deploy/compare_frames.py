#!/usr/bin/python3
"""Compares two frames that `obliq render` or `obliq get` wrote.

  compare_frames.py bits A B       every plane the same, bit for bit
  compare_frames.py samples A B    the same samples but for rays that meet an edge: another Embree or another
                                   libm decides those differently

In `samples`, a sample that moves to another bin changes the count of two. What is allowed of it:
"""
import pathlib
import sys

import numpy

PLANES = ("bins", "power", "count", "state")
# Of all samples, those that may be elsewhere, and of all bins, those that may hold another number of samples.
# Edge hits are a few per million rays within one Embree; rounding in libm moves samples at bins' borders as well.
ALLOWED_MOVED = 1e-4
ALLOWED_POWER_DB = 0.001  # total power: a moved sample carries its power along


def read(folder):
    return {name: numpy.load(pathlib.Path(folder) / f"{name}.npy") for name in PLANES}


def same_bits(a, b):
    differing = [name for name in PLANES if a[name].tobytes() != b[name].tobytes()]
    print(f"bits: {', '.join(PLANES)}: " + (f"DIFFERENT: {', '.join(differing)}" if differing else "the same"))
    return not differing


def same_samples(a, b):
    counts_a, counts_b = a["count"].astype(numpy.int64), b["count"].astype(numpy.int64)
    moved = numpy.abs(counts_a - counts_b)
    bins, samples = counts_a.size, counts_a.sum()
    total_db = 10 * numpy.log10(b["power"].sum(dtype=numpy.float64) / a["power"].sum(dtype=numpy.float64))
    print(f"samples: {samples}, in the other {counts_b.sum()}; counts differ in {numpy.count_nonzero(moved)} of "
          f"{bins} bins, by {moved.sum()} in all ({moved.sum() / samples:.2e} of the samples)")
    print(f"states differ in {numpy.count_nonzero(a['state'] != b['state'])} bins")
    same = (moved == 0) & (counts_a > 0)
    power_a, power_b = a["power"][same].astype(numpy.float64), b["power"][same].astype(numpy.float64)
    lit = numpy.maximum(power_a, power_b) > 0
    change = numpy.abs(power_a - power_b)[lit] / numpy.maximum(power_a, power_b)[lit]
    print(f"power of {change.size} bins with the same count: the same bits in {numpy.count_nonzero(change == 0)}, "
          f"within 1e-6 in {numpy.count_nonzero(change <= 1e-6)}, greatest change {change.max():.2e}; "
          f"all power {total_db:+.6f} dB")
    voltage_a, voltage_b = a["bins"][same], b["bins"][same]
    scale = numpy.sqrt(numpy.mean(numpy.abs(voltage_a.astype(numpy.complex128)) ** 2))
    print(f"bins (I&Q), same count: greatest |difference| {numpy.abs(voltage_a - voltage_b).max() / scale:.2e} "
          "of the root mean square")
    return moved.sum() <= ALLOWED_MOVED * samples and abs(total_db) <= ALLOWED_POWER_DB


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in ("bits", "samples"):
        print(__doc__)
        return 2
    a, b = read(sys.argv[2]), read(sys.argv[3])
    if any(a[name].shape != b[name].shape for name in PLANES):
        print("the frames differ in shape")
        return 1
    return 0 if (same_bits if sys.argv[1] == "bits" else same_samples)(a, b) else 1


if __name__ == "__main__":
    sys.exit(main())
