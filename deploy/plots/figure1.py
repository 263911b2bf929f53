#!/usr/bin/python3
"""The paper's Figure 1: the same scene through the symmetric and the oblique frustum, the whole map and a
zoom at far range, on one grey scale. The inputs are folders that `obliq render` or `obliq get` wrote.

  deploy/plots/figure1.py out/symmetric out/oblique figure1.png [--zoom EAST_KM NORTH_KM SIZE_KM]
"""
import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

PIXELS = 1000


class Frame:
    """One frame's |bin|^2 in dB, with the ground positions of its bins."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        document = json.loads((folder / "frame.json").read_text(encoding="utf-8"))
        described = document["frame"]
        self.buildings_seen = document["summary"]["buildings_seen"]
        self.buildings = described["buildings_in_scene"]
        self.azimuth_start_deg = described["azimuth_start_deg"]
        self.azimuth_width_deg = described["azimuth_width_deg"]
        self.range_start_m = described["range_start_m"]
        self.range_spacing_m = described["range_spacing_m"]
        # Flat ground at the median height is good enough for a picture; ground_map.tif is exact.
        self.height_m = described["antenna_y_m"] - described["map_reference_height_m"]
        bins = np.load(folder / "bins.npy")
        with np.errstate(divide="ignore"):
            self.level_db = 20 * np.log10(np.abs(bins))
        self.reach_m = self.range_start_m + bins.shape[1] * self.range_spacing_m
        state = np.load(folder / "state.npy")
        # Of the bins that hold something visible (0: visible but missed by every ray, 1: sampled).
        self.sampled_share = (state == 1).sum() / max(1, (state <= 1).sum())

    def map_db(self, east_m, north_m):
        """The level at ground positions relative to the antenna; NaN outside the sector."""
        bearing_deg = np.degrees(np.arctan2(east_m, north_m))
        turned_deg = np.mod(bearing_deg - self.azimuth_start_deg, 360)
        slant_m = np.sqrt(east_m**2 + north_m**2 + self.height_m**2)
        azimuth = np.floor(turned_deg / self.azimuth_width_deg).astype(int)
        range_bin = np.floor((slant_m - self.range_start_m) / self.range_spacing_m).astype(int)
        n_azimuth, n_range = self.level_db.shape
        inside = (azimuth < n_azimuth) & (range_bin >= 0) & (range_bin < n_range)
        level = self.level_db[np.where(inside, azimuth, 0), np.where(inside, range_bin, 0)]
        return np.where(inside, level, np.nan)


def extent_of_sector(frame):
    """West, east, south, north of the sector around the antenna, metres."""
    n_azimuth = frame.level_db.shape[0]
    edges = np.radians(frame.azimuth_start_deg + frame.azimuth_width_deg * np.arange(n_azimuth + 1))
    east, north = frame.reach_m * np.sin(edges), frame.reach_m * np.cos(edges)
    return min(0, east.min()), max(0, east.max()), min(0, north.min()), max(0, north.max())


def draw(axes, frame, extent, scale, title):
    west, east, south, north = extent
    pixel_m = max(east - west, north - south) / PIXELS
    east_m, north_m = np.meshgrid(np.arange(west, east, pixel_m), np.arange(north, south, -pixel_m))
    shown = frame.map_db(east_m, north_m)
    axes.set_facecolor("0.35")  # outside the sector; black inside it is a bin without any return
    axes.imshow(np.where(np.isneginf(shown), scale[0], shown), cmap="gray", vmin=scale[0], vmax=scale[1],
                extent=[v / 1000 for v in extent], interpolation="nearest")
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("east (km)")
    axes.set_ylabel("north (km)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("symmetric", help="folder of the symmetric frame")
    parser.add_argument("oblique", help="folder of the oblique frame")
    parser.add_argument("picture", help="PNG or JPEG to write")
    parser.add_argument("--zoom", nargs=3, type=float, metavar=("EAST_KM", "NORTH_KM", "SIZE_KM"),
                        help="centre and side of the zoom; default: the far end of the sector's middle")
    arguments = parser.parse_args()

    frames = {"symmetric": Frame(arguments.symmetric), "oblique": Frame(arguments.oblique)}
    whole = frames["oblique"]
    if arguments.zoom:
        east_m, north_m, side_m = (v * 1000 for v in arguments.zoom)
    else:
        middle = np.radians(whole.azimuth_start_deg + whole.azimuth_width_deg * whole.level_db.shape[0] / 2)
        east_m, north_m = 0.85 * whole.reach_m * np.sin(middle), 0.85 * whole.reach_m * np.cos(middle)
        side_m = whole.reach_m / 5
    zoom = (east_m - side_m / 2, east_m + side_m / 2, north_m - side_m / 2, north_m + side_m / 2)

    returns = whole.level_db[np.isfinite(whole.level_db)]
    scale = np.percentile(returns, [2, 99.5])
    extent = extent_of_sector(whole)
    shape = (extent[3] - extent[2]) / (extent[1] - extent[0])
    figure, axes = plt.subplots(2, 2, figsize=(12, 12 * (shape + 1) / 2), layout="constrained",
                                height_ratios=[shape, 1])
    for column, (name, frame) in enumerate(frames.items()):
        title = (f"{name} frustum: {100 * frame.sampled_share:.0f} % of the visible bins sampled,\n"
                 f"{frame.buildings_seen} of {frame.buildings} buildings seen")
        draw(axes[0, column], frame, extent, scale, title)
        draw(axes[1, column], frame, zoom, scale, f"{name}, zoom")
    figure.savefig(arguments.picture, dpi=100)


if __name__ == "__main__":
    main()
