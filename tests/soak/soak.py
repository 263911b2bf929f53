#!/usr/bin/env python3
"""The soak itself; see tests/soak.sh, which builds what it needs and draws the picture. Standard library only."""
import argparse
import csv
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import threading
import time

from daemon_metrics import quantile, read_metrics

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path += [os.path.join(ROOT, "tests", folder) for folder in ("support", "hostile")]
import crowd  # noqa: E402
import programs  # noqa: E402

SAMPLE_S = 5
LATENCY_SAMPLES = 12  # a minute
WARM_UP = 0.25  # of the time, 10 minutes at most
GROWTH_MB, GROWTH_MB_H = 4, 1
ABUSERS, GUESTS = 4, 2
FIELDS = ["t_s", "rss_mb", "descriptors", "threads", "clients", "frames_per_s", "dropped_per_s", "queue_mb",
          "render_p50_ms", "render_p99_ms", "pose_p50_ms", "pose_p99_ms"]


def process_state(pid):
    """Resident memory (MB), descriptors and threads."""
    return programs.memory_mb(pid), programs.descriptors(pid), programs.threads(pid)


class Soak:
    def __init__(self, arguments):
        self.bin, self.out = os.path.abspath(arguments.bin), os.path.abspath(arguments.out)
        self.seconds = arguments.hours * 3600
        self.stop = threading.Event()
        self.interrupted = False
        self.faults, self.notes, self.rows = [], [], []
        self.watchers = {}
        self.visits = {}
        shutil.rmtree(self.out, ignore_errors=True)
        os.makedirs(self.out)

    def log(self, name):
        return os.path.join(self.out, name + ".log")

    def spawn(self, name, words):
        return programs.Program(words, log=self.log(name))

    def start_daemon(self):
        scenes = os.path.join(ROOT, "deploy/scenes")
        tile = os.path.exists(os.path.join(scenes, "data/new_mexico_ned13.tif"))
        scene = os.path.join(scenes, "demo.toml" if tile else "demo_hills.toml")
        known = subprocess.run([os.path.join(self.bin, "obliqd"), "--config", scene, "--print-config"], capture_output=True, text=True,
                               check=True).stdout
        # Small enough for a machine that does other things as well; time limits that abusers meet.
        settings = ["frustum.pixels=[512, 256]", "bins.azimuth=128", "bins.range=256", "server.handshake_timeout_s=5",
                    "server.message_timeout_s=5", "server.stall_timeout_s=5"]
        self.modbus = programs.free_ports(1)[0] if "[modbus]" in known else None
        if self.modbus:
            settings += ["modbus.enabled=true", f"modbus.port={self.modbus}"]
        self.daemon = programs.daemon(scene, *settings, obliqd=os.path.join(self.bin, "obliqd"), log=self.log("obliqd"))
        self.address, self.http = self.daemon.address, f"127.0.0.1:{self.daemon.web_port}"
        self.notes.append(f"scene {os.path.basename(scene)}, stream {self.address}, HTTP {self.http}, "
                          f"Modbus {self.modbus or 'not there'}")

    def obliq(self, *words):
        return [os.path.join(self.bin, "obliq"), words[0], "--server", self.address, *words[1:]]

    def start_clients(self):
        known = subprocess.run([os.path.join(self.bin, "obliq"), "watch", "--help"], capture_output=True, text=True,
                               check=True).stdout
        kinds = {"watch_plain": ["--rate", "10"], "watch_slow": ["--rate", "0.5"]}
        if "--lossless" in known:
            kinds["watch_lossless"] = ["--rate", "10", "--lossless"]
        if "--encoding" in known:
            kinds["watch_packed"] = ["--rate", "10", "--encoding", "ci16_le", "--compress", "zstd"]
        for name, words in kinds.items():
            self.watchers[name] = self.spawn(name, self.obliq("watch", "--reconnect", "0", *words))
        self.flyer = self.spawn("fly", [os.path.join(self.bin, "soak_fly"), self.address, "main", "60",
                                        str(self.seconds)])
        ports = [int(a.rsplit(":", 1)[1]) for a in (self.address, self.http)] + ([self.modbus] if self.modbus else [])
        visitor = self.obliq("watch", "--rate", "10", "--reconnect", "0")
        self.threads = [threading.Thread(target=crowd.visits, args=(ports, visitor, self.stop, self.visits))
                        for _ in range(ABUSERS)]
        self.threads += [threading.Thread(target=self.be_guest, args=(i,)) for i in range(GUESTS)]
        if self.modbus and shutil.which("mbpoll"):
            self.threads.append(threading.Thread(target=self.poll_modbus))
        for thread in self.threads:
            thread.start()

    def visit(self, name, words):
        """A guest who behaves: must succeed."""
        done = subprocess.run(words, capture_output=True, text=True, check=False, start_new_session=True)
        self.visits[name] = self.visits.get(name, 0) + 1
        if done.returncode != 0 and len(self.faults) < 20:
            self.faults.append(f"{name}: exit code {done.returncode}: {(done.stderr or done.stdout).strip()[-300:]}")

    def be_guest(self, number):
        frame = os.path.join(self.out, f"guest{number}")
        while not self.stop.wait(0.5):
            self.visit("get", self.obliq("get", "--out", frame))
            self.visit("watch", self.obliq("watch", "--rate", "10", "--frames", "5", "--reconnect", "0"))
            self.visit("status", self.obliq("status"))
        shutil.rmtree(frame, ignore_errors=True)

    def poll_modbus(self):
        poll = ["mbpoll", "-m", "tcp", "-0", "-1", "-q", "-a", "1", "-t", "3", "-r", "0", "-c", "3",
                "-p", str(self.modbus), "127.0.0.1"]
        while not self.stop.wait(1):
            self.visit("modbus", poll)

    def sample(self, start, history):
        rss_mb, descriptors, threads = process_state(self.daemon.pid)
        values, buckets = read_metrics(self.http)
        now = time.monotonic()
        history.append((now, values, buckets))
        del history[: -LATENCY_SAMPLES - 1]
        then, earlier, _ = history[-2] if len(history) > 1 else (now - 1, values, {})
        row = {"t_s": round(now - start, 1), "rss_mb": round(rss_mb, 2), "descriptors": descriptors, "threads": threads,
               "clients": int(values.get("obliq_clients", 0)),
               "queue_mb": round(values.get("obliq_queue_bytes", 0) / 1e6, 3)}
        for field, name in (("frames_per_s", "obliq_frames_total"), ("dropped_per_s", "obliq_frames_dropped_total")):
            row[field] = round((values.get(name, 0) - earlier.get(name, 0)) / (now - then), 2)
        for field, name in (("render", "obliq_frame_render_seconds"), ("pose", "obliq_frame_pose_latency_seconds")):
            for part in (50, 99):
                value = quantile(history[0][2].get(name, {}), buckets.get(name, {}), part / 100)
                row[f"{field}_p{part}_ms"] = "" if value is None or len(history) < 2 else round(1000 * value, 2)
        self.rows.append(row)
        return row

    def run(self):
        self.start_daemon()
        self.idle = process_state(self.daemon.pid)
        self.start_clients()
        start, history = time.monotonic(), []
        with open(os.path.join(self.out, "soak.csv"), "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, FIELDS)
            table.writeheader()
            while time.monotonic() - start < self.seconds and not self.interrupted:
                time.sleep(min(SAMPLE_S, max(0.1, start + self.seconds - time.monotonic())))
                if not self.daemon.lives():
                    self.faults.append(f"obliqd has ended, {programs.ending(self.daemon.process.returncode)}")
                    break
                try:
                    table.writerow(self.sample(start, history))
                    file.flush()
                except OSError as error:
                    self.faults.append(f"/metrics after {time.monotonic() - start:.0f} s: {error}")
        self.end_clients()
        self.end_daemon()

    def end_clients(self):
        for name, watcher in self.watchers.items():
            if not watcher.lives():
                self.faults.append(f"{name} has {programs.ending(watcher.process.returncode)}: {watcher.log()[-300:]}")
            watcher.stop()
        if self.interrupted:
            self.flyer.kill()
            self.notes.append(f"interrupted after {self.rows[-1]['t_s'] if self.rows else 0:.0f} s")
        ended = self.flyer.finish(30)
        if ended != 0 and not self.interrupted:
            self.faults.append("the controller hangs" if ended == "still at work" else "the controller: " + self.flyer.log().strip()[-300:])
        self.notes.append("controller: " + self.flyer.log().strip())
        self.stop.set()
        for thread in self.threads:
            thread.join()

    def end_daemon(self):
        if not self.daemon.lives():
            return
        # What abusers left half open is closed by the time limits above.
        for _ in range(40):
            now = process_state(self.daemon.pid)
            if now[1] <= self.idle[1] and now[2] <= self.idle[2]:
                break
            time.sleep(0.5)
        for what, before, after in (("descriptors", self.idle[1], now[1]), ("threads", self.idle[2], now[2])):
            self.notes.append(f"{what} with nobody there: {before} before, {after} after")
            if after > before:
                self.faults.append(f"{after - before} {what} are left over")
        if (ended := self.daemon.stop(seconds=60)) != 0:
            self.faults.append(f"obliqd did not stop in good order: {ended}")

    def judge_watchers(self):
        for name, watcher in self.watchers.items():
            text = watcher.log()
            frames = [int(number) for number in re.findall(r"^frame (\d+): rendered", text, re.M)]
            skipped = sum(int(n) for n in re.findall(r", (\d+) skipped before it", text))
            aborted = len(re.findall(r"^frame \d+: aborted", text, re.M))
            self.notes.append(f"{name}: {len(frames)} whole frames, {skipped} left out, {aborted} aborted")
            if not frames:
                self.faults.append(f"{name} got no frame")
            if name == "watch_lossless":
                lost = frames[-1] - frames[0] + 1 - len(frames) if frames else 0
                if skipped or aborted or lost:
                    self.faults.append(f"{name} lost {max(skipped, aborted, lost)} frames of {len(frames)}")

    def judge_memory(self):
        warm = min(600.0, WARM_UP * self.seconds)
        rows = [row for row in self.rows if row["t_s"] >= warm]
        if len(rows) < 8:
            self.notes.append("memory: too short a time to judge its growth")
            return
        quarter = len(rows) // 4
        first = statistics.median(row["rss_mb"] for row in rows[:quarter])
        last = statistics.median(row["rss_mb"] for row in rows[-quarter:])
        hours = (rows[-1]["t_s"] - rows[0]["t_s"]) / 3600
        slope = statistics.linear_regression([r["t_s"] / 3600 for r in rows], [r["rss_mb"] for r in rows]).slope
        allowed = GROWTH_MB + GROWTH_MB_H * hours
        self.notes.append(f"memory after {warm:.0f} s of warm-up: {first:.1f} MB, at the end {last:.1f} MB, most "
                          f"{max(r['rss_mb'] for r in self.rows):.1f} MB; slope {slope:+.1f} MB/h over {hours:.2f} h; "
                          f"allowed growth {allowed:.1f} MB")
        if last - first > allowed:
            self.faults.append(f"memory has grown by {last - first:.1f} MB")

    def judge(self):
        self.judge_watchers()
        self.judge_memory()
        for field in ("render_p50_ms", "render_p99_ms", "pose_p50_ms", "pose_p99_ms"):
            values = [row[field] for row in self.rows if row[field] != ""]
            if values:
                self.notes.append(f"{field}: median {statistics.median(values):.1f}, worst minute {max(values):.1f}")
        self.notes.append("visits: " + ", ".join(f"{n} {name}" for name, n in sorted(self.visits.items())))
        lines = self.notes + [f"FAULT: {fault}" for fault in self.faults]
        lines.append("FAILED" if self.faults else "PASSED, interrupted" if self.interrupted else
                     f"PASSED: {self.seconds / 3600:g} h")
        with open(os.path.join(self.out, "verdict.txt"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        return 1 if self.faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--hours", type=float, required=True)
    parser.add_argument("--out", required=True)
    soak = Soak(parser.parse_args())

    def interrupt(_number, _frame):
        soak.interrupted = True

    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGTERM, interrupt)
    try:
        soak.run()
    finally:
        soak.stop.set()
        for program in filter(None, (getattr(soak, "daemon", None), getattr(soak, "flyer", None), *soak.watchers.values())):
            program.kill()
    return soak.judge()


if __name__ == "__main__":
    sys.exit(main())
