#!/usr/bin/env python3
"""What frames cost beside those of a commit before, and what leaves by the wire: a row and a verdict for each target.

  tests/bench/cities.py [--quick] [--before BUILD [--keep]] [--bin FOLDER] [--only WORD]... [--errors] [--busy] [--json FILE]

BUILD is the build folder of the commit before (its bin/frame_turns runs in turn with this build's, frame by frame, which holds on
a machine that others use). Without it the figures before are those of cities.json for this processor and instruction set;
--keep writes them there. Make one where cities.json has none (15838fa is the commit that the targets were set beside):

  git worktree add ../before 15838fa && cd ../before && cmake --preset release -DOBLIQ_BENCHMARKS=ON
  cmake --build --preset release --target frame_turns obliq

Frames: the least of the turns' processor time (user and system, plan included, two threads), of a radar that moves on. --quick takes
fewer turns and no rows without a target: ten minutes at most. --errors adds E, gaps and missed houses by `obliq frontier` (some minutes).
"least" is reached, "past it" was hoped for. What the clock measures needs a load average below 0.5, or --busy. Ends with 1 where a row is missed.
"""
import argparse
import json
import os
import pathlib
import sys
import time
from dataclasses import dataclass
from typing import Callable

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/figures"))
import wire_rows  # noqa: E402
from house_errors import errors_of  # noqa: E402
from in_turn import ENDED, Program, take_turns  # noqa: E402
from speed_tables import BEAM  # noqa: E402

KEPT = ROOT / "tests/bench/cities.json"
QUIET = 0.5  # load average
HILLS, CITY, MILLION, FINE = (f"tests/bench/{name}.toml" for name in ("paper_hills", "city", "million", "fine"))
LOS_ANGELES, X_BAND = (f"deploy/scenes/{name}.toml" for name in ("losangeles", "x_band_sector"))
STANDARD = ("frustum.quality=standard",)
# A dwell of dwells.py: 16 of the scene's 120 degrees with 64 of its 512 bins.
DWELL = ("frustum.quality=draft", "radar.range_normalisation=false", "radar.sector_deg=16", "bins.azimuth=64", "bins.range=512",
         "beam.pattern=gaussian", "beam.width_deg=3", "pulse.kind=rectangular", "pulse.length_us=0.25", "receiver.noise=true")


@dataclass
class Run:
    """A scene as both builds render it."""
    scene: str
    sets: tuple = STANDARD
    bare: bool = False  # power and state alone
    turns: tuple = (9, 25)  # quick, else
    quick: bool = True

    def command(self, folder):
        words = [folder / "frame_turns", self.scene]
        for setting in self.sets:
            words += ["--set", setting]
        return words + (["--bare"] if self.bare else [])


# In turn within a group, so that differences of its runs hold.
GROUPS = [
    {"hills": Run(HILLS), "hills_power": Run(HILLS, bare=True), "beam": Run(HILLS, (*BEAM, "radar.speckle=ground")),
     "beam_independent": Run(HILLS, (*BEAM, "radar.speckle=independent"))},
    {"draft": Run(HILLS, ("frustum.quality=draft",), bare=True)},
    {"city": Run(CITY)},
    {"million": Run(MILLION, turns=(4, 9))},
    {"dwell": Run(LOS_ANGELES, DWELL, turns=(25, 75))},
    {"losangeles": Run(LOS_ANGELES, quick=False)},
    {"fine": Run(FINE, quick=False)},
    {"spread": Run(HILLS, ("frustum.quality=oblique", "frustum.plates=spread"), quick=False)},
    {"x_band": Run(X_BAND, (), quick=False)},
]


def processor(run, less=None):
    """ms"""
    return lambda figures: 1000 * (figures[run]["processor_s"] - (figures[less]["processor_s"] if less else 0))


def memory(run, key):
    """MB"""
    return lambda figures: figures[run][key]


@dataclass
class Row:
    """New over before of one figure."""
    name: str
    least: float
    past: float
    figure: Callable
    runs: tuple
    unit: str = "ms"


