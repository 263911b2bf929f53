"""Recordings that are cut, damaged, or lie with a right checksum, through `obliq replay` to files, to a track and to a server."""
import struct
import time

import programs
import wire
from place import attack

SPARE_MB, SPARE_S = 400, 20


def messages(data):
    """Where each begins, its type, the bytes of its descriptor and of all behind the header."""
    at, found = 0, []
    while at + 48 <= len(data):
        size, descriptor = struct.unpack("<II", data[at + 12:at + 20])
        found.append((at, struct.unpack("<H", data[at + 6:at + 8])[0], descriptor, size))
        at += 48 + size
    return found


def seal(data, at, size):
    """The checksum that belongs to what the message says now."""
    head = data[at:at + 40] + bytes(4) + data[at + 44:at + 48]
    struct.pack_into("<I", data, at + 40, wire.crc32c(bytes(head + data[at + 48:at + 48 + size])))


def damaged(draw, whole, found):
    data, kind = bytearray(whole), draw.randrange(5)
    if kind == 0:
        del data[draw.randrange(len(data)):]
    elif kind == 1:
        for _ in range(draw.randint(1, 30)):
            data[draw.randrange(len(data))] = draw.randrange(256)
    elif kind == 2:
        at = draw.randrange(len(data))
        del data[at:at + draw.randint(1, 100_000)]
    else:
        for _ in range(draw.randint(1, 5)):
            at, _, descriptor, size = draw.choice([one for one in found if one[1] != wire.WEDGE_BLOCK]
                                                  if draw.random() < 0.6 else found)
            if kind == 4 and draw.random() < 0.4:
                data[at + draw.choice([6, 20, 24, 32, 39])] = draw.randrange(256)
            for _ in range(draw.randint(1, 3) if descriptor else 0):
                data[at + 48 + draw.randrange(descriptor)] = draw.randrange(256)
            seal(data, at, size)
    return bytes(data)


@attack()
def damaged_files(place):
    """Each is replayed to the screen, to files, or to a track: exit codes 0, 1, 2 and no other."""
    with open(place.recording(4), "rb") as file:
        whole = file.read()
    found, codes, draw, until = messages(whole), {}, place.random, place.until(2)
    while time.monotonic() < until:
        place.write("damaged.obliq", damaged(draw, whole, found))
        words = draw.choice([("--out", place.path("out")), ("--track", place.path("track.csv")), ()])
        program = place.command("replay", place.path("damaged.obliq"), "--speed", "max", *words)
        code = program.finish(60, processor=SPARE_S * place.slack)
        codes[code] = codes.get(code, 0) + 1
        place.expect(code in (0, 1, 2), f"a damaged recording: {code}: {program.log()[-200:]}")
        place.expect(program.most_mb <= SPARE_MB * place.slack, f"a damaged recording took {program.most_mb:.0f} MB")
    return f"{sum(codes.values())} recordings, exit codes {dict(sorted(codes.items(), key=str))}"


@attack()
def served_damage(place):
    """A damaged recording is served, in a loop, to one who watches."""
    with open(place.recording(10), "rb") as file:
        whole = file.read()
    found = messages(whole)
    frames = [at for at, kind, *_ in found if kind == wire.FRAME_BEGIN]
    data = bytearray(whole)
    for at in frames[2::3]:
        for k in range(at + 200, at + 2000, 7):
            data[k] ^= 0x55
    served = place.replay(place.write("damaged.obliq", bytes(data)), "--loop", ends=(0, 2))
    time.sleep(place.seconds)
    return f"{len(frames)} frames, {len(frames[2::3])} of them damaged; {programs.memory_mb(served.pid):.0f} MB"
