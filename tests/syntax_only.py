#!/usr/bin/env python3
"""Reads the sources of a build tree with its compiler and its flags, writes nothing: warnings and errors in a fraction of a build's time.

  syntax_only.py BUILD [--but-for OTHER] [--jobs N]

What a source includes and is made by the build must be there. --but-for: another build tree by the same compiler, whose objects need not
be read again. Exits with 1 when a source does not compile.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--but-for", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()

    sources = {}  # by the object that they become
    for entry in json.loads((args.build / "compile_commands.json").read_text()):
        command, output = re.fullmatch(r"(.*) -o (\S+) -c \S+", entry["command"]).groups()
        if output.endswith(".pch") or (args.but_for and (args.but_for / output).exists()):
            continue
        sources[output] = f"{command} -fsyntax-only {entry['file']}", entry["directory"]

    def read(output):
        command, folder = sources[output]
        return subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True)

    failed = 0
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for output, done in zip(sources, pool.map(read, sources)):
            if done.returncode != 0:
                failed += 1
                print(f"{output}\n{done.stderr}", file=sys.stderr)
    print(f"{len(sources)} sources read, {failed} of them do not compile")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
