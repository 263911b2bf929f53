"""`obliq replay --serve`: clients that steer it, and others that do not read."""
import contextlib
import math
import time

import wire
from place import attack

BATCH = 50


def pour(place, served, steer, made):
    """Batches of what `made` packs, answered, until time is over or the server."""
    count, until = 0, place.until(2)
    while time.monotonic() < until and served.lives():
        steer.socket.sendall(b"".join(made(steer, count + k) for k in range(BATCH)))
        for _ in range(BATCH):
            steer.answer()
        count += BATCH
    return count


@contextlib.contextmanager
def paused_beside_sleepers(place):
    """A replay in a pause, the hand that paused it and goes on at the end, and two clients that read nothing."""
    served = place.replay(place.recording(), "--loop")
    for _ in range(2):
        place.peer(served, buffer=2048).send(wire.SUBSCRIBE, radar="main", rate_hz=100, planes=["POWER"])
    steer = place.peer(served, timeout=30)
    steer.demand(wire.SET_REPLAY, paused=True)
    yield served, steer
    steer.demand(wire.SET_REPLAY, paused=False, speed=0.2, seek_s=0)


@attack("H5")
def seeks_beside_sleepers(place):
    """Two clients that read nothing, one that seeks."""
    with paused_beside_sleepers(place) as (served, steer):
        count = pour(place, served, steer, lambda peer, k: peer.packed(wire.SET_REPLAY, seek_s=k % 10 / 20))
    return f"{count} seeks"


@attack("H5")
def joins_beside_sleepers(place):
    """Two clients that read nothing, one that subscribes and leaves again in a pause."""
    with paused_beside_sleepers(place) as (served, steer):
        count = pour(place, served, steer, lambda peer, k: peer.packed(wire.UNSUBSCRIBE, radar="main") if k % 2 else
                     peer.packed(wire.SUBSCRIBE, radar="main", rate_hz=100, planes=["STATE"]))
    return f"{count} requests"


@attack("H5")
def dragged_bar(place):
    """One ordinary watcher that has stopped reading, and a hand that drags the bar, by two hands' speed."""
    served = place.replay(place.recording(), "--loop")
    place.peer(served).send(wire.SUBSCRIBE, radar="main", rate_hz=30, planes=["POWER"])
    steer, count, until = place.peer(served, timeout=30), 0, place.until(4)
    while time.monotonic() < until and served.lives():
        steer.demand(wire.SET_REPLAY, seek_s=count % 10 / 20)
        count += 1
        time.sleep(1 / 120)
    return f"{count} seeks"


@attack()
def odd_steering(place):
    """Speeds and places that are none, requests that change a radar, and eight clients that steer at once."""
    served = place.replay(place.recording(), "--loop", steady=False)
    peer, draw = place.peer(served), place.random
    for fields in ({"speed": math.nan}, {"speed": 0}, {"speed": -1}, {"speed": -math.inf}, {"speed": 1e300}, {"seek_s": math.nan},
                   {"seek_s": -1},
                   {"seek_s": 1e18}, {"seek_sim_time_ns": -(1 << 63)}):
        got = peer.outcome(wire.SET_REPLAY, **fields)
        place.expect(got in (0, wire.INVALID) and not (got == 0 and math.isnan(next(iter(fields.values())))),
                     f"{fields}: error {got}")
    for kind in (wire.RENDER_ONCE, wire.QUERY, wire.SET_POSE, wire.SET_SETTINGS, wire.CLAIM, wire.SET_STATE):
        place.expect((got := peer.outcome(kind)) == wire.REPLAYED, f"{wire.NAMES[kind]}: error {got}; wanted: {wire.REPLAYED}")
    count = [0]

    def steer(k):
        with contextlib.closing(wire.Peer(served.port, source=f"127.0.4.{k + 1}", timeout=30)) as other:
            until = place.until()
            while time.monotonic() < until:
                other.outcome(wire.SET_REPLAY,
                              **draw.choice([{"seek_s": draw.uniform(0, 1)}, {"speed": draw.choice([0.01, 1, 1e6, math.inf])},
                                                             {"paused": draw.random() < 0.5}]))
                count[0] += 1
    place.together([lambda k=k: steer(k) for k in range(8)])
    place.peer(served).demand(wire.SET_REPLAY, paused=False, speed=0.2, seek_s=0)
    return f"{count[0]} changes"
