"""client/c.h from a C program and by ctypes, against a daemon, beside the Python client.

  c_test.py --bin DIR --library libobliq.so
"""
import argparse
import ctypes
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import obliq

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import programs  # noqa: E402

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 2500.0
bearing_deg = 60.0
[bins]
azimuth = 64
range = 96
[[radar]]
name = "main"
sector_deg = 60.0
r_min_m = 3000.0
r_max_m = 9000.0
[[radar]]
name = "other"
"""
D, I, U64 = ctypes.c_double, ctypes.c_int, ctypes.c_uint64


class Pose(ctypes.Structure):
    _fields_ = [(name, D) for name in ("latitude_deg", "longitude_deg", "height_m", "bearing_deg", "tilt_deg", "valid_s")] + [
        ("sim_time_ns", ctypes.c_int64), ("pose_id", U64)] + [
        (name, D) for name in ("heading_deg", "velocity_north_m_s", "velocity_east_m_s", "velocity_up_m_s", "roll_deg", "pitch_deg")]


class Frame(ctypes.Structure):
    _fields_ = [("radar", ctypes.c_char_p), ("frame_id", U64), ("request_id", U64), ("frames_skipped", U64), ("n_azimuth", I), ("n_range", I)] + [
        (name, D) for name in ("azimuth_start_deg", "azimuth_width_deg", "range_start_m", "range_spacing_m", "video_floor_db", "video_span_db")] + [
        ("pose", Pose), ("iq", ctypes.POINTER(ctypes.c_float)), ("power_w", ctypes.POINTER(D)), ("count", ctypes.POINTER(ctypes.c_uint32)),
        ("state", ctypes.POINTER(ctypes.c_uint8)), ("video", ctypes.POINTER(ctypes.c_uint16)),
        ("material", ctypes.POINTER(ctypes.c_uint8)), ("building", ctypes.POINTER(ctypes.c_float)),
        ("height_m", ctypes.POINTER(ctypes.c_float)), ("returns", ctypes.POINTER(ctypes.c_uint8)),
        ("target", ctypes.POINTER(ctypes.c_uint32)), ("truth", ctypes.c_void_p), ("n_truth", ctypes.c_size_t)]


def fnv1a(data):
    total = 0xcbf29ce484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001b3 % 2**64
    return f"{total:016x}"


def check_program(programs, address):
    ran = subprocess.run([programs / "c_client", address, "main"], capture_output=True, text=True, timeout=120)
    found = ran.stdout.splitlines()
    with obliq.connect(address) as server:
        radar = server.radar("main")
        height_m = server.query([33.05], [-99.45]).height_m[0]
        frame = radar.frame(planes="iq state")  # the settings and the pose that the program has left
        rendered = server.render({"azimuth_bins": 8}, {"bearing_deg": 75.0}, planes="iq video", radar="main", as_live=True)
    wanted = [
        "before: outcome 4, error 0: ",
        "nowhere: outcome 1, error 0: address: found \"nowhere:at:all\"; allowed: HOST:PORT",
        "radars main other",
        "without control: outcome 6, error 103: ",
        "claim nothing: outcome 1, error 0: claims: found 0; allowed: OBLIQ_POSE, OBLIQ_SETTINGS, or their sum",
        "without settings: outcome 6, error 103: ",
        "where 33.000 -99.500 2500 70", "gain 6 speckle NONE_SPECKLE", "bars -2;-5.5 then \"\"",
        "wrong bars: outcome 1, error 0: settings: scan_bars: found -2;up; allowed: numbers with ; between them, such as -2;-5",
        "wrong name: outcome 1, error 0: settings: gain: found no field of RadarSettings; allowed: those of obliq.proto",
        "wrong number: outcome 1, error 0: settings: azimuth_bins: found 1.5; allowed: a whole number from -2147483648 to 2147483647",
        "wrong limits: outcome 6, error 100: settings refused: radar.sector_deg: found 500.0; allowed: number above 0, at most 360 deg",
        "no room: outcome 1, error 0: size: found 3; allowed: at least 13",
        "frame main 32 96 bearing 70 planes 10010", f"iq {fnv1a(frame.iq.tobytes())}", f"state {fnv1a(frame.state.tobytes())}",
        "rendered main 8 96 bearing 75 planes 10001", f"iq {fnv1a(rendered.iq.tobytes())}", "silence 1",
        f"ground 1 {height_m:.3f} seen ",
        "no bookmark: outcome 1, error 0: text: found 0 bytes; allowed: 1 to 1000 bytes of text without control characters",
        "from C by c of .", "events 7", "no replay: outcome 6, error 126: ", "unknown radar: outcome 6, error 101: "]
    for k, line in enumerate(wanted):
        if k >= len(found) or not found[k].startswith(line):
            sys.exit(f"c_client: line {k}: found {found[k] if k < len(found) else 'nothing'!r}; expected {line!r}\n{ran.stdout}{ran.stderr}")
    if ran.returncode != 0 or len(found) != len(wanted):
        sys.exit(f"c_client: exit code {ran.returncode}\n{ran.stdout}{ran.stderr}")


def check_ctypes(library, address):
    c = ctypes.CDLL(str(library))
    c.obliq_open.restype = ctypes.c_void_p
    c.obliq_error.restype = c.obliq_radar.restype = ctypes.c_char_p
    c.obliq_subscribe.argtypes = [ctypes.c_void_p, ctypes.c_char_p, D, ctypes.c_uint]
    client = ctypes.c_void_p(c.obliq_open())

    def ok(outcome):
        if outcome != 0:
            sys.exit(f"ctypes: outcome {outcome}: {c.obliq_error(client).decode()}")

    ok(c.obliq_connect(client, address.encode(), b"ctypes", None))
    if c.obliq_radar(client, 1) != b"other" or c.obliq_radar(client, 2) is not None:
        sys.exit("ctypes: other radars")
    ok(c.obliq_claim(client, b"main", 0))
    pose = Pose()
    c.obliq_no_pose(ctypes.byref(pose))
    pose.bearing_deg = 40.0
    ok(c.obliq_move(client, b"main", ctypes.byref(pose)))
    ok(c.obliq_subscribe(client, b"main", 20.0, 1 | 2 | 4 | 8 | 16 | 64 | 128 | 256 | 512 | 1024))
    frame = Frame()
    ok(c.obliq_receive(client, ctypes.byref(frame), 60000))
    shape = (frame.n_azimuth, frame.n_range)
    with obliq.connect(address) as server:
        same = server.radar("main").frame(planes="iq power count state video material building height returns target")
    for name in ("iq", "power_w", "count", "state", "video", "material", "building", "height_m", "returns", "target"):
        values = np.ctypeslib.as_array(getattr(frame, name), (*shape, 2) if name == "iq" else shape)
        if name == "iq":
            values = values.view(np.complex64)[..., 0]
        its = same.plane({"power_w": "power", "height_m": "height"}.get(name, name))
        if not np.array_equal(values, its, equal_nan=name == "height_m"):
            sys.exit(f"ctypes: another {name}")
    if abs(frame.azimuth_start_deg - 10.0) > 1e-9 or frame.radar != b"main" or frame.pose.bearing_deg != 40.0:
        sys.exit(f"ctypes: another frame: {frame.azimuth_start_deg}")
    c.obliq_close(client)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--library", type=pathlib.Path, required=True)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "scene.toml"
        scene.write_text(SCENE)
        daemon = programs.daemon(scene, obliqd=given.bin / "obliqd")
        try:
            check_program(given.bin, daemon.address)
            check_ctypes(given.library, daemon.address)
        finally:
            daemon.stop()
    print("C and ctypes agree with Python")


if __name__ == "__main__":
    main()
