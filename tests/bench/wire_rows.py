"""Rows of cities.py by the clock: streams, Python and dwells in flight, each as the bench that it is taken from measures it."""
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from typing import Callable

NEEDS = "found {}; allowed: a Python with numpy, protobuf and google-crc32c"


@dataclass
class Row:
    """Wanted is a value as high as `least`."""
    name: str
    least: float
    past: float
    measure: Callable  # (programs, quick): value and words; None and why not


def commit_of(folder):
    ran = subprocess.run(["git", "-C", folder, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    return ran.stdout.strip() or "an unknown commit"


def clients(programs):
    """client_bench.py with these programs; it needs numpy, protobuf and a CRC-32C."""
    os.environ["OBLIQ_BIN"] = str(programs)
    import client_bench
    return client_bench


def with_daemon(programs, bins, measured):
    """measured(bench, server) beside obliqd with frames of so many bins; a text where something is missing."""
    try:
        bench = clients(programs)
    except ImportError as error:
        return "not measured: " + NEEDS.format(error)
    azimuths = 2048 if bins == 1024 else bins
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "scene.toml"
        scene.write_text(bench.SCENE.format(azimuths=azimuths, bins=bins), encoding="utf-8")
        with bench.obliq.local(scene, obliqd=programs / "obliqd") as server:
            return measured(bench, server, pathlib.Path(folder))


def python_iq(programs, quick):
    def measured(bench, server, _):
        choice, seconds = bench.CASES["iq"], 2 if quick else 4
        ratios = []
        for _ in range(5 if quick else 9):
            cpp = bench.cpp(server.address, seconds, choice)
            ratios.append(bench.blocking(server.address, seconds, choice)[0] / cpp[0])
        return statistics.median(ratios)

    found = with_daemon(programs, 1024, measured)
    return (None, found) if isinstance(found, str) else (found, "")


def data_set(which):
    def measure(programs, quick):
        def measured(bench, server, folder):
            return statistics.median(bench.set_ratios(server, folder, 3 if quick else 7, (which,))[which])

        found = with_daemon(programs, 256, measured)
        return (None, found) if isinstance(found, str) else (found, "")

    return measure


def stream(programs, quick):
    program = programs / "stream_bench"
    if not program.exists():
        return None, f"not measured: no {program}"
    ran = subprocess.run([program, "5" if quick else "15"], capture_output=True, text=True, check=False)
    found = re.search(r"stream (\d+) %, client library (\d+) %", ran.stdout)
    if not found:
        return None, f"not measured: {ran.stderr.strip().splitlines()[-1]}"
    return int(found[1]) / 100, f"client library with CRC {int(found[2]) / 100:.2f}"


def dwells_beside_work(programs, quick):
    """Two cores, of which another program takes one."""
    os.environ["OBLIQ_BIN"] = str(programs)
    try:
        import dwells
    except ImportError as error:
        return None, "not measured: " + NEEDS.format(error)
    lacking = dwells.ground_of(dwells.SCENE)
    if lacking:
        return None, f"not measured: {lacking}"
    mine = sorted(os.sched_getaffinity(0))
    if len(mine) < 2:
        return None, "not measured: one core alone"
    busy = subprocess.Popen([sys.executable, "-c", f"import os\nos.sched_setaffinity(0, {{{mine[1]}}})\nwhile True: pass"])
    os.sched_setaffinity(0, set(mine[:2]))
    try:
        daemon = dwells.obliq.local_daemon(dwells.SCENE, obliqd=programs / "obliqd",
                                           settings={**dwells.RADAR, "bins.azimuth": "512", "bins.range": "512"})
        try:
            with dwells.obliq.connect(daemon.address) as server:
                radar = server.info.radars[0]
            said = dwells.fly([str(programs / "dwell")], daemon.address, radar, 300 if quick else 1800, "iq")
        finally:
            daemon.stop()
    finally:
        busy.kill()
        busy.wait()
        os.sched_setaffinity(0, set(mine))
    longest = re.search(r"last values: (.*)", said)[1]
    return float(re.search(r"([\d.]+) % within 33 ms", said)[1]) / 100, longest


ROWS = [
    Row("Python iq over C++", 0.9, 1.0, python_iq),
    Row("render_many over a bare loop", 0.95, 1.0, data_set("render_many")),
    Row("batch over a bare loop", 0.95, 1.0, data_set("batch")),
    Row("stream over a bare socket loop", 0.92, 0.97, stream),
    Row("dwells within 33 ms, one of two cores busy", 0.95, 0.99, dwells_beside_work),
]
