"""The honest client beside an attack, a process of its own: watches a radar, turns it so that no frame is a repetition, and
asks for the list of radars again and again. For each line of its standard input it prints what it has seen so far, as JSON, and
after the line "anew" it forgets that. Its arguments are JSON too."""
import json
import os
import sys
import threading
import time

import wire

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import programs  # noqa: E402

TURN_S = 0.05
ASK_S = 0.05


class Gap:
    """The longest stretch between two events, in the server's processor time and by the clock."""

    def __init__(self, pid):
        self.pid, self.lock, self.events, self.most = pid, threading.Lock(), 0, [0.0, 0.0]
        self.last = (0.0, 0.0)
        self.last = self.now()

    def now(self):
        try:
            return programs.processor_s(self.pid), time.monotonic()
        except OSError:  # it has ended
            return self.last[0], time.monotonic()

    def event(self):
        with self.lock:
            now = self.now()
            self.most = [max(most, b - a) for most, a, b in zip(self.most, self.last, now)]
            self.last = now
            self.events += 1

    def report(self, anew):
        """Since the beginning, or the report that was the last one before it began anew."""
        with self.lock:
            told = {"count": self.events, "processor_s": round(self.most[0], 2), "clock_s": round(self.most[1], 2)}
            if anew:
                self.events, self.most = 0, [0.0, 0.0]
            return told


class Watcher:
    def __init__(self, given):
        self.given, self.faults = given, []
        self.frames, self.answers = Gap(given["pid"]), Gap(given["pid"])

    def peer(self, name):
        return wire.Peer(self.given["port"], self.given["token"], name, timeout=600, tls=self.given["tls"])

    def guarded(self, work):
        try:
            work()
        except Exception as error:  # the attack's report tells it
            self.faults.append(f"{work.__name__}: {error!r}")

    def watch(self):
        peer = self.peer("watcher")
        peer.demand(wire.SUBSCRIBE, radar=self.given["radar"], rate_hz=self.given["rate_hz"], planes=["POWER"])
        while True:
            kind, payload = peer.receive()
            if kind == wire.FRAME_END:
                self.frames.event()
            elif kind == wire.HEARTBEAT:
                peer.beat(payload)
            elif kind == wire.ERROR:
                raise wire.Refused(wire.pb.Error.FromString(payload))

    def turn(self):
        peer = self.peer("pilot")
        peer.demand(wire.CLAIM, radar=self.given["radar"])
        bearing = 0
        while True:
            bearing = (bearing + 1) % 360
            peer.demand(wire.SET_POSE, radar=self.given["radar"], pose=wire.pb.Pose(bearing_deg=bearing))
            time.sleep(TURN_S)

    def ask(self):
        peer = self.peer("bystander")
        while True:
            peer.demand(wire.LIST)
            self.answers.event()
            time.sleep(ASK_S)

    def run(self):
        for work in [self.watch, self.ask] + ([self.turn] if self.given["turns"] else []):
            threading.Thread(target=self.guarded, args=(work,), daemon=True).start()
        for line in sys.stdin:
            anew = line == "anew\n"
            told = {"frames": self.frames.report(anew), "answers": self.answers.report(anew), "faults": self.faults[:3]}
            print(json.dumps(told), flush=True)


if __name__ == "__main__":
    Watcher(json.loads(sys.argv[1])).run()
