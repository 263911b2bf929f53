"""Programs of the project under attack, and what can be seen of them from outside: /proc and their logs."""
import mmap
import os
import re
import resource
import signal
import subprocess
import time

STARTS_S = 120  # on a machine that builds beside
TICK_S = 1 / os.sysconf("SC_CLK_TCK")


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


class Program:
    """A program with its output in a file."""

    def __init__(self, words, log, environment=None, gigabytes=0, stdin=subprocess.DEVNULL):
        self.words, self.log_path, self.begun = [str(word) for word in words], log, time.monotonic()
        with open(log, "wb") as file:
            self.process = subprocess.Popen(self.words, stdin=stdin, stdout=file, stderr=subprocess.STDOUT,
                                            start_new_session=True,
                                            env={**os.environ, "OBLIQ_CACHE_DIR": "", **(environment or {})},
                                            preexec_fn=limited(gigabytes) if gigabytes else None)
        self.pid, self.most_mb, self.used_s, self.killed = self.process.pid, 0.0, 0.0, False

    def log(self):
        with open(self.log_path, encoding="utf-8", errors="replace") as file:
            return file.read()

    def log_bytes(self):
        return os.path.getsize(self.log_path)

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
                raise RuntimeError(f"{os.path.basename(self.words[0])} does not say {pattern!r}: {self.log()[-800:]}")
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

    def stop(self, sent=signal.SIGTERM, seconds=30):
        if self.lives():
            self.process.send_signal(sent)
        return self.finish(seconds)

    def kill(self):  # by us: no fault of its own
        if self.lives():
            self.killed = True
            self.process.kill()
        self.process.wait()


class Served(Program):
    """obliqd or `obliq replay --serve`: has ports."""

    def __init__(self, *words, **more):
        super().__init__(*words, **more)
        ready = self.await_words(r"ready: .* on \S*:(\d+)")
        self.port = int(ready.group(1))
        page = re.search(r"https?://\S*?:(\d+)/", self.log())
        self.web_port = int(page.group(1)) if page else 0
        self.first_mb, self.first_descriptors, self.first_log_bytes = memory_mb(self.pid), self.descriptors(), self.log_bytes()

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.pid}/fd"))

    def processor_s(self):
        return processor_s(self.pid)
