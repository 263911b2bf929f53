#!/usr/bin/python3
"""Hostile peers and files against the programs, each beside an honest client, some seconds each.

  tests/hostile/run.py [--bin DIR] [--only NAME]... [--seconds S] [--seed N] [--list]

Prints a line an attack and at last "all held, daemon alive", exit code 0; else what did not hold, exit code 1. 77 where
python3-protobuf is missing. NAME: an attack, or a group of them, by its name before the point.
"""
import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SECONDS, SEED, LONGEST_S = 3.0, 27, 300
GROUPS = ("websocket", "frames", "requests", "connections", "replay", "ownship", "modbus", "reload", "files", "recordings",
          "python")
INSTALL = "deploy/install-deps.sh test installs it"


def find_interpreter():
    """The system's Python has protobuf; another one in the path may not. Runs this file with one that has."""
    try:
        import google.protobuf  # noqa: F401
        return
    except ImportError:
        pass
    for python in ("/usr/bin/python3", "python3"):
        if os.environ.get("OBLIQ_HOSTILE") != "again" and shutil.which(python) and subprocess.run(
                [python, "-c", "import google.protobuf"], capture_output=True).returncode == 0:
            os.environ["OBLIQ_HOSTILE"] = "again"
            os.execvp(python, [python, "-B", os.path.join(HERE, "run.py"), *sys.argv[1:]])
    print(f"hostile: skipped: no python3-protobuf here; {INSTALL}", file=sys.stderr)
    sys.exit(77)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(HERE, "../../build/release/bin"), help="folder of obliqd and obliq")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="an attack or a group; may be repeated")
    parser.add_argument("--seconds", type=float, default=SECONDS, help=f"of each attack that goes on and on; default {SECONDS:g}")
    parser.add_argument("--seed", type=int, default=SEED, help=f"of what is random; default {SEED}")
    parser.add_argument("--list", action="store_true", help="only names what there is")
    parser.add_argument("--logs", action="store_true", help="show the end of a log where an attack did not hold")
    return parser.parse_args()


def too_long(*_):
    raise TimeoutError(f"the attack took more than {LONGEST_S} s")


def run(attack, given):
    """What it did, in words, and what did not hold; None and a reason where it was skipped."""
    import place as places
    folder = tempfile.mkdtemp(prefix="obliq-hostile-")
    place = places.Place(given.bin, folder, given.seed, given.seconds, attack.name)
    words = ""
    signal.alarm(LONGEST_S)
    try:
        try:
            words = attack.run(place) or "done"
        except places.Skipped as reason:
            return None, str(reason)
        except Exception as error:
            place.expect(False, f"{type(error).__name__}: {error}")
        place.look_around()
        if place.waits:
            words += f"; the others waited for at most {max(place.waits):.1f} s of processor time"
    except Exception as error:
        place.expect(False, f"{type(error).__name__}: {error}")
    finally:
        signal.alarm(0)
        place.end()
        if place.faults and given.logs:
            print(place.logs())
        shutil.rmtree(folder, ignore_errors=True)
    return words, place.faults


def main():
    find_interpreter()
    given = arguments()
    sys.path.insert(0, HERE)
    import place as places
    for group in GROUPS:
        __import__(f"on_{group}")
    chosen = [a for a in places.ATTACKS if not given.only or a.name in given.only or a.name.split(".")[0] in given.only]
    unknown = [name for name in given.only if not any(name in (a.name, a.name.split(".")[0]) for a in places.ATTACKS)]
    if unknown:
        sys.exit(f"hostile: --only {unknown[0]}: no such attack; --list names them")
    if given.list:
        for attack in chosen:
            print(f"{attack.name:32} {attack.words}")
        return 0
    if not os.path.exists(os.path.join(given.bin, "obliqd")):
        sys.exit(f"hostile: no obliqd in {given.bin}; build it, or give --bin DIR")
    signal.signal(signal.SIGALRM, too_long)
    print(f"seed {given.seed}, {given.seconds:g} s an attack", flush=True)
    broken, begun = [], time.monotonic()
    for attack in chosen:
        start = time.monotonic()
        words, faults = run(attack, given)
        took = f"{time.monotonic() - start:.1f} s"
        if words is None:
            print(f"{attack.name}: skipped: {faults}", flush=True)
        elif faults:
            broken.append(attack.name)
            print(f"{attack.name}: DID NOT HOLD: {'; '.join(faults)}{' (' + words + ')' if words else ''} [{took}]", flush=True)
        else:
            print(f"{attack.name}: held: {words} [{took}]", flush=True)
    print(f"{len(chosen)} attacks in {time.monotonic() - begun:.0f} s")
    print("all held, daemon alive" if not broken else f"{len(broken)} did not hold: {', '.join(broken)}")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
