#!/usr/bin/env python3
"""A key of the scene file is one that was there before, or CHANGES.md names it.

  keys.py              exit code 1 and a line for each new key that CHANGES.md does not name
  keys.py --release    adds all keys to released_keys.txt: of a release, and never before
  keys.py --self-test  a planted key is found

The keys are those of PARAMETERS.md, which the programs write from their tables; the list of before is released_keys.txt.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARAMETERS, CHANGES, RELEASED = ROOT / "server/control/PARAMETERS.md", ROOT / "CHANGES.md", ROOT / "tests/checks/released_keys.txt"


def keys_of(parameters):
    """First columns of the tables whose head is "key"."""
    found, in_table = set(), False
    for line in parameters.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if not line.startswith("|"):
            in_table = False
        elif cells[1] == "key":
            in_table = True
        elif in_table and cells[1].startswith("`"):
            found.add(cells[1].strip("`"))
    return found


def faults_of(parameters, changes, released):
    """changes names a key as `key` or `key = value`."""
    named = set(re.findall(r"`([\w.]+)[ =`]", changes))
    return [f"{key}: a new key of the scene file, and CHANGES.md does not name it" for key in sorted(keys_of(parameters) - released - named)]


def self_test():
    table = "| key | type |\n|---|---|\n| `radar.old_m` | number |\n| `radar.new_m` | number |\n\n| name | |\n|---|---|\n| `other` | |\n"
    assert keys_of(table) == {"radar.old_m", "radar.new_m"}
    assert len(faults_of(table, "- `radar.newer_m`, radar.new_m\n", {"radar.old_m"})) == 1
    assert not faults_of(table, "- `radar.new_m`\n", {"radar.old_m"})
    assert not faults_of(table, "- `radar.new_m = 3`\n", {"radar.old_m"})
    print("a planted key is found")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    parameters = PARAMETERS.read_text(encoding="utf-8")
    if len(keys_of(parameters)) < 200:
        sys.exit(f"{PARAMETERS}: found {len(keys_of(parameters))} keys; allowed: 200 and more")
    if sys.argv[1:] == ["--release"]:
        RELEASED.write_text("\n".join(sorted(keys_of(parameters) | set(RELEASED.read_text().split()))) + "\n", encoding="utf-8")
        return None
    found = faults_of(parameters, CHANGES.read_text(encoding="utf-8"), set(RELEASED.read_text(encoding="utf-8").split()))
    print("\n".join(found) or "every new key is named in CHANGES.md")
    return sys.exit(bool(found))


if __name__ == "__main__":
    main()
