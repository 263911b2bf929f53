"""ObliqStream.cs, compiled by mcs and run by mono, against a daemon: its first frame has the bytes that the Python client
gets over TCP, a pose with bearing 0 is applied, refusals are printed with their fields; a radar that turns is shown as it turns; targets are as Python has them.

  csharp_client.py --bin DIR       exit code 77 where mcs or mono is missing
"""
import argparse
import hashlib
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import obliq

import targets_over_tcp

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "support"))
import programs  # noqa: E402

PLACE = (33.0, -99.5, 1500.0)
SCENE = """
[terrain]
synthetic = "ridge"
[antenna]
latitude_deg = %s
longitude_deg = %s
height_m = %s
bearing_deg = 20.0
[radar]
sector_deg = SECTOR
r_min_m = 2000.0
r_max_m = 5000.0
[bins]
azimuth = AZIMUTHS
range = 32
[server]
port = 0
tokens = "tokens"
max_targets = 2000
[http]
port = 0
[target_types.truck]
rcs_dbsm = 40.0
swerling = 0
top_m = 4.0
""" % PLACE
# 9 dwells in four seconds.
SCAN = """[scan]
mode = "circular"
rate_deg_s = 90.0
dwell_bins = 8
"""
TOKEN, VIEWER = "controller-token-0123456789", "viewer-token-0123456789"
# A bearing that is not 0 at first; a field that 64-bit numbers lose in a double; what SetSettings changed.
WHOLE32, WHOLE64 = ("a whole number from %d to %d" % (-2**bits, 2**bits - 1) for bits in (31, 63))
NOT_SENT = [("azimuth_bins", "1.5", WHOLE32), ("range_bins", "4294967295", WHOLE32), ("range_bins", "1000000000000", WHOLE32),
            ("speckle_seed", "NaN", WHOLE64), ("noise_frame", "-1", "a whole number from 0 to 18446744073709551615"),
            ("pixel_rows", "12x", WHOLE32), ("adc_bits", "1E-40", WHOLE32)]
# Two frames of 36 azimuths and three planes.
EXPECTED = ["rows kept for late takers 216", "refused 103", "bearing 0 pose_id 9007199254740993 mine True", "settings 2 6000",
            *(line for fault in NOT_SENT for line in ("obliq error 100: not sent", "  %s: found %s; allowed: %s" % fault)),
            "integers 40 2500 True", "knobs 0 false OFF_BEAM 2 100000000000000000", "as live 16 32 32 6000 5", "marks 1 True True", "obliq error 100: bookmark refused",
            "  text: found 0 bytes; allowed: 1 to 1000 bytes of text without control characters", "obliq error 100: pose refused",
            "  antenna.latitude_deg: found 95.0; allowed: number -90 to 90 deg",
            "  antenna.bearing_deg: found nan; allowed: number -360 to 360 deg"]


def sums_over_tcp(address):
    with obliq.connect(address, token=TOKEN) as server:
        frame = server.radar("main").frame(planes="iq state video material building height returns")
        sums = {name: hashlib.sha256(plane.tobytes()).hexdigest() for name, plane in frame.planes().items()}
        return [*(f"{name} {sums[name]}" for name in ("video", "iq", "state")),
                "labels " + " ".join(sums[name] for name in ("material", "building", "height", "returns"))]


def turning_over_tcp(address):
    latitude_deg, longitude_deg, height_m = PLACE
    with obliq.connect(address, token=TOKEN) as server:
        frame = server.render({"frustum": "sweep", "pixel_columns": 144, "pixel_rows": 64, "sector_deg": 360.0,
                               "r_min_m": 2000.0, "r_max_m": 5000.0, "azimuth_bins": 72, "range_bins": 32},
                              {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg, "height_m": height_m, "bearing_deg": 20.0},
                              planes="video state", radar="main")
        return [f"{name} {hashlib.sha256(getattr(frame, name).tobytes()).hexdigest()}" for name in ("video", "state")]


def check_readme(folder):
    """The blocks of the README compile, and ObliqStream.cs does as Unity has it."""
    first, targets, unity = re.findall(r"^```csharp\n(.*?)^```", (ROOT / "client/csharp/README.md").read_text(), re.M | re.S)
    (folder / "First.cs").write_text(first.replace("using Obliq;", "using Obliq; static class First { static void Use(byte[] rows, int first, int n) { }"
                                                   " static async System.Threading.Tasks.Task Run() {") + "}}\n")
    (folder / "Second.cs").write_text("using Obliq; static class Second { static void Use(ulong id, int azimuth, int range) { }"
                                      " static async System.Threading.Tasks.Task Run(ObliqStream radar) {" + targets + "}}\n")
    (folder / "Component.cs").write_text("using Obliq; using UnityEngine;\n" + unity)
    compile_csharp(folder / "First.dll", "-target:library", ROOT / "client/csharp/ObliqStream.cs", folder / "First.cs",
                   folder / "Second.cs")
    compile_csharp(folder / "Component.dll", "-target:library", "-d:UNITY_5_3_OR_NEWER", ROOT / "client/csharp/ObliqStream.cs",
                   ROOT / "tests/csharp/Unity.cs", folder / "Component.cs")


