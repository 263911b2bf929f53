"""tests/dis_load.sh: 10,000 PDUs a second to `obliq fly --dis --targets`, which feeds a daemon over the tests' hills."""
import argparse
import os
import pathlib
import re
import signal
import socket
import statistics
import struct
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "client" / "python" / "src"), str(ROOT / "tests" / "python")]
import numpy as np  # noqa: E402
import obliq  # noqa: E402
import support  # noqa: E402
from support import programs  # noqa: E402
from fly_test import earth_centred  # noqa: E402

ENTITIES, PDU_BYTES, PDUS_HZ = 1000, 144, 10_000  # tests/exercise/dis_recording.py
STEP_S = 0.01
LOOK_S = 5.0
# A place goes through degrees of double precision and back: some nanometres of the earth's radius.
MOST_OFF_M = 1e-6
UNDERSTOOD = re.compile(r"(\d+) PDUs? understood")
LOST = re.compile(r"(\d+) datagrams lost")


class State:
    """What a PDU says, read by the standard's offsets (IEEE 1278.1-2012, 7.2.2)."""

    def __init__(self, pdu):
        site, application, self.entity = struct.unpack_from(">3H", pdu, 12)
        self.id = (1 << 48) + (site << 32) + (application << 16) + self.entity
        self.velocity_m_s = np.array(struct.unpack_from(">3f", pdu, 36))
        self.place_m = np.array(struct.unpack_from(">3d", pdu, 48))


class Recording:
    """Rounds of PDUs, one of each entity, again and again."""

    def __init__(self, path):
        data = path.read_bytes()
        self.pdus = [data[at:at + PDU_BYTES] for at in range(0, len(data), PDU_BYTES)]
        assert len(self.pdus) * PDU_BYTES == len(data) and len(self.pdus) % ENTITIES == 0

    def pdu(self, number):
        return self.pdus[number % len(self.pdus)]


class Sender(threading.Thread):
    """Sends a recording at its pace; what it is late it makes good."""

    def __init__(self, recording, port, seconds):
        super().__init__(daemon=True)
        self.recording, self.wanted, self.sent = recording, int(seconds * PDUS_HZ), 0
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.late_s, self.times = 0.0, {}

    def send(self):
        self.socket.send(self.recording.pdu(self.sent))
        self.sent += 1

    def run(self):
        self.begin = time.monotonic()
        while self.sent < self.wanted:
            due = self.begin + self.sent / PDUS_HZ
            time.sleep(max(0.0, due - time.monotonic()))
            self.late_s = max(self.late_s, time.monotonic() - due)
            for _ in range(min(int(STEP_S * PDUS_HZ), self.wanted - self.sent)):
                self.send()
        self.took_s = time.monotonic() - self.begin

    def closing_round(self):
        """The next round, within a second; what each entity said last, and when, by its id."""
        last = {}
        for k in range(ENTITIES):
            state = State(self.recording.pdu(self.sent))
            last[state.id] = state, time.monotonic()
            self.send()
            if k % 10 == 9:
                time.sleep(0.01)
        return last


class KernelSocket:
    """A UDP socket as /proc/net/udp has it."""

    def __init__(self, port):
        self.local = f"0100007F:{port:04X}"

    def words(self):
        for line in pathlib.Path("/proc/net/udp").read_text().splitlines():
            if line.split()[1] == self.local:
                return line.split()
        raise SystemExit(f"dis_load: no socket {self.local} in /proc/net/udp")

    def drops(self):
        return int(self.words()[-1])

    def waiting_bytes(self):
        return int(self.words()[4].split(":")[1], 16)


def place_of(target):
    assert target.height_reference == "ellipsoid" and not target.geoid_undulation_m, target
    return earth_centred(target.latitude_deg, target.longitude_deg, target.height_m)


def until(holds, seconds):
    """Whether it holds within so long."""
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


