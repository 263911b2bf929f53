"""Peers that want the server's time and memory for themselves. Each function is one kind of them; it returns when
`until` (of time.monotonic) has come, and says in a sentence what it did."""
import os
import random
import socket
import ssl
import threading
import time

import wire


def polar_request(pb, port, tokens, until):
    """The most pixels that a frame may have, all of them in one wedge, asked for by a viewer."""
    peer = wire.Peer(pb, port, tokens["viewer"])
    request = pb.RenderOnce(
        radar="x", pose=pb.Pose(latitude_deg=33, longitude_deg=-99.5, height_m=2500),
        settings=pb.RadarSettings(frustum="POLAR", azimuth_bins=1, range_bins=1, pixel_columns=16384,
                                  pixel_rows=16384, sector_deg=60, r_min_m=4000, r_max_m=20000))
    try:
        peer.demand(wire.RENDER_ONCE, request)
    except wire.Refused as error:
        time.sleep(max(0, until - time.monotonic()))
        return f"refused: {error}"
    time.sleep(max(0, until - time.monotonic()))
    return "accepted; left in the middle of it"


def jumps(pb, port, tokens, until):
    """The other radar's antenna jumps by 6 km, twice; then nothing is heard of it."""
    peer = wire.Peer(pb, port, tokens["controller"])
    peer.demand(wire.CLAIM, pb.ClaimControl(radar="nose"))
    for k in range(3):
        pose = pb.Pose(latitude_deg=33 + 0.054 * k, longitude_deg=-99.5, height_m=2500)
        peer.demand(wire.SET_POSE, pb.SetPose(radar="nose", pose=pose))
        time.sleep(1)
    time.sleep(max(0, until - time.monotonic()))
    return "jumped twice"


def held_places(_pb, port, _tokens, until):
    """Three bytes each, from two addresses, opened anew when they are closed."""
    held, opened = [], 0
    while time.monotonic() < until:
        for address in ("127.0.0.2", "127.0.0.3"):
            for _ in range(34):
                peer = socket.socket()
                peer.settimeout(1)
                peer.bind((address, 0))
                try:
                    peer.connect(("127.0.0.1", port))
                    peer.sendall(b"\x16\x03\x01")
                    held.append(peer)
                    opened += 1
                except OSError:
                    peer.close()
        time.sleep(0.2)
        for peer in held[:-200]:
            peer.close()
        held = held[-200:]
    for peer in held:
        peer.close()
    return f"{opened} connections held"


def handshakes(_pb, port, _tokens, until):
    """Eight sockets that shake hands and leave, again and again."""
    counts = [0] * 8

    def shake(k):
        while time.monotonic() < until:
            try:
                wire.tls_socket(port, f"127.0.0.{k + 10}").close()
                counts[k] += 1
            except (OSError, ssl.SSLError):
                pass  # shown the door

    threads = [threading.Thread(target=shake, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return f"{sum(counts)} handshakes"


def odd_frames(pb, port, tokens, until):
    """Messages that are damaged, cut, of unknown types, with lengths that lie, or of random bytes inside."""
    random.seed(1)
    whole = wire.framed(wire.GET_STATUS, pb.GetStatus(request_id=1).SerializeToString())

    def odd():
        kind = random.randrange(6)
        if kind == 0:
            return os.urandom(random.randint(1, 5000))
        if kind == 1:
            return whole[: random.randint(1, len(whole) - 1)]
        if kind == 2:
            damaged = bytearray(whole)
            damaged[random.randrange(len(damaged))] ^= 1 << random.randrange(8)
            return bytes(damaged)
        if kind == 3:
            return wire.framed(random.randrange(1, 65536), os.urandom(random.randrange(200)))
        if kind == 4:
            return whole[:12] + b"\xff" * 8 + whole[20:]
        return wire.framed(random.choice([wire.SET_POSE, wire.SUBSCRIBE, wire.RENDER_ONCE]), os.urandom(60))

    visits = 0
    while time.monotonic() < until:
        try:
            peer = wire.Peer(pb, port, tokens["viewer"], timeout=2)
            for _ in range(random.randint(1, 20)):
                peer.socket.sendall(odd())
            peer.socket.close()
            with wire.tls_socket(port, timeout=2) as stranger:  # before Hello
                stranger.sendall(odd())
        except (OSError, EOFError, wire.Refused):
            pass  # shown the door, as it should be
        visits += 1
    return f"{visits} visits"
