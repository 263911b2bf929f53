"""The minute of abuse itself; see tests/abuse.sh. Standard library and python3-protobuf."""
import argparse
import collections
import multiprocessing
import os
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import visits
import wire

RATE_HZ = 20
MOST_MB = 700  # scene.toml's server.max_memory_mb, and what a measure of it may be off
PHASE_S = 9
BASE_S = 5
LOGINS = 8


def watch(pb, port, token, times):
    """In a process of its own: when each frame of "main" came."""
    peer = wire.Peer(pb, port, token, "watcher")
    peer.demand(wire.SUBSCRIBE, pb.Subscribe(radar="main", rate_hz=RATE_HZ, planes=["POWER"]))
    while True:
        if peer.receive()[0] == wire.FRAME_END:
            times.put(time.monotonic())


def turn(pb, port, token):
    """In a process of its own: turns "main", so that no frame is a repetition."""
    peer = wire.Peer(pb, port, token, "pilot")
    peer.demand(wire.CLAIM, pb.ClaimControl(radar="main"))
    for k in range(1 << 30):
        peer.demand(wire.SET_POSE, pb.SetPose(radar="main", pose=pb.Pose(bearing_deg=k % 360)))
        time.sleep(1 / RATE_HZ)


class Abuse:
    def __init__(self, arguments):
        self.bin, self.phase_s = os.path.abspath(arguments.bin), arguments.seconds
        self.folder = tempfile.mkdtemp(prefix="obliq-abuse-")
        self.pb = wire.messages(self.folder)
        self.tokens = {role: secrets.token_hex(24) for role in ("viewer", "controller", "admin")}
        self.faults, self.children = [], []
        self.frames = multiprocessing.Queue()
        self.times = collections.deque()
        self.most_mb = 0
        self.daemon = None

    def path(self, name):
        return os.path.join(self.folder, name)

    def log(self):
        with open(self.path("log"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def start(self):
        with open(os.open(self.path("tokens"), os.O_CREAT | os.O_WRONLY, 0o600), "w", encoding="ascii") as file:
            for role, token in self.tokens.items():
                file.write(f"{role} {token}\n")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:4096", "-nodes", "-days", "30", "-subj",
                        "/CN=localhost", "-keyout", self.path("key"), "-out", self.path("certificate")],
                       check=True, capture_output=True)
        os.chmod(self.path("key"), 0o600)
        words = [os.path.join(self.bin, "obliqd"), "--config", os.path.join(os.path.dirname(__file__), "scene.toml")]
        for setting in (f'server.tokens="{self.path("tokens")}"', f'server.tls_key="{self.path("key")}"',
                        f'server.tls_certificate="{self.path("certificate")}"'):
            words += ["--set", setting]
        with open(self.path("log"), "wb") as log:
            self.daemon = subprocess.Popen(words, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        while "ready: " not in self.log():
            if self.daemon.poll() is not None:
                sys.exit("abuse: obliqd does not start:\n" + self.log())
            time.sleep(0.05)
        self.port = int(re.search(r"ready: .* on \S*:(\d+)", self.log()).group(1))
        self.expect("RSA" in self.log(), "no warning that an RSA-4096 key invites floods of handshakes")
        for target, arguments in ((watch, (self.tokens["viewer"], self.frames)), (turn, (self.tokens["admin"],))):
            child = multiprocessing.Process(target=target, args=(self.pb, self.port, *arguments), daemon=True)
            child.start()
            self.children.append(child)

    def expect(self, good, fault):
        if not good:
            self.faults.append(fault)
            print("  FAULT:", fault, flush=True)

    def look(self):
        """Memory and frames, now."""
        with open(f"/proc/{self.daemon.pid}/status", encoding="ascii") as file:
            self.most_mb = max(self.most_mb, int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)) / 1024)
        while not self.frames.empty():
            self.times.append(self.frames.get())

    def rate(self, begin, end):
        self.look()
        return sum(begin <= t < end for t in self.times) / (end - begin)

    def pause(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.look()
            time.sleep(0.1)

    def login(self):
        """Seconds until Welcome; nothing when it failed."""
        begin = time.monotonic()
        try:
            wire.Peer(self.pb, self.port, self.tokens["viewer"], "guest").socket.close()
        except (OSError, EOFError, wire.Refused) as error:
            print("  login:", error, flush=True)
            return None
        return time.monotonic() - begin

    def windows(self):
        return self.log().count("the next window of terrain serves")

    def phase(self, visit, logins=0):
        begin = time.monotonic()
        until = begin + self.phase_s
        said = multiprocessing.Queue()
        child = multiprocessing.Process(
            target=lambda: said.put(visit(self.pb, self.port, self.tokens, until)), daemon=True)
        child.start()
        took = []
        self.pause(1)
        for _ in range(logins):
            took.append(self.login())
            self.pause(max(0.1, self.phase_s / logins / 2))
        self.pause(max(0, until - time.monotonic()))
        rate = self.rate(begin, until)
        child.join(20)
        words = said.get() if not said.empty() else "did not end"
        print(f"{visit.__name__}: {words}; watcher {rate:.1f} Hz, {self.most_mb:.0f} MB at most", flush=True)
        if took:
            good = [t for t in took if t is not None]
            print(f"  {len(good)} of {len(took)} logins, the slowest in {max(good, default=0):.2f} s", flush=True)
            self.expect(len(good) == len(took), f"{visit.__name__}: a good token did not get in")
        self.expect(rate >= self.base / 2, f"{visit.__name__}: {rate:.1f} frames a second of {self.base:.1f}")
        self.expect(self.most_mb < MOST_MB, f"{visit.__name__}: {self.most_mb:.0f} MB, more than {MOST_MB}")
        self.expect(self.daemon.poll() is None, f"{visit.__name__}: obliqd has ended")

    def run(self):
        self.start()
        self.pause(2)
        begin = time.monotonic()
        self.pause(BASE_S)
        self.base = self.rate(begin, begin + BASE_S)
        print(f"alone: watcher {self.base:.1f} Hz, {self.most_mb:.0f} MB", flush=True)
        self.expect(self.base > 1, "the watcher gets no frames to begin with")
        self.phase(visits.polar_request)
        pilot = self.children[-1].pid
        os.kill(pilot, signal.SIGSTOP)  # whose poses would tell that the other radar has come to rest
        self.phase(visits.jumps)
        loaded = self.windows()
        self.pause(3)
        os.kill(pilot, signal.SIGCONT)
        self.expect(loaded <= 4, f"two jumps: {loaded} windows of terrain were loaded")
        self.expect(self.windows() == loaded, "windows of terrain are loaded without end")
        self.phase(visits.held_places, LOGINS)
        self.phase(visits.handshakes, LOGINS)
        self.phase(visits.odd_frames, LOGINS)
        self.expect(self.login() is not None, "afterwards: a good token does not get in")
        for child in self.children:
            child.terminate()
        self.daemon.send_signal(signal.SIGTERM)
        try:
            self.expect(self.daemon.wait(15) == 0, f"obliqd ended with {self.daemon.returncode}")
        except subprocess.TimeoutExpired:
            self.expect(False, "obliqd does not stop")
        return not self.faults

    def end(self):
        for child in self.children:
            child.kill()
        if self.daemon and self.daemon.poll() is None:
            self.daemon.kill()
        if self.faults:
            print(self.log()[-6000:])
            print("faults:", *self.faults, sep="\n  ")
        shutil.rmtree(self.folder, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", default="build/release/bin")
    parser.add_argument("--seconds", type=float, default=PHASE_S, help="of each of the five kinds of abuse")
    arguments = parser.parse_args()
    multiprocessing.set_start_method("fork")
    abuse = Abuse(arguments)
    good = False
    try:
        good = abuse.run()
    finally:
        abuse.end()
    print("held" if good else "did not hold")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
