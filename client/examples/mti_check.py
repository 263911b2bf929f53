#!/usr/bin/env python3
"""Measures what a radar's modes make of Doppler, and holds it against closed forms.

  python3 mti_check.py [--scene SCENE.toml] [--server HOST:PORT]

Starts an obliqd of its own on deploy/scenes/targets_check.toml unless --server names one; any scene of level ground will do. A
line says what was measured and, in brackets, what the closed form gives: how much a canceller of one and of two delays improves
an antenna that turns by a beamwidth in 20 pulses; how far the noise changes with the canceller on; how many times narrower than
the beam a point is in a map sharpened by Doppler; how far from its place a mover stands there. Exit code 1: a level is off by
more than 0.3 dB, or a figure by more than 2 %.
"""
import argparse
import math
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
try:
    import obliq
except ImportError:  # the package of this tree
    sys.path.insert(0, str(HERE.parent / "python" / "src"))
    import obliq

LIGHT_M_S = 299792458.0
FREQUENCY_GHZ = 9.4
WAVELENGTH_M = LIGHT_M_S / (FREQUENCY_GHZ * 1e9)
BEAM_DEG = 3.0
PULSES_A_BEAM = 20
SPEED_M_S, MOVER_M_S = 150.0, 10.0
PRF_HZ, PULSES = 1000.0, 64
# Low and far: on the ground the beam is 1 / cos(elevation) wider, here by a ten thousandth.
HEIGHT_M, RANGE_M = 300.0, 20e3
PLACE = {"latitude_deg": 36.4065, "longitude_deg": -107.5855, "height_m": HEIGHT_M, "height_reference": "ground", "bearing_deg": 0.0}
METRES_PER_DEGREE = 6360e3 * math.pi / 180


def radar(sector_deg, azimuth_bins, **more):
    """Settings of a radar that looks at a strip of level ground, without a pulse and without speckle."""
    return obliq.Settings(**{
        "frequency_ghz": FREQUENCY_GHZ, "power_w": 50e3, "gain_db": 33.0, "frustum": "sweep", "speckle": "none", "sector_deg": sector_deg,
        "azimuth_bins": azimuth_bins, "r_min_m": RANGE_M - 500, "r_max_m": RANGE_M + 500, "range_bins": 50, "beam_pattern": "gaussian",
        "beam_width_deg": BEAM_DEG, **more})


def db(ratio):
    return 10 * math.log10(ratio)


def target(bearing_deg, closing_m_s=0.0):
    """A steady one on the ground; it closes, in what the antenna's own motion leaves of it."""
    east, north = math.sin(math.radians(bearing_deg)), math.cos(math.radians(bearing_deg))
    ground_m = math.sqrt(RANGE_M**2 - HEIGHT_M**2)
    level_m_s = closing_m_s * RANGE_M / ground_m
    latitude_deg = PLACE["latitude_deg"] + ground_m * north / METRES_PER_DEGREE
    middle = math.radians((latitude_deg + PLACE["latitude_deg"]) / 2)
    return {"id": 1, "rcs_dbsm": 60.0, "swerling": 0, "latitude_deg": latitude_deg,
            "longitude_deg": PLACE["longitude_deg"] + ground_m * east / METRES_PER_DEGREE / math.cos(middle),
            "velocity_north_m_s": -level_m_s * north, "velocity_east_m_s": -level_m_s * east}


def flying(psi_deg):
    """A pose whose velocity lies psi to the left of the line of sight."""
    psi = math.radians(psi_deg)
    return {**PLACE, "velocity_north_m_s": SPEED_M_S * math.cos(psi), "velocity_east_m_s": -SPEED_M_S * math.sin(psi),
            "velocity_up_m_s": 0.0}


# ---- What is measured

def improvements(server):
    """Of cancellers of one and two delays, dB: unit noise gain, so the improvement is what the ground falls by."""
    rate_deg_s = 60.0
    turning = radar(20, 400, scan_mode="sector", scan_rate_deg_s=rate_deg_s, prf_hz=PULSES_A_BEAM * rate_deg_s / BEAM_DEG)

    def ground_w(**mode):
        return server.render(turning.replace(**mode), PLACE, planes="power").power[200].mean()

    mean_w = ground_w(mode="map")
    return [db(mean_w / ground_w(mode="mti", canceller=delays)) for delays in (1, 2)]


def noise_change(server):
    """By the canceller, dB, of a receiver without an echo."""
    silent = radar(20, 400, power_w=0.0, noise=True, noise_seed=7)
    map_w, mti_w = ((np.abs(server.render(silent.replace(mode=mode), PLACE, planes="iq").iq) ** 2).mean() for mode in ("map", "mti"))
    return db(mti_w / map_w)


