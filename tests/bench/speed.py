#!/usr/bin/env python3
"""The tables of SPEED.md and the short one of README.md: measured, kept and written by this script, all figures from one run.

  tests/bench/speed.py [--without PART]... [--bin FOLDER]   runs the programs, writes speed.json and the tables
  tests/bench/speed.py --again PART                         measures one part anew, which SPEED.md then says
  tests/bench/speed.py --write                              writes the tables from speed.json
  tests/bench/speed.py --check                              fails when the tables are not what speed.json gives

A program that is missing or fails leaves its part out, and SPEED.md says so. Leave the machine alone for a run whose
figures are published: the load average is published with them.
"""
import argparse
import difflib
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import speed_parts

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIGURES = ROOT / "tests/bench/speed.json"
README = ROOT / "README.md"
SPEED = ROOT / "tests/bench/SPEED.md"
BEGIN = "<!-- Written by tests/bench/speed.py from tests/bench/speed.json: do not edit. -->"
END = "<!-- End of what tests/bench/speed.py writes. -->"
LONGEST_S = 3600  # of one program
BUSY = 1.0        # load average before the run above which others had a part of the machine


def machine():
    """Where and when; load: the average of the last minute, before anything was run."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    return {"processor": names[0] if names else "unknown", "threads": os.cpu_count(), "date": time.strftime("%Y-%m-%d"),
            "commit": commit.stdout.strip(), "load": os.getloadavg()[0]}


def run_part(part, bin_folder, folder):
    """What a part's programs have written; {"missing": why} when one of them cannot be run."""
    results = []
    for command in part.commands(bin_folder, folder):
        name = " ".join(os.path.basename(word) for word in command[:1])
        if not os.access(ROOT / command[0], os.X_OK):
            return {"missing": f"`{name}` is not built"}
        print("speed.py:", " ".join(map(str, command)), flush=True)
        try:
            ran = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=LONGEST_S, check=False)
        except subprocess.TimeoutExpired:
            return {"missing": f"`{name}` took longer than {LONGEST_S} s"}
        if ran.returncode != 0:
            return {"missing": f"`{name}` ended with exit code {ran.returncode}"}
        results.append(ran.stdout)
    return part.collect(results, folder)


def measure(bin_folder, without):
    report = {"machine": machine(), "parts": {}}
    for part in speed_parts.PARTS:
        if part.name in without:
            report["parts"][part.name] = {"missing": "not part of this run"}
            continue
        with tempfile.TemporaryDirectory() as folder:
            report["parts"][part.name] = run_part(part, bin_folder, pathlib.Path(folder))
    report["machine"]["load_at_end"] = os.getloadavg()[0]
    FIGURES.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


def measure_again(bin_folder, name):
    """One part in a run of its own, beside the figures that are kept."""
    report = json.loads(FIGURES.read_text(encoding="utf-8"))
    part = next(part for part in speed_parts.PARTS if part.name == name)
    where = machine()
    with tempfile.TemporaryDirectory() as folder:
        report["parts"][name] = run_part(part, bin_folder, pathlib.Path(folder)) | {"again": where}
    FIGURES.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


def section(report):
    where = report["machine"]
    text = [f"{where['processor']}, {where['threads']} threads, {where['date']}, commit {where['commit']}; load average "
            f"{where['load']:.1f} before the run and {where['load_at_end']:.1f} after it. All figures are from this run of "
            "`tests/bench/speed.py`, which also writes this section."]
    if where["load"] > BUSY:
        text.append("**The machine was not alone**: times are longer than they need be; ratios and shares hold better.")
    left_out = []
    for part in speed_parts.PARTS:
        figures = report["parts"].get(part.name, {"missing": "not part of this run"})
        if "missing" in figures:
            left_out.append(f"{part.title[0].lower()}{part.title[1:]} ({figures['missing']})")
        else:
            again = figures.get("again")
            apart = f" (In a run of its own: {again['date']}, commit {again['commit']}, load average {again['load']:.1f}.)" if again else ""
            figures = {key: value for key, value in figures.items() if key != "again"}
            text.append(f"**{part.title}.**{apart} " + part.words(figures))
    if left_out:
        text.append("Not in this run: " + "; ".join(left_out) + ".")
    return "\n\n".join(text)


def short_section(report):
    """README's table: a few rows of the same figures."""
    where = report["machine"]
    rows = [row for name, few in speed_parts.SHORT for figures in [report["parts"].get(name, {"missing": ""})]
            if "missing" not in figures for row in few(figures)]
    return (f"{where['processor']}, {where['threads']} threads, {where['date']}, commit {where['commit']}."
            + speed_parts.table(["what", "result"], rows))


def with_section(page, text):
    before, rest = page.split(BEGIN + "\n")
    _, after = rest.split(END + "\n")
    return f"{before}{BEGIN}\n\n{text}\n\n{END}\n{after}"


def settle(path, text, check):
    """Writes the page's section; with `check`, only compares it."""
    page = path.read_text(encoding="utf-8")
    wanted = with_section(page, text)
    if not check:
        path.write_text(wanted, encoding="utf-8")
    elif page != wanted:
        sys.stdout.writelines(difflib.unified_diff(page.splitlines(True), wanted.splitlines(True), path.name, "from speed.json"))
        sys.exit(f"{path.name}: found other figures than speed.json gives; run tests/bench/speed.py --write")
    else:
        print(f"{path.name} has the figures of speed.json")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="where the programs are")
    parser.add_argument("--without", action="append", default=[], choices=[part.name for part in speed_parts.PARTS])
    parser.add_argument("--again", choices=[part.name for part in speed_parts.PARTS])
    parser.add_argument("--write", action="store_true", help="only write the tables")
    parser.add_argument("--check", action="store_true", help="only compare the tables")
    arguments = parser.parse_args()
    if arguments.again:
        measure_again((ROOT / arguments.bin).resolve(), arguments.again)
    elif not arguments.write and not arguments.check:
        measure((ROOT / arguments.bin).resolve(), arguments.without)
    report = json.loads(FIGURES.read_text(encoding="utf-8"))
    settle(SPEED, section(report), arguments.check)
    settle(README, short_section(report), arguments.check)


if __name__ == "__main__":
    main()
