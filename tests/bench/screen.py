#!/usr/bin/python3
"""The page's speed: daemon, page and a browser without a screen on this machine. Prints a table; asserts nothing.

    tests/page/run.sh --program tests/bench/screen.py [--seconds 20] [--only NAME,...] [--picture FILE] [--film FILE]
"""
import argparse
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "page"))
import support  # noqa: E402
import obliq  # noqa: E402

SCENES = ROOT / "deploy" / "scenes"
SPEED_M_S = 200.0
CIRCLE_M = 1500.0  # radius of the flight: the demo's ground is a single tile
POSES_HZ = 20
M_PER_DEG = 111_200.0
CLEAR = "for (const list of [obliq.meter.latencies, obliq.meter.drawTimes, obliq.meter.steps_deg]) list.length = 0;"
STANDING = """
[terrain]
synthetic = "hills"
[antenna]
height_m = 3000.0
[bins]
azimuth = {n}
range = {n}
[frustum]
quality = "draft"
[radar]
sector_deg = 60.0
r_min_m = 4000.0
r_max_m = 24000.0
"""


def row(name, text):
    print(f"{name:<34} {text}", flush=True)


def size_of_picture(page, side):
    """A window whose picture has this many pixels a side."""
    page.size(side + 291, side + 34 + 96)


def heap_mb(page):
    page.script("globalThis.gc?.()")
    return page.script("return performance.memory.usedJSHeapSize") / 1e6


