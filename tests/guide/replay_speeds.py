#!/usr/bin/env python3
"""The speeds of a replay are the same in every text: what the server takes, what the page offers."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# Texts that say which speeds a server takes.
SAY_LIMITS = ["proto/obliq.proto", "proto/PROTOCOL.md", "client/guide/instructor.md", "client/guide/display.md", "client/python/src/obliq/_aio_streams.py"]
# And which the page offers.
SAY_OFFER = ["client/guide/instructor.md", "client/guide/display.md"]


def text_of(name):
    """With one space for every gap: sentences run over lines."""
    return re.sub(r"\s+", " ", (ROOT / name).read_text(encoding="utf-8"))


def main():
    code = text_of("server/apps/replay/replay_player.h")
    slowest, fastest = (float(re.search(rf"{name} = ([\d.e]+);", code).group(1)) for name in ("kSlowestReplay", "kFastestReplay"))
    offered = [float(speed) for speed in re.search(r"\bSPEEDS = \[([^\]]+)\]", text_of("server/http/page/debrief.js")).group(1).split(",")]
    limits, offer = f"{slowest:.10g} to {fastest:.10g}, or", f"speeds from {min(offered):g} to {max(offered):g}"
    faults = [f"{name}: allowed: \"{limits}\"" for name in SAY_LIMITS if limits not in text_of(name)]
    faults += [f"{name}: allowed: \"{offer}\"" for name in SAY_OFFER if offer not in text_of(name)]
    faults += [f"debrief.js offers {speed:g}; allowed: {limits} infinity" for speed in offered if not slowest <= speed <= fastest]
    print("\n".join(faults) or f"{offer}; allowed: {limits} infinity")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
