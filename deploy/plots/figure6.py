#!/usr/bin/python3
"""Plots the paper's Figure 6: slant-range step of one pixel row at the near and the far end of the swath, for the
symmetric and the oblique frustum (antenna at 1 km over flat ground, 2048 rows, r_min = r_max / 10).

  obliq frustum --figure6 | deploy/plots/figure6.py figure6.png
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CURVES = [
    ("symmetric_far_m", "symmetric, far end", "tab:red", "-"),
    ("symmetric_near_m", "symmetric, near end", "tab:red", "--"),
    ("oblique_far_m", "oblique, far end", "tab:blue", "-"),
    ("oblique_near_m", "oblique, near end", "tab:blue", "--"),
]


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        return 2
    rows = list(csv.DictReader(line for line in sys.stdin if not line.startswith("#")))
    needed = {"r_max_m"} | {column for column, *_ in CURVES}
    missing = needed - set(rows[0] if rows else [])
    if missing:
        print(f"figure6.py: no column {', '.join(sorted(missing))} on standard input", file=sys.stderr)
        return 1
    r_max_km = [float(row["r_max_m"]) / 1000 for row in rows]
    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for column, label, colour, style in CURVES:
        axes.semilogy(r_max_km, [float(row[column]) for row in rows], style, color=colour, label=label)
    axes.set_xlabel("maximum slant range (km)")
    axes.set_ylabel("slant-range step of one pixel row (m)")
    axes.set_xlim(r_max_km[0], r_max_km[-1])
    axes.set_ylim(bottom=0.1)  # at 10 km the near step falls to nothing: r_min is the height itself
    axes.grid(True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(sys.argv[1], dpi=120)
    return 0


if __name__ == "__main__":
    sys.exit(main())