class Load:
    """A daemon, the command that feeds it, and what is sent to it."""

    def __init__(self, bin_folder, recording, seconds, folder):
        self.daemon, self.flight = programs.daemon(support.scene(folder), "http.enabled=false", obliqd=bin_folder / "obliqd"), None
        try:
            self.address = self.daemon.address
            self.flight = programs.Program([bin_folder / "obliq", "fly", "--server", self.address, "--dis", "--targets", "--udp", "0"])
            port = int(self.flight.await_words(r"listening on 127\.0\.0\.1:(\d+)").group(1))
        except BaseException:
            self.stop()
            raise
        self.kernel, self.sender = KernelSocket(port), Sender(recording, port, seconds)

    def stop(self):
        for program in filter(None, (self.flight, self.daemon)):
            program.kill()

    def run(self):
        """Sends at full pace; the shares of a core that command, daemon and sender (with this test's looks) took, and how many
        targets there were at each look."""
        pids, counts = (self.flight.pid, self.daemon.pid, os.getpid()), []
        before = [programs.processor_s(pid) for pid in pids]
        self.sender.start()
        with obliq.connect(self.address) as server:
            while self.sender.is_alive():
                self.sender.join(LOOK_S)
                counts.append(len(server.target_list()))
        return [(programs.processor_s(pid) - was) / self.sender.took_s for pid, was in zip(pids, before)], counts

    def say_all_once_more(self):
        """A round that came whole: what each entity said last, and when. The kernel counts what it drops in the next datagram's
        company, so this brings the command's count up to date."""
        for _ in range(10):
            until(lambda: self.kernel.waiting_bytes() == 0, 60)
            before = self.kernel.drops()
            last = self.sender.closing_round()
            until(lambda: self.kernel.waiting_bytes() == 0, 60)
            if self.kernel.drops() == before:
                return last
        raise SystemExit("dis_load: the kernel drops from each of ten slow rounds")

    def end(self):
        """What the command understood and lost, in the kernel or itself; and the kernel's own count."""
        drops = self.kernel.drops()
        if (code := self.flight.stop(signal.SIGINT, 60)) != 0:
            raise SystemExit(f"dis_load: obliq fly: {code}: {self.flight.log()}")
        said = self.flight.log().strip().splitlines()[-1]
        return int(UNDERSTOOD.search(said)[1]), int(LOST.search(said)[1]), drops, said


class Places:
    """How well the world's targets agree with what their entities said last."""

    def __init__(self, targets, now, last):
        self.missing = sorted(set(last) - {target.id for target in targets})
        self.off_m, self.late_s, self.wrong = [], [], []
        for target in targets:
            state, sent = last.get(target.id, (None, 0))
            if state is None:
                self.wrong.append(f"{target.id} is no entity's")
                continue
            off_m = place_of(target) - state.place_m
            square = state.velocity_m_s @ state.velocity_m_s
            if square:
                # Along its line, as far as it has come since it said so: not yet when it was sent, no later than now.
                after_s = off_m @ state.velocity_m_s / square
                off_m = off_m - after_s * state.velocity_m_s
                self.late_s.append(now - target.age_s - (sent + after_s))
                if not 0 <= after_s <= now - sent:
                    self.wrong.append(f"{target.id} is {after_s:.3f} s on its way; allowed: 0 to {now - sent:.3f}")
            self.off_m.append(float(np.linalg.norm(off_m)))
            if self.off_m[-1] > MOST_OFF_M:
                self.wrong.append(f"{target.id} is {self.off_m[-1]:g} m off; allowed: {MOST_OFF_M:g}")

    def agree(self):
        return not self.missing and not self.wrong


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("recording", type=pathlib.Path)
    arguments.add_argument("--seconds", type=float, default=30.0)
    arguments.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin")
    arguments = arguments.parse_args()
    places = None
    with tempfile.TemporaryDirectory() as folder:
        load = Load(arguments.bin.resolve(), Recording(arguments.recording), arguments.seconds, pathlib.Path(folder))
        try:
            shares, counts = load.run()
            last = load.say_all_once_more()
            with obliq.connect(load.address) as server:
                def agree():
                    nonlocal places
                    places = Places(server.target_list(), time.monotonic(), last)
                    return places.agree()

                agreed = until(agree, 10)  # before those that move time out
            understood, lost, drops, said = load.end()
        finally:
            load.stop()
    sent, sender = load.sender.sent, load.sender
    lost_here = max(0, lost - drops)
    print(f"sent {sent} PDUs of {ENTITIES} entities, {sender.wanted / sender.took_s:.0f} a second for {sender.took_s:.1f} s, at most "
          f"{1e3 * sender.late_s:.0f} ms late; understood {understood}, kernel drops {drops}, lost by the command {lost_here}")
    print(f"shares of a core: obliq fly {shares[0]:.1%}, obliqd {shares[1]:.1%}, this test {shares[2]:.1%}")
    if places.off_m and places.late_s:
        print(f"targets: {min(counts)} to {max(counts)} in {len(counts)} looks, {len(places.off_m)} at the end, at most {max(places.off_m):.1e} m from where, or from the line on "
              f"which, their entities said; those that move are shown {1e3 * statistics.median(places.late_s):.0f} ms from the sender's time")
    faults = [] if agreed else [f"places do not agree: {places.wrong[:5]}, missing {places.missing[:5]}"]
    if sent != understood + drops + lost_here:
        faults.append(f"{sent} sent are not {understood} understood, {drops} dropped by the kernel and {lost_here} lost by the command")
    for fault in faults:
        print(f"dis_load: {fault}; the command said: {said}", file=sys.stderr)
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