def part(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else math.nan


def frames_in(page, seconds):
    before = page.script("return [obliq.meter.received, obliq.meter.drawn, performance.now()]")
    time.sleep(seconds)
    after = page.script("return [obliq.meter.received, obliq.meter.drawn, performance.now()]")
    passed = (after[2] - before[2]) / 1000
    return (after[0] - before[0]) / passed, (after[1] - before[1]) / passed


def standing(seconds):
    daemon, page = support.Daemon(STANDING.format(n=1024)), support.Page()
    size_of_picture(page, 1024)
    page.open(daemon.url, "rate=30")
    page.await_script("globalThis.obliq && obliq.meter.drawn > 5", "frames")
    page.script(CLEAR)
    received, drawn = frames_in(page, seconds)
    times = page.script("return obliq.meter.drawTimes")
    row("standing, 1024 x 1024, 30 asked", f"{received:.1f} received, {drawn:.1f} drawn a second; draw {part(times, .5):.1f} ms, "
        f"99 % {part(times, .99):.1f} ms")
    other = support.Page()
    size_of_picture(other, 1024)
    other.open(daemon.url, "rate=30")
    other.await_script("globalThis.obliq && obliq.meter.drawn > 5", "frames")
    received, drawn = frames_in(page, seconds)
    row("  with a second page open", f"{received:.1f} received, {drawn:.1f} drawn a second")
    other.close()
    tables = page.script("""const t = []; for (let k = 0; k < 20; ++k) { obliq.pictures.zoom(k % 2 ? 1.3 : 1 / 1.3); const { ppi } = obliq.panes[0];
        ppi.draw(performance.now() + 100 * k); t.push(ppi.times.table_ms); } return t;""")
    row("  zoom step at 1024", f"{part(tables[4:], .5):.1f} ms, 99 % {part(tables[4:], .99):.1f} ms")
    glow = page.script("""obliq.look.change({ afterglow_s: 5 }); const { ppi } = obliq.panes[0], t = [];
        for (let k = 0; k < 20; ++k) { ppi.needs.all = true; ppi.draw(performance.now() + 5000 + 100 * k); t.push(ppi.times.draw_ms); } return t;""")
    row("  draw of all with afterglow, 1024", f"{part(glow, .5):.1f} ms, 99 % {part(glow, .99):.1f} ms")
    page.close()
    daemon.close()


POSE = """
const done = arguments[0], { link } = obliq, [pane] = obliq.panes, radar = pane.radar, times = [], frames = [];
return (async () => {
  await link.ask('ClaimControl', { radar });
  for (let k = 0; k < done; ++k) {
    const bearing = 10 + (k % 20), sent = performance.now();
    await link.ask('SetPose', { radar, pose: { bearing_deg: bearing } });
    for (;;) {
      await new Promise((next) => requestAnimationFrame(next));
      if (Number(pane.bins.descriptor.pose.bearing_deg ?? 0) === bearing && pane.ppi.draws) break;
    }
    await new Promise((next) => requestAnimationFrame(next));
    times.push(performance.now() - sent);
    frames.push(pane.bins.render_ms);
    await new Promise((next) => setTimeout(next, 37));
  }
  await link.ask('ReleaseControl', { radar });
  return [times, frames];
})();
"""


def pose(seconds):
    daemon, page = support.Daemon(STANDING.format(n=512)), support.Page()
    size_of_picture(page, 1024)
    page.open(daemon.url, "rate=30")
    page.await_script("globalThis.obliq && obliq.meter.drawn > 5", "frames")
    times, frames = page.script(POSE, max(10, int(2 * seconds)))
    row("pose sent to picture, 512 x 512", f"{part(times, .5):.0f} ms, 99 % {part(times, .99):.0f} ms; its frame's rendering "
        f"{part(frames, .5):.0f} ms, 99 % {part(frames, .99):.0f} ms")
    page.close()
    daemon.close()


def fly(address, stop):
    """Circles over the scene at SPEED_M_S, bearing as it is."""
    with obliq.connect(address, name="flight") as server:
        radar = server.radar()
        start = radar.pose
        with radar.control() as control:
            began = time.monotonic()
            while not stop.is_set():
                t = time.monotonic() - began
                angle = SPEED_M_S * t / CIRCLE_M
                north, east = CIRCLE_M * math.sin(angle), CIRCLE_M * (1 - math.cos(angle))
                control.set_pose(latitude_deg=start.latitude_deg + north / M_PER_DEG,
                                 longitude_deg=start.longitude_deg + east / M_PER_DEG / math.cos(math.radians(start.latitude_deg)),
                                 sim_time_ns=int(t * 1e9))
                stop.wait(1 / POSES_HZ)


def scanning(scene, seconds, text=None):
    """Heap before and after in MB, passes drawn. text: a scene instead of a shipped one."""
    daemon, page = support.Daemon(text or SCENES / f"{scene}.toml"), support.Page()
    page.open(daemon.url)
    page.await_script("globalThis.obliq && obliq.panes[0].bins.scanRow >= 0", "a beam")
    stop = threading.Event()
    pilot = threading.Thread(target=fly, args=(daemon.address, stop))
    pilot.start()
    try:
        time.sleep(6)
        page.script(CLEAR + "obliq.panes[0].bins.missed = 0; obliq.panes[0].bins.skipped = 0")
        heap, began = heap_mb(page), time.monotonic()
        latencies, steps, draws = [], [], []
        while time.monotonic() - began < seconds:
            time.sleep(min(5, seconds))
            more = page.script("const { latencies, steps_deg, drawTimes } = obliq.meter; "
                               "return [latencies.splice(0), steps_deg.splice(0), drawTimes.splice(0)]")
            for kept, new in zip((latencies, steps, draws), more):
                kept += new
        missed, skipped, frames, width = page.script("const { bins } = obliq.panes[0]; return [bins.missed, bins.skipped, "
                                                     "bins.frames, Number(bins.descriptor.settings.beam_width_deg)]")
        passed = time.monotonic() - began
        row(f"{scene}, {SPEED_M_S:.0f} m/s, {passed:.0f} s", f"missed bins {missed}, passes left out {skipped}, {frames} passes")
        row("  beam to pixel", f"{part(latencies, .5):.0f} ms, 99 % {part(latencies, .99):.0f} ms, most {max(latencies):.0f} ms, "
            f"of {len(latencies)} azimuths")
        row("  step of the picture", f"{part(steps, .5):.2f} deg, 99 % {part(steps, .99):.2f} deg, most {max(steps):.2f} deg; "
            f"beam {width:g} deg")
        row("  draws", f"{len(draws) / passed:.1f} a second, {part(draws, .5):.1f} ms, 99 % {part(draws, .99):.1f} ms")
        later = heap_mb(page)
        row("  heap", f"{heap:.1f} MB, {passed:.0f} s later {later:.1f} MB")
        return heap, later, frames
    finally:
        stop.set()
        pilot.join()
        page.close()
        daemon.close()


def picture(path):
    """Two radars of the demo, with cursor and markers."""
    daemon, page = support.Daemon(SCENES / "demo.toml"), support.Page()
    page.open(daemon.url, "rate=5")
    page.await_script("globalThis.obliq && obliq.meter.drawn > 3", "frames")
    page.script("const { ppi } = obliq.panes[0]; obliq.markers.setCursor(ppi.fromScreen(600, 330)); obliq.markers.placeLine(['mark', 0], obliq.panes[0], 470, 300); "
                "document.activeElement?.blur?.()")
    time.sleep(1.5)
    page.shot(path)
    row("picture", str(path))
    page.close()
    daemon.close()


def film(path, seconds=10, rate=10):
    """A turning radar for the README, from screenshots; needs ffmpeg."""
    daemon, page = support.Daemon(SCENES / "x_band_circular.toml"), support.Page(960, 700)
    page.open(daemon.url)
    page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "passes")
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        times = []
        while (now := time.monotonic() - began) < seconds:
            page.shot(pathlib.Path(folder) / f"{len(times):05d}.png")
            times.append(now)
            time.sleep(max(0, len(times) / rate - (time.monotonic() - began)))
        listing = pathlib.Path(folder) / "list"
        ends = [*times[1:], seconds]
        listing.write_text("".join(f"file '{k:05d}.png'\nduration {end - at:.4f}\n" for k, (at, end) in enumerate(zip(times, ends))))
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-f", "concat", "-i", str(listing), "-vf",
                        f"crop={960 - 290}:666:0:34,scale=500:-1:flags=area,fps={rate},split[a][b];[a]palettegen=max_colors=48[p];[b][p]paletteuse=dither=none", str(path)], check=True)
    row("film", f"{path}, {os.path.getsize(path) / 1e6:.1f} MB, {len(times) / seconds:.1f} pictures a second")
    page.close()
    daemon.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20, help="of each measurement")
    parser.add_argument("--scan-seconds", type=float, help="of a scanning radar's, 600 for ten minutes")
    parser.add_argument("--only", default="standing,pose,x_band_circular,x_band_sector")
    parser.add_argument("--picture", type=pathlib.Path, help="writes a screenshot of the demo, and measures nothing")
    parser.add_argument("--film", type=pathlib.Path, help="writes ten seconds of a turning radar as a GIF, and measures nothing")
    wanted = parser.parse_args()
    if wanted.picture:
        picture(wanted.picture)
    if wanted.film:
        film(wanted.film)
    if wanted.picture or wanted.film:
        return
    row("load", " ".join(f"{value:.1f}" for value in os.getloadavg()) + f" on {os.cpu_count()} cores")
    for name in wanted.only.split(","):
        if name in ("standing", "pose"):
            globals()[name](wanted.seconds)
        else:
            scanning(name, wanted.scan_seconds or wanted.seconds)


if __name__ == "__main__":
    main()
