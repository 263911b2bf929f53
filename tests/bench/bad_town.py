#!/usr/bin/env python3
"""Writes a town of bad footprints and a scene that loads it, for plan_bench: a million outlines of which a third
are duplicates, a third a copy of the same data set a hand's breadth off, and among the rest slivers, houses of
1 mm and of 10 km, rings that cross themselves, points that repeat and rings of two corners.

    tests/bench/bad_town.py FOLDER [OUTLINES] && build/release/bin/plan_bench FOLDER/town.toml
"""
import json
import math
import pathlib
import random
import sys

DEGREE_M = 111320.0
EAST_DEG, NORTH_DEG = -99.5, 33.17  # the middle of the area of million.toml


def ring(corners_m, east_m, north_m):
    """Corners in metres around a place, as closed longitudes and latitudes."""
    per_east = DEGREE_M * math.cos(math.radians(NORTH_DEG))
    points = [[round(EAST_DEG + (east_m + x) / per_east, 9), round(NORTH_DEG + (north_m + y) / DEGREE_M, 9)] for x, y in corners_m]
    return points + points[:1]


def rectangle(width_m, depth_m):
    return [(0, 0), (width_m, 0), (width_m, depth_m), (0, depth_m)]


def outline(dice):
    """One of the odd kinds now and then, else a house, a third of them concave."""
    kind = dice.randrange(1000)
    width, depth = dice.uniform(6, 25), dice.uniform(6, 25)
    if kind < 20:
        return rectangle(0.02, depth)  # a sliver
    if kind < 40:
        return rectangle(0.001, 0.001)
    if kind < 45:
        return rectangle(10000, 10000)
    if kind < 50:
        return rectangle(4000, 4000)
    if kind < 60:
        return [(0, 0), (width, depth), (width, 0), (0, depth)]  # crosses itself
    if kind < 70:
        return [(0, 0)] * 5 + rectangle(width, depth)[1:]
    if kind < 80:
        return [(0, 0), (width, 0)]
    if kind < 400:
        return [(0, 0), (width, 0), (width, depth / 2), (width / 3, depth / 2), (width / 3, depth), (0, depth)]
    return rectangle(width, depth)


def main():
    folder = pathlib.Path(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 1000000
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "town.geojsonl", "w", encoding="utf-8") as file:
        for shift_m in (0, 0, 0.15):
            dice = random.Random(16)
            for _ in range(count // 3):
                points = ring(outline(dice), dice.uniform(-31000, 20000) + shift_m, dice.uniform(-18000, 8000))
                geometry = {"type": "Polygon", "coordinates": [points]}
                feature = {"type": "Feature", "properties": {"height": round(dice.uniform(3, 30), 1)}, "geometry": geometry}
                file.write(json.dumps(feature, separators=(",", ":")) + "\n")
    scene = pathlib.Path(__file__).with_name("million.toml").read_text(encoding="utf-8")
    begin, end = scene.index("[[prisms]]"), scene.index("[antenna]")
    source = f'[[buildings]]\nsource = "{(folder / "town.geojsonl").resolve()}"\n\n'
    (folder / "town.toml").write_text(scene[:begin] + source + scene[end:], encoding="utf-8")


main()
