"""What the tests of the Python package share: a daemon over small ground, and a server that misbehaves as told."""
import atexit
import contextlib
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests" / "support"))
if "OBLIQ_INSTALLED" not in os.environ:  # the package of the tree, not one that is installed
    sys.path.insert(0, str(ROOT / "client" / "python" / "src"))
os.environ.setdefault("OBLIQ_CACHE_DIR", "")  # tests leave nothing in the user's cache

import obliq  # noqa: E402
import programs  # noqa: E402
from obliq import wire  # noqa: E402
from obliq._protocol import wire as _wire  # noqa: E402
from programs import BIN, OBLIQ, OBLIQD  # noqa: E402, F401

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[earth]
radius_factor = 1.3333333333333333
[antenna]
height_m = 1500.0
bearing_deg = 60.0
[bins]
azimuth = 64
range = 96
[frustum]
kind = "sweep"
[[radar]]
name = "main"
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 12000.0
[[radar]]
name = "scan"
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 12000.0
scan.mode = "sector"
scan.rate_deg_s = 180.0
"""


def scene(folder, text=SCENE, name="hills.toml"):
    path = pathlib.Path(folder) / name
    path.write_text(text)
    return path


@contextlib.contextmanager
def daemon(text=SCENE, settings=None):
    """The address of an obliqd of its own; settings: values in TOML by their keys."""
    with tempfile.TemporaryDirectory() as folder, \
            programs.daemon(scene(folder, text), *(f"{key}={value}" for key, value in (settings or {}).items())) as running:
        yield running.address


_shared = None


def shared_daemon():
    """The address of the obliqd that the tests of a program share; no test changes its radars for good."""
    global _shared
    if _shared is None:
        _shared = contextlib.ExitStack()
        _shared.address = _shared.enter_context(daemon())
        atexit.register(_shared.close)
    return _shared.address


def wait_until(holds, seconds=20):
    """Until it holds, or the test fails."""
    programs.await_that(holds, "what the test waits for", seconds)


def run(*words, check=True):
    """A program of ours; its standard output."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if check and done.returncode != 0:
        raise AssertionError(f"{words}: exit code {done.returncode}: {done.stderr}")
    return done.stdout


def needs(*modules):
    """Skips a test by name where a package is missing."""
    missing = []
    for module in modules:
        try:
            __import__(module)
        except ImportError:
            missing.append(module)
    return unittest.skipIf(missing, f"{', '.join(missing)} is not installed")


class Folder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)


# ---- A server that says what it is told ----

class Peer:
    """One connection of the fake server, blocking."""

    def __init__(self, connection):
        self.socket, self.sequence = connection, 0
        self.splitter = _wire.Splitter()

    def read(self):
        """The next request, parsed; EOFError when the client has gone."""
        while (message := self.splitter.next()) is None:
            count = self.socket.recv_into(self.splitter.space())
            if not count:
                raise EOFError
            self.splitter.filled(count)
        return message.parsed()

    def bytes_of(self, message, stream_id=0, plane=b""):
        self.sequence += 1
        return _wire.encode(message, self.sequence, stream_id, plane)

    def send(self, message, stream_id=0, plane=b""):
        self.socket.sendall(self.bytes_of(message, stream_id, plane))

    def greet(self, **more):
        """Hello and Welcome."""
        hello = self.read()
        welcome = wire.Welcome(request_id=hello.request_id, major=1, minor=1, radars=["main"], scene_name="made up")
        welcome.limits.max_renders_queued = 4
        for name, value in more.items():
            setattr(welcome.limits if hasattr(welcome.limits, name) else welcome, name, value)
        self.send(welcome)

    def await_subscribe(self):
        while not isinstance(request := self.read(), wire.Subscribe):
            self.answer(request)
        self.send(wire.Ack(request_id=request.request_id))
        return request

    def answer(self, request):
        if isinstance(request, wire.Heartbeat):
            self.send(wire.Heartbeat(request_id=request.request_id))
        else:
            self.send(wire.Ack(request_id=request.request_id))

    def begin(self, azimuths=8, ranges=4, frame_id=1, request_id=0, stream_id=1):
        begin = wire.FrameBegin(frame_id=frame_id, request_id=request_id, wedges=1)
        begin.frame.radar = "main"
        begin.frame.frame_id = frame_id
        begin.frame.settings.azimuth_bins, begin.frame.settings.range_bins = azimuths, ranges
        self.send(begin, stream_id)

    def state_block(self, azimuths=8, ranges=4, frame_id=1, stream_id=1, plane=None, **fields):
        block = wire.WedgeBlock(frame_id=frame_id, plane=3, n_azimuth=azimuths, n_range=ranges, **fields)
        self.send(block, stream_id, bytes([1]) * (azimuths * ranges) if plane is None else plane)

    def end(self, frame_id=1, stream_id=1, **fields):
        self.send(wire.FrameEnd(frame_id=frame_id, **fields), stream_id)

    def stay(self):
        """Until the client leaves; its requests are answered."""
        with contextlib.suppress(EOFError, OSError):
            while True:
                self.answer(self.read())


class FakeServer:
    """Calls script(peer) for each connection, one after the other, and closes it then."""

    def __init__(self, script):
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self.failure = None
        self._script = script
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self):
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            connection.settimeout(20)
            with connection:
                try:
                    self._script(Peer(connection))
                except (EOFError, OSError):
                    pass
                except Exception as error:
                    self.failure = error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._listener.close()
        if self.failure:
            raise self.failure


def fake(script):
    return FakeServer(script)
