#!/usr/bin/python3
"""The Python clients beside the C++ client: frames a second and processor time, in turns of one run.

  tests/bench/client_bench.py [--turns 5] [--seconds 4]

A standing radar of 2048 x 1024 bins, whose wedges are sent again, so that the clients and the sending are what takes time, and
no rate comes near the 100 Hz that a subscription may ask for.
C++: `obliq watch` (which assembles and looks at every frame). Ratios are medians of the turns' ratios; figures of one machine
that others use mean little by themselves. Then the data sets: frames a second by 1 and 2 workers.
"""
import argparse
import asyncio
import collections
import concurrent.futures
import multiprocessing
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "client" / "python" / "src"))
os.environ["PYTHONPATH"] = str(ROOT / "client" / "python" / "src")  # of the workers
import obliq  # noqa: E402
from obliq._protocol import crc as _crc  # noqa: E402

BIN = pathlib.Path(os.environ.get("OBLIQ_BIN", ROOT / "build" / "release" / "bin"))
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
height_m = 1500.0
[bins]
azimuth = {azimuths}
range = {bins}
[radar]
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 20000.0
[frustum]
quality = "standard"
"""
SET_FRAMES = 192
CASES = {"iq": dict(planes="iq"), "iq, ci16": dict(planes="iq", encoding="ci16"), "all planes": {}}


def used_s(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def cpp(address, seconds, choice):
    words = [str(BIN / "obliq"), "watch", "--server", address, "--rate", "100"]
    if "planes" in choice:
        words += ["--planes", choice["planes"]]
    if "encoding" in choice:
        words += ["--encoding", "ci16_le"]
    before = used_s(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    process.stdout.readline()
    began = time.monotonic()
    frames = 0
    for _ in process.stdout:
        frames += 1
        if time.monotonic() - began >= seconds:
            break
    took = time.monotonic() - began
    process.terminate()
    process.stdout.close()
    process.wait()
    return frames / took, (used_s(resource.RUSAGE_CHILDREN) - before) / max(frames, 1)


def blocking(address, seconds, choice):
    with obliq.connect(address) as server, server.radar().stream(rate_hz=100, copy=False, **choice) as frames:
        next(frames)
        before, began, count = used_s(resource.RUSAGE_SELF), time.monotonic(), 0
        while time.monotonic() - began < seconds:
            next(frames)
            count += 1
        return count / (time.monotonic() - began), (used_s(resource.RUSAGE_SELF) - before) / max(count, 1)


def aio(address, seconds, choice, held=None):
    async def run():
        async with obliq.aio.connect(address) as server:
            async with server.radar().stream(rate_hz=100, copy=False, **choice) as frames:
                await frames.__anext__()
                before, began, count = used_s(resource.RUSAGE_SELF), time.monotonic(), 0
                while time.monotonic() - began < seconds:
                    await frames.__anext__()
                    count += 1
                return count / (time.monotonic() - began), (used_s(resource.RUSAGE_SELF) - before) / max(count, 1)

    async def watched():
        longest = 0.0

        async def turn():
            nonlocal longest
            while True:
                before = time.thread_time()
                await asyncio.sleep(0)
                longest = max(longest, time.thread_time() - before)

        watcher = asyncio.create_task(turn())
        try:
            return await run()
        finally:
            watcher.cancel()
            held.append(longest)

    return asyncio.run(run() if held is None else watched())


def memory_kb():
    return int(open("/proc/self/statm").read().split()[1]) * 4


def streams(address, turns, seconds):
    print(f"{'case':<12}{'C++':>9}{'blocking':>11}{'ratio':>7}{'cpu':>6}{'asyncio':>10}{'ratio':>7}   frames/s, medians")
    for name, choice in CASES.items():
        rows = [(cpp(address, seconds, choice), blocking(address, seconds, choice), aio(address, seconds, choice))
                for _ in range(turns)]

        def middle(of):
            return statistics.median(of(row) for row in rows)

        print(f"{name:<12}{middle(lambda r: r[0][0]):9.1f}{middle(lambda r: r[1][0]):11.1f}"
              f"{middle(lambda r: r[1][0] / r[0][0]):7.2f}{middle(lambda r: r[1][1] / r[0][1]):6.2f}"
              f"{middle(lambda r: r[2][0]):10.1f}{middle(lambda r: r[2][0] / r[1][0]):7.2f}", flush=True)
    held = []
    aio(address, seconds, {}, held)
    print(f"longest turn of the event loop: {1000 * held[0]:.1f} ms of processor time")
    with obliq.connect(address) as server, server.radar().stream(rate_hz=100, copy=False) as frames:
        for _ in range(10):
            next(frames)
        before = memory_kb()
        for _ in range(200):
            next(frames)
        print(f"memory over 200 frames: {memory_kb() - before:+d} kB")


def poses(count):
    return [{"id": k, "latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1500.0, "bearing_deg": k * 0.7} for k in range(count)]


def set_ratios(server, folder, turns, which=("render_many", "batch")):
    """Frames a second of each over those of a bare loop, turn by turn. Rendering by the daemon is the same work for all."""
    settings, pose = server.radar().settings, server.radar().pose
    wanted = [pose.replace(bearing_deg=k * 0.7) for k in range(SET_FRAMES)]
    programs = {"render_many": lambda _: collections.deque(server.render_many(wanted, settings, planes="iq state"), maxlen=0),
                "batch": lambda turn: obliq.batch(poses(SET_FRAMES), folder / f"one{turn}", server=server.address, progress=False)}
    ratios = {name: [] for name in which}
    for turn in range(turns):
        for name, of in ratios.items():
            alone_s = timed_s(lambda: bare(server, wanted, settings))
            of.append(alone_s / timed_s(lambda: programs[name](turn)))
    return ratios


def timed_s(work):
    began = time.monotonic()
    work()
    return time.monotonic() - began


def data_sets(scene, folder, turns):
    with obliq.local(scene, obliqd=BIN / "obliqd") as server:
        ratios = set_ratios(server, folder, turns)
        print(f"one daemon, 256 x 256 bins, of a bare loop with 4 in flight: render_many "
              f"{statistics.median(ratios['render_many']):.2f}, batch {statistics.median(ratios['batch']):.2f}")
    spawn = multiprocessing.get_context("spawn")
    rates = {}
    for turn in range(turns):
        for workers in (1, 2):
            with concurrent.futures.ProcessPoolExecutor(workers, mp_context=spawn) as executor:
                job = obliq.prepare(poses(2 * SET_FRAMES), folder / f"w{workers}{turn}", local=scene, obliqd=str(BIN / "obliqd"),
                                    local_settings={"run.threads": 1}, shard_size=32)
                list(executor.map(len, [""] * workers))  # Python is up; daemons begin with the first shard
                began = time.monotonic()
                results = list(executor.map(job.run, obliq.todo(job)))
                rates.setdefault(workers, []).append(sum(r[1] for r in results) / (time.monotonic() - began))
    one, two = (statistics.median(rates[workers]) for workers in (1, 2))
    print(f"own daemons of one thread each: 1 worker {one:.0f}, 2 workers {two:.0f} frames/s, {two / one:.2f} times")


def bare(server, wanted, settings):
    """What a user would write: four requests in flight, results dropped."""
    session, connection = server._connection.session, server._connection
    waiting = []

    for pose in wanted:
        waiting.append(server._begin((settings, pose, "iq state", "cf32", None, None, "x", None)))
        if len(waiting) == 4:
            connection.run(session.finish_render(waiting.pop(0), 60))
    while waiting:
        connection.run(session.finish_render(waiting.pop(0), 60))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--only", choices=("streams", "sets"))
    given = parser.parse_args()
    began = time.monotonic()
    subprocess.run([sys.executable, "-c", "import numpy, google.protobuf"], check=True)
    plain = time.monotonic() - began
    began = time.monotonic()
    subprocess.run([sys.executable, "-c", "import obliq"], check=True)
    print(f"import: {time.monotonic() - began:.2f} s, of which Python, numpy and protobuf {plain:.2f} s")
    print(f"CRC-32C: {_crc.NAME}")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for azimuths, bins in ((2048, 1024), (256, 256)):
            (folder / f"{bins}.toml").write_text(SCENE.format(azimuths=azimuths, bins=bins))
        if given.only != "sets":
            with obliq.local(folder / "1024.toml", obliqd=BIN / "obliqd") as server:
                streams(server.address, given.turns, given.seconds)
        if given.only != "streams":
            data_sets(folder / "256.toml", folder, min(3, given.turns))


if __name__ == "__main__":
    main()
