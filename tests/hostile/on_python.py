"""The Python package against servers and recordings that lie, lines of poses that are none, and its own sudden end."""
import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import programs
import wire
from place import Skipped, attack

SOURCE = os.path.join(wire.ROOT, "client/python/src")
MOST_MB = 400  # numpy and the package take 60
MOST_S = 30
ENDS_S = 20  # 3 are usual
FAMILY = ("BadStream", "ConnectionLost", "CannotConnect", "TimedOut", "Refused", "Unauthorized", "Untrusted", "FrameAborted",
          "ObliqError", "ImportError", "a frame",
          "connected")
ASK = """
import sys, obliq
for _ in range(int(sys.argv[2])):
    try:
        with obliq.connect(sys.argv[1], timeout=3) as server:
            pose = obliq.Pose(latitude_deg=1, longitude_deg=1, height_m=1)
            frame = server.render(obliq.Settings(azimuth_bins=64), pose, planes="state", timeout=3)
            print("a frame", frame.state.shape, flush=True)
    except (obliq.ObliqError, ImportError) as error:  # of zstandard, which not everybody has
        print(type(error).__name__, error, flush=True)
"""
READ = """
import sys, obliq
try:
    for frame in obliq.open(sys.argv[1]):
        print("a frame", frame.state.shape)
except obliq.ObliqError as error:
    print(type(error).__name__, error)
"""
OWN_DAEMON = """
import sys, time, obliq
with obliq.local(sys.argv[1], obliqd=sys.argv[2]) as server:
    print("served by", server.radar("main").frame().shape, flush=True)
    time.sleep(120)
"""


def python(place, *words, environment=None, gigabytes=12):
    if subprocess.run([sys.executable, "-c", "import obliq"], env={**os.environ, "PYTHONPATH": SOURCE},
                      capture_output=True).returncode != 0:
        raise Skipped("no numpy or CRC-32C for Python here; deploy/install-deps.sh test installs them")
    program = programs.Program([sys.executable, "-B", *words], place.path(f"log.{len(place.programs)}"),
                              {"PYTHONPATH": SOURCE, **(environment or {})}, gigabytes)
    place.programs.append(program)
    return program


def welcome():
    return wire.encoded(wire.WELCOME, request_id=1, major=1, minor=1, radars=["main"], role="admin",
                        limits=wire.pb.Limits(max_request_bytes=1 << 20, max_plane_bytes=1 << 20))


def begin(azimuths=64, ranges=64, request=0, **frame):
    settings = wire.pb.RadarSettings(azimuth_bins=azimuths, range_bins=ranges, sector_deg=60, r_min_m=1, r_max_m=2)
    descriptor = wire.pb.FrameDescriptor(radar="main", frame_id=1, settings=settings,
                                         pose=wire.pb.Pose(latitude_deg=1, longitude_deg=1, height_m=1), **frame)
    return wire.encoded(wire.FRAME_BEGIN, stream=9, frame_id=1, request_id=request, wedges=1, frame=descriptor)


def block(azimuths, ranges, data=b"", plane=3, **more):
    return wire.encoded(wire.WEDGE_BLOCK, data, 9, frame_id=1, plane=plane, n_azimuth=azimuths, n_range=ranges, **more)


def end(*spans):
    return wire.encoded(wire.FRAME_END, stream=9, frame_id=1,
                        missed=[wire.pb.AzimuthSpan(first_azimuth=a, n_azimuth=n) for a, n in spans])


class Liar:
    """Says one script a connection: what answers Hello, and what answers RenderOnce (None: it is not awaited)."""

    def __init__(self, scripts):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.listener.getsockname()[1]}"
        threading.Thread(target=self.serve, args=(scripts,), daemon=True).start()

    def serve(self, scripts):
        for first, then in scripts:
            try:
                peer, _ = self.listener.accept()
                with peer:
                    peer.settimeout(10)
                    peer.recv(1 << 16)
                    peer.sendall(first)
                    if then is not None:
                        peer.recv(1 << 16)
                        peer.sendall(then)
                    peer.shutdown(socket.SHUT_WR)
                    while peer.recv(1 << 16):
                        pass
            except OSError:
                pass  # it has left, as it should

    def close(self):
        self.listener.close()


