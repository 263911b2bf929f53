"""`obliq fly --udp` and `--dis` under datagrams that are none, `obliq cat240` with arguments at their ends."""
import math
import signal
import socket
import struct
import time

import wire
from place import attack

POSE_BYTES, ENTITY_BYTES = 56, 144
ODD = (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -0.0, 90, -90, 180, -180, 90.0000001, 1e5, -1000, 0)
EARTH_M = 6378137.0
LINES_A_SECOND, LINES_ANYWAY = 1, 12


def pose(latitude=33.0, longitude=-99.5, height=2500.0, heading=0.0, sim_time_ns=0, number=1, magic=b"OBLP"):
    """server/apps/dis/README.md"""
    return struct.pack("<4sHHqddddQ", magic, 1, 0, sim_time_ns, latitude, longitude, height, heading, number)


def motion(north=0.0, east=0.0, up=0.0, roll=0.0, pitch=0.0):
    data = bytearray(pose(sim_time_ns=time.time_ns()) + struct.pack("<5d", north, east, up, roll, pitch))
    struct.pack_into("<HH", data, 4, 2, 3)
    return bytes(data)


def entity(place_m=(EARTH_M, 0.0, 1000.0), velocity=(0, 0, 0), acceleration=(0, 0, 0), heading=0.0, reckoning=2, number=3, kind=1, roll=0.0,
           size=ENTITY_BYTES,
           length=None):
    """An Entity State PDU (IEEE 1278.1-2012, 7.2.2)."""
    data = bytearray(max(size, ENTITY_BYTES))
    struct.pack_into(">BBBBIHH", data, 0, 7, 1, kind, 1, 0, size if length is None else length, 0)
    struct.pack_into(">HHH", data, 12, 1, 2, number)
    struct.pack_into(">fff", data, 36, *velocity)
    struct.pack_into(">dddfff", data, 48, *place_m, heading, 0.0, roll)
    data[88] = reckoning
    struct.pack_into(">fff", data, 104, *acceleration)
    return bytes(data[:size])


class Flight:
    """`obliq fly` that listens, and a socket towards it."""

    def __init__(self, place, served, *words):
        self.place, self.sent = place, 0
        self.program = place.command("fly", "--server", f"127.0.0.1:{served.port}", "--radar", "nose", *words, "--udp", "0")
        self.port = int(self.program.await_words(r"listening on \S+:(\d+)").group(1))
        self.socket = place.kept(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))

    def send(self, data):
        self.socket.sendto(data, ("127.0.0.1", self.port))
        self.sent += 1
        if self.sent % 20 == 0:
            time.sleep(0.001)  # what it has no time to take, it does not see

    def end(self):
        self.program.look()
        self.place.expect(self.program.lives(), "fly has ended")
        code = self.program.stop(signal.SIGINT)
        self.place.expect(code in (0, 130), f"fly ended with {code}")
        self.place.expect(self.program.most_mb <= 150 * self.place.slack, f"fly took {self.program.most_mb:.0f} MB")
        lines = len(self.program.log().splitlines())
        allowed = LINES_ANYWAY + LINES_A_SECOND * (time.monotonic() - self.program.begun)
        self.place.expect(lines <= allowed, f"fly printed {lines} lines; allowed: {allowed:.0f}")
        return f"{self.sent} datagrams, {lines} lines"


@attack("L6")
def bad_poses(place):
    """Datagrams of poses with values that are none, other sizes, random bytes: one line a second at most."""
    flight, draw = Flight(place, place.daemon()), place.random
    for value in ODD:
        for field in ("latitude", "longitude", "height", "heading"):
            flight.send(pose(**{field: value}, sim_time_ns=time.time_ns()))
        for field in ("north", "east", "up", "roll", "pitch"):
            flight.send(motion(**{field: value}))
    for sim_time_ns in (0, -1, (1 << 63) - 1, -(1 << 63), 4 * 10**18, 4 * 10**18 + 1):
        flight.send(pose(sim_time_ns=sim_time_ns))
    for size in (0, 1, 3, 55, 57, 95, 96, 97, 2048, 65507):
        flight.send((pose() * 1200)[:size])
    for k in range(1500):  # another reason each time
        flight.send((pose(magic=b"NONE"), pose()[:10], pose(latitude=math.nan))[k % 3])
    until = place.until(0.5)
    while time.monotonic() < until:
        data = bytearray(draw.choice((pose(sim_time_ns=time.time_ns()), motion())))
        data[draw.randrange(len(data))] = draw.randrange(256)
        flight.send(bytes(data) if flight.sent % 2 else draw.randbytes(POSE_BYTES))
    return flight.end()


