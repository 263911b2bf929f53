#!/usr/bin/env python3
"""What the modes that look at Doppler cost beside the real beam's map: processor time, a frame of each in turn.

  tests/bench/modes.py [--turns N] [--bin FOLDER]

1024 x 1024 bins over 60 degrees of hills behind a beam of 3 degrees at 9.4 GHz; an image of 1024 x 1024 bins at 3 m from 20 km.
"""
import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
BEAM = ["beam.pattern=gaussian", "beam.width_deg=3", "radar.frequency_ghz=9.4", "radar.sector_deg=60", "frustum.kind=sweep",
        "antenna.bearing_deg=0"]
FLYING = ["antenna.velocity_north_m_s=130", "antenna.velocity_east_m_s=75"]
SEA = ["materials.terrain.model=sea", "sea.state=3", "sea.shape=0"]
SCANNING = ["scan.mode=sector"]
PATCH = ["radar.frequency_ghz=9.4", "radar.sector_deg=8.8", "frustum.kind=sweep", "radar.r_min_m=18500", "radar.r_max_m=21500",
         "pulse.kind=compressed", "antenna.velocity_east_m_s=150"]
RUNS = {
    "map": BEAM + FLYING,
    "mti": BEAM + ["radar.mode=mti"],
    "mti, clutter lock": BEAM + FLYING + ["radar.mode=mti", "doppler.clutter_lock=true", "pulse.prf_hz=2000"],
    "dbs of 64 ms": BEAM + FLYING + ["radar.mode=dbs", "doppler.pulses=64"],
    "map, sea": BEAM + FLYING + SEA,
    "dbs of 64 ms, sea": BEAM + FLYING + SEA + ["radar.mode=dbs", "doppler.pulses=64"],
    "map, scanning": BEAM + FLYING + SCANNING,
    "mti, scanning": BEAM + SCANNING + ["radar.mode=mti"],
    "mti, scanning, wind": BEAM + SCANNING + ["radar.mode=mti", "atmosphere.wind_m_s=5", "materials.terrain.wind=true"],
    "mti, scanning, flying": BEAM + FLYING + SCANNING + ["radar.mode=mti"],
    "mti, scanning, flying, lock": BEAM + FLYING + SCANNING + ["radar.mode=mti", "doppler.clutter_lock=true"],
    "map, patch": PATCH,
    "sar of 3 m": PATCH + ["radar.mode=sar", "doppler.resolution_m=3"],
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=7)
    parser.add_argument("--bin", help="folder of frame_turns")
    arguments = parser.parse_args()
    command = [sys.executable, HERE / "in_turn.py", HERE / "paper_hills.toml", "--turns", str(arguments.turns)]
    if arguments.bin:
        command += ["--bin", arguments.bin]
    for name, settings in RUNS.items():
        command += ["--run", name, *settings]
    return subprocess.call([str(word) for word in command])


if __name__ == "__main__":
    sys.exit(main())
