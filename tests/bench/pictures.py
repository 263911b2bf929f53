#!/usr/bin/env python3
"""How many pictures a second `obliq watch --picture` draws of a moving radar, and what one costs.

    tests/bench/pictures.py [BIN] [SECONDS] [--sector DEGREES]       default: build/release/bin, 20, 120

Starts obliqd on two cores with seeded hills and 512 x 512 bins, flies the radar over them by `obliq fly` at 30
poses a second, and watches as fast as frames come. A picture counts when the file in place is another one.
"""
import argparse
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from programs import processor_s  # noqa: E402

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 30.0
area = [-99.843, 32.8, -99.157, 33.4]
shape.height_m = 800.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 3000.0
[radar]
sector_deg = {sector}
r_min_m = 2000.0
r_max_m = 20000.0
[frustum]
quality = "standard"
[bins]
azimuth = 512
range = 512
[server]
port = 0
[http]
enabled = false
"""


def two_cores():
    os.sched_setaffinity(0, set(list(os.sched_getaffinity(0))[:2]))


def ready_at(log):
    for _ in range(1200):
        found = re.search(r"ready: main on (\S+)", log.read_text(encoding="utf-8"))
        if found:
            return found.group(1)
        time.sleep(0.1)
    sys.exit("obliqd is not ready:\n" + log.read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", nargs="?", default="build/release/bin")
    parser.add_argument("seconds", nargs="?", type=float, default=20)
    parser.add_argument("--sector", type=float, default=120)
    arguments = parser.parse_args()
    programs = pathlib.Path(arguments.bin).resolve()
    running = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.toml").write_text(SCENE.format(sector=arguments.sector), encoding="utf-8")
        with open(folder / "track.csv", "w", encoding="utf-8") as track:
            track.write("time,latitude,longitude,height,bearing\n")
            for second in range(int(arguments.seconds) + 60):  # 150 m/s to the north, turning
                track.write(f"{second},{33.0 + second * 150 / 111000:.6f},-99.5,3000,{3 * second % 360}\n")

        def start(*command):
            log = open(folder / f"{len(running)}.log", "w", encoding="utf-8")
            process = subprocess.Popen([str(part) for part in command], stdout=log, stderr=subprocess.STDOUT,
                                       preexec_fn=two_cores)
            running.append(process)
            return process

        try:
            server = start(programs / "obliqd", "--config", folder / "scene.toml")
            address = ready_at(folder / "0.log")
            start(programs / "obliq", "fly", "--server", address, "--rate", 30, folder / "track.csv")
            picture = folder / "radar.png"
            watch = start(programs / "obliq", "watch", "--server", address, "--rate", 50, "--picture", picture)
            while not picture.exists():
                if watch.poll() is not None:
                    sys.exit((folder / "2.log").read_text(encoding="utf-8"))
                time.sleep(0.01)
            time.sleep(1)
            begin, spent, served = time.monotonic(), processor_s(watch.pid), processor_s(server.pid)
            pictures, last = 0, None
            while time.monotonic() - begin < arguments.seconds:
                now = picture.stat().st_ino, picture.stat().st_mtime_ns
                pictures += now != last
                last = now
                time.sleep(0.002)
            elapsed = time.monotonic() - begin
            print(f"{pictures / elapsed:.1f} pictures a second, {picture.stat().st_size / 1e6:.2f} MB each; "
                  f"processor time of a picture {1000 * (processor_s(watch.pid) - spent) / pictures:.0f} ms "
                  f"(receiving included), of obliqd {1000 * (processor_s(server.pid) - served) / pictures:.0f} ms; "
                  f"load average {os.getloadavg()[0]:.1f}")
            lines = (folder / "2.log").read_text(encoding="utf-8").splitlines()
            print(lines[-1] if lines else "")
        finally:
            for process in reversed(running):
                process.send_signal(signal.SIGTERM)
                process.wait()


main()
