#!/usr/bin/env python3
"""Finds a convoy among woods and hills, with numpy alone: not on the map, but with the moving target indicator.

  python3 mti.py [--looks 8] [--scene SCENE.toml] [--server HOST:PORT]

Starts an obliqd of its own on deploy/scenes/mti_convoy.toml unless --server names one. Power is averaged over
some looks, which have speckle, noise and fluctuation of their own. A bin stands out where it is well above the mean of a ring of
bins around it (a CFAR detector), and a place is found where a bin that stands out is the strongest within a beam. The truth says
afterwards which of them are trucks.
"""
import argparse
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
try:
    import obliq
except ImportError:  # the package of this tree
    sys.path.insert(0, str(HERE.parent / "python" / "src"))
    import obliq

THRESHOLD_DB = 8.0  # above the bins around
GUARD, AROUND = (14, 2), (24, 12)  # half sides in azimuth and range bins: what may be the target's own, and what it is compared with


def box_mean(values, half):
    """Mean over a box around each bin; beyond an edge its bins again."""
    for axis, n in enumerate(half):
        padded = np.pad(values, [(n + 1, n) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        sums = np.cumsum(padded, axis)
        last, first = np.arange(2 * n + 1, sums.shape[axis]), np.arange(sums.shape[axis] - 2 * n - 1)
        values = (np.take(sums, last, axis) - np.take(sums, first, axis)) / (2 * n + 1)
    return values


def area(half):
    return (2 * half[0] + 1) * (2 * half[1] + 1)


def places(power):
    """Bins (azimuth, range) of what stands out, strongest first."""
    ring = (box_mean(power, AROUND) * area(AROUND) - box_mean(power, GUARD) * area(GUARD)) / (area(AROUND) - area(GUARD))
    ratio = power / np.maximum(ring, power.max() * 1e-12)
    out = ratio * (ratio > 10 ** (THRESHOLD_DB / 10))
    found = []
    while out.max() > 0:
        at = np.unravel_index(np.argmax(out), out.shape)
        found.append((at, ratio[at]))
        out[max(0, at[0] - GUARD[0]):at[0] + GUARD[0] + 1, max(0, at[1] - GUARD[1]):at[1] + GUARD[1] + 1] = 0
    return found


def average(server, info, mode, looks):
    """Mean |I + jQ|^2 over looks, and the last frame with its truth."""
    settings = info.settings.replace(mode=mode)
    total, frame = 0.0, None
    for frame in server.render_many([info.pose] * looks, settings, planes="iq", seed=1, live_targets=True, truth=True):
        total = total + np.abs(frame.iq) ** 2
    return total / looks, frame


def report(server, info, mode, looks):
    """Prints what is found beside the truth; how many trucks, and how much else."""
    power, frame = average(server, info, mode, looks)
    found = places(power)
    # A place is right within a third of a beam and two range bins.
    beam_bins = info.settings.beam_width_deg / frame.descriptor.azimuth_width_deg
    left = dict(enumerate(found))
    lines, trucks = [], 0
    for t in frame.targets:
        near = [k for k, (at, _) in left.items()
                if abs(at[0] - t["azimuth_bin"]) <= beam_bins / 3 and abs(at[1] - t["range_bin"]) <= 2]
        text = (f"  truth {t['bearing_deg']:6.2f} deg {t['range_m']:5.0f} m, {t['closing_m_s']:5.1f} m/s, "
                f"{t['snr_db']:4.1f} dB over the noise: ")
        if near:
            at, ratio = left.pop(near[0])
            trucks += 1
            text += (f"found at {frame.azimuth_deg[at[0]] % 360:6.2f} deg {frame.range_m[at[1]]:5.0f} m, "
                     f"{10 * np.log10(ratio):4.1f} dB above its surroundings")
        else:
            text += "not found"
        lines.append(text)
    print(f"radar.mode = \"{mode}\": found {trucks} of {len(frame.targets)}, and {len(left)} places where none is")
    print("\n".join(lines), flush=True)
    return trucks, len(left)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", type=int, default=8)
    parser.add_argument("--scene", type=pathlib.Path, default=HERE.parent.parent / "deploy" / "scenes" / "mti_convoy.toml")
    parser.add_argument("--server", help="HOST:PORT of one that runs")
    given = parser.parse_args()
    with obliq.connect(given.server) if given.server else obliq.local(given.scene) as server:
        info = server.radar().info()
        hidden, _ = report(server, info, "map", given.looks)
        found, _ = report(server, info, "mti", given.looks)
    return 0 if found > hidden else 1


if __name__ == "__main__":
    sys.exit(main())
