#!/usr/bin/env python3
"""The guide's picture of fields and roads from a raster of decibels ([[surfaces]] gamma_raster) over synthetic hills.

  deploy/plots/fields.py OBLIQ FOLDER      writes fields.jpg there; OBLIQ: the program; needs gdal_translate

The raster, an ESRI ASCII grid with its .prj, is made up: fields of some 600 m, -8 to 5 dB, roads every two kilometres, 9 dB.
"""
import pathlib
import random
import subprocess
import sys
import tempfile

SIDE, CELL_DEG = 800, 1 / 4000
WGS84 = ('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
         'UNIT["degree",0.0174532925199433]]')
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 20
[terrain.shape]
height_m = 120
[[surfaces]]
gamma_raster = "fields.asc"
[antenna]
latitude_deg = 32.94
longitude_deg = -99.5
height_m = 2500
bearing_deg = 0
[radar]
r_min_m = 2600
r_max_m = 14000
sector_deg = 80
range_normalisation = true
[frustum]
kind = "sweep"
"""


def value_db(row, column):
    across, along = column + 0.15 * row, row - 0.15 * column
    if across % 78 < 1.5 or along % 85 < 1.5:
        return 9
    return random.Random(int(across // 26) * 7919 + int(along // 17) * 104729).choice((-8, -5, -3, 0, 0, 2, 5))


def write_raster(file):
    rows = [" ".join(str(value_db(row, column)) for column in range(SIDE)) for row in range(SIDE)]
    head = (f"ncols {SIDE}\nnrows {SIDE}\nxllcorner {-99.5 - SIDE * CELL_DEG / 2}\nyllcorner {33 - SIDE * CELL_DEG / 2}\n"
            f"cellsize {CELL_DEG}\n")
    file.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    file.with_suffix(".prj").write_text(WGS84, encoding="utf-8")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as scratch:
        at = pathlib.Path(scratch)
        write_raster(at / "fields.asc")
        (at / "fields.toml").write_text(SCENE, encoding="utf-8")
        subprocess.run([program, "render", str(at / "fields.toml"), "--out", str(at / "out")], check=True, capture_output=True)
        subprocess.run(["gdal_translate", "-q", "-of", "JPEG", "-b", "1", "-b", "2", "-b", "3", "-outsize", "900", "0", "-r", "average", "-co", "QUALITY=80",
                        str(at / "out/ground_map.png"), str(folder / "fields.jpg")], check=True)
    (folder / "fields.jpg.aux.xml").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
