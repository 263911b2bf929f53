#!/usr/bin/env python3
"""Makes up the town of deploy/scenes/town.toml: its houses, and what the ground between them is.

  deploy/plots/town.py [FOLDER]      writes town_houses.geojson and town_ground.geojson; default: deploy/scenes
"""
import json
import math
import pathlib
import random
import sys

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"
LATITUDE_DEG, LONGITUDE_DEG = 33.09, -99.5  # of the market place
METRES_PER_DEGREE = 6371e3 * math.pi / 180


def place(x_m, y_m):
    """East and north of the market place to longitude and latitude."""
    return [round(LONGITUDE_DEG + x_m / METRES_PER_DEGREE / math.cos(math.radians(LATITUDE_DEG)), 6),
            round(LATITUDE_DEG + y_m / METRES_PER_DEGREE, 6)]


def feature(ring, **properties):
    return {"type": "Feature", "properties": properties,
            "geometry": {"type": "Polygon", "coordinates": [[place(*point) for point in [*ring, ring[0]]]]}}


def rectangle(x, y, length, width, turned_deg=0.0):
    c, s = math.cos(math.radians(turned_deg)), math.sin(math.radians(turned_deg))
    corners = [(-length / 2, -width / 2), (length / 2, -width / 2), (length / 2, width / 2), (-length / 2, width / 2)]
    return [(x + c * a - s * b, y + s * a + c * b) for a, b in corners]


def band(points, width):
    """A road or a river along points."""
    sides = [], []
    for k, (x, y) in enumerate(points):
        (x0, y0), (x1, y1) = points[max(k - 1, 0)], points[min(k + 1, len(points) - 1)]
        along = math.hypot(x1 - x0, y1 - y0)
        across = (-(y1 - y0) / along * width / 2, (x1 - x0) / along * width / 2)
        sides[0].append((x + across[0], y + across[1]))
        sides[1].append((x - across[0], y - across[1]))
    return sides[0] + sides[1][::-1]


def houses():
    dice = random.Random(5)
    made = []

    def house(x, y, length, width, turned_deg, height_m):
        made.append(feature(rectangle(x, y, length, width, turned_deg), height=round(height_m, 1)))

    for radius, count in ((70, 16), (105, 24), (150, 34), (190, 44)):  # the old town, in rings about the market place
        for k in range(count):
            angle = 360 * (k + dice.uniform(0.3, 0.7)) / count
            if min(abs((angle + 45) % 90 - 45), 90) * math.pi / 180 * radius < 14:
                continue  # the four roads
            x, y = radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle))
            house(x, y, dice.uniform(15, 20), dice.uniform(9, 12), angle + 90 + dice.uniform(-6, 6), dice.uniform(7, 12))
    house(30, 22, 38, 16, 8, 22)  # the church
    for column in range(5):  # a new quarter: streets every 80 m
        for row in range(5):
            for k in range(4):
                for side in (-1, 1):
                    x, y = 290 + 80 * column + 17.0 * (k - 1.5), 130 + 80 * row + 19 * side
                    house(x, y, dice.uniform(10, 13), dice.uniform(8, 10), dice.uniform(-2, 2), dice.uniform(5, 8))
    for k in range(6):  # blocks of flats
        house(-260 + 6 * k, 150 + 62 * k, 60, 13, 20, 25)
    for k in range(3):  # halls and tanks of a works
        house(330 + 95 * k, -200, 80, 40, -6, 12)
    for k in range(8):
        x, y = 320 + 48 * (k % 4), -320 - 48 * (k // 4)
        corners = [(x + 15 * math.cos(math.radians(45 * n)), y + 15 * math.sin(math.radians(45 * n))) for n in range(8)]
        made.append(feature(corners, height=14))
    for k in range(4):  # hangars
        house(-330 + 70 * k, -330, 45, 35, 10, 11)
    return made


def ground():
    dice = random.Random(6)
    made = []
    for row in range(-7, 8):  # fields
        for column in range(-5, 6):
            kind = dice.choice(("bare", "grass", "stubble", "stubble", "crop"))
            made.append(feature(rectangle(180 * column + 45 * (row % 2), 130 * row, 176, 126, 6), kind=kind))
    made.append(feature([(-900, 420), (-520, 330), (-330, 470), (-350, 760), (-620, 900), (-900, 880)], kind="forest"))
    made.append(feature([(420, -560), (700, -500), (900, -640), (880, -900), (560, -880)], kind="forest"))
    made.append(feature([(-230, -230), (230, -230), (230, 230), (-230, 230)], kind="grass"))
    river = [(-1000, 40), (-760, 110), (-560, 60), (-430, -80), (-300, -190), (-100, -250), (120, -260), (260, -420), (380, -640),
             (360, -1000)]
    made.append(feature(band(river, 42), kind="water"))
    made.append(feature(rectangle(-330, -450, 1000, 45, 10), kind="road"))  # the runway
    roads = [[(-1000, 0), (1000, 20)], [(0, -1000), (0, 1000)], [(0, -200), (600, -260)],
             *([(240, 90 + 80 * k), (700, 90 + 80 * k)] for k in range(6)), *([(250 + 80 * k, 0), (250 + 80 * k, 500)] for k in range(6))]
    made += [feature(band(road, 11), kind="road") for road in roads]
    return made


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else SCENES
    for name, features in (("town_houses", houses()), ("town_ground", ground())):
        lines = ",\n".join(json.dumps(one) for one in features)
        head = '{"type": "FeatureCollection", "description": "Made up by deploy/plots/town.py.", "features": ['
        (folder / f"{name}.geojson").write_text(f"{head}\n{lines}\n]}}\n")


if __name__ == "__main__":
    main()
