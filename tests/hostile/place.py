"""The place of an attack: what it is given, and what must hold after it. The programs live; an honest client was served
meanwhile, and another is let in afterwards; memory, descriptors and the log are within their bounds."""
import contextlib
import dataclasses
import json
import os
import random
import re
import secrets
import shutil
import subprocess
import sys
import threading
import time
import zlib

import web
import wire

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "../support"))
import programs  # noqa: E402

# Of an honest client's wait, in the server's processor time, which a busy machine does not stretch: where all held, 0.1 s was
# the most, and 1.6 s the least that a fault took. The clock's bound is for a server that waits without working.
MOST_GAP_PROCESSOR_S, MOST_GAP_CLOCK_S = 1.0, 60.0
MOST_LOGIN_S = 2.0  # of processor time, a handshake of RSA-4096 and frames of others included
MOST_GROWTH_MB = 250  # 178 MB was the most of a frame that is allowed (8192 azimuths, 1,024 looks)
MOST_LOG_KB, MOST_LINE_BYTES = 200, 4096
LEFT_OPEN = 2  # descriptors: the bystander's own comings and goings
CLOSES_S = 15
SANITIZED = 10  # times as much time and memory as a sanitizer may take
GOES_ON, GOES_ON_S = 3, 60  # frames and answers afterwards
ROLES = ("viewer", "controller", "admin")

ATTACKS = []


@dataclasses.dataclass
class Attack:
    name: str  # "websocket.large_message"
    finding: str  # what it was found as: a class of findings; "" for what has always held
    words: str
    run: object


def attack(finding=""):
    """Registers a function as an attack: its file's name and its own, its docstring's first line in the list."""
    def register(function):
        group = function.__module__.removeprefix("on_")
        ATTACKS.append(Attack(f"{group}.{function.__name__}", finding, function.__doc__.split("\n")[0], function))
        return function
    return register


@dataclasses.dataclass
class Bounds:
    """Of one program under attack."""
    most_mb: float = 0  # resident, at most; 0: what it had at first and MOST_GROWTH_MB
    log_kb: float = MOST_LOG_KB
    ends: tuple = (0,)  # exit codes after SIGTERM
    watched: bool = True
    steady: bool = True  # whether frames are due all the while; a replay that others hold has none


class Skipped(Exception):
    """Something that the attack needs is not installed."""


