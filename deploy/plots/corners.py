#!/usr/bin/python3
"""The guide's picture of a town's corners: two headings 3 degrees apart, corners off and on.

  deploy/plots/corners.py FOLDER      writes corners.jpg there; needs obliqd, matplotlib and the package obliq
"""
import math
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from modes import SCENES, obliq, on_ground

DISTANCE_M = 10400.0  # from the antenna to what it turns about
TOWN_M = (420.0, 10330.0)  # the rectangular quarter's middle, east and north of the scene's antenna


def looks(pose):
    """The scene's own pose, and one turned about the town by 3 degrees."""
    yield 0.0, pose
    turn = math.radians(3)
    east, north = -DISTANCE_M * math.sin(turn), DISTANCE_M * (1 - math.cos(turn))
    yield 3.0, pose.replace(
        latitude_deg=pose.latitude_deg + north / 110_900,
        longitude_deg=pose.longitude_deg + east / (111_320 * math.cos(math.radians(pose.latitude_deg))),
        bearing_deg=3.0,
    )


def main():
    folder = pathlib.Path(sys.argv[1])
    figure, axes = plt.subplots(2, 2, figsize=(12, 12.4), layout="constrained")
    levels = None
    for row, corners in enumerate([False, True]):
        scene = folder / "corners_scene.toml"
        text = (SCENES / "town.toml").read_text(encoding="utf-8")
        text = text.replace("corners = true", f"corners = {str(corners).lower()}").replace('source = "', f'source = "{SCENES}/')
        text = text[: text.index('[[radar]]\nname = "dbs"')]  # one of its radars is enough
        scene.write_text(text, encoding="utf-8")
        with obliq.local(scene) as server:
            info = server.radar("real_beam").info()
            settings = info.settings.replace(beam_pattern="off", pulse_kind="off", speckle="none")
            for axis, (turned, pose) in zip(axes[row], looks(info.pose)):
                frame = server.render(settings, pose, planes="power")
                # Of the town, from the second antenna's place.
                centre = (TOWN_M[0] + DISTANCE_M * math.sin(math.radians(turned)), TOWN_M[1] - DISTANCE_M * (1 - math.cos(math.radians(turned))))
                image = 10 * np.log10(np.maximum(on_ground(frame, frame.power, centre, 480.0, 600), 1e-30))
                if levels is None:
                    ground = np.nanmedian(image)
                    levels = ground - 10, ground + 32
                axis.imshow(image, cmap="gray", vmin=levels[0], vmax=levels[1])
                axis.set_title(f"heading {turned:.0f} deg, corners {'on' if corners else 'off'}")
                axis.set_axis_off()
        scene.unlink()
    figure.savefig(folder / "corners.jpg", dpi=85, pil_kwargs={"quality": 84})


if __name__ == "__main__":
    main()
