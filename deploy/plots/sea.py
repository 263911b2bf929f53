#!/usr/bin/python3
"""The guide's picture of a coast at sea states 1, 3 and 5 (coast.toml).

  deploy/plots/sea.py OBLIQ FOLDER      writes sea.jpg there; OBLIQ: the program; needs matplotlib and the scene's elevation model
"""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

SCENE = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "scenes" / "coast.toml"
SECTOR_DEG, NEAR_M, FAR_M, HEIGHT_M = 150.0, 1600.0, 20000.0, 1200.0
ACROSS_M, AHEAD_M = (-6000.0, 11000.0), (1000.0, 13500.0)  # of the antenna, its bearing up


def amplitude(program, state, folder):
    """|bin| [azimuth][range], times range squared."""
    values = {"sea.state": state, "sea.shape": 0.3, "atmosphere.wind_m_s": 8, "atmosphere.wind_from_deg": 240, "antenna.height_m": HEIGHT_M,
              "radar.sector_deg": SECTOR_DEG, "radar.r_min_m": NEAR_M, "radar.r_max_m": FAR_M}
    settings = [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    subprocess.run([program, "render", str(SCENE), *settings, "--out", str(folder)], check=True, capture_output=True)
    return np.abs(np.load(folder / "bins.npy"))


def on_ground(bins, pixels):
    """In dB, as if all lay at the datum."""
    across = np.linspace(*ACROSS_M, pixels)
    ahead = np.linspace(AHEAD_M[1], AHEAD_M[0], int(pixels * (AHEAD_M[1] - AHEAD_M[0]) / (ACROSS_M[1] - ACROSS_M[0])))
    x, y = np.meshgrid(across, ahead)
    azimuth = ((np.degrees(np.arctan2(x, y)) + SECTOR_DEG / 2) / SECTOR_DEG * bins.shape[0]).astype(int)
    gate = ((np.sqrt(x**2 + y**2 + HEIGHT_M**2) - NEAR_M) / (FAR_M - NEAR_M) * bins.shape[1]).astype(int)
    inside = (azimuth >= 0) & (azimuth < bins.shape[0]) & (gate >= 0) & (gate < bins.shape[1])
    found = np.where(inside, bins[np.where(inside, azimuth, 0), np.where(inside, gate, 0)], 0)
    return 20 * np.log10(np.maximum(found, 1e-12))


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    figure, axes = plt.subplots(1, 3, figsize=(16, 4.6), layout="constrained")
    with tempfile.TemporaryDirectory() as scratch:
        for state, place in zip((1, 3, 5), axes):
            image_db = on_ground(amplitude(program, state, pathlib.Path(scratch) / str(state)), 900)
            place.set_facecolor("black")
            place.imshow(image_db, cmap="gray", vmin=-105, vmax=-55, interpolation="nearest")
            place.set_title(f"sea state {state}", fontsize=12)
            place.set_xticks([])
            place.set_yticks([])
    figure.savefig(folder / "sea.jpg", dpi=90, pil_kwargs={"quality": 80})


if __name__ == "__main__":
    main()
