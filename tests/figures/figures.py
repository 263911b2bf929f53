#!/usr/bin/env python3
"""Tables of figures in documents: measured, kept as JSON, written between the markers of the documents, compared with them.

  tests/figures/figures.py                     writes every table from the figures that are kept
  tests/figures/figures.py --check             fails where a document has other tables than those figures give
  tests/figures/figures.py --measure [NAME...] measures and keeps anew, then writes; without names the parts marked * by --list,
                                               "all": every part, an hour or more
  tests/figures/figures.py --list              the parts: how old, what they took, what they run
  tests/figures/figures.py --age               one line: which figures are older than the code that they are of
  tests/figures/figures.py --release           the same with exit code 1 where one is: deploy/release-check.sh

Figures of speed are in tests/bench/speed.json, declared by speed_tables.py beside it; those of accuracy in
tests/accuracy/accuracy.json, by accuracy_tables.py. A part whose program is missing or fails keeps its old figures. Leave the
machine alone for a run whose figures are published: the load average is published with them.
"""
import argparse
import difflib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/bench"), str(ROOT / "tests/accuracy"), str(ROOT / "tests/figures")]
import accuracy_tables  # noqa: E402
import speed_tables  # noqa: E402
from tables import table  # noqa: E402

KEPT = {"speed": ROOT / "tests/bench/speed.json", "accuracy": ROOT / "tests/accuracy/accuracy.json"}
PARTS = {"speed": speed_tables.PARTS, "accuracy": accuracy_tables.PARTS}
SHORT = {"speed": speed_tables.SHORT, "accuracy": accuracy_tables.SHORT}
# The code that figures are of.
MEASURED = ("server/radar", "server/scene")
# The blocks of each document, in order. A text is a list that several documents show.
DOCUMENTS = {
    "README.md": ["speed.short_qualities", "accuracy.short_checks", "speed.short_frames"],
    "client/guide/model.md": ["accuracy.short_coherence", "text.not_modelled", "text.known_faults"],
    "tests/bench/SPEED.md": [f"speed.{part.name}" for part in speed_tables.PARTS],
    "tests/accuracy/ACCURACY.md": [f"accuracy.{part.name}" for part in accuracy_tables.PARTS],
}
TEXTS = {"text.not_modelled": ROOT / "client/guide/not_modelled.txt", "text.known_faults": ROOT / "client/guide/known_faults.txt"}
# Documents all of whose tables are of figures.
NO_OTHER_TABLES = ("tests/bench/SPEED.md", "tests/accuracy/ACCURACY.md")
BLOCK = re.compile(r"^<!-- (?:figures|text): ([\w.]+), written by tests/figures/figures\.py: do not edit -->\n(.*?)^<!-- end -->$", re.M | re.S)
LONGEST_S = 3600  # of one program


# ---- Measuring

def git(*words):
    """None: no git, or no history."""
    try:
        ran = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return None
    return ran.stdout.strip() if ran.returncode == 0 else None


