#!/usr/bin/env python3
"""What frames cost beside those of commit ed06c75, the last before cities at speed: processor time, both builds in turn.

  tests/bench/cities.py [--turns N] [--only NAME]... [--errors] [--json FILE] [--bin FOLDER] [--old PROGRAM]

The old program, frame_turns of ed06c75, is built into build/ed06c75 from this repository's history where it is not there
yet; --old names one that is. Each figure is the least of N turns of a radar that moves on: user + system time of plan and
wedges on two threads, all planes. Frames of a row's programs alternate, each in a process that keeps its scene. --errors
adds E, gaps, missed buildings and energy from `obliq frontier` (some minutes more).
"""
import argparse
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass

from in_turn import ENDED, Program, take_turns

ROOT = pathlib.Path(__file__).resolve().parents[2]
OLD = "ed06c75"
HILLS, CITY, FINE = (f"tests/bench/{name}.toml" for name in ("paper_hills", "city", "fine"))
MILLION = "tests/bench/million.toml"
LOS_ANGELES = "deploy/scenes/losangeles.toml"
STANDARD = ("frustum.quality=standard",)
DEFAULTS = ("materials.terrain.gamma_db=-15",)  # another default in the old build; powers are compared
PAPER = ("frustum.quality=paper", "run.rays=embree")


@dataclass
class Run:
    """A scene as one program renders it."""
    scene: str
    sets: tuple = STANDARD
    old: bool = False
    bare: bool = False  # power and state alone

    def command(self, programs):
        words = [programs[self.old], self.scene]
        defaults = DEFAULTS if self.scene == HILLS else ()
        for setting in (*defaults, *self.sets):
            words += ["--set", setting]
        return words + (["--bare"] if self.bare else [])


@dataclass
class Row:
    """A ratio of processor times: ours over theirs."""
    name: str
    what: str
    ours: Run
    theirs: Run
    targets: tuple  # to reach, to go past it to
    errors: tuple = ()   # options of `obliq frontier`; empty: its errors are not measured
    thinner: tuple = ()  # what to replace in the scene for the errors: fewer buildings, a quicker reference


def against_old(name, what, scene, targets, errors=()):
    return Row(name, what, Run(scene), Run(scene, old=True), targets, errors)


REFERENCE = ("--against", "reference", "--azimuths", "0")
TRUTH = ("--azimuths", "64", "--truth-planes", "128", "--truth-planes-limit", "128")
ROWS = [
    against_old("hills", "`paper_hills.toml`", HILLS, (0.50, 0.30), REFERENCE),
    against_old("city", "`city.toml`, 100,000 buildings", CITY, (0.15, 0.08), REFERENCE),
    Row("million", "`million.toml` over `paper_hills.toml`, this build both", Run(MILLION), Run(HILLS), (5.5, 3),
        REFERENCE, ("per_km2 = 700.0", "per_km2 = 210.0")),
    against_old("losangeles", "Los Angeles", LOS_ANGELES, (0.50, 0.25), TRUTH),
    against_old("fine", "`fine.toml`, posts of 10 m", FINE, (0.55, 0.35), REFERENCE),
    Row("paper_hills", "hills: sweep over the paper's setting by Embree, this build both", Run(HILLS), Run(HILLS, PAPER), (0.25, 0.1)),
    Row("paper_losangeles", "Los Angeles: the same", Run(LOS_ANGELES), Run(LOS_ANGELES, PAPER), (0.40, 0.1)),
    Row("plates", "oblique: spread over nearest, this build both", Run(HILLS, ("frustum.plates=spread",)),
        Run(HILLS, ("frustum.plates=nearest",)), (2, 1.3)),
    Row("bare", "bare hills, `draft`, power and state alone", Run(HILLS, ("frustum.quality=draft",), bare=True),
        Run(HILLS, ("frustum.quality=draft",), old=True), (0.45, 0.25)),
]


def build_old():
    """frame_turns of the old commit, as the release preset builds it."""
    folder = ROOT / "build" / OLD
    program = folder / "build" / "bin" / "frame_turns"
    source = folder / "source"
    bench = ROOT / "tests/bench/frame_turns.cpp"
    if program.exists() and program.stat().st_mtime > bench.stat().st_mtime:
        return program
    print(f"cities.py: building {OLD} in {folder}", file=sys.stderr, flush=True)
    if not source.exists():
        source.mkdir(parents=True)
        archive = subprocess.Popen(["git", "archive", OLD], cwd=ROOT, stdout=subprocess.PIPE)
        subprocess.run(["tar", "-x", "-C", source], stdin=archive.stdout, check=True)
        if archive.wait() != 0:
            shutil.rmtree(source)
            sys.exit(f"cities.py: found no commit {OLD} here; allowed: a clone with its history, or --old PROGRAM")
        with open(source / "CMakeLists.txt", "a", encoding="utf-8") as file:
            file.write("add_executable(frame_turns frame_turns.cpp)\ntarget_link_libraries(frame_turns PRIVATE obliq_options obliq_app "
                       "obliq_radar obliq_control CLI11::CLI11 nlohmann_json::nlohmann_json)\n")
    shutil.copy(bench, source / "frame_turns.cpp")
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DOBLIQ_TESTS=OFF", "-DOBLIQ_BENCHMARKS=OFF"]
    subprocess.run(["cmake", "-S", source, "-B", folder / "build", *options], check=True, stdout=sys.stderr)
    subprocess.run(["cmake", "--build", folder / "build", "--target", "frame_turns"], check=True, stdout=sys.stderr)
    return program