def response(server, settings, pose, one):
    """Mean power of a target alone over bearing, and the bearings; the truth's bearing of it."""
    with_it = server.render(settings, pose, planes="power", targets=[one], truth=True)
    without = server.render(settings, pose, planes="power")
    power = (with_it.power - without.power)[:, int(with_it.targets["range_bin"][0])]
    bearing_deg = (np.asarray(with_it.azimuth_deg) + 180) % 360 - 180
    return bearing_deg, power, (float(with_it.targets["bearing_deg"][0]) + 180) % 360 - 180


def vertex(x, y, at):
    """Place of the extremum of the parabola through three neighbours."""
    left, middle, right = y[at - 1:at + 2]
    return x[at] + (x[1] - x[0]) * 0.5 * (left - right) / (left - 2 * middle + right)


def crossings(x, y, level):
    """Places where y goes through a level."""
    above = y > level
    at = np.flatnonzero(above[1:] != above[:-1])
    return x[at] + (level - y[at]) / (y[at + 1] - y[at]) * (x[1] - x[0])


def sharpening(server):
    """The real beam's half-power width over the distance from a point's peak to its first null."""
    settings, pose = radar(8, 1600, mode="map"), flying(30)
    bearing, power, _ = response(server, settings, pose, target(0))
    width = np.ptp(crossings(bearing, power / power.max(), 0.25))  # one-way half power is a quarter both ways
    bearing, power, _ = response(server, settings.replace(mode="dbs", prf_hz=PRF_HZ, doppler_pulses=PULSES, doppler_window="none"), pose,
                                 target(0))
    lows = [k for k in range(1, len(power) - 1) if power[k] < power[k - 1] and power[k] <= power[k + 1]]
    peak = int(np.argmax(power))
    nulls = [vertex(bearing, power, max(k for k in lows if k < peak)), vertex(bearing, power, min(k for k in lows if k > peak))]
    return width / (abs(nulls[1] - nulls[0]) / 2)


def displacement(server):
    """Of a mover from its place, degrees: those two lie on either side of psi = 60, for which alone the closed form holds."""
    aside_deg = math.degrees(MOVER_M_S / (SPEED_M_S * math.sin(math.radians(60)))) / 2
    # A beam that has both in it; the same train of four times as many pulses, whose ambiguities lie beyond the beam.
    wide = radar(24, 3200, mode="dbs", prf_hz=4 * PRF_HZ, doppler_pulses=4 * PULSES, beam_width_deg=12.0)
    bearing, power, true_deg = response(server, wide, flying(60), target(aside_deg, MOVER_M_S))
    return true_deg - vertex(bearing, power, int(np.argmax(power)))


# ---- Closed forms

def closed_improvements():
    """Of a Gaussian beam that turns by half its power in n pulses: 1 / (1 - r1), 3 / (3 - 4 r1 + r2) (Radar Handbook 2008, chapter 2)."""
    r1, r2 = (math.exp(-2 * math.log(2) * (k / PULSES_A_BEAM) ** 2) for k in (1, 2))
    return db(1 / (1 - r1)), db(3 / (3 - 4 * r1 + r2))


def closed_ratio():
    """Beam over lambda / (2 v T sin psi)."""
    train_s = PULSES / PRF_HZ
    return math.radians(BEAM_DEG) / (WAVELENGTH_M / (2 * SPEED_M_S * train_s * math.sin(math.radians(30))))


def closed_displacement():
    """Radial speed over v sin psi."""
    return math.degrees(MOVER_M_S / (SPEED_M_S * math.sin(math.radians(60))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", type=pathlib.Path, default=HERE.parent.parent / "deploy" / "scenes" / "targets_check.toml")
    parser.add_argument("--server", help="HOST:PORT of one that runs")
    given = parser.parse_args()
    with obliq.connect(given.server) if given.server else obliq.local(given.scene) as server:
        single, double = improvements(server)
        noise = noise_change(server)
        ratio = sharpening(server)
        mover = displacement(server)
    wanted_single, wanted_double = closed_improvements()
    wanted_ratio, wanted_mover = closed_ratio(), closed_displacement()
    print(f"single {single:.1f}, double {double:.1f} dB ({wanted_single:.2f}, {wanted_double:.2f}), noise changed {noise:.2f} dB; "
          f"DBS ratio {ratio:.1f} ({wanted_ratio:.2f}); mover {mover:.2f} deg ({wanted_mover:.3f})")
    levels_hold = max(abs(single - wanted_single), abs(double - wanted_double), abs(noise)) <= 0.3
    figures_hold = max(abs(ratio / wanted_ratio - 1), abs(mover / wanted_mover - 1)) <= 0.02
    return 0 if levels_hold and figures_hold else 1


if __name__ == "__main__":
    sys.exit(main())
