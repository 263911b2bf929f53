"""Targets by client/c.h from a C program, against a daemon, beside the Python client.

  c_targets_test.py --bin DIR
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import obliq

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import programs  # noqa: E402
from obliq.targets import HIDDEN_BY

from c_test import SCENE

TRUCK = """
[target_types.truck]
rcs_dbsm = 40.0
swerling = 0
top_m = 4.0
"""
TOKEN, VIEWER = "controller-token-0123456789", "viewer-token-0123456789"
NO_TRUTH = "outcome 6, error 108: being told where targets are (server.truth_role) needs the role controller"
WORLD = [{"id": 1, "type": "truck", "latitude_deg": 33.02, "longitude_deg": -99.45, "rcs_dbsm": 60.0},
         {"id": 8, "swerling": 0, "latitude_deg": 30.0, "longitude_deg": -99.45}]
# Lines of c_targets before its frames, from their beginning on.
SET = [
    "before: outcome 4, error 0: not connected",
    "without claim: outcome 6, error 103: not claimed: targets",
    'set 1 "éclair" truck 33.020 -99.450 0 over 1, 40 dBsm, Swerling 0, north 0, heading nan, valid 0 s, timed',
    'set 2 ""  33.030 -99.460 900 over 0, 20 dBsm, Swerling 1, north 12, heading 90, valid 1000 s, of its arrival',
    'set 18446744073709551615 ""  33.000 -99.450 0 over 1, 10 dBsm, Swerling 1, north nan, heading nan, valid 0 s, timed, '
    "route of 2 to 33.02 -99.43 at 20 m/s, 0 m, loops 1",
    "an id twice: outcome 6, error 100: targets refused: targets[1].id: found 1 again; allowed: each id once in a request",
    "no id: outcome 6, error 100: targets refused: targets[0].id: found 0; allowed: a number from 1",
    "NaN of a new one: outcome 6, error 100: targets refused: targets[0].latitude_deg: found nothing; allowed: a value",
    "infinite: outcome 6, error 100: targets refused: targets[0].latitude_deg: found inf; allowed: number -90 to 90 deg",
    'no such choices: outcome 6, error 100: targets refused: targets[0].height_reference: found 9; allowed: "datum" | "ground" | '
    '"ellipsoid"; targets[0].swerling: found 7; allowed: integer 0 to 4',
    'unknown type: outcome 6, error 100: targets refused: targets[0].type: found "tank"; allowed: one of "truck"',
    "no UTF-8: outcome 1, error 0: targets[0].name: found no UTF-8 at byte 0; allowed: UTF-8",
    "no speeds: outcome 1, error 0: targets[0].route.speed_m_s: found NULL; allowed: n values",
    "route and velocity: outcome 6, error 100: targets refused: targets[0].route: found a velocity beside it",
    "too many: outcome 6, error 109: max_targets is 20: nothing was changed: targets: found 21; allowed: at most 20",
    f"too many by far: outcome 1, error 0: n: found {2**64 - 1}; allowed: fewer",
    "no array: outcome 1, error 0: targets: found NULL; allowed: n targets",
    "no ids: outcome 1, error 0: ids: found NULL; allowed: n ids",
    "no place for it: outcome 1, error 0: target: found NULL; allowed: a place for one",
    "no frame: outcome 1, error 0: frame: found NULL; allowed: a place for one",
    "no event: outcome 1, error 0: event: found NULL; allowed: a place for one",
    "no places: outcome 1, error 0: latitude_deg, longitude_deg, ground: found NULL; allowed: n of each",
    "long route: outcome 1, error 0: targets[0]: found 2400",
    "late warns: 1 late: their sim_time_ns is before the newest of their target; left out",
    'left 1 "éclair" truck 33.020 -99.450 0 over 1, 50 dBsm, Swerling 0, north 0,',
    'left 18446744073709551615 ""  33.000 -99.450 0 over 1, 10 dBsm, Swerling 1, north nan,',
    "unknown plane: outcome 1, error 0: planes: found 2048; allowed: a sum of obliq_planes",
    "truth without planes: outcome 1, error 0: planes: found 65536; allowed: a sum of obliq_planes",
    "not of a subscription: outcome 1, error 0: planes: found OBLIQ_LIVE_TARGETS; allowed: of obliq_render() alone"]
AFTER = [
    "bare main: 0 targets, in bins 0, power 0",
    f"viewer asks for truth: {NO_TRUTH}", f"viewer asks for the plane: {NO_TRUTH}", f"viewer lists: {NO_TRUTH}",
    "viewer claims: outcome 6, error 108: this request needs the role controller", "viewer's frame: state 1, power 0, truth 0",
    "released: outcome 6, error 103: not claimed: targets"]


def told(what, frame, power):
    """As c_targets prints a frame's truth."""
    lines = [f"{what} main: {len(frame.targets)} targets, in bins {np.count_nonzero(frame.target == 1)}, power {power}"]
    for t in frame.targets:
        lines.append(f"truth {t['id']} {t['latitude_deg']:.6f} {t['longitude_deg']:.6f} {t['height_m']:.3f} bearing {t['bearing_deg']:.4f} "
                     f"range {t['range_m']:.2f} elevation {t['elevation_deg']:.4f} closing {t['closing_m_s']:.3f} snr {t['snr_db']:.3f} "
                     f"rcs {t['rcs_dbsm']:.3f} seen {t['share_seen']:.3f} bin {t['azimuth_bin']} {t['range_bin']} by {t['hidden_by']} "
                     f"power {int(t['is_power'])}")
    return lines


def frames_over_python(address):
    with obliq.connect(address, token=TOKEN) as server, server.targets() as world:
        world.replace(WORLD)
        frame = server.radar("main").frame(planes="target power", truth=True)
        rendered = server.render({"azimuth_bins": 16}, {}, planes="target", radar="main", as_live=True, live_targets=True, truth=True)
        world.clear()
    first = frame.targets[0]
    if np.count_nonzero(frame.target == 1) == 0 or HIDDEN_BY[first["hidden_by"]] != "nothing" or first["snr_db"] < -900:
        sys.exit(f"c_targets: the scene hides its target: {first}")
    return [*told("frame", frame, 1), *told("rendered", rendered, 0)]


def check(programs, address):
    ran = subprocess.run([programs / "c_targets", address, "main", TOKEN, VIEWER], capture_output=True, text=True, encoding="utf-8",
                         timeout=120)
    found = ran.stdout.splitlines()
    wanted = [*SET, *frames_over_python(address), *AFTER]
    for k, line in enumerate(wanted):
        if k >= len(found) or not found[k].startswith(line):
            sys.exit(f"c_targets: line {k}: found {found[k] if k < len(found) else 'nothing'!r}; expected {line!r}\n{ran.stdout}{ran.stderr}")
    if ran.returncode != 0 or ran.stderr or len(found) != len(wanted):
        sys.exit(f"c_targets: exit code {ran.returncode}\n{ran.stdout}{ran.stderr}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene, tokens = pathlib.Path(folder) / "scene.toml", pathlib.Path(folder) / "tokens"
        scene.write_text(SCENE + TRUCK)
        tokens.write_text(f"controller {TOKEN}\nviewer {VIEWER}\n")
        tokens.chmod(0o600)
        daemon = programs.daemon(scene, f"server.tokens={tokens}", "server.max_targets=20", obliqd=given.bin / "obliqd")
        try:
            check(given.bin, daemon.address)
        finally:
            daemon.stop()
    print("C's targets agree with Python's")


if __name__ == "__main__":
    main()
