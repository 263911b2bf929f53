#!/usr/bin/python3
"""Runs the fenced blocks of a page, in order, as its reader would: sh and bash in one shell, python with an interpreter that
has the package, toml into the file that the words before it name.

  run_blocks.py PAGE.md --bin DIR [--list]

A block with the line "<!-- not run: WHY -->" before it is counted, not run. Files of the reader's own (ground.tif ...) are made
up first. Ports are any free ones in place of those of the page. Exit code 77 where gdal_translate is missing.
"""
import argparse
import contextlib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import programs  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RUN = ("sh", "bash", "python", "toml")
PORTS = (7420, 7421, 7430, 7480, 7481, 1502)
TRACK = "0,{0},{1},{2},60\n2,{0},{1},{2},70\n"
# Marks are few, and a new one is noticed.
NOT_RUN = {"README.md": 2, "client/guide/guide.md": 3, "client/guide/instructor.md": 1, "client/guide/data.md": 0,
           "client/guide/operator.md": 1, "client/python/README.md": 3}
POSES = "".join('{"id": "a%d", "latitude_deg": 36.302, "longitude_deg": -107.585, "height_m": 4000, "bearing_deg": %d}\n' % (k, k)
                for k in range(20))


def blocks(page):
    """(kind, text, why it is not run or None, the paragraph before)."""
    found = []
    text = page.read_text()
    for match in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.M | re.S):
        before = text[: match.start()].rstrip().splitlines()
        mark = re.fullmatch(r"<!-- not run: (.+) -->", before[-1]) if before else None
        found.append((match.group(1), match.group(2), mark.group(1) if mark else None, "\n".join(before[-6:])))
    return found


def elevation(path, west, south, side_deg, n=240):
    """Hills as a GeoTIFF."""
    y, x = np.mgrid[0:n, 0:n] / n
    heights = (2000 + 150 * np.sin(9 * x) * np.cos(7 * y) + 40 * np.sin(31 * x + 17 * y)).astype("<f4")
    raw = path.with_suffix(".raw")
    heights.tofile(raw)
    raw.with_suffix(".hdr").write_text(f"ENVI\nsamples = {n}\nlines = {n}\nbands = 1\ndata type = 4\ninterleave = bsq\n"
                                       "byte order = 0\nheader offset = 0\n")
    subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:4326", "-a_ullr", str(west), str(south + side_deg),
                    str(west + side_deg), str(south), str(raw), str(path)], check=True)


def polygon(path, west, south, side_deg, fields):
    ring = [[west, south], [west + side_deg, south], [west + side_deg, south + side_deg], [west, south + side_deg], [west, south]]
    path.write_text('{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": %s, "geometry": '
                    '{"type": "Polygon", "coordinates": [%s]}}]}' % (fields, ring))


def readers_files(folder):
    """What a page takes for granted, at the places that it has in mind."""
    elevation(folder / "ground.tif", -118.8, 33.7, 0.7)
    polygon(folder / "houses.geojson", -118.40, 34.06, 0.001, '{"HEIGHT_ft": 60}')
    polygon(folder / "lakes.geojson", -118.38, 34.05, 0.01, "{}")
    (folder / "track.csv").write_text(TRACK.format(34.02, -118.46, 1500))
    (folder / "poses.jsonl").write_text(POSES)
    # The tree, with the demo's ground made up and coarse.
    for name in ("build", "client", "proto", "server", "tests", "README.md"):
        (folder / name).symlink_to(ROOT / name)
    shutil.copytree(ROOT / "deploy", folder / "deploy", ignore=shutil.ignore_patterns("data", "pictures"))
    (folder / "deploy" / "scenes" / "data").mkdir()
    track = folder / "deploy" / "scenes" / "demo_track.csv"  # flown in a tenth of its half minute
    track.write_text(re.sub(r"(?m)^\d+", lambda time: str(int(time[0]) / 10), track.read_text()))
    elevation(folder / "deploy" / "scenes" / "data" / "new_mexico_ned13.tif", -107.72, 36.28, 0.26)
    shutil.copy(folder / "deploy" / "scenes" / "demo.toml", folder / "scene.toml")
    scene = (folder / "scene.toml").read_text().replace("data/", "deploy/scenes/data/").replace(
        '"new_mexico_valleys', '"deploy/scenes/new_mexico_valleys')
    (folder / "scene.toml").write_text(scene)


