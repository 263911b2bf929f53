#!/usr/bin/python3
"""CAT 240 on the loopback into a receiver with the default buffer: what is lost, by the sender's count and the receiver's.

  tests/bench/cat240.py [--seconds 60] [--rate 10] [--azimuths 1024] [--cells 1024] [--bits 8] [--buffer OCTETS]
      [--realtime]

A standing radar, obliqd, `obliq cat240` and the receiver on this machine. Exit code 1 where something was lost. The default
buffer (net.core.rmem_default) holds some nine milliseconds: on a machine that does other things meanwhile a receiver that is not
scheduled for longer loses what the sender paced well. --buffer: a larger one. --realtime: the receiver goes before all others (root).
"""
import argparse
import multiprocessing
import os
import pathlib
import re
import resource
import socket
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "client" / "python" / "src"))
sys.path.insert(0, str(ROOT / "tests" / "python"))
from support import OBLIQ, daemon  # noqa: E402

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
height_m = 1500.0
[bins]
azimuth = {azimuths}
range = {cells}
[radar]
sector_deg = 360.0
r_min_m = 2000.0
r_max_m = 20000.0
[frustum]
kind = "sweep"
"""
SILENCE_S = 3  # after so long the sender has ended

def receive(receiver, answer, realtime):
    """Counts video messages and the gaps in their numbers until none comes."""
    if realtime:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    receiver.settimeout(60)
    space = bytearray(65536)
    messages = octets = lost = late = 0
    expected = 0
    longest_s, before_s = 0.0, None
    while True:
        try:
            size = receiver.recv_into(space)
        except socket.timeout:
            break
        receiver.settimeout(SILENCE_S)
        if space[7] != 2:  # a summary
            continue
        now_s = time.monotonic()
        longest_s = max(longest_s, now_s - (before_s or now_s))
        before_s = now_s
        index = int.from_bytes(space[8:12], "big")
        if index < expected:
            late += 1
        else:
            lost += index - expected
            expected = index + 1
        messages += 1
        octets += size
    answer.put((messages, octets, lost, late, longest_s, expected))

def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--seconds", type=float, default=60)
    options.add_argument("--rate", type=float, default=10)
    options.add_argument("--azimuths", type=int, default=1024)
    options.add_argument("--cells", type=int, default=1024)
    options.add_argument("--bits", type=int, choices=(8, 16), default=8)
    options.add_argument("--buffer", type=int)
    options.add_argument("--realtime", action="store_true")
    given = options.parse_args()
    frames = round(given.seconds * given.rate)
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    if given.buffer:
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, given.buffer)
    receiver.bind(("127.0.0.1", 0))
    answer = multiprocessing.Queue()
    process = multiprocessing.Process(target=receive, args=(receiver, answer, given.realtime))
    with daemon(SCENE.format(azimuths=given.azimuths, cells=given.cells)) as address:

        process.start()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        began_s = time.monotonic()
        done = subprocess.run(
            [OBLIQ, "cat240", address, "--to", f"127.0.0.1:{receiver.getsockname()[1]}", "--rate", str(given.rate), "--bits",
             str(given.bits), "--frames", str(frames)], capture_output=True, text=True, check=True)
        took_s = time.monotonic() - began_s
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    messages, octets, lost, late, longest_s, expected = answer.get(timeout=120)
    process.join()
    said = done.stdout.splitlines()[-1]
    sent, not_sent = map(int, re.search(r"(\d+) datagrams sent, (\d+) could not be sent", said).groups())
    summaries = sent - expected
    buffer = receiver.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    print(f"{given.rate:g} Hz x {given.azimuths} radials of {given.cells} cells of {given.bits} bits for {took_s:.1f} s, receiver's buffer "
          f"{buffer} octets, load {os.getloadavg()[0]:.1f}")
    print(f"sender:   {said}{'; ' + done.stderr.strip() if done.stderr else ''}")
    print(f"receiver: {messages} video messages, {octets / took_s / 1e6:.1f} MB/s, {lost} lost, {late} out of order, "
          f"longest pause {1000 * longest_s:.1f} ms, {summaries} summaries")
    print(f"obliq cat240: {100 * used_s / took_s:.1f} % of a core")
    return 0 if lost == late == not_sent == 0 and messages == expected and expected >= frames * given.azimuths else 1

if __name__ == "__main__":
    sys.exit(main())
