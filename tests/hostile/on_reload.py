"""SIGHUP again and again: scene files that change, break and come back under turning beams, pattern tables as well."""
import os
import signal
import stat
import time

import wire
from on_requests import TURNING
from place import attack


def replaced(place, name, text):
    place.write(name + "~", text)
    os.replace(place.path(name + "~"), place.path(name))


def settings_of(place, served):
    return wire.pb.RadarInfo.FromString(place.peer(served).demand(wire.GET_RADAR, radar="turn")).settings


def await_settings(place, served, wanted):
    """The last file is the one that serves, within a time that a reload may take."""
    end = time.monotonic() + 30
    while not wanted(got := settings_of(place, served)) and time.monotonic() < end:
        time.sleep(0.2)
    place.expect(wanted(got), "what was put right at last does not serve")


@attack()
def scene_files(place):
    """Other sectors, bins, beams, scans, houses, a broken file, a pipe, no file at all."""
    served, draw, count, until = place.daemon(scene=TURNING), place.random, 0, place.until(2)
    with open(place.path("scene.toml"), encoding="utf-8") as file:
        good = file.read()
    changes = [("", ""), ("sector_deg = 360.0", "sector_deg = 360.0\nbins.azimuth = 720"),
               ("r_max_m = 15000.0", "r_max_m = 9000.0"), ("width_deg = 3.0", "width_deg = 9.0"),
               ('pattern = "gaussian"', 'pattern = "off"'), ('"circular"', '"frame"'), ("[radar.beam]", "[radar.beam"),
               ("seed = 7", "seed = 8"),
               ('scan.mode = "circular"', 'scan.mode = "circular"\nscan.bars = [-1.0, -3.0]'), ("cell_m = 60.0", "cell_m = nan")]
    while time.monotonic() < until:
        replaced(place, "scene.toml", good.replace(*draw.choice(changes)))
        if draw.random() < 0.1:
            os.remove(place.path("scene.toml"))
            if draw.random() < 0.5:
                os.mkfifo(place.path("scene.toml"))
        os.kill(served.pid, signal.SIGHUP)
        count += 1
        time.sleep(draw.choice([0.01, 0.05, 0.3]))
    replaced(place, "scene.toml", good.replace("width_deg = 3.0", "width_deg = 4.5"))
    os.kill(served.pid, signal.SIGHUP)
    await_settings(place, served, lambda got: got.beam_width_deg == 4.5)
    place.expect(stat.S_ISREG(os.stat(place.path("scene.toml")).st_mode), "the scene file is no file")
    return f"{count} SIGHUPs"


@attack()
def pattern_files(place):
    """A table that a turning beam reads: changed, cut, emptied, removed."""
    scene = TURNING.replace('pattern = "gaussian"', 'pattern = "file"\nfile = "pattern.csv"')

    def table(width):
        rows = (f"azimuth,{k / 10},{-12 * (k / 10 / width) ** 2}\n" for k in range(-int(20 * width), int(20 * width) + 1))
        return "cut,angle_deg,gain_db\n" + "".join(rows)
    place.write("pattern.csv", table(2))
    served, draw, count, until = place.daemon(scene=scene), place.random, 0, place.until(1.5)
    while time.monotonic() < until:
        text = table(draw.choice([0.3, 1, 2, 4]))
        replaced(place, "pattern.csv", draw.choice([text, text, text, text[: len(text) // 2] + "x", ""]))
        if draw.random() < 0.1:
            os.remove(place.path("pattern.csv"))
        os.kill(served.pid, signal.SIGHUP)
        count += 1
        time.sleep(draw.choice([0.02, 0.1, 0.3]))
    replaced(place, "pattern.csv", table(3))
    os.kill(served.pid, signal.SIGHUP)
    await_settings(place, served, lambda got: got.beam_pattern == wire.pb.FILE_BEAM)
    return f"{count} SIGHUPs"


@attack()
def withdrawn_tokens(place):
    """A token is taken away while the scene file has a typo: its client is closed, on both doors, nobody comes in with it."""
    served = place.daemon(tokens=True)
    peers = [place.peer(served, "controller"), place.web_socket(served, "controller")]
    with open(place.path("scene.toml"), "a", encoding="utf-8") as file:
        file.write("\n[nope\n")
    lines = "".join(f"{role} {token}\n" for role, token in place.tokens.items() if role != "controller")
    place.write("tokens~", lines)
    os.chmod(place.path("tokens~"), 0o600)
    os.replace(place.path("tokens~"), place.path("tokens"))
    os.kill(served.pid, signal.SIGHUP)
    for peer in peers:
        said = 0
        try:
            while said != wire.NO_TOKEN:
                kind, payload = peer.receive()
                said = (payload.get("number")
                        if isinstance(payload, dict) else wire.pb.Error.FromString(payload).number) if kind == wire.ERROR else 0
        except (EOFError, OSError) as error:
            place.expect(not isinstance(error, TimeoutError), f"{type(peer).__module__}: the client whose token is gone stays")
    try:
        place.peer(served, "controller")
        place.expect(False, "a token that is gone lets in")
    except wire.Refused as refused:
        place.expect(refused.number == wire.NO_TOKEN, f"a token that is gone: {refused}")