class Place:
    def __init__(self, bin_folder, folder, seed, seconds, name):
        self.bin, self.folder, self.seconds = os.path.abspath(bin_folder), folder, seconds
        self.random = random.Random(seed ^ zlib.crc32(name.encode()))
        self.faults, self.served, self.programs, self.open = [], [], [], contextlib.ExitStack()
        self.tokens, self.waits = {}, []
        self.slack = SANITIZED if programs.is_sanitized(os.path.join(self.bin, "obliqd")) else 1

    # ---- What attacks use ----

    def expect(self, good, fault):
        if not good:
            self.faults.append(fault)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def until(self, part=1.0):
        """The end of this part of the attack's time."""
        return time.monotonic() + part * self.seconds

    def kept(self, closable):
        """Closed when the attack ends."""
        self.open.callback(closable.close)
        return closable

    def token_file(self):
        """One token a role; afterwards peer() and web_socket() bring them."""
        self.tokens = {role: secrets.token_hex(24) for role in ROLES}
        path = self.write("tokens", "".join(f"{role} {token}\n" for role, token in self.tokens.items()))
        os.chmod(path, 0o600)
        return path

    def certificate(self):
        """RSA of 4096 bits: the dearest handshake."""
        if not shutil.which("openssl"):
            raise Skipped("no openssl here; deploy/install-deps.sh test installs it")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:4096", "-nodes", "-days", "30", "-subj", "/CN=localhost",
                        "-keyout", self.path("key"), "-out", self.path("certificate")], check=True, capture_output=True)
        os.chmod(self.path("key"), 0o600)
        return [f'server.tls_certificate="{self.path("certificate")}"', f'server.tls_key="{self.path("key")}"']

    def daemon(self, *settings, scene="", tokens=False, tls=False, **bounds):
        """obliqd over small hills, with a client that watches "main"; scene: what is added to the scene file."""
        with open(os.path.join(HERE, "scene.toml"), encoding="utf-8") as file:
            path = self.write("scene.toml", file.read() + scene)
        words = [os.path.join(self.bin, "obliqd"), "--config", path]
        if tokens:
            settings = (*settings, f'server.tokens="{self.token_file()}"')
        if tls:
            settings = (*settings, *self.certificate())
        for setting in settings:
            words += ["--set", setting]
        return self.serve(words, Bounds(**bounds), tls, turns=True)

    def replay(self, recording, *words, **bounds):
        """`obliq replay --serve` of it, watched as well."""
        words = [os.path.join(self.bin, "obliq"), "replay", recording, "--serve", "--port", "0", "--http-port", "0", *words]
        return self.serve(words, Bounds(**bounds), False, turns=False)

    def peer(self, served, role="viewer", **more):
        return self.kept(wire.Peer(served.port, self.tokens.get(role, ""), tls=served.tls, **more))

    def web_socket(self, served, role="viewer", **more):
        return self.kept(web.Socket(served.web_port, self.tokens.get(role, ""), **more))

    def command(self, *words, environment=None, gigabytes=9, name="obliq"):
        """A command of the project, begun: with little room to grow."""
        program = programs.Program([os.path.join(self.bin, name), *words], self.path(f"log.{len(self.programs)}"), environment,
                                  gigabytes if self.slack == 1 else 0)
        self.programs.append(program)
        return program

    def recording(self, frames=20, radar="main", scene="", planes=("POWER", "STATE")):
        """The bytes that a daemon of its own sends to a watcher: a recording, as PROTOCOL.md has it."""
        bounds = Bounds(watched=False)
        served = self.daemon(scene=scene, watched=False)
        peer, data, ends = wire.Peer(served.port), [], 0
        with contextlib.closing(peer):
            data.append(wire.framed(wire.WELCOME, peer.welcome.SerializeToString()))
            data.append(wire.framed(wire.GET_RADAR + 1, peer.demand(wire.GET_RADAR, radar=radar), 2))
            peer.send(wire.SUBSCRIBE, radar=radar, rate_hz=20, planes=list(planes))
            while ends < frames:
                head = peer.read(48)
                data += [head, peer.read(int.from_bytes(head[12:16], "little"))]
                ends += int.from_bytes(head[6:8], "little") == wire.FRAME_END
        self.served.remove(served)
        self.expect(served.stop() == 0 and not bounds.watched, "the daemon that was recorded did not stop")
        return self.write("recording.obliq", b"".join(data))

    def together(self, works, *arguments):
        """Threads, joined; an error of one of them is the attack's."""
        errors = []

        def guarded(work):
            try:
                work(*arguments)
            except Exception as error:
                errors.append(error)
        threads = [threading.Thread(target=guarded, args=(work,), daemon=True) for work in works]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if errors:
            raise errors[0]

    # ---- What is looked at ----

    def serve(self, words, bounds, tls, turns):
        served = programs.Served(words, log=self.path(f"served.{len(self.served)}"))
        served.bounds, served.tls, served.watcher = bounds, tls, None
        self.served.append(served)
        if bounds.watched:
            given = {"port": served.port, "pid": served.pid, "token": self.tokens.get("admin", ""), "tls": tls, "radar": "main",
                     "rate_hz": 20, "turns": turns}
            served.watcher = subprocess.Popen([sys.executable, "-B", os.path.join(HERE, "watcher.py"), json.dumps(given)],
                                              stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            self.await_frames(served, "the watcher gets no frames to begin with")
            served.first_mb, served.first_descriptors = programs.memory_mb(served.pid), served.descriptors()
            self.seen(served, "anew")
        return served

    def seen(self, served, line=""):
        """What the watcher has seen; line "anew": and is to forget."""
        served.watcher.stdin.write(line + "\n")
        served.watcher.stdin.flush()
        line = served.watcher.stdout.readline()
        if not line:
            raise RuntimeError("the watcher has ended")
        return json.loads(line)

    def await_frames(self, served, fault):
        """The watcher gets a few, and answers to what it asks."""
        end, report = time.monotonic() + GOES_ON_S, self.seen(served)
        first = {what: report[what]["count"] for what in ("frames", "answers")}
        while (wanting := any(report[what]["count"] < first[what] + GOES_ON for what in first)) and served.lives() \
                and time.monotonic() < end and not report["faults"]:
            time.sleep(0.05)
            report = self.seen(served)
        self.expect(not wanting or not served.lives(), f"{fault}{': ' if report['faults'] else ''}{'; '.join(report['faults'])}")

    def look_at(self, served):
        """After the attack; its sockets are closed."""
        bounds = served.bounds
        if not served.lives():
            self.faults.insert(0, f"{os.path.basename(served.words[0])} {programs.ending(served.process.returncode)}")
        else:
            served.look()
            if served.watcher:
                self.look_at_watcher(served)
            self.look_at_login(served)
            most = (bounds.most_mb or served.first_mb + MOST_GROWTH_MB) * self.slack
            self.expect(served.most_mb <= most,
                        f"{served.most_mb:.0f} MB resident, at first {served.first_mb:.0f}; allowed: {most:.0f}")
            end = time.monotonic() + CLOSES_S
            while (left := served.descriptors() - served.first_descriptors) > LEFT_OPEN and time.monotonic() < end:
                time.sleep(0.1)
            self.expect(left <= LEFT_OPEN, f"{left} descriptors more than at first")
            ended = served.stop()
            self.expect(ended in bounds.ends, "does not stop"
                        if ended == "still at work" else f"stopped, {programs.ending(ended)}")
        grown = served.log_bytes() - served.first_log_bytes
        self.expect(grown <= bounds.log_kb * 1000, f"the log grew by {grown / 1000:.0f} kB; allowed: {bounds.log_kb}")
        longest = max(map(len, served.log().splitlines()), default=0)
        self.expect(longest <= MOST_LINE_BYTES, f"a log line of {longest} bytes; allowed: {MOST_LINE_BYTES}")

    def look_at_watcher(self, served):
        self.await_frames(served, "the watcher gets no frames afterwards")
        report = self.seen(served)
        looked_at = {"frames": "frame for the watcher", "answers": "answer to another client"}
        if not served.bounds.steady:
            del looked_at["frames"]
        self.waits.append(max(report[what]["processor_s"] for what in looked_at))
        for what, words in looked_at.items():
            gap = report[what]
            self.expect(gap["processor_s"] <= MOST_GAP_PROCESSOR_S * self.slack
                        and gap["clock_s"] <= MOST_GAP_CLOCK_S * self.slack,
                        f"no {words} for {gap['processor_s']:.1f} s of processor time ({gap['clock_s']:.1f} s by the clock)")

    def look_at_login(self, served):
        used = served.processor_s()
        try:
            wire.Peer(served.port, self.tokens.get("viewer", ""), timeout=60, tls=served.tls).close()
            used = served.processor_s() - used
            self.expect(used <= MOST_LOGIN_S * self.slack, f"a login took {used:.1f} s of processor time")
        except (OSError, EOFError, wire.Refused) as error:
            self.expect(False, f"no login afterwards: {error}")

    def look_around(self):
        self.open.close()
        for served in self.served:
            self.look_at(served)
        for program in self.programs:
            if program.lives():
                program.kill()
                self.expect(False, f"{' '.join(program.words[1:3])}: still there")
            code = program.process.returncode
            self.expect(code >= 0 or program.killed, f"{' '.join(program.words[1:3])[:80]} {programs.ending(code)}")
            self.expect("Traceback" not in program.log(), f"{' '.join(program.words[1:3])[:80]}: a traceback")

    def end(self):
        """Nothing that it began stays, whatever happened."""
        self.open.close()
        for served in self.served:
            if served.watcher:
                served.watcher.kill()
                served.watcher.wait()
                served.watcher.stdin.close()
                served.watcher.stdout.close()
        for program in self.served + self.programs:
            program.kill()

    def logs(self):
        return "\n".join(re.sub(r"[^\n]{300,}", lambda m: m.group()[:300] + "...", served.log()[-3000:])
                         for served in self.served)