def version():
    return re.search(r"project\(obliq VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)


def here():
    """Where and when; load: the average of the last minute, before anything was run."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    changed = git("status", "--porcelain", "--", *MEASURED)
    return {"processor": names[0] if names else "unknown", "threads": os.cpu_count(), "date": time.strftime("%Y-%m-%d"),
            "version": version(), "commit": (git("rev-parse", "--short", "HEAD") or "unknown") + ("-changed" if changed else ""),
            "load": round(os.getloadavg()[0], 1)}


def measured(part, programs):
    """The part as it is kept; a text: why it could not be measured."""
    where, start = here(), time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        outputs = []
        for command in part.commands(programs, pathlib.Path(folder)):
            print("figures.py:", " ".join(map(str, command)), flush=True)
            if not os.access(ROOT / command[0], os.X_OK):
                return f"{command[0]} is not built"
            try:
                ran = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=LONGEST_S, check=False,
                                     env={**os.environ, "OBLIQ_CACHE_DIR": ""})
            except subprocess.TimeoutExpired:
                return f"{command[0]} took longer than {LONGEST_S} s"
            if ran.returncode != 0:
                return f"{command[0]} ended with exit code {ran.returncode}: {ran.stdout[-2000:]}"
            outputs.append(ran.stdout)
        try:
            figures = part.collect(outputs, pathlib.Path(folder))
            part.words(figures)
        except (RuntimeError, OSError, KeyError, IndexError, StopIteration) as error:  # a skipped test, a result that is not there
            return repr(error)
    return {"where": {**where, "seconds": round(time.monotonic() - start)}, "figures": figures}


def measure(programs, names):
    failed, start = [], time.monotonic()
    for document, parts in PARTS.items():
        for part in parts:
            if part.name not in names:
                continue
            found = measured(part, programs)
            if isinstance(found, str):
                failed.append(part.name)
                print(f"figures.py: {part.name} keeps its old figures: {found}", file=sys.stderr)
                continue
            print(f"figures.py: {part.name} took {found['where']['seconds']} s", flush=True)
            kept = load(document)
            kept[part.name] = found
            # Each part is kept as soon as it is there.
            KEPT[document].write_text(json.dumps({p.name: kept[p.name] for p in parts if p.name in kept}, indent=1) + "\n", encoding="utf-8")
    print(f"figures.py: {len(names) - len(failed)} parts in {time.monotonic() - start:.0f} s" + (f"; not {', '.join(failed)}" if failed else ""))
    return failed


# ---- Writing

def load(document):
    return json.loads(KEPT[document].read_text(encoding="utf-8"))


def measured_where(where):
    load = "load not recorded" if where["load"] is None else f"load average {where['load']:.1f} before the run"
    return f"*{where['processor']}, {where['threads']} threads; {where['date']}, commit {where['commit']}, version {where['version']}; {load}.*"


def block(name, kept):
    """The text of a block, by its name."""
    if name in TEXTS:
        return TEXTS[name].read_text(encoding="utf-8").rstrip()
    document, name = name.split(".")
    if name in SHORT[document]:
        head, rows = SHORT[document][name]
        try:
            return table(head, rows(kept[document])).strip()
        except KeyError as missing:
            return f"Not measured yet: {missing}."
    part = next(part for part in PARTS[document] if part.name == name)
    if name not in kept[document]:
        return f"**{part.title}.** Not measured yet."
    found = kept[document][name]
    return f"**{part.title}.** {part.words(found['figures'])}\n\n{measured_where(found['where'])}"


def written(path, page, kept):
    """The page with its blocks as they should be; exits where a marker is missing."""
    found = [match.group(1) for match in BLOCK.finditer(page)]
    if found != DOCUMENTS[path]:
        sys.exit(f"{path}: found the blocks {', '.join(found) or 'none'}; allowed: {', '.join(DOCUMENTS[path])}")
    return BLOCK.sub(lambda match: f"{match.group(0).splitlines()[0]}\n\n{block(match.group(1), kept)}\n\n<!-- end -->", page)


def faults_of(path, page, kept):
    wanted = written(path, page, kept)
    faults = list(difflib.unified_diff(page.splitlines(True), wanted.splitlines(True), path, "from the figures that are kept"))
    if path in NO_OTHER_TABLES and re.search(r"^\|", BLOCK.sub("", page), re.M):
        faults.append(f"{path}: found a table that is not written from figures\n")
    return faults


def settle(check):
    kept = {document: load(document) for document in KEPT}
    faults = []
    for path in DOCUMENTS:
        page = (ROOT / path).read_text(encoding="utf-8")
        if check:
            faults += faults_of(path, page, kept)
        else:
            (ROOT / path).write_text(written(path, page, kept), encoding="utf-8")
    if faults:
        sys.stdout.writelines(faults)
        sys.exit("documents have other figures than those that are kept; run: cmake --build --preset release --target generated")
    print(f"{len(DOCUMENTS)} documents have the figures that are kept")


# ---- Age

def newer_change(commit):
    """The last change of the measured code after a commit, as words; "": none."""
    if git("cat-file", "-e", f"{commit}^{{commit}}") is None:
        return "a commit that is not in this history"
    return git("log", "-1", "--format=older than %h (%s)", f"{commit}..HEAD", "--", *MEASURED)


def aged():
    """Parts whose figures are not of this code, with the reason; None: nothing can be said, without git's history."""
    ours, found, said = version(), {}, {}
    if git("rev-parse", "HEAD") is None:
        return None
    for document, parts in PARTS.items():
        kept = load(document)
        for part in parts:
            where = kept.get(part.name, {}).get("where")
            if where is None:
                found[part.name] = "never measured"
            elif where["version"].split(".")[:2] != ours.split(".")[:2]:
                found[part.name] = f"of version {where['version']}, not {ours}"
            elif why := said.setdefault(where["commit"], newer_change(where["commit"])):
                found[part.name] = why
    return found


def say_age(release):
    found, count = aged(), sum(map(len, PARTS.values()))
    if found is None:
        print("figures: no git history here, so their age cannot be told")
        sys.exit(release)
    if not found:
        print(f"figures: all {count} parts are of version {version()} and of the present {' and '.join(MEASURED)}")
    elif not release:
        print(f"figures: {len(found)} of {count} parts are older than the code that they are of: tests/figures/figures.py --list")
    else:
        sys.exit("\n".join(f"figures of {name}: {why}; allowed: version {version()}, after the last change of {' and '.join(MEASURED)}: "
                           f"tests/figures/figures.py --measure {name}" for name, why in found.items()))


def list_parts():
    found = aged() or {}
    for document, parts in PARTS.items():
        kept = load(document)
        for part in parts:
            where = kept.get(part.name, {}).get("where", {})
            print(f"{'*' if part.quick else ' '} {part.name:12} {document:8} {where.get('date', 'never'):10} {str(where.get('seconds', '?')):>4} s  {found.get(part.name, '')}")
            for command in part.commands(pathlib.Path("build/release/bin"), pathlib.Path("FOLDER")):
                print("     ", " ".join(map(str, command)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="where the programs are")
    parser.add_argument("--measure", nargs="*", metavar="NAME")
    for flag in ("check", "list", "age", "release"):
        parser.add_argument(f"--{flag}", action="store_true")
    arguments = parser.parse_args()
    every = {part.name: part for parts in PARTS.values() for part in parts}
    if arguments.list:
        return list_parts()
    if arguments.age or arguments.release:
        return say_age(arguments.release)
    failed = []
    if arguments.measure is not None:
        names = arguments.measure or [name for name, part in every.items() if part.quick]
        if names == ["all"]:
            names = list(every)
        unknown = [name for name in names if name not in every]
        if unknown:
            parser.error(f"--measure: found {', '.join(unknown)}; allowed: all, {', '.join(every)}")
        failed = measure(pathlib.Path(arguments.bin), names)
    settle(arguments.check)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
