#!/usr/bin/python3
"""Plots what many_radars measured: how late frames are, and how many of those asked for are delivered, against load.

  build/release/bin/many_radars tests/bench/paper_hills.toml --json many_radars.json
  deploy/plots/many_radars.py many_radars.json many_radars.png
"""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        report = json.load(file)

    figure, (latency, delivered) = plt.subplots(1, 2, figsize=(11, 4.2))
    runs = (("all_alike", "all alike", "tab:blue"),
            ("one_slow", f"one of them {report['slower']} times as slow (the others' figures)", "tab:orange"))
    for key, name, colour in runs:
        rows = report[key]
        load = [row["load"] for row in rows]
        latency.plot(load, [1000 * row["p50_s"] for row in rows], "o-", color=colour, label=f"median, {name}")
        latency.plot(load, [1000 * row["p99_s"] for row in rows], "o--", color=colour, label=f"99 %, {name}")
        delivered.plot(load, [row["delivered"] / max(1, row["asked"]) for row in rows], "o-", color=colour, label=name)
    loads = [row["load"] for row in report["all_alike"]]
    delivered.plot(loads, [min(1, 1 / load) for load in loads], ":", color="grey", label="what there is time for")
    latency.axhline(1000 * report["frame_s"], linestyle=":", color="grey", label="a frame alone")

    latency.set_yscale("log")
    latency.set_ylabel("from date to last byte at the client (ms)")
    delivered.set_ylim(0, 1.08)
    delivered.set_ylabel("frames delivered of those asked for")
    for axes in (latency, delivered):
        axes.set_xlabel("frames asked for / frames that there is time for")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    figure.suptitle(f"{report['radars']} radars of {report['bins']} x {report['bins']} bins over one scene")
    figure.tight_layout()
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
