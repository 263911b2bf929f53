"""Over TCP: messages that are none, ground queries, settings that change all the time, scans as fast as they go."""
import contextlib
import time

import wire
from place import attack

TURNING = """
[[radar]]
name = "turn"
sector_deg = 360.0
r_min_m = 4000.0
r_max_m = 15000.0
scan.mode = "circular"
scan.rate_deg_s = 180.0
scan.dwell_bins = 16
[radar.beam]
pattern = "gaussian"
width_deg = 3.0
"""
HERE = wire.pb.Pose(latitude_deg=33, longitude_deg=-99.5, height_m=2500)
MOST_PLACES = 10_000
LEAST_PASS_NS = 10_000_000
ROUNDED_NS = 1000  # of two times in nanoseconds that were worked out as seconds


@attack("H5")
def lost_windows(place):
    """Watchers of a part of the bins that read nothing, while settings take their bins away and give them back."""
    served = place.daemon()
    for _ in range(3):
        peer = place.peer(served, name="lazy", buffer=2048)
        peer.send(wire.SUBSCRIBE, radar="nose", rate_hz=100, window=wire.pb.BinWindow(first_azimuth=100))
    pilot, count, until = place.peer(served, "controller"), 0, place.until(2)
    pilot.demand(wire.CLAIM, radar="nose")
    while time.monotonic() < until and served.lives():
        pilot.socket.sendall(b"".join(pilot.packed(wire.SET_SETTINGS, radar="nose",
                                                   settings=wire.pb.RadarSettings(azimuth_bins=8 if k % 2 else 128))
                                      for k in range(50)))
        for _ in range(50):
            pilot.answer()
        count += 50
    return f"{count} settings"


@attack()
def log_followed_by_none(place):
    """Clients that follow the log of the exercise and read nothing, while another changes settings as fast as it can."""
    served = place.daemon()
    for _ in range(3):
        peer = place.peer(served, name="lazy", buffer=2048)
        peer.send(wire.GET_EVENTS, follow=True, with_state=True)
    pilot, count, until = place.peer(served, "controller"), 0, place.until()
    pilot.demand(wire.CLAIM, radar="nose")
    place.expect(pilot.outcome(wire.ADD_BOOKMARK, text="x" * 100_000) == wire.INVALID, "a bookmark of 100 kB is taken")
    while time.monotonic() < until and served.lives():
        pilot.socket.sendall(b"".join(pilot.packed(wire.SET_SETTINGS, radar="nose", settings=wire.pb.RadarSettings(power_w=1 + k % 2))
                                      for k in range(50)))
        for _ in range(50):
            pilot.answer()
        pilot.outcome(wire.ADD_BOOKMARK, text="b" * 1000)
        count += 50
    answer = pilot.demand(wire.GET_EVENTS, after=0)
    place.expect(answer is not None, "the log has no answer")
    return f"{count} settings"


@attack("L8")
def fastest_scans(place):
    """A sector of a hundredth of a degree at the fastest rate: passes of 10 ms at least."""
    served, told = place.daemon(scene=TURNING), []
    pilot = place.peer(served, "controller")
    pilot.demand(wire.CLAIM, radar="turn")
    for settings in ({"sector_deg": 0.01, "scan_mode": "SECTOR_SCAN", "scan_rate_deg_s": 7200, "azimuth_bins": 8, "range_bins": 8,
                      "scan_dwell_bins": 8,
                      "beam_pattern": "OFF_BEAM"}, {"sector_deg": 1e-9}, {"sector_deg": 5e-324}):
        pilot.outcome(wire.SET_SETTINGS, radar="turn", settings=wire.pb.RadarSettings(**settings))
        with contextlib.closing(wire.Peer(served.port)) as peer:
            peer.demand(wire.SUBSCRIBE, radar="turn", rate_hz=100, planes=["STATE"])
            begins, until = [], place.until(0.5)
            while time.monotonic() < until:
                kind, payload = peer.receive()
                if kind == wire.FRAME_BEGIN:
                    begins.append(wire.pb.FrameBegin.FromString(payload).scan.begin_ns)
        least = min((b - a for a, b in zip(begins[1:], begins[2:])), default=LEAST_PASS_NS)
        told.append(f"{len(begins)} passes, {least / 1e6:.3f} ms at least")
        place.expect(least >= LEAST_PASS_NS - ROUNDED_NS, f"{settings}: a pass of {least / 1e6:.3f} ms; allowed: at least 10")
    return "; ".join(told)


