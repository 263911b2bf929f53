"""Runs a program until it ends or standard input does: the pipe of a parent that is gone, however it went."""
import os
import select
import signal
import subprocess
import sys

child = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL)
signal.signal(signal.SIGTERM, lambda *_: child.terminate())
while child.poll() is None:
    readable, _, _ = select.select([0], [], [], 0.1)
    if readable and not os.read(0, 4096):
        child.terminate()
        try:
            child.wait(10)
        except subprocess.TimeoutExpired:
            child.kill()
        break
sys.exit(child.wait())
