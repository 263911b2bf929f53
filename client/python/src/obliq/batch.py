"""python -m obliq.batch poses.jsonl --out DIR (--server HOST:PORT | --local SCENE.toml) ...

Exit code 0: the data set, or this share of it, is whole; 2: it is, but for poses that the server refused, which
failed.jsonl lists; 1: not, run it again.
"""
from __future__ import annotations

import argparse
import concurrent.futures
import multiprocessing
import sys
import types

from ._batch import batch
from .errors import ObliqError
from .parameters import Settings


def setting(text):
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


def arguments(words):
    parser = argparse.ArgumentParser(prog="python -m obliq.batch", description="Render many poses into a data set. Run it "
                                     "again after any failure: it does what is missing.")
    parser.add_argument("poses", help="JSON lines: {\"id\": \"a17\", \"latitude_deg\": ..., \"bearing_deg\": ..., "
                        "\"r_max_m\": ...}, any field of a pose and of the settings")
    parser.add_argument("--out", required=True, help="folder of the data set")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--server", metavar="HOST:PORT")
    where.add_argument("--local", metavar="SCENE.toml", help="start obliqd, and stop it at the end; each worker its own")
    parser.add_argument("--obliqd", help="the program for --local")
    parser.add_argument("--planes", default="iq,state")
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
    return parser.parse_args(words)


def main(words=None):
    given = arguments(words)
    options = dict(server=given.server, local=given.local, planes=given.planes, settings=dict(given.set), radar=given.radar,
                   seed=given.seed, speckle_per_frame=given.speckle_per_frame,
                   shard_size=given.shard_size, shard=given.shard, token_file=given.token_file, tls=given.tls,
                   ca_file=given.ca, obliqd=given.obliqd, progress=True)
    try:
        if given.workers > 1:
            spawn = multiprocessing.get_context("spawn")
            with concurrent.futures.ProcessPoolExecutor(given.workers, mp_context=spawn) as executor:
                done = batch(given.poses, given.out, executor=executor, **options)
        else:
            done = batch(given.poses, given.out, **options)
    except (ObliqError, OSError, TypeError, ValueError, concurrent.futures.BrokenExecutor) as error:
        print(f"obliq.batch: {error}", file=sys.stderr)
        return 1
    refused = ""
    if (first := done.first_failed) is not None:
        refused = f"; {done.failed} refused, as failed.jsonl says: {given.poses}, line {first['line']}: {first['text']}"
    print(f"obliq.batch: {done.frames} frames in {done.seconds:.1f} s; {done.parts} of {done.parts_wanted} parts are there"
          + refused, file=sys.stderr)
    return 2 if done.failed else 0


if __name__ == "__main__":
    sys.exit(main())


class _Callable(types.ModuleType):
    """obliq.batch is a function, also where `import obliq.batch` has made it a module."""

    def __call__(self, *arguments_, **options):
        return batch(*arguments_, **options)


sys.modules[__name__].__class__ = _Callable