@attack()
def odd_messages(place):
    """Messages that are damaged, cut, of unknown types, with lengths that lie, or random inside."""
    served, visits, until = place.daemon(), 0, place.until()
    whole = wire.framed(wire.GET_STATUS, wire.pb.GetStatus(request_id=1).SerializeToString())
    draw = place.random

    def odd():
        kind = draw.randrange(6)
        if kind == 0:
            return draw.randbytes(draw.randint(1, 5000))
        if kind == 1:
            return whole[: draw.randint(1, len(whole) - 1)]
        if kind == 2:
            damaged = bytearray(whole)
            damaged[draw.randrange(len(damaged))] ^= 1 << draw.randrange(8)
            return bytes(damaged)
        if kind == 3:
            return wire.framed(draw.randrange(1, 65536), draw.randbytes(draw.randrange(200)))
        if kind == 4:
            return whole[:12] + b"\xff" * 8 + whole[20:]
        return wire.framed(draw.choice([wire.SET_POSE, wire.SUBSCRIBE, wire.RENDER_ONCE]), draw.randbytes(60))

    while time.monotonic() < until:
        try:
            with contextlib.closing(wire.Peer(served.port, timeout=2)) as peer:
                for _ in range(draw.randint(1, 20)):
                    peer.socket.sendall(odd())
            with wire.plain_socket(served.port, timeout=2) as stranger:  # before Hello
                stranger.sendall(odd())
        except OSError:
            pass  # shown the door, as it should be
        visits += 1
    return f"{visits} visits"


@attack()
def ground_queries(place):
    """Queries of the most places by many at a time and by one that reads nothing; odd ones are refused in words."""
    served, draw = place.daemon(), place.random
    places = {"latitude_deg": [33 + draw.uniform(-0.3, 0.3) for _ in range(MOST_PLACES)],
              "longitude_deg": [-99.5 + draw.uniform(-0.3, 0.3) for _ in range(MOST_PLACES)], "height_m": [50.0], "antenna": HERE}
    rays = {"bearing_deg": [draw.uniform(0, 360) for _ in range(MOST_PLACES)],
            "range_m": [draw.uniform(1, 1e6) for _ in range(MOST_PLACES)], "antenna": HERE}
    one, count = {"latitude_deg": [33.0], "longitude_deg": [-99.5]}, [0]
    for what, fields, wanted in (
            ("10,001 places",
             {**places, "latitude_deg": places["latitude_deg"] + [33.0], "longitude_deg": places["longitude_deg"] + [-99.5]},
             wire.ABOVE_LIMIT),
            ("none", {}, wire.INVALID), ("both ways", {**one, "bearing_deg": [1.0]}, wire.INVALID),
            ("NaN", {"latitude_deg": [float("nan")], "longitude_deg": [0.0]}, wire.INVALID),
            ("an infinite range", {"antenna": HERE, "bearing_deg": [0.0], "range_m": [float("inf")]}, wire.INVALID),
            ("1e308 m", {**one, "height_m": [1e308], "antenna": HERE}, wire.INVALID),
            ("the poles", {"latitude_deg": [90.0, -90.0], "longitude_deg": [0.0, 180.0]}, 0),
            ("from the other side of the Earth",
             {**one, "antenna": wire.pb.Pose(latitude_deg=-33, longitude_deg=80.5, height_m=1000)}, 0),
            ("from under the ground", {**one, "antenna": wire.pb.Pose(latitude_deg=33, longitude_deg=-99.5, height_m=-1000)},
             wire.INVALID)):
        got = place.peer(served).outcome(wire.QUERY, **fields)
        place.expect(got == wanted, f"{what}: error {got}; wanted: {wanted}")

    def ask(k):
        until = place.until()
        with contextlib.closing(wire.Peer(served.port, source=f"127.0.2.{k + 1}", timeout=60)) as peer:
            sent = peer.packed(wire.QUERY, **(places if k % 2 else rays))
            peer.socket.sendall(sent * 4)
            while time.monotonic() < until:
                kind, _ = peer.receive()
                count[0] += kind == wire.GROUND_ANSWER
                peer.socket.sendall(sent)
    place.together([lambda k=k: ask(k) for k in range(12)])
    lazy = place.peer(served, buffer=4096)
    sent, until = lazy.packed(wire.QUERY, **places), place.until(0.5)
    lazy.socket.settimeout(1)
    with contextlib.suppress(TimeoutError):
        while time.monotonic() < until:
            lazy.socket.sendall(sent)
    return f"{count[0]} answers"


