#!/usr/bin/python3
"""Plots what build/release/bin/scaling_bench measured: frame time against rays, bins, threads, posts,
buildings and range, with the power law that each ends in.

  deploy/plots/scaling.py scaling.json scaling.png
"""
import json
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"oblique": "tab:orange", "sweep": "tab:blue"}


def law(at, seconds):
    """The exponent between the last two decades' halves: a least-squares line through the upper half."""
    half = len(at) // 2
    x = [math.log(a) for a in at[half:]]
    y = [math.log(s) for s in seconds[half:]]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        axes = json.load(file).get("axes", {})
    if not axes:
        sys.exit(f"{sys.argv[1]}: no axes")
    columns = min(3, len(axes))
    rows = -(-len(axes) // columns)
    figure, panels = plt.subplots(rows, columns, figsize=(4.6 * columns, 3.9 * rows), squeeze=False, sharey=True)
    for panel in panels.flat[len(axes):]:
        panel.set_visible(False)
    for panel, axis in zip(panels.flat, axes.values()):
        for name, colour in COLOURS.items():
            points = [point for point in axis["points"] if name in point]
            at, seconds = [point["at"] for point in points], [point[name] for point in points]
            exponent = law(at, seconds)
            panel.loglog(at, [1000 * s for s in seconds], "o-", color=colour, label=f"{name}: ends as x^{exponent:.2f}")
        panel.set_xlabel(axis["label"])
        panel.grid(True, which="major", alpha=0.3)
        panel.legend(fontsize=8)
    for row in panels:
        row[0].set_ylabel("frame, ms")
    figure.tight_layout()
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
