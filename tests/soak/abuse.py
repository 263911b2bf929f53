"""Clients that do not behave. Each function is one visit; all keep few connections open, so that the limit of clients
per address leaves room for good clients."""
import os
import random
import signal
import socket
import struct
import subprocess
import time

MAGIC = b"OBLQ"


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=5)


def random_bytes(ports, stop):
    with connect(random.choice(ports)) as peer:
        peer.sendall(os.urandom(random.randint(1, 20000)))
        stop.wait(0.2)


def slow_loris(ports, stop):
    """A byte every half second: a header of HTTP or of the stream that never ends."""
    port = random.choice(ports)
    text = random.choice([b"GET /metrics HTTP/1.1\r\nHost: a\r\nX: " + b"y" * 100, MAGIC + bytes(100)])
    with connect(port) as peer:
        for byte in text:
            peer.sendall(bytes([byte]))
            if stop.wait(0.5):
                return


def silent(ports, stop):
    with connect(random.choice(ports)):
        stop.wait(random.uniform(1, 15))


def reset(ports, _stop):
    """Gone with a reset in the middle of what looks like a message."""
    peer = connect(random.choice(ports))
    peer.sendall(MAGIC + os.urandom(random.randint(1, 60)))
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    peer.close()


def huge_message(ports, stop):
    """Lengths as large as they can be."""
    with connect(ports[0]) as peer:
        peer.sendall(MAGIC + b"\xff" * 60)
        stop.wait(0.5)


def vanish(watch, stop):
    """A watcher that is killed while frames are under way."""
    with subprocess.Popen(watch, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          start_new_session=True) as process:
        stop.wait(random.uniform(0.2, 3))
        process.kill()


def stall(watch, stop):
    """A watcher that stops reading for longer than the server waits, and is then killed."""
    with subprocess.Popen(watch, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          start_new_session=True) as process:
        stop.wait(1)
        process.send_signal(signal.SIGSTOP)
        stop.wait(random.uniform(2, 12))
        process.kill()


def abuse(ports, watch, stop, counts):
    """One visit after the other until stopped. counts: how many of each."""
    visits = [random_bytes, slow_loris, silent, reset, huge_message]
    while not stop.is_set():
        if random.random() < 0.2:
            visit, arguments = random.choice([vanish, stall]), (watch, stop)
        else:
            visit, arguments = random.choice(visits), (ports, stop)
        try:
            visit(*arguments)
        except OSError:
            pass  # shown the door, as it should be
        counts[visit.__name__] = counts.get(visit.__name__, 0) + 1
        time.sleep(0.05)
