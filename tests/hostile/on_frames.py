"""RenderOnce of a viewer at the extremes of what PARAMETERS.md allows: what the others get meanwhile, and the memory."""
import contextlib
import select
import time

import wire
from place import attack

POSE = wire.pb.Pose(latitude_deg=33, longitude_deg=-99.5, height_m=2500)
PLAIN = {"frustum": "SWEEP", "sector_deg": 60, "azimuth_bins": 128, "range_bins": 256, "pixel_columns": 128, "r_min_m": 4000,
         "r_max_m": 20000}
HALF_LIGHT_M_US = 149.896229  # c / 2
ANSWERED_S = 2.0  # of processor time, until a request is answered or the others are


def once(**settings):
    more = {name: settings.pop(name) for name in ("planes", "window", "video_bits") if name in settings}
    return {"radar": "x", "pose": POSE, "settings": wire.pb.RadarSettings(**{**PLAIN, **settings}), **more}


def fine_beam(azimuths, ranges, pattern, **more):
    """A beam that splits each azimuth bin in eight and looks all round, a pulse that splits each range bin in eight."""
    return {"sector_deg": 360, "azimuth_bins": azimuths, "range_bins": ranges, "pixel_columns": azimuths, "beam_pattern": pattern,
            "beam_width_deg": max(0.05, 360 / azimuths / 4 * 1.0001), "beam_extent_deg": 180, "pulse_kind": "RECTANGULAR_PULSE",
            "pulse_length_us": max(0.001, 16000 / ranges / 8 / HALF_LIGHT_M_US * 1.0001), "pulse_extent_bins": 1, **more}


def ask_and_leave(place, served, processor_s, **settings):
    """In words, what it got by the time when the server has worked for so long: refused, a frame, or nothing."""
    with contextlib.closing(wire.Peer(served.port, place.tokens.get("viewer", ""), timeout=60)) as peer:
        begun, said, until = served.processor_s(), "nothing", time.monotonic() + 10 * place.seconds
        peer.send(wire.RENDER_ONCE, **once(**settings))
        while served.lives() and (used := served.processor_s() - begun) < processor_s and time.monotonic() < until:
            if not select.select([peer.socket], [], [], 0.1)[0]:
                continue
            kind, payload = peer.receive()
            if kind == wire.ERROR:
                error = wire.pb.Error.FromString(payload)
                return f"error {error.number} ({error.text[:50]}) after {used:.1f} s"
            if kind in (wire.FRAME_END, wire.FRAME_ABORT):
                return f"a frame after {used:.1f} s"
            said = f"accepted, left after {processor_s:g} s"
        return said


def plans(place, served, cases):
    told = []
    for azimuths, ranges, pattern, more in cases:
        said = ask_and_leave(place, served, place.seconds, **fine_beam(azimuths, ranges, pattern, **more))
        told.append(f"{azimuths} x {ranges} {said}")
        if not served.lives():
            break
        time.sleep(0.5)
    return "; ".join(told)


@attack("H2")
def huge_plans(place):
    """A beam's plan of a thousand million weights, where memory is limited: nobody else waits while it is judged."""
    served = place.daemon("server.max_memory_mb=300", most_mb=400)
    return plans(place, served, [(1024, 1024, "TAYLOR_BEAM", {"scan_mode": "CIRCULAR_SCAN"}), (8192, 8192, "UNIFORM_BEAM", {})])


@attack("H2")
def huge_plans_without_limit(place):
    """The same with the default limit."""
    served = place.daemon("server.max_memory_mb=0", most_mb=1500)
    return plans(place, served, [(4096, 4096, "TAYLOR_BEAM", {}), (8192, 8192, "TAYLOR_BEAM", {"scan_mode": "CIRCULAR_SCAN"})])


@attack("H2")
def huge_plans_of_live_radars(place):
    """The same plan by SetSettings of a radar that is watched."""
    served = place.daemon("server.max_memory_mb=300", most_mb=400)
    told = []
    with contextlib.closing(wire.Peer(served.port, timeout=60)) as peer:
        peer.demand(wire.CLAIM, radar="nose")
        peer.demand(wire.SUBSCRIBE, radar="nose", rate_hz=1, planes=["STATE"])
        for azimuths, ranges in ((8192, 8192), (4096, 1024)):
            error = peer.outcome(wire.SET_SETTINGS, radar="nose",
                                 settings=wire.pb.RadarSettings(**fine_beam(azimuths, ranges, "UNIFORM_BEAM")))
            told.append(f"{azimuths} x {ranges}: error {error}")
        time.sleep(place.seconds)
    return "; ".join(told)


@attack("H3")
def wide_pattern(place):
    """A pattern that makes every output wedge of a large frame ready at once: live frames go on while they are summed."""
    served = place.daemon("server.max_memory_mb=0", most_mb=1000)
    return ask_and_leave(place, served, 4 + place.seconds, azimuth_bins=1400, range_bins=1400, pixel_columns=1400, planes=["STATE"],
                         beam_pattern="UNIFORM_BEAM", beam_width_deg=3, beam_extent_deg=180)


@attack("H4")
def one_wide_bin(place):
    """One azimuth bin of 16,384 planes, exact or in narrow bins, with the default limit of memory."""
    served, told = place.daemon("server.max_memory_mb=0", most_mb=1000), []
    for parts, wanted in ((1024, "accepted"), (0, "error 109")):
        said = ask_and_leave(place, served, 2 * place.seconds, azimuth_bins=1, range_bins=8192, pixel_columns=16384,
                             sub_columns=parts)
        told.append(f"sub_columns {parts}: {said}")
        place.expect(said.startswith(wanted), f"sub_columns {parts}: {said}; wanted: {wanted}")
        time.sleep(1)
    return "; ".join(told)


