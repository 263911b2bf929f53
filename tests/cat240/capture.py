"""Datagrams of `obliq cat240` beside the video that they should hold, for programs of others to judge.

  capture.py FOLDER

Writes FOLDER/NAME.json (datagrams as hexadecimal text, when each arrived, the frame's geometry and video) and FOLDER/NAME.pcap for
each case. Needs the package and obliqd as the tests in tests/python do.
"""
import json
import pathlib
import socket
import struct
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "python"))
from support import OBLIQ, daemon, obliq  # noqa: E402

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
height_m = 1500.0
bearing_deg = {bearing}
[bins]
azimuth = {azimuths}
range = {cells}
[radar]
sector_deg = {sector}
r_min_m = 2003.0
r_max_m = 20000.0
[frustum]
kind = "sweep"
[scan]
mode = "{scan}"
rate_deg_s = {rate}
"""
# Name: the scene, bits, frames, further options.
CASES = {}
for bits in (8, 16):
    for cells in (512, 1024, 4096):
        CASES[f"frame-{cells}-{bits}"] = (
            dict(bearing=350.0, azimuths=72, cells=cells, sector=90.0, scan="frame", rate=90.0), bits, 1, ())
    CASES[f"turns-1024-{bits}"] = (
        dict(bearing=0.0, azimuths=360, cells=1024, sector=360.0, scan="circular", rate=180.0), bits, 3, ())
    CASES[f"passes-700-{bits}"] = (
        dict(bearing=10.0, azimuths=90, cells=700, sector=60.0, scan="sector", rate=40.0), bits, 3, ())
CASES["large-4096-16"] = (
    dict(bearing=350.0, azimuths=72, cells=4096, sector=90.0, scan="frame", rate=90.0), 16, 1, ("--max-datagram", "9000"))
CASES["high-8192-16"] = (
    dict(bearing=350.0, azimuths=16, cells=8192, sector=90.0, scan="frame", rate=90.0), 16, 1, ("--max-datagram", "65507"))
SAC, SIC = 25, 201
PCAP_RAW_IPV4 = 228  # LINKTYPE_IPV4


def receive(receiver, into, done):
    receiver.settimeout(0.2)
    while True:
        try:
            data = receiver.recv(65536)
            into.append((time.time(), data))
        except socket.timeout:
            if done.is_set():
                return


def pcap_of(datagrams, port):
    """A capture file: each datagram in an IPv4 packet of its own, fragments put together."""
    out = [struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, PCAP_RAW_IPV4)]
    for arrived, data in datagrams:
        udp = struct.pack(">HHHH", 50000, port, 8 + len(data), 0) + data
        packet = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, bytes([127, 0, 0, 1]), bytes([127, 0, 0, 1])) + udp
        out.append(struct.pack("<IIII", int(arrived), int(arrived % 1 * 1e6), len(packet), len(packet)) + packet)
    return b"".join(out)


def capture(name, folder):
    scene, bits, frames, more = CASES[name]
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
    receiver.bind(("127.0.0.1", 0))
    port = receiver.getsockname()[1]
    datagrams, done = [], threading.Event()
    thread = threading.Thread(target=receive, args=(receiver, datagrams, done))
    thread.start()
    try:
        with daemon(SCENE.format(**scene)) as address:
            with obliq.connect(address) as server:
                frame = server.radar().frame(planes="video16" if bits == 16 else "video")
                while frame.missed:
                    frame = server.radar().frame(planes="video16" if bits == 16 else "video")
            said = subprocess.run(
                [OBLIQ, "cat240", address, "--to", f"127.0.0.1:{port}", "--bits", str(bits), "--frames", str(frames), "--rate", "2",
                 "--sac", str(SAC), "--sic", str(SIC), *more], capture_output=True, text=True, check=True).stdout
    finally:
        done.set()
        thread.join()
    descriptor = frame.descriptor
    kept = {
        "name": name, "said": said, "bits": bits, "frames": frames, "sac": SAC, "sic": SIC, "scans": scene["scan"] != "frame",
        "max_datagram": int(more[1]) if more else 1472, "radar": descriptor.radar,
        "azimuth_start_deg": descriptor.azimuth_start_deg, "azimuth_width_deg": descriptor.azimuth_width_deg,
        "range_start_m": descriptor.range_start_m, "range_spacing_m": descriptor.range_spacing_m,
        "floor_db": descriptor.video_floor_db, "span_db": descriptor.settings.video_span_db,
        "latitude_deg": descriptor.pose.latitude_deg, "longitude_deg": descriptor.pose.longitude_deg, "height_m": descriptor.pose.height_m,
        "levels": [row.astype(">u2").tobytes().hex() for row in frame.video],
        "arrived": [arrived for arrived, _ in datagrams], "datagrams": [data.hex() for _, data in datagrams],
    }
    (folder / f"{name}.json").write_text(json.dumps(kept))
    (folder / f"{name}.pcap").write_bytes(pcap_of(datagrams, 8600))
    print(f"{name}: {len(datagrams)} datagrams; {said.splitlines()[-1]}", flush=True)


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in CASES:
        capture(name, folder)


if __name__ == "__main__":
    main()
