"""python -m obliq.batch poses.jsonl --out DIR (--server HOST:PORT | --local SCENE.toml) ...

Exit code 0: the data set, or this share of it, is whole; 2: it is, but for poses that the server refused, which
failed.jsonl lists; 1: not, run it again. --check renders nothing: 0: all poses are good, 2: not all. --self-test: 0: good.
"""
from __future__ import annotations

import argparse
import concurrent.futures
import multiprocessing
import sys
import types
from collections.abc import Sequence
from typing import Any

from ._sets.batch import batch, check
from ._sets.progress import Done
from .errors import ObliqError
from .parameters import Settings


def setting(text: str) -> tuple[str, object]:
    """KEY=VALUE, by the scene file's name or by Python's."""
    key, equals, value = text.partition("=")
    name = Settings.keys.get(key, key)
    if not equals or name not in Settings.names():
        raise argparse.ArgumentTypeError(f"found {text!r}; allowed: KEY=VALUE with a key of the radar, such as radar.r_max_m")
    if name in Settings.choices:
        return name, value
    if value in ("true", "false"):
        return name, value == "true"
    try:
        return name, int(value) if value.lstrip("+-").isdigit() else float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{key}: found {value!r}; allowed: a number") from None


def arguments(words: Sequence[str] | None) -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(prog="python -m obliq.batch", description="Render many poses into a data set. Run it "
                                     "again after any failure: it does what is missing.")
    parser.add_argument("poses", nargs="?", help="JSON lines: {\"id\": \"a17\", \"latitude_deg\": ..., \"bearing_deg\": ..., "
                        "\"r_max_m\": ...}, any field of a pose and of the settings; \"meta\": {...}, your own columns; "
                        "\"split\": \"train\"; \"scene\": \"b.toml\", the path of another scene file")
    parser.add_argument("--out", help="folder of the data set")
    parser.add_argument("--check", action="store_true", help="judge all poses, render none, write nothing")
    parser.add_argument("--self-test", action="store_true", help="make a small data set and look at it")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--server", metavar="HOST:PORT")
    where.add_argument("--local", metavar="SCENE.toml", help="start obliqd, and stop it at the end; each worker its own")
    parser.add_argument("--obliqd", help="the program for --local")
    parser.add_argument("--planes", default="iq,state")
    parser.add_argument("--area", choices=("poses", "scene"), default="poses", help="with --local: load the ground that the poses "
                        "reach, where the scene file names no terrain.area (the default), or what the scene says")
    parser.add_argument("--min-coverage", type=float, default=0.0, metavar="SHARE", help="a frame with less ground in its sector "
                        "fails, such as 0.95")
    parser.add_argument("--set", type=setting, action="append", default=[], metavar="KEY=VALUE", help="of all frames; else as "
                        "the server's radar has it")
    parser.add_argument("--radar", help="whose settings are taken; default: main, or the first")
    parser.add_argument("--seed", type=int, default=0, help="each frame has noise and independent speckle of its own, which "
                        "follow from this number and the pose's place in the data set; default 0")
    parser.add_argument("--speckle-per-frame", action="store_true", help="the ground's speckle is another in each frame, too")
    parser.add_argument("--shard-size", type=int, default=64, help="frames a part")
    parser.add_argument("--shard", metavar="I/N", help="do one share in N, I from 0 or 1; as in an Indexed Job")
    parser.add_argument("--workers", type=int, default=1, help="processes on this machine")
    parser.add_argument("--token-file")
    parser.add_argument("--tls", action="store_true")
    parser.add_argument("--ca", metavar="FILE")
    given = parser.parse_args(words)
    if not given.self_test:
        if given.poses is None or (given.out is None and not given.check):
            parser.error("the following arguments are required: poses, --out (or --check), --server or --local")
    return given


def main(words: Sequence[str] | None = None) -> int:
    """The program; its exit code."""
    given = arguments(words)
    options: dict[str, Any] = {
        "server": given.server, "local": given.local, "planes": given.planes, "settings": dict(given.set), "radar": given.radar,
        "seed": given.seed, "speckle_per_frame": given.speckle_per_frame, "shard_size": given.shard_size,
        "token_file": given.token_file, "tls": given.tls, "ca_file": given.ca, "obliqd": given.obliqd, "area": given.area,
        "min_coverage": given.min_coverage}
    try:
        if given.self_test:
            from ._sets.self_test import self_test

            return 0 if self_test(given.obliqd) else 1
        if given.check:
            checked = check(given.poses, **options)
            print(f"obliq.batch: {checked.sentence(given.poses)}", file=sys.stderr)
            return 2 if checked.refused else 0
        options.update(shard=given.shard, progress=True)
        if given.workers > 1:
            spawn = multiprocessing.get_context("spawn")
            with concurrent.futures.ProcessPoolExecutor(given.workers, mp_context=spawn) as executor:
                done = batch(given.poses, given.out, executor=executor, **options)
        else:
            done = batch(given.poses, given.out, **options)
    except (ObliqError, OSError, TypeError, ValueError, concurrent.futures.BrokenExecutor) as error:
        print(f"obliq.batch: {error}", file=sys.stderr)
        return 1
    return told(given.poses, done)


def told(poses: str, done: Done) -> int:
    """Says what was done; the exit code."""
    refused = ""
    if (first := done.first_failed) is not None:
        refused = f"; {done.failed} refused, as failed.jsonl says: {poses}, line {first['line']}: {first['text']}"
    print(f"obliq.batch: {done.frames} frames in {done.seconds:.1f} s; {done.parts} of {done.parts_wanted} parts are there"
          + refused, file=sys.stderr)
    return 2 if done.failed else 0


if __name__ == "__main__":
    sys.exit(main())


class _Callable(types.ModuleType):
    """obliq.batch is a function, also where `import obliq.batch` has made it a module."""

    def __call__(self, *arguments_: Any, **options: Any) -> Done:
        return batch(*arguments_, **options)


sys.modules[__name__].__class__ = _Callable