def measure(row, programs, turns):
    runs = {"ours": row.ours, "theirs": row.theirs}
    for run in runs.values():
        if not (ROOT / run.scene).exists():
            return {"missing": f"no {run.scene}"}
    started = {name: Program(run.command(programs)) for name, run in runs.items()}
    try:
        take_turns(started, turns)
    except ENDED as error:
        return {"missing": str(error) or "the program ended"}
    figures = {name: program.end() for name, program in started.items()}
    ratios = [ours["processor_s"] / theirs["processor_s"]
              for ours, theirs in zip(started["ours"].frames, started["theirs"].frames)]
    return figures | {"ratio": figures["ours"]["processor_s"] / figures["theirs"]["processor_s"],
                      "ratios": [min(ratios), max(ratios)], "energy": figures["ours"]["power_w"] / figures["theirs"]["power_w"] - 1}


def frontier(programs, row):
    """What `obliq frontier` says of one and two planes in each azimuth bin: `draft` and `standard`."""
    with tempfile.TemporaryDirectory() as folder:
        scene = ROOT / row.ours.scene
        if row.thinner:
            text = scene.read_text(encoding="utf-8")
            if row.thinner[0] not in text:
                return {"missing": f"{row.ours.scene}: found no \"{row.thinner[0]}\" to replace"}
            scene = pathlib.Path(folder) / "scene.toml"
            scene.write_text(text.replace(*row.thinner), encoding="utf-8")
        command = [programs["obliq"], "frontier", scene, *row.errors, "--kinds", "sweep", "--quick", "--repeats", "1",
                   "--out", f"{folder}/frontier"]
        ran = subprocess.run([str(word) for word in command], cwd=ROOT, capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            return {"missing": ran.stderr.strip().splitlines()[-1]}
        with open(f"{folder}/frontier/frontier.csv", encoding="utf-8", newline="") as file:
            found = {int(line["columns"]): line for line in csv.DictReader(file)
                     if line["returns"] == "all" and line["sub_columns"] == "64"}
    return {planes: {key: float(found[1024 * planes][key]) for key in ("power_error", "energy_error", "gap_fraction",
                                                                        "false_light", "false_light_energy", "buildings_missed",
                                                                        "buildings_visible")} for planes in (1, 2)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="this build's programs")
    parser.add_argument("--old", help=f"frame_turns of {OLD} (or of any other commit)")
    parser.add_argument("--turns", type=int, default=9)
    parser.add_argument("--only", action="append", choices=[row.name for row in ROWS])
    parser.add_argument("--errors", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    rows = [row for row in ROWS if not arguments.only or row.name in arguments.only]
    bin_folder = ROOT / arguments.bin
    programs = {False: bin_folder / "frame_turns", "obliq": bin_folder / "obliq"}
    if any(row.theirs.old for row in rows):
        programs[True] = pathlib.Path(arguments.old).resolve() if arguments.old else build_old()
    report = {"turns": arguments.turns, "load": os.getloadavg()[0], "old": OLD, "rows": {}}
    print(f"{'':66}{'ours':>9}{'theirs':>9}{'ratio':>7}{'to reach':>10}{'past it':>8}  ms of processor time, least of {arguments.turns}")
    for row in rows:
        figures = measure(row, programs, arguments.turns)
        figures |= {"what": row.what, "targets": row.targets}
        report["rows"][row.name] = figures
        if "missing" in figures:
            print(f"{row.what:66} {figures['missing']}", flush=True)
            continue
        ours, theirs = figures["ours"], figures["theirs"]
        print(f"{row.what:66}{1000 * ours['processor_s']:9.1f}{1000 * theirs['processor_s']:9.1f}{figures['ratio']:7.3f}"
              f"{row.targets[0]:10g}{row.targets[1]:8g}  wall {1000 * ours['wall_s']:.0f} / {1000 * theirs['wall_s']:.0f}, plan "
              f"{1000 * ours['plan_s']:.1f} / {1000 * theirs['plan_s']:.1f}, energy {figures['energy']:+.1e}, "
              f"seen {ours['seen']} / {theirs['seen']}, memory {ours['memory_mb']:.0f} (most {ours['most_memory_mb']:.0f}) / "
              f"{theirs['memory_mb']:.0f} MB, loaded in {ours['load_s']:.1f} / {theirs['load_s']:.1f} s", flush=True)
        if arguments.errors and row.errors:
            figures["errors"] = frontier(programs, row)
            for planes, e in figures["errors"].items():
                if planes == "missing":
                    print(f"  {e}", flush=True)
                    continue
                print(f"  {planes} planes: E {e['power_error']:.3g}, energy {e['energy_error']:+.2g}, gaps {100 * e['gap_fraction']:.3g} %, "
                      f"false light in {e['false_light']:.0f} bins ({e['false_light_energy']:.1g} of the energy), "
                      f"{e['buildings_missed']:.0f} of {e['buildings_visible']:.0f} buildings missed", flush=True)
    report["load_at_end"] = os.getloadavg()[0]
    if arguments.json:
        arguments.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
