#!/usr/bin/python3
"""Plots what tests/soak.sh measured: memory, descriptors and threads, and latency over time.

  deploy/plots/soak.py soak.csv soak.png
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def column(rows, name):
    return [float(row[name]) if row[name] else float("nan") for row in rows]


def with_room(axes):
    """From 0, with room for the legend above the curves."""
    axes.set_ylim(0, 1.35 * max(axes.dataLim.y1, 1e-3))
    axes.legend(loc="upper right", ncol=4)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(f"{sys.argv[1]}: no samples")
    seconds = column(rows, "t_s")
    unit, name = (3600, "h") if seconds[-1] > 2 * 3600 else (60, "min")
    time = [s / unit for s in seconds]

    figure, (memory, handles, frames, latency) = plt.subplots(4, 1, figsize=(10, 11), sharex=True)
    memory.plot(time, column(rows, "rss_mb"), color="tab:blue")
    memory.set_ylabel("resident memory (MB)")
    # Not from 0: a leak is small beside the terrain. At least 40 MB, so that noise looks like noise.
    middle, half = (memory.dataLim.y0 + memory.dataLim.y1) / 2, max(20, 0.6 * memory.dataLim.height)
    memory.set_ylim(max(0, middle - half), middle + half)
    handles.plot(time, column(rows, "descriptors"), color="tab:orange", label="descriptors")
    handles.plot(time, column(rows, "threads"), color="tab:green", label="threads")
    handles.plot(time, column(rows, "clients"), color="tab:gray", label="clients")
    handles.set_ylabel("count")
    with_room(handles)
    frames.plot(time, column(rows, "frames_per_s"), color="tab:blue", label="rendered")
    frames.plot(time, column(rows, "dropped_per_s"), color="tab:red", label="left out for slow clients")
    frames.set_ylabel("frames a second")
    with_room(frames)
    for key, text, colour in (("render", "frame", "tab:blue"), ("pose", "pose to last block", "tab:purple")):
        latency.plot(time, column(rows, f"{key}_p50_ms"), color=colour, label=f"{text}, median")
        latency.plot(time, column(rows, f"{key}_p99_ms"), color=colour, linestyle="--", label=f"{text}, 99 %")
    latency.set_ylabel("latency of the last minute (ms)")
    latency.set_xlabel(f"time ({name})")
    with_room(latency)
    for axes in (memory, handles, frames, latency):
        axes.grid(alpha=0.3)
    figure.suptitle(f"obliqd for {seconds[-1] / 3600:.2f} h with clients that behave and others that do not")
    figure.tight_layout()
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
