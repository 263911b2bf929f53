"""Programs of this build in tests written in Python: how each is started, what it says, what can be seen of it from outside, and
how it ends: with its object or with the test, whatever happens. Standard library only.

  served = programs.daemon("scene.toml", 'radar.gain_db=3')      obliqd on free ports, ready
  served = programs.replay("a.obliq", "--hold")                  `obliq replay --serve`, ready
  program = programs.Program([programs.OBLIQ, "fly", ...])       any other; program.await_words("listening on (.*)")
"""
import mmap
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import tempfile
import time
import weakref

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BIN = pathlib.Path(os.environ.get("OBLIQ_BIN", ROOT / "build" / "release" / "bin"))
OBLIQ, OBLIQD = str(BIN / "obliq"), str(BIN / "obliqd")
STARTS_S = 120  # on a machine that builds beside
TICK_S = 1 / os.sysconf("SC_CLK_TCK")


def free_ports(count, kind=socket.SOCK_STREAM):
    """Ports of this machine that nobody listens on at this moment."""
    held = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    for one in held:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


def await_that(question, what, seconds=STARTS_S):
    """The first true answer; an AssertionError with `what` where none comes: words, or a function that says them then."""
    end = time.monotonic() + seconds
    while not (answer := question()):
        if time.monotonic() > end:
            raise AssertionError(f"waited {seconds} s for {what() if callable(what) else what}")
        time.sleep(0.02)
    return answer


def processor_s(pid):
    """What the process has used so far; its ended threads count."""
    with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
        words = file.read().rsplit(")", 1)[1].split()
    return (int(words[11]) + int(words[12])) * TICK_S


def memory_mb(pid, what="VmRSS"):
    """Resident, now; VmHWM: at most."""
    try:
        with open(f"/proc/{pid}/status", encoding="utf-8", errors="replace") as file:
            return int(re.search(what + r":\s+(\d+)", file.read()).group(1)) / 1024
    except (OSError, AttributeError):  # it has ended
        return 0.0


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def threads(pid):
    return len(os.listdir(f"/proc/{pid}/task"))


def is_sanitized(program):
    """Built with a sanitizer: slower, and with more addresses than a limit would leave it."""
    with open(program, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        return any(data.find(name) >= 0 for name in (b"__asan_init", b"__tsan_init"))


def ending(code):
    return f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"


def limited(gigabytes):
    """For a command that a file might make greedy: room for addresses and files, and no dump of either."""
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (gigabytes << 30, gigabytes << 30))
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return limit


def _end(process):
    if process.poll() is None:
        process.kill()
    process.wait()


class Program:
    """A program with its output in a file: at the end of `log`, or in one of its own that goes with it."""

    def __init__(self, words, log=None, environment=None, gigabytes=0, stdin=subprocess.DEVNULL):
        self.words, self.begun = [str(word) for word in words], time.monotonic()
        if log is None:
            descriptor, log = tempfile.mkstemp(prefix=os.path.basename(self.words[0]) + "-")
            os.close(descriptor)
            weakref.finalize(self, os.unlink, log)
        self.log_path = log
        with open(log, "ab") as file:
            self._log_begin = file.tell()
            # A session of its own: Ctrl-C is for the test, which ends it in good order.
            self.process = subprocess.Popen(self.words, stdin=stdin, stdout=file, stderr=subprocess.STDOUT, start_new_session=True,
                                            env={**os.environ, "OBLIQ_CACHE_DIR": "", **(environment or {})},
                                            preexec_fn=limited(gigabytes) if gigabytes else None)
        weakref.finalize(self, _end, self.process)
        self.pid, self.most_mb, self.used_s, self.killed = self.process.pid, 0.0, 0.0, False

    def log(self):
        """What it has said so far."""
        with open(self.log_path, "rb") as file:
            file.seek(self._log_begin)
            return file.read().decode(errors="replace")

    def log_bytes(self):
        return os.path.getsize(self.log_path) - self._log_begin

    def lives(self):
        return self.process.poll() is None

    def look(self):
        """Keeps memory at most and processor time so far, which are gone with the process."""
        if self.lives():
            self.most_mb = max(self.most_mb, memory_mb(self.pid, "VmHWM"))
            try:
                self.used_s = processor_s(self.pid)
            except OSError:
                pass

    def await_words(self, pattern):
        """What the log says by then; RuntimeError where the program ends without it."""
        end = time.monotonic() + STARTS_S
        while not (found := re.search(pattern, self.log())):
            if not self.lives() or time.monotonic() > end:
                if found := re.search(pattern, self.log()):  # its last words
                    break
                raise RuntimeError(f"{os.path.basename(self.words[0])} does not say {pattern!r}: {self.log()[-2000:]}")
            time.sleep(0.02)
        return found

    def finish(self, seconds, processor=None):
        """Waits; what it ended with, or "still at work" when time is over (or processor time) and it was killed."""
        end = time.monotonic() + seconds
        while self.lives() and time.monotonic() < end and (processor is None or self.used_s < processor):
            self.look()
            time.sleep(0.01)
        if self.lives():
            self.kill()
            return "still at work"
        return self.process.returncode

    def send(self, number):
        self.process.send_signal(number)

    def stop(self, sent=signal.SIGTERM, seconds=30):
        """Asks it to end; what finish() says."""
        if self.lives():
            self.send(sent)
        return self.finish(seconds)

    def kill(self):  # by us: no fault of its own
        if self.lives():
            self.killed = True
            self.process.kill()
        self.process.wait()


class Served(Program):
    """obliqd or `obliq replay --serve`: has ports."""

    def __init__(self, words, **more):
        super().__init__(words, **more)
        try:
            self.address = self.await_words(r"ready: .* on (\S+:\d+)").group(1)
        except BaseException:
            self.kill()
            raise
        self.port = int(self.address.rsplit(":", 1)[1])
        page = re.search(r"(?:https?://|HTTP on )\S*?:(\d+)\b", self.log())
        self.web_port = int(page.group(1)) if page else 0
        self.first_mb, self.first_descriptors, self.first_log_bytes = memory_mb(self.pid), self.descriptors(), self.log_bytes()

    def descriptors(self):
        return descriptors(self.pid)

    def processor_s(self):
        return processor_s(self.pid)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


def daemon(scene, *settings, obliqd=OBLIQD, **more):
    """obliqd with a scene file, ready; on free ports unless a setting ("KEY=VALUE", as --set has it) says otherwise."""
    words = [obliqd, "--config", scene]
    for setting in ("server.port=0", "http.port=0", *settings):
        words += ["--set", setting]
    return Served(words, **more)


def replay(recording, *words, obliq=OBLIQ, **more):
    """`obliq replay --serve` of a recording, ready; on a free port unless the words say otherwise."""
    return Served([obliq, "replay", recording, "--serve", "--port", "0", *words], **more)