ROWS = [
    Row("hills, standard, I&Q", 0.75, 0.52, processor("hills"), ("hills",)),
    Row("bare hills, draft, power and state", 0.65, 0.45, processor("draft"), ("draft",)),
    Row("100,000 houses", 0.65, 0.50, processor("city"), ("city",)),
    Row("a million houses", 0.50, 0.35, processor("million"), ("million",)),
    Row("memory with 1.65 million houses", 0.6, 0.5, memory("million", "memory_mb"), ("million",), "MB"),
    Row("the same at most", 0.7, 0.6, memory("million", "most_memory_mb"), ("million",), "MB"),
    Row("dwell of 16 degrees, 64 x 512 bins, Los Angeles", 0.75, 0.60, processor("dwell"), ("dwell",)),
    Row("ground speckle beyond power alone", 0.5, 0.4, processor("hills", "hills_power"), ("hills", "hills_power")),
    Row("ground speckle beyond independent, beam", 0.6, 0.4, processor("beam", "beam_independent"), ("beam", "beam_independent")),
    Row("Los Angeles, standard", 1.02, 1.0, processor("losangeles"), ("losangeles",)),
    Row("posts of 10 m (fine.toml)", 1.02, 1.0, processor("fine"), ("fine",)),
    Row("oblique, spread plates", 1.02, 1.0, processor("spread"), ("spread",)),
    Row("x_band_sector.toml", 1.02, 1.0, processor("x_band"), ("x_band",)),
]
# Frames a second of two threads.
GOALS = [("bare hills", "hills", 40), ("100,000 houses", "city", 20), ("a million houses", "million", 5)]
DWELL_GOAL_S = 0.015


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        fields = dict(line.strip().split(":", 1) for line in file if ":" in line)
    fields = {key.strip(): value.strip() for key, value in fields.items()}
    flags = fields.get("flags", "").split()
    # As server/radar/simd/kernels.cpp chooses.
    isa = "AVX-512" if {"avx512f", "avx512dq", "avx512vl", "avx512bw"} <= set(flags) else "AVX2" if "avx2" in flags else "baseline"
    return {"processor": f"{fields.get('model name', 'unknown')}, family {fields.get('cpu family', '?')}, model {fields.get('model', '?')}",
            "instruction_set": isa}


def measure(group, folders, quick):
    """Figures by folder and run; a text where one of the programs ends."""
    lacking = [run.scene for run in group.values() if not (ROOT / run.scene).exists()]
    if lacking:
        return f"no {lacking[0]}"
    programs = {(which, name): Program(run.command(folder)) for name, run in group.items() for which, folder in folders.items()}
    try:
        take_turns(programs, min(run.turns[0 if quick else 1] for run in group.values()))
    except ENDED as error:
        return str(error) or "a frame_turns ended"
    figures = {which: {} for which in folders}
    for (which, name), program in programs.items():
        figures[which][name] = program.end()
    return figures


def measure_all(folders, wanted, quick):
    figures, lacking = {which: {} for which in folders}, {}
    for group in GROUPS:
        chosen = {name: run for name, run in group.items() if name in wanted}
        if not chosen:
            continue
        print(f"cities.py: {', '.join(chosen)}", file=sys.stderr, flush=True)
        found = measure(chosen, folders, quick)
        if isinstance(found, str):
            lacking |= dict.fromkeys(chosen, found)
            continue
        for which, of in found.items():
            figures[which] |= of
    return figures, lacking


def verdict(value, least, past):
    """Ratios are to be low where `past` is below `least`, else high."""
    sign = 1 if past <= least else -1
    if sign * value <= sign * past:
        return "past it"
    return "least" if sign * value <= sign * least else f"MISSED by {100 * abs(value / least - 1):.0f} %"


def say(name, value, least, past, words):
    print(f"{name:49}{value if isinstance(value, str) else f'{value:.3f}':>8}{least:>7g}{past:>8g}  {words}", flush=True)


def frame_row(row, figures, before, lacking, why_none):
    """Value or None, and verdict."""
    why = next((lacking[name] for name in row.runs if name in lacking), None)
    if not why and (not before or any(name not in before for name in row.runs)):
        why = why_none
    if why:
        return None, f"not measured: {why}"
    new, old = row.figure(figures), row.figure(before)
    return new / old, f"{verdict(new / old, row.least, row.past)}; {new:.1f} for {old:.1f} {row.unit}"


def say_goals(figures, quiet):
    print("\ngoals of two cores" + ("" if quiet else "; others are at work: two threads' processor time, as if both cores were theirs"))
    for name, run, goal in GOALS:
        if run not in figures:
            continue
        rate = 1 / (figures[run]["wall_s"] if quiet else figures[run]["processor_s"] / 2)
        print(f"{name:49}{rate:8.1f} of {goal} frames/s: {100 * rate / goal:.0f} %")
    if "dwell" in figures:
        took_s = figures["dwell"]["processor_s"]
        print(f"{'a dwell of 16 degrees in a city':49}{1000 * took_s:8.1f} ms of processor time, wanted {1000 * DWELL_GOAL_S:.0f}: "
              f"{took_s / DWELL_GOAL_S:.2f} times it")


