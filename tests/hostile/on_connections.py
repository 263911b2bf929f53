"""Connections that hold places: silent ones, TLS handshakes again and again, thousands that come and go."""
import contextlib
import ssl
import threading
import time

import crowd
import web
import wire
from place import attack

CROWD, LOGINS = 16, 4
WAITING = 200  # held at a time: more than server.max_waiting, fewer than the descriptors of this program


def logins(place, served, until):
    """Good tokens get in meanwhile, over TCP and by WebSocket."""
    for k in range(LOGINS):
        used = served.processor_s()
        try:
            with contextlib.closing(wire.Peer(served.port, place.tokens["viewer"], tls=served.tls, timeout=30,
                                              source="127.0.11.1")):
                pass
            if not served.tls:
                with contextlib.closing(web.Socket(served.web_port, place.tokens["viewer"], timeout=30, source="127.0.11.2")):
                    pass
            used = served.processor_s() - used
            place.expect(used <= 4 * place.slack, f"login {k + 1} took {used:.1f} s of processor time")
        except (OSError, EOFError, wire.Refused) as error:
            place.expect(False, f"a good token does not get in: {error}")
        time.sleep(max(0, (until - time.monotonic()) / (LOGINS - k)))


@attack()
def held_places(place):
    """Three bytes, half a request, a WebSocket without Hello, from six addresses, opened anew when they are closed."""
    served, until, opened = place.daemon(tokens=True), place.until(), [0]

    def hold():
        held = []
        while time.monotonic() < until:
            for k in range(18):
                address = f"127.0.10.{k % 6 + 2}"
                try:
                    if k % 3 == 0:
                        held.append(web.Socket(served.web_port, hello=False, source=address, timeout=1).socket)
                    else:
                        peer = wire.plain_socket(served.web_port if k % 3 == 1 else served.port, address, timeout=1)
                        held.append(peer)
                        peer.sendall(b"GET /stre" if k % 3 == 1 else b"OBL")
                    opened[0] += 1
                except (OSError, EOFError):
                    pass  # shown the door
            while len(held) > WAITING:
                held.pop(0).close()
            time.sleep(0.05)
        for peer in held:
            peer.close()
    place.together([hold, lambda: logins(place, served, until)])
    return f"{opened[0]} connections held"


@attack()
def held_places_tls(place):
    """Three bytes of a handshake each, where the server speaks TLS."""
    served, until, opened = place.daemon(tokens=True, tls=True), place.until(), [0]

    def hold():
        held = []
        while time.monotonic() < until:
            for k in range(68):
                try:
                    peer = wire.plain_socket(served.port, f"127.0.0.{k % 2 + 2}", timeout=1)
                    held.append(peer)
                    peer.sendall(b"\x16\x03\x01")
                    opened[0] += 1
                except OSError:
                    pass
            time.sleep(0.2)
            while len(held) > WAITING:
                held.pop(0).close()
        for peer in held:
            peer.close()
    place.together([hold, lambda: logins(place, served, until)])
    return f"{opened[0]} connections held"


@attack()
def handshakes(place):
    """Eight sockets that shake hands by RSA-4096 and leave, again and again."""
    served, until, count = place.daemon(tokens=True, tls=True), place.until(), [0]
    place.expect("RSA" in served.log(), "no warning that an RSA-4096 key invites floods of handshakes")

    def shake(k):
        while time.monotonic() < until:
            try:
                wire.tls_socket(served.port, f"127.0.0.{k + 10}").close()
                count[0] += 1
            except (OSError, ssl.SSLError):
                pass  # shown the door
    place.together([lambda k=k: shake(k) for k in range(8)] + [lambda: logins(place, served, until)])
    return f"{count[0]} handshakes"


@attack()
def many_kinds(place):
    """The soak's crowd in a hurry: headers that never end, resets in the middle of a message, lengths as large as they can be."""
    served, counts, stop = place.daemon("server.handshake_timeout_s=1", "http.timeout_s=1"), {}, threading.Event()

    def come(k):
        crowd.visits([served.port, served.web_port], None, stop, counts, pace=0.02, sources=[f"127.0.12.{k + 1}"])

    timer = threading.Timer(place.seconds, stop.set)
    timer.start()
    place.together([lambda k=k: come(k) for k in range(CROWD)])
    return f"{sum(counts.values())} visits of {len(counts)} kinds"


@attack()
def come_and_go(place):
    """WebSockets by the thousand: half without a Hello, some subscribe, some are reset."""
    served, until, count, turned_away = place.daemon(), place.until(), 0, 0
    while time.monotonic() < until:
        try:
            peer = web.Socket(served.web_port, hello=count % 2 == 0, timeout=5, source=f"127.0.6.{count % 200 + 1}")
            if count % 3 == 0:
                peer.socket.sendall(web.frame(web.BINARY, web.message(wire.SUBSCRIBE, {"radar": "main", "rate_hz": 30})))
            wire.reset(peer.socket) if count % 5 == 0 else peer.close()
        except (OSError, EOFError):
            turned_away += 1
        count += 1
    place.expect(turned_away <= count / 10, f"{turned_away} of {count} WebSockets were turned away")
    return f"{count} WebSockets"