def told(place, program, cases=0):
    """Each case ended in an exception of the package, or in a frame; no more memory, time or letters than it may take.
    cases 0: it may say anything of them, or nothing."""
    code = program.finish(MOST_S + 5 * cases, processor=MOST_S)
    said = program.log().splitlines()
    place.expect(code == 0, f"Python: {programs.ending(code) if isinstance(code, int) else code}: {program.log()[-300:]}")
    place.expect(program.most_mb <= MOST_MB, f"Python took {program.most_mb:.0f} MB; allowed: {MOST_MB}")
    place.expect(len(said) == (cases or len(said)) and all(line.startswith(FAMILY) for line in said),
                 f"Python said {said[-2:]}; {len(said)} lines for {cases} cases")
    return f"{program.most_mb:.0f} MB, {program.used_s:.1f} s of processor time"


@attack("M2")
def missed_azimuths(place):
    """A frame of 4 GB whose end says that all its azimuths were missed, from a server."""
    acked = wire.encoded(wire.ACK, request_id=2)
    liar = place.kept(Liar([(welcome(), acked + begin(16384, 1 << 18, 2) + end((0, 16384)))]))
    program = python(place, "-c", ASK, liar.address, "1")
    words = told(place, program, 1)
    place.expect(program.log().startswith(("BadStream", "FrameAborted")),
                 f"a frame of 4 GB in 330 bytes: {program.log()[:100]!r}; wanted: BadStream or FrameAborted")
    return words


@attack("M2")
def missed_azimuths_recorded(place):
    """The same in a recording that has one azimuth of it."""
    path = place.write("lying.obliq", welcome() + begin(16384, 1 << 18) + block(1, 1 << 18, bytes(1 << 18)) + end((1, 16383)))
    program = python(place, "-W", "ignore::UserWarning", "-c", READ, path)
    words = told(place, program)
    place.expect("a frame" not in program.log(), f"a frame of 4 GB in {os.path.getsize(path)} bytes: {program.log()[:100]!r}")
    return words


@attack("L4")
def control_characters(place):
    """An Error whose text would colour the terminal."""
    liar = place.kept(Liar([(wire.encoded(wire.ERROR, request_id=1, number=11, text="\x1b[31mred\x07\r\n", fields=[
        wire.pb.FieldFault(field="\x1b]0;title\x07", found="\x9b1m", allowed="\0")]), None)]))
    program = python(place, "-c", ASK, liar.address, "1")
    program.finish(MOST_S)
    shown = program.log()
    place.expect(shown.strip() and all(c.isprintable() or c == "\n" for c in shown),
                 f"control characters are printed: {shown[:120]!r}")


@attack("L4")
def odd_data_sets(place):
    """Lines of poses that are no JSON, too deep, of NaN, beside a folder of other things: no traceback."""
    served = place.daemon()
    good = '"latitude_deg":33,"longitude_deg":-99.5,"height_m":2500}'
    os.makedirs(place.path("junk/.part-junk"))
    os.makedirs(place.path("links/part-00000"))
    cases = {"100,000 brackets": ("[" * 100_000, "a"),
             "NaN": ('{"id":1,"latitude_deg":NaN,"longitude_deg":Infinity,"height_m":1e400}', "b"),
             "an unknown key": ('{"id":1,"x":1,' + good, "c"),
             "ids alike": ('{"id":1,' + good + '\n{"id":"1",' + good, "d"), "bytes of NUL": ("\0" * 1000, "e"),
             "a path as id": ('{"id":"../../escaped",' + good, "f"),
             "a folder .part-junk": ('{"id":1,' + good, "junk"), "a part in the way": ('{"id":1,' + good, "links")}
    for what, (text, folder) in cases.items():
        poses = place.write("poses.jsonl", text + "\n")
        program = python(place, "-m", "obliq.batch", poses, "--out", place.path(folder), "--server", f"127.0.0.1:{served.port}",
                         "--set", "bins.azimuth=8", "--set", "bins.range=8")
        code = program.finish(60)
        place.expect(code in (0, 1, 2) and "Traceback" not in program.log(), f"{what}: exit code {code}: {program.log()[-120:]}")
    place.expect(not os.path.exists(place.path("escaped")) and not os.path.exists(os.path.dirname(place.folder) + "/escaped"),
                 "an id became a path")
    return f"{len(cases)} data sets"


