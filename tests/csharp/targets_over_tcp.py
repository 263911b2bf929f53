"""What Targets.cs prints against a daemon, from the Python client and from what is known: of csharp_client.py."""
import numpy as np
import obliq
from obliq.targets import HIDDEN_BY

NO_TRUTH = ("viewer: obliq error 108: being told where targets are (server.truth_role) needs the role controller; "
            "this client's token gives viewer")
TRUCK = {"id": 1, "type": "truck", "latitude_deg": 33.027, "longitude_deg": -99.488, "rcs_dbsm": 60.0}
FAR = {"id": 8, "swerling": 0, "latitude_deg": 30.0, "longitude_deg": -99.45}
FIRST, LAST = ("1 'éclair \"1\"' truck 33.027 -99.488 0 GROUND 60 dBsm 0 north 0 valid 0 route 0",
               "18446744073709551615 ''  33 -99.45 0 GROUND 10 dBsm 1 north 0 valid 0 route 2")
BEFORE = [
    "may have truth: True, the viewer: False",
    "unclaimed: obliq error 103: not claimed: targets; claim them first",
    "set 3", FIRST, "2 ''  33.03 -99.46 900 DATUM 10 dBsm 1 north 12 valid 1000 route 0", LAST,
    "twice: obliq error 100: targets refused", "  targets[1].id: found 9 again; allowed: each id once in a request",
    "no id: obliq error 100: targets refused", "  targets[0].id: found 0; allowed: a number from 1",
    "  targets[0].longitude_deg: found nothing; allowed: a value: a new target is somewhere",
    "NaN: obliq error 100: targets refused", "  targets[0].latitude_deg: found nan; allowed: number -90 to 90 deg",
    "route of NaN: obliq error 100: targets refused", "  targets[0].route[0].latitude_deg: found nan; allowed: number -90 to 90 deg",
    "type: obliq error 100: targets refused", '  targets[0].type: found "tank"; allowed: one of "truck"',
    "too many: obliq error 109: max_targets is 2000: nothing was changed", "  targets: found 2001; allowed: at most 2000 in a request",
    "too long: obliq error 100: not sent", "  targets[1]: found 70058 bytes of JSON; allowed: at most 60000",
    "swerling: obliq error 100: targets refused", "  targets[0].swerling: found 7; allowed: integer 0 to 4",
    "id: obliq error 100: not sent", "  id: found -1; allowed: a whole number from 0 to 18446744073709551615",
    "late: 1 late: their sim_time_ns is before the newest of their target; left out",
    "left 2", FIRST, LAST,
    "many 2000 a target with a name that takes some room: 2000"]
AFTER = [
    "bare no targets, in bins 0", NO_TRUTH, NO_TRUTH, NO_TRUTH, "viewer sees echoes: True, truth: False", "cleared 0",
    "released: obliq error 103: not claimed: targets; claim them first",
    'unknown plane: obliq error 5: the JSON of Subscribe: planes: found "TARGETS"; allowed: IQ, POWER, COUNT, STATE, VIDEO, PULSES, MATERIAL, '
    "BUILDING, HEIGHT, RETURNS, TARGET"]
OF_A_PASS = 2 * ["pass: 1 target, its bin says 1"]


def told(what, frame):
    """As Targets.cs prints a frame's truth."""
    lines = [f"{what} {len(frame.targets)} targets, in bins {np.count_nonzero(frame.target == 1)}"]
    for t in frame.targets:
        hidden_by = "".join(word.capitalize() for word in HIDDEN_BY[t["hidden_by"]].split("_"))
        lines.append(f"truth {t['id']} {t['latitude_deg']:.6f} {t['longitude_deg']:.6f} {t['height_m']:.3f} bearing {t['bearing_deg']:.4f} "
                     f"range {t['range_m']:.2f} elevation {t['elevation_deg']:.3f} snr {t['snr_db']:.2f} rcs {t['rcs_dbsm']:.2f} "
                     f"seen {t['share_seen']:.3f} bin {t['azimuth_bin']} {t['range_bin']} by {hidden_by} power {bool(t['is_power'])}")
    return lines


def expected(address, token):
    """Every line of Targets.cs, whose claim must be free."""
    with obliq.connect(address, token=token) as server, server.targets() as world:
        world.replace([TRUCK, FAR])
        frame = server.radar("main").frame(planes="target", truth=True)
        rendered = server.render({"azimuth_bins": 18}, {}, planes="target", radar="main", as_live=True, live_targets=True, truth=True)
        world.clear()
    if np.count_nonzero(frame.target == 1) == 0:
        raise SystemExit(f"csharp_client: the scene hides its target: {frame.targets[0]}")
    return [*BEFORE, *told("frame", frame), *told("rendered", rendered), *AFTER]
