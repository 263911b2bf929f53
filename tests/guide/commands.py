#!/usr/bin/env python3
"""server/apps/COMMANDS.md from what the programs say of themselves.

  commands.py --bin DIR [--check]     --check: fails where the page is another
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

COMMAND = "cmake --build --preset release --target generated"
PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "server" / "apps" / "COMMANDS.md"


def said(*words):
    # A terminal's width and the user's variables would show in it.
    kept = {name: value for name, value in os.environ.items() if not name.startswith("OBLIQ")}
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True, env=kept).stdout.rstrip()


def page(folder):
    overview = said(folder / "obliq", "--help")
    names = re.findall(r"^  (\w+) ", overview.split("Subcommands:")[1], re.M)
    parts = ["# Commands", "", f"Written by `{COMMAND}` from `--help`; do not edit. A test compares it.", "",
             "## obliqd", "", "```text", said(folder / "obliqd", "--help"), "```", ""]
    for name in names:
        parts += [f"## obliq {name}", "", "```text", said(folder / "obliq", name, "--help"), "```", ""]
    return "\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    text = page(given.bin)
    if not given.check:
        PAGE.write_text(text)
    elif PAGE.read_text() != text:
        sys.exit(f"{PAGE} is not what the programs say: run: {COMMAND}")
    else:
        print(f"{text.count('## ')} commands")


if __name__ == "__main__":
    main()