@attack()
def switches(place):
    """A turning radar's settings, a thousand a minute and more: scan, speckle, beam, bins, pulse, frustum."""
    served, count, refused, until = place.daemon(scene=TURNING), 0, 0, place.until()
    viewers = [place.web_socket(served) for _ in range(2)]
    for viewer in viewers:
        viewer.demand(wire.SUBSCRIBE, radar="turn", rate_hz=30, planes=["VIDEO"])
    pilot, draw = place.peer(served, "controller", timeout=30), place.random
    pilot.demand(wire.CLAIM, radar="turn")
    choices = {"scan_mode": ["FRAME_SCAN", "SECTOR_SCAN", "CIRCULAR_SCAN"], "azimuth_bins": [360, 720, 8],
               "range_bins": [256, 1, 512],
               "speckle": ["AUTO_SPECKLE", "NONE_SPECKLE", "INDEPENDENT_SPECKLE", "GROUND_SPECKLE", "GEOMETRIC_SPECKLE"],
               "beam_pattern": ["OFF_BEAM", "GAUSSIAN_BEAM", "TAYLOR_BEAM"], "noise": [False, True],
               "frustum": ["SWEEP", "OBLIQUE", "POLAR"],
               "pulse_kind": ["OFF_PULSE", "RECTANGULAR_PULSE", "COMPRESSED_PULSE"], "scan_dwell_bins": [8, 16, 360]}
    while time.monotonic() < until:
        name = draw.choice(list(choices))
        refused += pilot.outcome(wire.SET_SETTINGS, radar="turn",
                                 settings=wire.pb.RadarSettings(**{name: draw.choice(choices[name])})) != 0
        count += 1
        time.sleep(draw.choice([0, 0, 0.02]))
    return f"{count} switches, {refused} refused"


@attack()
def jumps(place):
    """An antenna jumps by 6 km, twice, and to the poles; terrain is not loaded without end."""
    served = place.daemon()
    pilot = place.peer(served, "controller", timeout=60)
    pilot.demand(wire.CLAIM, radar="nose")

    def windows():
        return wire.pb.Status.FromString(place.peer(served).demand(wire.GET_STATUS)).windows_loaded
    for latitude, longitude in ((33.054, -99.5), (33.108, -99.5), (90, 0), (-90, 0), (0, 180), (33, -99.5)):
        pilot.demand(wire.SET_POSE, radar="nose",
                     pose=wire.pb.Pose(latitude_deg=latitude, longitude_deg=longitude, height_m=2500))
        time.sleep(place.seconds / 6)
    end, loaded, quiet = time.monotonic() + 60, windows(), 0
    while quiet < 10 and time.monotonic() < end:
        time.sleep(0.2)
        quiet, loaded = (quiet + 1, loaded) if windows() == loaded else (0, windows())
    place.expect(quiet == 10, "windows of terrain are loaded without end")
    place.expect(loaded <= 12, f"six jumps: {loaded} windows of terrain were loaded")
    return f"{loaded} windows loaded"


@attack()
def many_small_frames(place):
    """RenderOnce as fast as they are answered: memory stays where it was after the first hundred."""
    served, count, until, first = place.daemon(most_mb=250), 0, place.until(), 0
    peer = place.peer(served, timeout=30)
    while time.monotonic() < until or count < 200:
        for k in range(4):
            peer.send(wire.RENDER_ONCE, radar="x", pose=HERE, planes=["STATE"], settings=wire.pb.RadarSettings(
                frustum="SWEEP", azimuth_bins=16, range_bins=32, pixel_columns=16, sector_deg=20, r_min_m=4000, r_max_m=12000,
                                                                                                               noise=True,
                beam_pattern="GAUSSIAN_BEAM" if k else "OFF_BEAM", beam_width_deg=2))
        ends = 0
        while ends < 4:
            ends += peer.receive()[0] in (wire.FRAME_END, wire.FRAME_ABORT, wire.ERROR)
        count += 4
        served.look()
        first = first or (served.most_mb if count >= 100 else 0)
    place.expect(served.most_mb <= first + 20 * place.slack,
                 f"{first:.0f} MB after a hundred frames, {served.most_mb:.0f} after {count}")
    return f"{count} frames"
