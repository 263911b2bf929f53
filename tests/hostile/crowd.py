"""A crowd of clients that do not behave, for tests/soak.sh and for attacks. Each function is one visit; all keep few connections
open, so that the limit of clients per address leaves room for honest clients. Standard library only."""
import os
import random
import signal
import socket
import struct
import subprocess
import time

MAGIC = b"OBLQ"


def connect(port, source="127.0.0.1"):
    return socket.create_connection(("127.0.0.1", port), timeout=5, source_address=(source, 0))


def random_bytes(peer, wait):
    peer.sendall(os.urandom(random.randint(1, 20000)))
    wait(0.2)


def slow_loris(peer, wait):
    """A byte every half second: a header of HTTP or of the stream that never ends."""
    text = random.choice([b"GET /metrics HTTP/1.1\r\nHost: a\r\nX: " + b"y" * 100, MAGIC + b"\x01\x01\x01" + bytes(97), MAGIC + bytes(100)])
    for byte in text:
        peer.sendall(bytes([byte]))
        if wait(0.5):
            return


def silent(_peer, wait):
    wait(random.uniform(1, 15))


def reset(peer, _wait):
    """Gone with a reset in the middle of what looks like a message."""
    peer.sendall(MAGIC + os.urandom(random.randint(1, 60)))
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def huge_message(peer, wait):
    """Lengths as large as they can be."""
    peer.sendall(MAGIC + b"\xff" * 60)
    wait(0.5)


def vanish(process, wait):
    """A watcher that is killed while frames are under way."""
    wait(random.uniform(0.2, 3))
    process.kill()


def stall(process, wait):
    """A watcher that stops reading for longer than the server waits, and is then killed."""
    wait(1)
    process.send_signal(signal.SIGSTOP)
    wait(random.uniform(2, 12))
    process.kill()


def visits(ports, watch, stop, counts, pace=1.0, sources=("127.0.0.1",)):
    """One visit after the other until `stop` (an Event) is set. ports: the server's. watch: a command that watches it, or None.
    counts: how many of each. pace: of all waits, their usual length. sources: addresses to come from."""
    def wait(seconds):
        return stop.wait(seconds * pace)

    while not stop.is_set():
        watches = watch and random.random() < 0.2
        visit = random.choice([vanish, stall] if watches else [random_bytes, slow_loris, silent, reset, huge_message])
        try:
            if watches:
                with subprocess.Popen(watch, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True) as process:
                    visit(process, wait)
            else:
                with connect(random.choice(ports), random.choice(sources)) as peer:
                    visit(peer, wait)
        except OSError:
            pass  # shown the door, as it should be
        counts[visit.__name__] = counts.get(visit.__name__, 0) + 1
        time.sleep(0.05 * pace)