def compile_csharp(out, *arguments):
    subprocess.run(["mcs", "-warnaserror", f"-out:{out}", "-r:System.Runtime.Serialization.dll", "-r:System.Core.dll", *arguments], check=True)


def start(folder, bin_folder, name, scene):
    (folder / f"{name}.toml").write_text(scene)
    daemon = programs.daemon(folder / f"{name}.toml", obliqd=bin_folder / "obliqd")
    return daemon, daemon.address, f"ws://127.0.0.1:{daemon.web_port}/stream"


def compare(found, wanted, more):
    for number, (line, other) in enumerate(zip(found + [""] * len(wanted), wanted)):
        if line != other:
            sys.exit(f"csharp_client: line {number}: found {line!r}; expected {other!r}\n" + "\n".join(found) + more)


def check_turning(folder, bin_folder, probe):
    scene = SCENE.replace("SECTOR", "360.0").replace("AZIMUTHS", "72") + SCAN
    daemon, tcp, web = start(folder, bin_folder, "turning", scene)
    try:
        wanted = ["once 72 32 whole", *turning_over_tcp(tcp), "refused 100 longitude_deg,height_m",
                  "first pass: 0 as before, 18 empty of 18 CIRCULAR_SCAN", "0 rows unlike those of the whole frame", "the pass is whole",
                  "next pass: 18 as before, 0 empty of 18", "bearings: as seen", "stop", "missed: some, told all",
                  "frozen True silent False", "frozen False silent True", "silent False"]
        with subprocess.Popen(["mono", probe, web, "main", TOKEN, "turning", *map(str, PLACE)], stdin=subprocess.PIPE, text=True,
                              stdout=subprocess.PIPE) as asking:
            late = threading.Timer(240, asking.kill)
            late.start()
            found = []
            for line in asking.stdout:
                found.append(line.rstrip("\n"))
                if found[-1] == "stop":  # long enough for the server to skip dwells: more than a quarter of a second
                    daemon.send(signal.SIGSTOP)
                    time.sleep(1)
                    daemon.send(signal.SIGCONT)
                    print(file=asking.stdin, flush=True)
            late.cancel()
        compare(found, wanted, "")
        ran = subprocess.run(["mono", probe, web, "main", TOKEN, "pass"], capture_output=True, text=True, timeout=120)
        compare(ran.stdout.splitlines(), targets_over_tcp.OF_A_PASS, ran.stderr)
    finally:
        daemon.kill()


def check_targets(probe, tcp, web):
    wanted = targets_over_tcp.expected(tcp, TOKEN)
    ran = subprocess.run(["mono", probe, web, "main", TOKEN, "targets", VIEWER], capture_output=True, text=True, encoding="utf-8", timeout=120)
    compare(ran.stdout.splitlines(), wanted, ran.stderr)


def check(folder, bin_folder):
    check_readme(folder)
    probe = folder / "Probe.exe"
    compile_csharp(probe, *(ROOT / name for name in ("client/csharp/ObliqStream.cs", "tests/csharp/Probe.cs", "tests/csharp/Turning.cs",
                                               "tests/csharp/Targets.cs")))
    tokens = folder / "tokens"
    tokens.write_text(f"controller {TOKEN}\nviewer {VIEWER}\n")
    tokens.chmod(0o600)
    daemon, tcp, web = start(folder, bin_folder, "scene", SCENE.replace("SECTOR", "60.0").replace("AZIMUTHS", "36"))
    try:
        wanted = ["welcome obliqd main controller", "frame 36 32", *sums_over_tcp(tcp), *EXPECTED,
                  'obliq error 5: the JSON of SetPose: found the field "bering_deg"; allowed: those of Pose in obliq.proto', "ended by 5"]
        ran = subprocess.run(["mono", probe, web, "main", TOKEN], capture_output=True, text=True, timeout=120)
        compare(ran.stdout.splitlines(), wanted, ran.stderr)
        stranger = subprocess.run(["mono", probe, web, "main", "another-token-0123456789"], capture_output=True,
                                  text=True, timeout=120)
        if stranger.returncode != 1 or "obliq error 11: " not in stranger.stdout:
            sys.exit(f"csharp_client: with a wrong token: {stranger.stdout}{stranger.stderr}")
        check_targets(probe, tcp, web)
    finally:
        daemon.kill()
    check_turning(folder, bin_folder, probe)


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
