#!/usr/bin/env python3
"""Processor time of frames under several settings, one frame of each in turn: ratios hold on a machine that is not quiet.

  tests/bench/in_turn.py SCENE.toml --run NAME [KEY=VALUE...] [--run ...] [--turns N] [--json FILE] [--bin FOLDER]

Each run is a frame_turns that keeps its scene and moves on from frame to frame; figures are the least of N frames, plan included.
"""
import argparse
import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENDED = (RuntimeError, IndexError, ValueError, BrokenPipeError)  # of a program that did


class Program:
    """A frame_turns, which keeps its scene."""

    def __init__(self, command):
        self.command = command
        self.process = None
        self.frames = []

    def start(self):
        """Until its scene is loaded."""
        self.process = subprocess.Popen([str(word) for word in self.command], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        if self.process.stdout.readline().strip() != "ready":
            raise RuntimeError(self.process.stderr.read().strip().splitlines()[-1])

    def turn(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        self.frames.append(json.loads(self.process.stdout.readline()))

    def kill(self):
        if self.process:
            self.process.kill()
            self.process.wait()

    def end(self):
        """Figures of all its frames: the least times."""
        memory = pathlib.Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8").splitlines()
        self.process.stdin.close()
        self.process.wait()
        figures = {key: min(frame[key] for frame in self.frames) for key in ("processor_s", "wall_s", "plan_s")}
        figures |= {key: self.frames[0][key] for key in ("load_s", "power_w", "samples", "buildings", "seen")}
        for line in memory:
            for key, name in (("VmRSS", "memory_mb"), ("VmHWM", "most_memory_mb")):
                if line.startswith(key + ":"):
                    figures[name] = int(line.split()[1]) / 1024
        return figures


def take_turns(programs, turns):
    """So many frames of each, by name; one of ENDED, with no program left, where one ends."""
    names = list(programs)
    try:
        for program in programs.values():
            program.start()  # one after the other: loading takes all threads
        for turn in range(turns):
            for name in (names if turn % 2 == 0 else names[::-1]):
                programs[name].turn()
    except ENDED:
        for program in programs.values():
            program.kill()
        raise


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--run", action="append", nargs="+", required=True, metavar=("NAME", "KEY=VALUE"))
    parser.add_argument("--turns", type=int, default=9)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--bin", default="build/release/bin")
    given = parser.parse_args()
    programs = {name: Program([ROOT / given.bin / "frame_turns", given.scene, *(word for one in sets for word in ("--set", one))])
                for name, *sets in given.run}
    take_turns(programs, given.turns)
    figures = {name: program.end() for name, program in programs.items()}
    for name, f in figures.items():
        print(f"{name:40} {1000 * f['processor_s']:8.1f} ms of processor time, {1000 * f['wall_s']:8.1f} ms")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
