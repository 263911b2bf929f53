"""A first picture: a radar map of made-up hills, or of ground that an elevation model gives.

    python3 -m obliq.demo out.png
    python3 -m obliq.demo out.png --dem ground.tif
"""
from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

from .errors import ObliqError
from .local import find_program, local

# The antenna stands over the ground's middle, as where a scene names no place.
SCENE = """
[terrain]
{terrain}
[[prisms]]
per_km2 = 10.0
[antenna]
height_m = 1500.0
height_reference = "ground"
[radar]
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = {r_max_m:.0f}
range_normalisation = true
[bins]
azimuth = 512
range = 1024
"""
HILLS = 'synthetic = "hills"\ncell_m = 20.0\nshape = {height_m = 1600.0, seed = 1}'


def draw(scene: pathlib.Path, picture: pathlib.Path) -> None:
    """The picture of `obliq render`, for which no package of Python's is needed."""
    program, environment = find_program("obliq")
    ran = subprocess.run([program, "render", scene, "--north-up", "--out", scene.parent], check=False, env=environment,
                         capture_output=True, text=True)
    if ran.returncode != 0:
        raise ValueError(ran.stderr.strip())
    shutil.copyfile(scene.parent / "ground_map.png", picture)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python3 -m obliq.demo", description=__doc__.partition("\n")[0])
    parser.add_argument("picture", type=pathlib.Path, help="a file by its suffix: .png, .npz, .tif, .nc")
    parser.add_argument("--dem", type=pathlib.Path, help="elevation model that GDAL opens; default: made-up hills")
    parser.add_argument("--range", type=float, default=20e3, metavar="METRES", help="outer range (default: %(default)g)")
    asked = parser.parse_args(arguments)
    terrain = f"dem = [{json.dumps(str(asked.dem.resolve()))}]" if asked.dem else HILLS
    with tempfile.TemporaryDirectory(prefix="obliq-demo-") as folder:
        scene = pathlib.Path(folder, "scene.toml")
        scene.write_text(SCENE.format(terrain=terrain, r_max_m=asked.range), encoding="utf-8")
        try:
            if asked.picture.suffix == ".png":
                draw(scene, asked.picture)
            else:
                with local(scene) as server:
                    server.radar().frame().save(asked.picture)
        except (ObliqError, OSError, ValueError, ImportError) as error:
            print(f"obliq.demo: {error}", file=sys.stderr)
            return 1
    print(asked.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