def choose(rows, words):
    return [row for row in rows if not words or any(word in row.name for word in words)]


def kept_before(where):
    """The figures before of this machine, and the line that says which."""
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else []
    one = next((k for k in kept if k["machine"] == where), None)
    return one, f"{one['commit']}, {one['date']}, load {one['load']}, from {KEPT.name}" if one else f"none in {KEPT.name} for this machine"


def keep(where, commit, load, before):
    kept = [k for k in json.loads(KEPT.read_text(encoding="utf-8")) if k["machine"] != where] if KEPT.exists() else []
    keys = ("processor_s", "wall_s", "memory_mb", "most_memory_mb")
    kept.append({"machine": where, "commit": commit, "date": time.strftime("%Y-%m-%d"), "load": round(load, 1),
                 "runs": {name: {key: float(f"{f[key]:.4g}") for key in keys} for name, f in before.items()}})
    KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--before", type=pathlib.Path, metavar="BUILD")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin", help="this build's programs")
    parser.add_argument("--only", action="append", metavar="WORD", help="rows whose name has it")
    parser.add_argument("--errors", action="store_true")
    parser.add_argument("--busy", action="store_true", help="measure by the clock though others are at work")
    parser.add_argument("--json", type=pathlib.Path)
    given = parser.parse_args()
    load, where = os.getloadavg()[0], machine()
    quiet = load < QUIET
    new = given.bin.resolve()
    kept, said = kept_before(where)
    folders = {"new": new}
    if given.before:
        folders["before"] = given.before.resolve() / "bin"
        commit = wire_rows.commit_of(given.before)
        said = f"{commit}, in turn"
    print(f"{where['processor']}, {os.cpu_count()} threads, {where['instruction_set']}; load average {load:.1f}; before: {said}")
    if where["instruction_set"] != "AVX-512":
        print("AVX-512: not measured: this processor has none; run this on one that has")
    rows = choose([row for row in ROWS if not given.quick or row.past < 1], given.only)
    figures, lacking = measure_all(folders, {name for row in rows for name in row.runs}, given.quick)
    before, why_none = figures.get("before"), f"no figures before for this machine; allowed: --before BUILD, or {KEPT.name} with them"
    if not given.before and kept:
        before = kept["runs"]
        if not quiet and not given.busy:
            before, why_none = None, f"load {load:.1f}: figures of another time do not compare; allowed: --before BUILD, or --busy"
    if given.before and given.keep:
        keep(where, commit, load, before)
    print(f"\n{'':49}{'ratio':>8}{'least':>7}{'past it':>8}")
    results = {}
    for row in rows:
        value, words = frame_row(row, figures["new"], before, lacking, why_none)
        results[row.name] = {"value": value, "least": row.least, "past": row.past, "verdict": words}
        say(row.name, "" if value is None else value, row.least, row.past, words)
    for row in choose(wire_rows.ROWS, given.only):
        value, words = None, f"not measured: load {load:.1f}, by the clock; allowed: below {QUIET}, or --busy"
        if quiet or given.busy:
            value, words = row.measure(new, given.quick)
            if value is not None:
                words = verdict(value, row.least, row.past) + (f"; {words}" if words else "") + ("" if quiet else f"; load {load:.1f}")
        results[row.name] = {"value": value, "least": row.least, "past": row.past, "verdict": words}
        say(row.name, "" if value is None else value, row.least, row.past, words)
    if figures["new"]:
        say_goals(figures["new"], quiet)
    if given.errors:
        print()
        for name, scene in (("hills", HILLS), ("city", CITY), ("million", MILLION), ("dwell", LOS_ANGELES)):
            for line in errors_of(new / "obliq", ROOT / scene) if name in figures["new"] else ():
                print(f"{scene}: {line}", flush=True)
    if given.json:
        given.json.write_text(json.dumps({"machine": where, "load": load, "before": said, "rows": results, "figures": figures}, indent=1) + "\n",
                              encoding="utf-8")
    return 1 if any("MISSED" in result["verdict"] for result in results.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
