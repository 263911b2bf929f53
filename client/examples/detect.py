#!/usr/bin/env python3
"""Counts detections in I&Q with noise, and holds them against the theory of Swerling and Marcum.

  python3 detect.py [--looks 10000] [--scene SCENE.toml] [--server HOST:PORT]

Starts an obliqd of its own on deploy/scenes/targets_check.toml unless --server names one. Targets stand in free space: the
antenna is so high that the ground lies beyond r_max. A look is a target in a frame with noise of its own; it is found where
|I + jQ|^2 is above the threshold that noise alone exceeds with the probability Pfa.
"""
import argparse
import math
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
try:
    import obliq
except ImportError:  # the package of this tree
    sys.path.insert(0, str(HERE.parent / "python" / "src"))
    import obliq

PFA = 1e-6
HEIGHT_M = 60e3
PLACE = {"latitude_deg": 36.4065, "longitude_deg": -107.5855}
METRES_PER_DEGREE = (6360e3 + HEIGHT_M) * math.pi / 180
# Ranges at which one pulse finds 10 m^2 with these probabilities, km; a target each, side by side.
RANGES_KM = {0: (10.0, 28.0, 31.0, 33.2, 35.0, 37.0), 1: (10.0, 15.0, 21.0, 26.0, 31.0, 36.0),
             3: (12.0, 18.0, 24.0, 28.0, 32.0, 36.0)}


def probability(swerling, snr, pfa=PFA):
    """Of finding a target of a mean signal-to-noise ratio with one pulse."""
    t = -math.log(pfa)
    if swerling == 1:
        return math.exp(-t / (1 + snr))
    if swerling == 3:
        half = snr / 2
        return math.exp(-t / (1 + half)) * (1 + t * half / (1 + half) ** 2)
    if snr > 600 > 2 * t:
        return 1.0  # exp(-snr) would be no number any more
    # Marcum's Q as a sum over k of Poisson(k; snr) times the upper gamma function of k + 1.
    found, poisson, tail, term = 0.0, math.exp(-snr), 0.0, math.exp(-t)
    for k in range(2000):
        tail += term
        found += poisson * min(tail, 1.0)
        term *= t / (k + 1)
        poisson *= snr / (k + 1)
    return found


def target(number, swerling, bearing_deg, range_km):
    """At the antenna's own height."""
    north = 1000 * range_km * math.cos(math.radians(bearing_deg))
    east = 1000 * range_km * math.sin(math.radians(bearing_deg))
    middle = math.radians(PLACE["latitude_deg"] + north / METRES_PER_DEGREE / 2)
    return {"id": number, "rcs_dbsm": 10.0, "swerling": swerling, "height_m": HEIGHT_M, "height_reference": "datum",
            "latitude_deg": PLACE["latitude_deg"] + north / METRES_PER_DEGREE,
            "longitude_deg": PLACE["longitude_deg"] + east / METRES_PER_DEGREE / math.cos(middle)}


def count(server, radar, swerling, looks):
    """Prints a line a target; the number of standard deviations that the worst is off."""
    pose = {**PLACE, "height_m": HEIGHT_M, "bearing_deg": 0.0}
    settings = radar.settings.replace(noise=True, noise_seed=7)
    many = [target(k + 1, swerling, -12.5 + 5 * k, range_km) for k, range_km in enumerate(RANGES_KM[swerling])]
    first = server.render(settings, pose, planes="power", targets=many, truth=True)
    noise_w = first.descriptor.noise_power_w
    bins = [(int(t["azimuth_bin"]), int(t["range_bin"])) for t in first.targets]
    threshold = -math.log(PFA) * noise_w
    found, crossed, noise_looks = np.zeros(len(bins)), 0, 0
    frames = max(1, looks // len(bins))
    empty = (slice(None), slice(0, 100))  # nearer than any of them
    for frame in server.render_many([pose] * frames, settings, planes="iq", seed=swerling + 1, targets=many, timeout=300):
        power = np.abs(frame.iq) ** 2
        found += [power[at] > threshold for at in bins]
        noise = power[empty]
        crossed += int(np.count_nonzero(noise > -math.log(1e-3) * noise_w))
        noise_looks += noise.size
    worst = 0.0
    for (azimuth, gate), t, hits in zip(bins, first.targets, found):
        snr = first.power[azimuth, gate] / noise_w  # the mean power plane has beam and pulse in it, and no noise
        theory = probability(swerling, snr)
        deviations = abs(hits / frames - theory) / max(math.sqrt(theory * (1 - theory) / frames), 1 / frames)
        worst = max(worst, deviations)
        print(f"  10 m^2 at {t['range_m'] / 1000:5.2f} km: {t['snr_db']:5.2f} dB in the middle of beam and gate, "
              f"{10 * math.log10(snr):5.2f} dB in its bin; Pd {hits / frames:.3f}, by theory {theory:.3f}")
    print(f"  noise above the threshold of Pfa 1e-3: {crossed / noise_looks:.2e} of {noise_looks} looks")
    return max(worst, abs(crossed / noise_looks - 1e-3) / math.sqrt(1e-3 / noise_looks))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--looks", type=int, default=10000, help="at targets of each kind")
    parser.add_argument("--scene", type=pathlib.Path, default=HERE.parent.parent / "deploy" / "scenes" / "targets_check.toml")
    parser.add_argument("--server", help="HOST:PORT of one that runs")
    given = parser.parse_args()
    with obliq.connect(given.server) if given.server else obliq.local(given.scene) as server:
        radar = server.radar(server.info.radars[0])
        worst = 0.0
        for swerling in RANGES_KM:
            print(f"Swerling {swerling}: Pfa {PFA:g}, one pulse")
            worst = max(worst, count(server, radar, swerling, given.looks))
    print(f"the worst of these is {worst:.1f} standard deviations off")
    return 0 if worst < 4.5 else 1


if __name__ == "__main__":
    sys.exit(main())
