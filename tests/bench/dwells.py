#!/usr/bin/python3
"""A host that commands the beam over Los Angeles: dwells of 16 degrees at 60 Hz, asked for by client/examples/dwell.cpp.

  tests/bench/dwells.py [--dwells 600] [--turns 3] [--bins 512x512] [--set KEY=VALUE]... [--scene FILE] [--python]

A beam of 3 degrees, a pulse of 0.25 us, receiver noise. Prints how long each dwell took from its request, which is the moment
when it was due, to the first and to the last of its values: of I&Q, then of the video, which is from pose to video. Wanted are
99 % within 33 ms and 99.9 % within 50 ms, and what the server's processor time was, which says the same on a machine that others
use: at 60 Hz two threads have 33 ms a dwell. The same mission, flown again, must have the same sums. --python: also by dwell.py.
Without Los Angeles (the scene file says where it is looked for) it says so and ends with 77.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "client" / "python" / "src"))
sys.path.append(str(ROOT / "tests" / "support"))
import obliq  # noqa: E402
import programs  # noqa: E402

BIN = pathlib.Path(os.environ.get("OBLIQ_BIN", ROOT / "build" / "release" / "bin"))
SCENE = ROOT / "deploy" / "scenes" / "losangeles.toml"
# The scene file has the paper's radar: an ideal one, without noise, by rays.
RADAR = {"frustum.quality": "draft", "radar.range_normalisation": False, "beam.pattern": "gaussian",
         "beam.width_deg": 3.0, "pulse.kind": "rectangular", "pulse.length_us": 0.25, "receiver.noise": True}


def ground_of(scene):
    """Why its ground is missing, or None."""
    with open(scene, "rb") as file:
        for path in tomllib.load(file)["terrain"].get("dem", ()):
            if not (scene.parent / path).exists():
                return f"no {(scene.parent / path).resolve()}"
    return None


def processor_s(daemon):
    """User and system time of obliqd, which is the keeper's only child."""
    keeper = daemon._keeper.pid
    child = pathlib.Path(f"/proc/{keeper}/task/{keeper}/children").read_text().split()[0]
    return programs.processor_s(child)


def fly(command, address, radar, dwells, plane):
    words = [*command, address, radar, str(dwells), plane]
    return subprocess.run(words, check=True, capture_output=True, text=True, env={
        **os.environ, "PYTHONPATH": str(ROOT / "client" / "python" / "src")}).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dwells", type=int, default=600)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--bins", default="512x512", help="of the scene's whole sector of 120 degrees")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--scene", type=pathlib.Path, default=SCENE)
    parser.add_argument("--python", action="store_true")
    given = parser.parse_args()
    lacking = ground_of(given.scene)
    if lacking:
        print(f"skipped: Los Angeles: {lacking}")
        return 77
    azimuth, _, ranges = given.bins.partition("x")
    settings = {**RADAR, "bins.azimuth": azimuth, "bins.range": ranges, **dict(item.split("=", 1) for item in given.set)}
    print(", ".join(f"{key} {value}" for key, value in settings.items()))
    programs = {"C++": [str(BIN / "dwell")]}
    if given.python:
        programs["Python"] = [sys.executable, str(ROOT / "client" / "python" / "examples" / "dwell.py")]
    sums = {}
    daemon = obliq.local_daemon(given.scene, obliqd=BIN / "obliqd", settings=settings)
    try:
        with obliq.connect(daemon.address) as server:
            radar = server.info.radars[0]
        for turn in range(given.turns):
            for plane in ("iq", "video"):
                for name, command in programs.items():
                    before = processor_s(daemon)
                    said = fly(command, daemon.address, radar, given.dwells, plane)
                    each = 1000 * (processor_s(daemon) - before) / given.dwells
                    print(f"-- {plane}, {name}, mission {turn + 1}: {each:.1f} ms of the server's processor time a dwell\n{said}",
                          end="", flush=True)
                    sums.setdefault(plane, set()).add(re.search("sum (.*)", said).group(1))
    finally:
        daemon.stop()
    print("sums:", "; ".join(f"{plane} {', '.join(sorted(found))}" for plane, found in sums.items()))
    return 0 if all(len(found) == 1 for found in sums.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