@attack()
def pose_flood(place):
    """Good poses, as many as go, that jump between places and over the poles; the daemon comes to rest afterwards."""
    served = place.daemon()
    flight, draw, until = Flight(place, served), place.random, place.until(0.7)
    while time.monotonic() < until:
        flight.send(pose(latitude=33 + draw.choice([0, 0.05, -0.05]), sim_time_ns=time.time_ns(), number=flight.sent))
    for latitude, longitude in ((90, 0), (-90, 0), (0, 180), (0, -180), (33, -99.5)):
        flight.send(pose(latitude, longitude))
        time.sleep(0.3)
    words = flight.end()
    end, loading, loaded = time.monotonic() + 60, True, -1
    while loading and time.monotonic() < end:
        time.sleep(1)
        status = wire.pb.Status.FromString(place.peer(served).demand(wire.GET_STATUS))
        loading, loaded = status.window_loading or status.windows_loaded != loaded, status.windows_loaded
    place.expect(not loading, "windows of terrain are loaded without end")
    return f"{words}, {loaded} windows"


@attack("L6")
def bad_entities(place):
    """PDUs of DIS with values that are none, lengths that lie, random bytes, and an entity of 15 km/s."""
    flight, draw = Flight(place, place.daemon(), "--dis", "1:2:3"), place.random
    nan, inf = math.nan, math.inf
    for fields in ({"place_m": (nan,) * 3}, {"place_m": (0, 0, 0)}, {"place_m": (1e300,) * 3}, {"place_m": (0, 0, 6357752.0)},
                   {"place_m": (5e-324, 0, 0)},
                   {"velocity": (nan,) * 3}, {"velocity": (inf, 0, 0)}, {"velocity": (19999, 0, 0)},
                   {"acceleration": (19999, 0, 0), "reckoning": 4},
                   {"heading": nan}, {"heading": 3e38}, {"roll": nan}, {"roll": -3e38}, {"roll": 3.0, "reckoning": 8}, {"size": 10}, {"size": 143}, {"length": 65535}, {"length": 0},
                   {"kind": 2}, {"number": 9},
                   {"reckoning": 255}):
        flight.send(entity(**fields))
    until = place.until(0.5)
    while time.monotonic() < until:
        data = bytearray(entity())
        data[draw.randrange(ENTITY_BYTES)] = draw.randrange(256)
        flight.send(bytes(data))
    flight.send(entity(velocity=(15000, 0, 0), acceleration=(19000, 0, 0), reckoning=4))
    time.sleep(1)
    return flight.end()


@attack()
def bad_targets(place):
    """An exercise of random entities and orders, as many as go; PDUs of any numbers; the daemon has what it may have."""
    served = place.daemon()
    flight, draw, until = Flight(place, served, "--dis", "1:2:3", "--targets"), place.random, place.until(0.7)
    while time.monotonic() < until:
        data = bytearray(entity(velocity=(draw.uniform(-300, 300), 0, 0), reckoning=draw.randrange(10), number=draw.randrange(65536)))
        data[20:28] = bytes((draw.randrange(4), draw.randrange(6))) + draw.randbytes(6)
        data[116:128] = struct.pack(">fff", *(draw.uniform(-9, 9) for _ in range(3)))
        data[129:140] = draw.randbytes(11)
        if flight.sent % 3 == 0:
            data[draw.randrange(ENTITY_BYTES)] = draw.randrange(256)
        if flight.sent % 500 == 499:  # Remove, Start, Stop to all
            kind, size = draw.choice(((12, 28), (13, 44), (14, 40)))
            data = bytearray(struct.pack(">BBBBIHHHHHHHH", 7, 1, kind, 5, 0, size, 0, 9, 9, 9, *(65535,) * 3) + bytes(size - 24))
        flight.send(bytes(data))
    time.sleep(1)
    status = wire.pb.Status.FromString(place.peer(served).demand(wire.GET_STATUS))
    place.expect(0 < status.targets <= status.max_targets, f"{status.targets} targets; allowed: 1 to {status.max_targets}")
    return f"{flight.end()}, {status.targets} targets"


@attack()
def cat240(place):
    """Addresses, rates and sizes at their ends: refused in words, or datagrams."""
    served = place.daemon()
    sink = place.kept(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    sink.bind(("127.0.0.1", 0))
    to = f"127.0.0.1:{sink.getsockname()[1]}"
    running = [(to, "--rate", "100"), (to, "--rate", "100", "--bits", "16", "--max-datagram", "65507")]
    refused = [("[::1]:9",), ("127.0.0.1:0",), ("127.0.0.1:65536",), ("evil",), ("a" * 10_000 + ":9",), (to, "--rate", "1e9"),
               (to, "--rate", "nan"),
               (to, "--max-datagram", "0"), (to, "--ttl", "256"), (to, "--radar", "nope")]
    for words in running + refused:
        program = place.command("cat240", "--server", f"127.0.0.1:{served.port}", "--to", *words)
        code = program.finish(place.seconds / 2 if words in running else 20)
        if words in refused:
            place.expect(code in (1, 2, 105, 106), f"cat240 --to {' '.join(words)[:60]}: {code}; wanted: refused")
            place.expect(program.log().strip() != "" or code == "still at work",
                         f"cat240 --to {' '.join(words)[:60]}: without a word")
        place.expect(program.most_mb <= 150 * place.slack, f"cat240 --to {' '.join(words)[:60]}: {program.most_mb:.0f} MB")
    return f"{len(running) + len(refused)} calls"
