#!/usr/bin/python3
"""README's picture of real beam, DBS and SAR (town.toml), and the guide's of a convoy with MTI off and on (mti_convoy.toml).

  deploy/plots/modes.py FOLDER      writes modes.jpg and mti.jpg there; needs obliqd, matplotlib and the package obliq
"""
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
try:
    import obliq
except ImportError:  # the package of this tree
    sys.path.insert(0, str(ROOT / "client" / "python" / "src"))
    import obliq

SCENES = ROOT / "deploy" / "scenes"


def ground_range_m(frame):
    """As if all of it lay at its median height."""
    down_m = frame.descriptor.antenna_y_m - frame.descriptor.map_reference_height_m
    return np.sqrt(np.maximum(np.asarray(frame.range_m) ** 2 - down_m**2, 0))


def on_ground(frame, power, centre_m, side_m, pixels):
    """Mean power of the bins in each pixel, north up; where a pixel is smaller than a bin, its bin."""
    range_m = ground_range_m(frame)
    step = side_m / pixels
    parts = 3
    offsets = (np.arange(pixels * parts) + 0.5) * step / parts - side_m / 2
    east, north = np.meshgrid(centre_m[0] + offsets, centre_m[1] - offsets)
    bearing = np.degrees(np.arctan2(east, north))
    azimuth = np.floor((bearing - frame.descriptor.azimuth_start_deg) % 360 / frame.descriptor.azimuth_width_deg).astype(int)
    gate = np.searchsorted((range_m[1:] + range_m[:-1]) / 2, np.hypot(east, north))
    inside = (azimuth < power.shape[0]) & (gate > 0) & (gate < power.shape[1] - 1)
    found = np.where(inside, power[np.where(inside, azimuth, 0), np.where(inside, gate, 0)], np.nan)
    return found.reshape(pixels, parts, pixels, parts).mean(axis=(1, 3))


def show(axes, image_db, levels_db, side_m, centre_m, title):
    extent = [(middle + half) / 1000 for middle in centre_m for half in (-side_m / 2, side_m / 2)]
    axes.set_facecolor("black")
    axes.imshow(image_db, cmap="gray", vmin=levels_db[0], vmax=levels_db[1], extent=extent, interpolation="nearest")
    axes.set_title(title, fontsize=11)
    axes.set_xticks([])
    axes.set_yticks([])


def town(picture):
    centre_m, side_m = (0.0, 9970.0), 1500.0
    # Half-power widths at 10 km, behind Hamming's window.
    titles = {"real_beam": "real beam: 3 degrees, 520 m", "dbs": "DBS: 64 pulses in 64 ms, 22 m", "sar": "SAR: 0.35 s of flight, 4 m"}
    figure, axes = plt.subplots(1, 3, figsize=(16, 5.7), layout="constrained")
    with obliq.local(SCENES / "town.toml") as server:
        for axis, (name, title) in zip(axes, titles.items()):
            info = server.radar(name).info()
            frame = server.render(info.settings, info.pose, planes="iq")
            image = 10 * np.log10(on_ground(frame, np.abs(frame.iq) ** 2, centre_m, side_m, 600))
            levels = np.nanpercentile(image, [8, 99.3])
            show(axis, image, levels, side_m, centre_m, title)
    figure.savefig(picture, dpi=100, pil_kwargs={"quality": 84})


def convoy(picture):
    looks, side_m = 8, 8000.0
    modes = {"map": "MTI off", "mti": "MTI on: two delays, woods in a wind of 5 m/s"}
    figure, axes = plt.subplots(1, 2, figsize=(14, 7.25), layout="constrained")
    images = []
    with obliq.local(SCENES / "mti_convoy.toml") as server:
        info = server.radar().info()
        bearing = np.radians(info.pose.bearing_deg)
        centre_m = (7000 * np.sin(bearing), 7000 * np.cos(bearing))
        for mode in modes:
            power = 0.0
            for frame in server.render_many([info.pose] * looks, info.settings.replace(mode=mode), planes="iq", seed=1, live_targets=True,
                                            truth=True):
                power = power + np.abs(frame.iq) ** 2 / looks
            images.append(10 * np.log10(on_ground(frame, power, centre_m, side_m, 640)))
    # One scale for both: from the noise to what is bright.
    levels = np.nanpercentile(images[1], 55), np.nanpercentile(images[0], 99.7)
    antenna = frame.descriptor.antenna_y_m - frame.descriptor.map_reference_height_m
    ground_km = np.sqrt(frame.targets["range_m"] ** 2 - antenna**2) / 1000
    at = np.radians(frame.targets["bearing_deg"])
    for axis, image, title in zip(axes, images, modes.values()):
        show(axis, image, levels, side_m, centre_m, title)
        axis.plot(ground_km * np.sin(at), ground_km * np.cos(at), "o", markersize=19, markerfacecolor="none", markeredgecolor="orange")
    figure.savefig(picture, dpi=85, pil_kwargs={"quality": 84})


def main():
    folder = pathlib.Path(sys.argv[1])
    town(folder / "modes.jpg")
    convoy(folder / "mti.jpg")


if __name__ == "__main__":
    main()