@attack("H4")
def one_wide_bin_in_memory(place):
    """One azimuth bin of 8,192 planes that memory has room for: live frames go on within it."""
    served = place.daemon("server.max_memory_mb=0", most_mb=1200)
    return ask_and_leave(place, served, 2 * place.seconds, azimuth_bins=1, range_bins=8192, pixel_columns=8192, sub_columns=16)


@attack("H4")
def default_limit(place):
    """Limits name the memory that the server takes for itself: less than the machine has."""
    served = place.daemon("server.max_memory_mb=0")
    limit = place.peer(served).welcome.limits.max_memory_mb
    with open("/proc/meminfo", encoding="ascii") as file:
        machine = int(file.readline().split()[1]) / 1024
    place.expect(0 < limit < machine, f"Limits.max_memory_mb is {limit}; allowed: 1 to {machine:.0f}, what the machine has")
    return f"{limit} MB of {machine:.0f}"


@attack("L7")
def readers_of_nothing(place):
    """Large frames asked for by many who do not read: memory stays within the limit, honest requests are taken afterwards."""
    served, refused, held = place.daemon("server.max_memory_mb=400", most_mb=440), 0, []
    until = place.until(2)
    for k in range(40):
        if time.monotonic() > until:
            break
        peer = wire.Peer(served.port, source=f"127.0.8.{k + 1}", buffer=4096, timeout=30)
        held.append(peer)
        refused += peer.outcome(wire.RENDER_ONCE, **once(azimuth_bins=4096, range_bins=2048, pixel_columns=4096)) != 0
    time.sleep(place.seconds)
    served.look()
    for peer in held:
        peer.close()
    end, taken = time.monotonic() + 15, 1
    while taken != 0 and time.monotonic() < end:
        with contextlib.closing(wire.Peer(served.port)) as honest:
            taken = honest.outcome(wire.RENDER_ONCE, **once())
        time.sleep(0.2)
    place.expect(taken == 0, f"a small request is refused by error {taken} after they left")
    return f"{len(held) - refused} of {len(held)} taken, {served.most_mb:.0f} MB"


@attack()
def extremes(place):
    """One setting after the other at its end, alone and with a beam."""
    served = place.daemon("server.max_memory_mb=0", most_mb=700)
    beam = {"beam_pattern": "GAUSSIAN_BEAM", "beam_width_deg": 3}
    many = {"azimuth_bins": 1024, "range_bins": 1024, "pixel_columns": 1024}
    cases = [{**beam, **many, "sector_deg": 360, "beam_width_deg": 90}, {**beam, "beam_width_deg": 0.05, "azimuth_bins": 8192},
             {"pulse_kind": "COMPRESSED_PULSE", "pulse_length_us": 100, "pulse_extent_bins": 256},
             {"pulse_kind": "RECTANGULAR_PULSE", "pulse_length_us": 10000},
             {"video_looks": 1024, "azimuth_bins": 8192, "range_bins": 8192, "pixel_columns": 8192, "planes": ["VIDEO"]},
             {"sub_columns": 1024, "azimuth_bins": 8192, "pixel_columns": 16384}, {"sector_deg": 1e-9}, {"sector_deg": 1e-300},
             {**beam, "sector_deg": 5e-324},
             {"r_min_m": 10000, "r_max_m": 10000.000001},
             {**beam, "r_min_m": 0, "r_max_m": 500e3, "sector_deg": 360, "azimuth_bins": 720, "range_bins": 2048},
             {"speckle": "INDEPENDENT_SPECKLE", "azimuth_bins": 4096, "range_bins": 4096, "pixel_columns": 4096},
             {**many, "rain_mm_h": 200, "rain_top_m": 20000, "gas": True, "frequency_ghz": 300},
             {"frustum": "SYMMETRIC", "azimuth_bins": 1, "range_bins": 1, "pixel_columns": 16384, "pixel_rows": 16384},
             {**beam, **many, "frustum": "OBLIQUE", "pixel_columns": 16384, "pixel_rows": 16384},
             {**beam, **many, "frustum": "SYMMETRIC", "pixel_columns": 16384, "pixel_rows": 16384},
             {"window": wire.pb.BinWindow(n_azimuth=1, n_range=1), **beam, "sector_deg": 360, "azimuth_bins": 4096,
              "beam_width_deg": 90}]
    said = [ask_and_leave(place, served, place.seconds / 3, **case) for case in cases]
    return f"{len(cases)} settings, {sum(one.startswith('error') for one in said)} refused"


@attack()
def ask_and_go(place):
    """Frames with a beam, four at a time, asked for and left at once: nothing of them is rendered afterwards."""
    served, count, until = place.daemon(), 0, place.until()
    wanted = once(azimuth_bins=1024, range_bins=1024, pixel_columns=1024, beam_pattern="GAUSSIAN_BEAM", noise=True)
    while time.monotonic() < until:
        with contextlib.closing(wire.Peer(served.port)) as peer:
            peer.socket.sendall(b"".join(peer.packed(wire.RENDER_ONCE, **wanted) for _ in range(4)))
            time.sleep(place.random.choice([0, 0.001, 0.01, 0.05]))
        count += 1
    end, queued = time.monotonic() + 15, 1
    while queued and time.monotonic() < end:
        time.sleep(0.1)
        queued = wire.pb.Status.FromString(place.peer(served).demand(wire.GET_STATUS)).renders_queued
    place.expect(queued == 0, f"{queued} requests of clients that left are still queued")
    return f"{count} times"
