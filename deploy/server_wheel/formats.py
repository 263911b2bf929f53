#!/usr/bin/env python3
"""formats.py WHEEL: the programs of the wheel render from every format that its README names. Needs gdal_translate and ogr2ogr of
this machine, which write the files; the programs run without this machine's GDAL, PROJ and fonts."""
from __future__ import annotations

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import zipfile

WEST, SOUTH = -108, 36  # a tile of one degree: SRTMHGT has no other
SIDE = 1201
RASTERS = {
    "GTiff": ("g.tif", ["-co", "COMPRESS=DEFLATE"]), "GTiff, ZSTD": ("z.tif", ["-co", "COMPRESS=ZSTD"]),
    "GTiff, LERC": ("l.tif", ["-co", "COMPRESS=LERC"]), "VRT": ("g.vrt", []), "USGSDEM": ("g.dem", ["-a_nodata", "-32767"]),
    "EHdr": ("g.bil", []), "AAIGrid": ("g.asc", []), "HFA": ("g.img", []), "SRTMHGT": ("N36W108.hgt", []),
}
VECTORS = {"GeoJSON": "b.geojson", "GPKG": "b.gpkg", "ESRI Shapefile": "b.shp"}
SCENE = """
[terrain]
dem = [{dem}]
area = [-107.6, 36.4, -107.5, 36.5]
[[buildings]]
source = {buildings}
height_field = "height_m"
[antenna]
latitude_deg = 36.45
longitude_deg = -107.55
height_m = 800.0
height_reference = "ground"
[radar]
sector_deg = 60.0
r_min_m = 1000.0
r_max_m = 4000.0
[bins]
azimuth = 32
range = 64
"""


def run(*words: str | os.PathLike[str], **more: str) -> str:
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, **more})
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))}: {done.stdout}")
    return done.stdout


def write_ground(folder: pathlib.Path) -> None:
    """A tile of waves, and four houses within the sector."""
    rows = (" ".join(str(int(1500 + 100 * math.sin(i / 20) * math.cos(j / 30))) for j in range(SIDE)) for i in range(SIDE))
    half = 0.5 / (SIDE - 1)
    head = f"ncols {SIDE}\nnrows {SIDE}\nxllcorner {WEST - half}\nyllcorner {SOUTH - half}\ncellsize {1 / (SIDE - 1)}\n"
    (folder / "made.asc").write_text(head + "\n".join(rows) + "\n")
    for name, (file, options) in RASTERS.items():
        run("gdal_translate", "-q", "-ot", "Int16", "-a_srs", "EPSG:4326", "-of", name.partition(",")[0], *options,
            folder / "made.asc", folder / file)
    houses = []
    for east, north in ((0.01, 0.012), (0.012, 0.014), (0.008, 0.02), (0.0, 0.02)):
        x, y, d = -107.55 + east, 36.45 + north, 0.0002
        houses.append({"type": "Feature", "properties": {"height_m": 12.0}, "geometry": {"type": "Polygon", "coordinates": [
            [[x, y], [x + d, y], [x + d, y + d], [x, y + d], [x, y]]]}})
    (folder / "b.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": houses}))
    for name, file in VECTORS.items():
        if not (folder / file).exists():
            run("ogr2ogr", "-f", name, folder / file, folder / "b.geojson")


def main() -> None:
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        with zipfile.ZipFile(sys.argv[1]) as archive:
            archive.extractall(folder)
        sys.path.insert(0, scratch)
        import obliq_server  # the wheel's

        for program in (folder / "obliq_server/bin").iterdir():
            program.chmod(0o755)
        write_ground(folder)
        pairs = [(name, file, "b.geojson") for name, (file, _) in RASTERS.items()]
        pairs += [(name, "g.tif", file) for name, file in VECTORS.items()]
        for name, dem, buildings in pairs:
            scene = folder / "scene.toml"
            scene.write_text(SCENE.format(dem=json.dumps(str(folder / dem)), buildings=json.dumps(str(folder / buildings))))
            said = run(obliq_server.program("obliq"), "render", scene, "--out", folder / "frame", **obliq_server.environment(),
                       OBLIQ_CACHE_DIR="")
            if "4 in the scene" not in said or "error" in said.lower():
                raise SystemExit(f"{name}: {said}")
            print(f"{name}: rendered")


if __name__ == "__main__":
    main()