@attack("L5")
def sudden_end(place):
    """Python with a daemon of its own is killed, and asked to end: the daemon goes, and its log."""
    for sent in (signal.SIGKILL, signal.SIGTERM):
        folder = place.path(f"tmp.{sent.name}")
        os.mkdir(folder)
        program = python(place, "-c", OWN_DAEMON, os.path.join(os.path.dirname(__file__), "scene.toml"),
                         os.path.join(place.bin, "obliqd"), environment={"TMPDIR": folder}, gigabytes=0)
        program.await_words("served by")
        program.killed = True
        program.process.send_signal(sent)
        program.process.wait(30)
        until = time.monotonic() + ENDS_S
        while ((left := os.listdir(folder)) or running_with(folder)) and time.monotonic() < until:
            time.sleep(0.1)
        place.expect(not left, f"after {sent.name} there is left: {left}")
        for pid in (running := running_with(folder)):
            os.kill(pid, signal.SIGKILL)
        place.expect(not running, f"after {sent.name} the daemon runs on")


def running_with(folder):
    """The processes whose folder for temporary files this is."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError), open(f"/proc/{pid}/environ", "rb") as file:
            if f"TMPDIR={folder}\0".encode() in file.read():
                found.append(int(pid))
    return found


@attack()
def lying_servers(place):
    """Other programs, other versions, endless headers, frames and blocks that do not fit: an exception in words each."""
    hello = welcome()
    acked = wire.encoded(wire.ACK, request_id=2)
    most = (1 << 32) - 1
    before = [b"HTTP/1.1 200 OK\r\n\r\n", b"", b"OBLQ\1\1\2\0\0\0\xff\xff" + bytes(60),
              b"OBLQ\1\1\2\0\0\0\x30\0" + b"\xff" * 8 + bytes(60), b"OBLQ\x09\1" + bytes(42),
              hello[:-1] + b"x", wire.encoded(wire.WELCOME, request_id=1, major=2),
              wire.encoded(wire.WELCOME, request_id=1, major=1, radars=["a"] * 60_000),
              wire.encoded(wire.ACK, request_id=1), b"OBLQ\1\1\2\0\0\0\x30\0\0\0\x10\0\0\0\0\0" + bytes(1 << 20)]
    frames = [begin(16384, 1 << 24, 2), begin(32768, 10, 2), begin(-5, 10, 2), begin(0, 0, 2),
              begin(16384, 1 << 19, 2) + block(1, 1, b"\1") + end(),
              begin(request=2) + end(*[(most, most)] * 1000),
              begin(request=2) + block(64, 64, b"\x28\xb5\x2f\xfd" + bytes(100), compression=1, plain_bytes=4096),
              begin(request=2) + block(64, 64, b"", compression=1, plain_bytes=most), begin(request=2) + block(most, 1),
              begin(request=2) + block(64, 0),
              begin(request=2) + block(0, most), begin(request=2) + block(1, 64, bytes(64)) * 2,
              begin(request=2) + block(1, 1, b"\0", plane=77),
              begin(request=2, window=wire.pb.BinWindow(first_azimuth=most, n_azimuth=most, azimuth_step=most)),
              begin(request=2) * 2, end(),
              wire.encoded(wire.ERROR, request_id=2, number=99999, text="<b>" * 1000,
                           fields=[wire.pb.FieldFault(field="a" * 1000)] * 100)]
    scripts = [(first, None) for first in before] + [(hello, acked + frame) for frame in frames]
    liar = place.kept(Liar(scripts))
    words = told(place, python(place, "-c", ASK, liar.address, str(len(scripts))), len(scripts))
    return f"{len(scripts)} lies, {words}"
