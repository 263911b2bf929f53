#!/usr/bin/python3
"""How long a seek takes in a served recording: from the request to the whole picture at a station.

  tests/bench/seek.py [--minutes 60] [--seeks 40] [--keep FOLDER]

Two made recordings: 10 frames/s of 128 x 256 bins, and an antenna that turns in 2.5 s with 720 x 1024 bins, 1 GB each an hour. The
replay is paused; each seek goes to a random place. With --keep they are kept, and used again.
"""
import argparse
import os
import pathlib
import random
import statistics
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "python"))
import made_recording  # noqa: E402
from support import obliq, programs  # noqa: E402

CASES = {"10 frames/s": dict(azimuths=128, ranges=256), "a turn in 2.5 s": dict(azimuths=720, ranges=1024, scan_s=2.5)}


def measure(path, step_s, seeks):
    began_s = time.monotonic()
    replay = programs.replay(path, "--hold")
    ready_s = time.monotonic() - began_s
    took_s = []
    place = random.Random(1)
    try:
        with obliq.connect(replay.address) as server:
            server.replay.pause()
            duration_s = server.replay.state().duration_s
            with server.radar().stream(rate_hz=100, planes="video") as frames:
                for _ in range(seeks):
                    to_s = place.uniform(step_s, duration_s)
                    before = int(to_s / step_s)  # number of the frame before that of the place, from 1
                    began_s = time.monotonic()
                    server.replay.seek(to_s)
                    while next(frames).pose.pose_id not in (before, before + 1):
                        pass
                    took_s.append(time.monotonic() - began_s)
    finally:
        replay.stop()
    return ready_s, took_s


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--minutes", type=float, default=60)
    options.add_argument("--seeks", type=int, default=40)
    options.add_argument("--keep", type=pathlib.Path)
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, case) in enumerate(CASES.items()):
            path = (given.keep or pathlib.Path(folder)) / f"seek-{number}-{given.minutes:g}.obliq"
            if not path.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                made_recording.write(path, 60 * given.minutes, **case)
            ready_s, took_s = measure(path, case.get("scan_s", 0.1), given.seeks)
            print(f"{name}, {given.minutes:g} minutes, {path.stat().st_size / 1e9:.2f} GB: ready in {ready_s:.2f} s; {len(took_s)} seeks, "
                  f"whole picture after {1000 * statistics.median(took_s):.0f} ms (median), {1000 * max(took_s):.0f} ms (greatest); "
                  f"load {os.getloadavg()[0]:.1f}", flush=True)


if __name__ == "__main__":
    main()