def free_ports():
    return dict(zip(PORTS, programs.free_ports(len(PORTS))))


# Daemons that a page's words say are there.
DAEMON = "obliqd --config deploy/scenes/demo.toml --port {port} --set http.port={http} >{port}.log 2>&1 &\n"
WAIT = "obliq get --server :{port} --wait 60 --planes state --azimuths 0:8 --out ready-{port} >/dev/null\n"
BEFORE = {"client/guide/instructor.md": [7420], "client/guide/data.md": [7420], "client/guide/operator.md": [7420, 7421],
          "client/python/README.md": [7420]}


def script_of(page, ports, python):
    name = str(page.relative_to(ROOT))
    lines = ["set -euo pipefail\n", f'python() {{ {python} "$@"; }}\n']
    for port in BEFORE.get(name, []):
        lines += [DAEMON.format(port=port, http=7480 if port == 7420 else 0), WAIT.format(port=port)]
    ran = skipped = 0
    for kind, text, why, words in blocks(page):
        if kind not in RUN:
            continue
        if why:
            skipped += 1
            print(f"not run: {why}", flush=True)
            continue
        ran += 1
        lines.append(f"echo '--- block {ran}' >&2\n")
        if kind == "toml":
            target = re.search(r"[Ss]ave this as `([\w.]+)`", words).group(1)
            lines.append(f"cat >{target} <<'END_OF_BLOCK'\n{text}END_OF_BLOCK\n")
        elif kind == "python":
            lines.append(f"{python} - <<'END_OF_BLOCK'\n{text}END_OF_BLOCK\n")
        else:
            lines.append(text)
    script = "".join(lines)
    for port, free in ports.items():
        script = re.sub(rf"\b{port}\b", str(free), script)
    return script, ran, skipped


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--list", action="store_true")
    given = parser.parse_args()
    page = given.page.resolve()
    ports = free_ports()
    script, ran, skipped = script_of(page, ports, sys.executable)
    wanted = NOT_RUN.get(str(page.relative_to(ROOT)), skipped)
    if skipped != wanted:
        print(f"{page.name}: found {skipped} blocks marked as not run; allowed: {wanted}")
        return 1
    if given.list:
        print(script)
        return 0
    if not shutil.which("gdal_translate"):
        print("gdal-bin is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        readers_files(pathlib.Path(folder))
        environment = {**os.environ, "PATH": f"{given.bin.resolve()}:{os.environ['PATH']}", "OBLIQ_SERVER_PORT": str(ports[7420]),
                       "OBLIQ_HTTP_PORT": str(ports[7480]), "OBLIQ_CACHE_DIR": "", "PYTHONPATH": str(ROOT / "client/python/src"),
                       "OBLIQ_SERVER": f"127.0.0.1:{ports[7420]}"}
        said = pathlib.Path(folder) / "said"
        with open(said, "w") as log:
            shell = subprocess.Popen(["bash", "-c", script], cwd=folder, env=environment, stdout=log, stderr=log,
                                     start_new_session=True)
            try:
                code = shell.wait()
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(shell.pid, signal.SIGKILL)  # what it left running
        lines = said.read_text(errors="replace").splitlines(True)
    if code != 0:
        print("".join(lines[-40:]))
        print(f"{page.name}: the block above ended with exit code {code}")
        return 1
    print(f"{page.name}: {ran} blocks ran, {skipped} are marked as not run")
    return 0


if __name__ == "__main__":
    sys.exit(main())
