"""ObliqStream.cs, compiled by mcs and run by mono, against a daemon: its first frame has the bytes that the Python client
gets over TCP, a pose with bearing 0 is applied, refusals are printed with their fields.

  csharp_client.py --bin DIR       exit code 77 where mcs or mono is missing
"""
import argparse
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import obliq

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = """
[terrain]
synthetic = "ridge"
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1500.0
bearing_deg = 20.0
[radar]
sector_deg = 60.0
r_min_m = 2000.0
r_max_m = 5000.0
[bins]
azimuth = 36
range = 32
[server]
port = 0
tokens = "tokens"
[http]
port = 0
"""
TOKEN = "controller-token-0123456789"
# A bearing that is not 0 at first; a field that 64-bit numbers lose in a double; what SetSettings changed.
EXPECTED = ["refused 103", "bearing 0 pose_id 9007199254740993 mine True", "settings 2 6000", "obliq error 100: pose refused",
            "  antenna.latitude_deg: found 95.0; allowed: number -90 to 90 deg",
            "  antenna.bearing_deg: found nan; allowed: number -360 to 360 deg"]


def await_line(log, pattern, daemon):
    for _ in range(1200):
        found = re.search(pattern, log.read_text())
        if found:
            return found.group(1)
        if daemon.poll() is not None:
            break
        time.sleep(0.05)
    sys.exit(f"csharp_client: obliqd did not become ready:\n{log.read_text()}")


def sums_over_tcp(address):
    with obliq.connect(address, token=TOKEN) as server:
        frame = server.radar("main").frame(planes="iq state video")
        return [f"{name} {hashlib.sha256(getattr(frame, name).tobytes()).hexdigest()}" for name in ("video", "iq", "state")]


def check(folder, programs):
    probe = folder / "Probe.exe"
    subprocess.run(["mcs", "-warnaserror", f"-out:{probe}", "-r:System.Runtime.Serialization.dll", "-r:System.Core.dll",
                    ROOT / "client/csharp/ObliqStream.cs", ROOT / "tests/csharp/Probe.cs"], check=True)
    (folder / "scene.toml").write_text(SCENE)
    tokens = folder / "tokens"
    tokens.write_text(f"controller {TOKEN}\n")
    tokens.chmod(0o600)
    log = folder / "obliqd.log"
    with log.open("w") as out:
        daemon = subprocess.Popen([programs / "obliqd", folder / "scene.toml"], stdout=out, stderr=out, stdin=subprocess.DEVNULL)
    try:
        tcp = await_line(log, r"ready: main on (\S+)\n", daemon)
        web = await_line(log, r"in a browser: http://(\S+)/\n", daemon)
        wanted = ["welcome obliqd main controller", "frame 36 32", *sums_over_tcp(tcp), *EXPECTED,
                  "obliq error 5: the JSON of SetPose: (pose) bering_deg: Cannot find field; allowed: the fields and values that "
                  "obliq.proto has", "ended by 5"]
        ran = subprocess.run(["mono", probe, f"ws://{web}/stream", "main", TOKEN], capture_output=True, text=True, timeout=120)
        found = ran.stdout.splitlines()
        for number, (line, other) in enumerate(zip(found + [""] * len(wanted), wanted)):
            if line != other:
                sys.exit(f"csharp_client: line {number}: found {line!r}; expected {other!r}\n{ran.stdout}{ran.stderr}")
        stranger = subprocess.run(["mono", probe, f"ws://{web}/stream", "main", "another-token-0123456789"], capture_output=True,
                                  text=True, timeout=120)
        if stranger.returncode != 1 or "obliq error 11: " not in stranger.stdout:
            sys.exit(f"csharp_client: with a wrong token: {stranger.stdout}{stranger.stderr}")
    finally:
        daemon.terminate()
        daemon.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    if not shutil.which("mcs") or not shutil.which("mono"):
        print("skipped: no mcs or mono here; deploy/install-deps.sh test installs them")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        check(pathlib.Path(folder), arguments.bin)
    print("the C# client agrees")


if __name__ == "__main__":
    main()
