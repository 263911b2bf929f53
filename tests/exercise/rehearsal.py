"""tests/exercise.sh: who flies, who operates, what an instructor does, on one server."""
import argparse
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "client" / "python" / "src"), str(ROOT / "tests" / "python"), str(ROOT / "tests" / "support")]
import obliq  # noqa: E402
import programs  # noqa: E402
from obliq import obliq_pb2 as wire  # noqa: E402
from fly_test import RESUME, STOP, entity_state, order  # noqa: E402
from programs import await_that  # noqa: E402

GROUP, LOOPBACK = "239.255.77.9", "127.0.0.1"
ENTITY = "1:2:3"
HOST_HZ, DIS_HZ = 60, 10
MOST_LAG_S = 0.2
POWER_REGISTER, APPLY_COIL, MAIN_UNIT = 240, 2, 1  # server/modbus/REGISTERS.md
# Two on an aircraft, one before the wing and one behind it that looks back, and one that a host moves.
RADARS = {"main": 'platform = "aircraft"\n[radar.mount]\nforward_m = 6.0',
          "map": 'platform = "aircraft"\n[radar.mount]\nforward_m = -8.0\nup_m = 2.0\nlook_deg = 180.0',
          "host": "[radar.antenna]\nlatitude_deg = 33.0\nlongitude_deg = -99.5\nheight_m = 2500.0"}
SCENE = """
[terrain]
synthetic = "ridge"
shape = { distance_m = 5000.0 }
[[platform]]
name = "aircraft"
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 2500.0
[bins]
azimuth = 48
range = 64
[frustum]
kind = "sweep"
[modbus]
enabled = true
port = %d
[server]
port = %d
[http]
enabled = false
""" + "".join(f'[[radar]]\nname = "{name}"\nsector_deg = 60.0\nr_min_m = 3000.0\nr_max_m = 9000.0\n{place}\n' for name, place in RADARS.items())


class Simulator(threading.Thread):
    """An aircraft in a DIS exercise: Entity State PDUs to a group, from another thread."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.port, self.flies, self.ends = port, True, threading.Event()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(LOOPBACK))

    def send(self, pdu):
        self.socket.sendto(pdu, (GROUP, self.port))

    def run(self):
        latitude = 33.0
        while not self.ends.wait(1 / DIS_HZ):
            if self.flies:
                latitude += 1e-4
                self.send(entity_state(latitude, -99.5, 2500.0, 20.0, speed=100.0))


class Host(threading.Thread):
    """A host with a clock of its own, 60 poses a second; looks how late its radar's pictures are."""

    def __init__(self, address):
        super().__init__(daemon=True)
        self.address, self.ends = address, threading.Event()
        self.rate, self.pauses, self.reset = 1.0, False, False
        self.sim_s, self.sent, self.refused = 1000.0, 0, 0
        self.lags_s, self.settles = [], 0.0

    def run(self):
        while not self.ends.is_set():
            try:
                with obliq.connect(self.address, name="host") as server, server.radar("host").control(claims="pose") as control:
                    watching = threading.Thread(target=self.watch, daemon=True)
                    watching.start()
                    self.settles = time.monotonic() + 1
                    self.fly(control)
            except (obliq.ConnectionLost, obliq.CannotConnect, obliq.ServerStopping):
                time.sleep(0.1)

    def fly(self, control):
        due = time.monotonic()
        first = True
        while not self.ends.is_set():
            due += 1 / HOST_HZ
            time.sleep(max(0.0, due - time.monotonic()))
            if self.pauses:
                continue
            new, self.reset = self.reset or first, False
            if new:
                self.sim_s = 0.0
            first = False
            self.sim_s += self.rate / HOST_HZ
            try:
                control.set_pose(latitude_deg=33 + 1e-6 * self.sim_s, heading_deg=45.0, sim_time_ns=int(self.sim_s * 1e9),
                                 time_rate=self.rate, new_time_line=new)
                self.sent += 1
            except obliq.Refused as refusal:
                if isinstance(refusal, obliq.ServerStopping):
                    raise
                self.refused += 1
                print("exercise: pose refused:", refusal, file=sys.stderr)

    def watch(self):
        try:
            with obliq.connect(self.address, name="host's picture") as server, server.radar("host").wedges(HOST_HZ, "state") as wedges:
                for wedge in wedges:
                    if not self.pauses and time.monotonic() > self.settles:
                        self.lags_s.append(abs(self.sim_s - wedge.pose.sim_time_ns * 1e-9) / self.rate)
        except obliq.ObliqError:
            pass


def knobs(radar):
    return radar.settings, radar.pose.tilt_deg, radar.transmit_off, radar.frozen


class Exercise:
    def __init__(self, bin_folder, folder, unit_s):
        self.bin, self.folder, self.unit_s = bin_folder, folder, unit_s
        self.port, self.modbus_port = programs.free_ports(2)
        self.dis_port = programs.free_ports(1, socket.SOCK_DGRAM)[0]
        self.address = f"{LOOPBACK}:{self.port}"
        self.scene = folder / "scene.toml"
        self.scene.write_text(SCENE % (self.modbus_port, self.port))
        self.settings, self.refusals, self.bookmarks = 0, [], []
        self.serve()

    def start(self, name, *words):
        return programs.Program([self.bin / "obliq", *words], log=self.folder / f"{name}.log")

    def serve(self):
        self.server = programs.daemon(self.scene, f"server.port={self.port}", "http.enabled=false", obliqd=self.bin / "obliqd",
                                      log=self.folder / "obliqd.log")

    def obliq(self, *words):
        done = subprocess.run([self.bin / "obliq", *map(str, words), "--server", self.address], capture_output=True, text=True)
        if done.returncode != 0:
            self.refusals.append(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
        return done.stdout

    def fly(self, radar):
        return self.start(f"fly-{radar}", "fly", "--server", self.address, "--radar", radar, "--dis", ENTITY, "--udp", self.dis_port,
                          "--listen", GROUP, "--interface", LOOPBACK, "--rate", HOST_HZ, "--reconnect", 60)

    def record(self, radar):
        return self.start(f"record-{radar}", "record", "--server", self.address, "--radar", radar, "--out", self.folder / f"{radar}.obliq",
                          "--planes", "state", "--rate", 5, "--reconnect", 60)

    # Three stations, one after the other: each holds the settings for as long as it sets them.

    def by_command(self, k):
        self.obliq("set", "--radar", "main", f"receiver.gain_db={k % 30}", f"antenna.tilt_deg={-(k % 10)}", f"antenna.bearing_deg={k % 40 - 20}")

    def by_panel(self, k):
        with socket.create_connection((LOOPBACK, self.modbus_port)) as panel:
            for body in (struct.pack(">BHHBf", 16, POWER_REGISTER, 2, 4, 100.0 + k), struct.pack(">BHH", 5, APPLY_COIL, 0xFF00)):
                panel.sendall(struct.pack(">HHHB", 1, 0, len(body) + 1, MAIN_UNIT) + body)
                answer = panel.recv(260)
                if answer[7] & 0x80:
                    self.refusals.append(f"Modbus: exception {answer[8]}")

    def by_page(self, k):
        try:
            with obliq.connect(self.address, name="page") as server, server.radar("main").control(claims="settings") as hand:
                hand.set(r_max_m=8000.0 + k)
                hand.set_pose(tilt_deg=-1.0 - k % 5)
        except obliq.Refused as refusal:
            self.refusals.append(f"page: {refusal}")

    def operate(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            (self.by_command, self.by_panel, self.by_page)[self.settings % 3](self.settings)
            self.settings += 1
            time.sleep(min(1.0, self.unit_s / 8))

    def bookmark(self, text):
        self.obliq("bookmark", text)
        self.bookmarks.append(text)

    def state(self):
        with obliq.connect(self.address) as server:
            return server.exercise()

    def knobs_are_free(self):
        with obliq.connect(self.address) as server:
            return not any(server.radar(radar).info().settings_controller for radar in RADARS)

    def log(self):
        with obliq.connect(self.address) as server:
            return server.events()

    def rehearse(self):
        simulator, host = Simulator(self.dis_port), Host(self.address)
        flight = self.fly("aircraft")
        recorders = [self.record(radar) for radar in ("main", "host")]
        simulator.start()
        host.start()
        await_that(lambda: all(r.pose.pose_id > 3 for r in self.state().radars[:2]), "a flight of both radars")
        self.operate(2 * self.unit_s)
        self.bookmark("before the pause")
        # A pause of all that fly.
        simulator.flies, host.pauses = False, True
        simulator.send(order(STOP))
        await_that(lambda: self.state().radars[0].frozen and self.state().radars[1].frozen, "radars that are frozen by Stop/Freeze")
        time.sleep(self.unit_s)
        simulator.send(order(RESUME, (65535, 65535, 65535)))
        await_that(lambda: not any(radar.frozen for radar in self.state().radars), "radars that go on")
        await_that(self.knobs_are_free, "knobs that the flights let go")  # they held them to freeze and to thaw
        simulator.flies, host.pauses, host.settles = True, False, time.monotonic() + 0.2
        self.operate(self.unit_s)
        for rate, resets in ((1.0, True), (10.0, False), (1.0, False), (0.5, False)):
            host.reset, host.settles = resets, time.monotonic() + 0.2
            host.rate = rate
            self.operate(self.unit_s)
        # A total freeze, and a state that comes back.
        self.obliq("freeze", "on")
        self.obliq("save", self.folder / "state.toml")
        saved = self.state()
        self.obliq("reset", "--radar", "main")
        self.obliq("load", self.folder / "state.toml")
        again = self.state()
        same = [was.settings == now.settings for was, now in zip(saved.radars, again.radars)]
        self.obliq("freeze", "off")
        self.bookmark("before server and host are killed")
        host.settles = time.monotonic() + 1
        # Server and host are killed; all that were there come back by themselves, the host by hand.
        self.server.kill()
        flight.kill()
        self.serve()
        flight = self.fly("aircraft")
        self.obliq("load", self.folder / "state.toml")
        await_that(lambda: all(r.pose.pose_id > 3 for r in self.state().radars[:2]), "a flight after the restart")
        self.operate(2 * self.unit_s)
        self.bookmark("the end")
        time.sleep(0.5)  # the recorders write it
        simulator.ends.set()
        host.ends.set()
        host.join(20)
        for program in (flight, *recorders):
            program.send(signal.SIGINT)
        codes = [program.finish(30) for program in (flight, *recorders)]
        log, ended = self.log(), self.state()
        self.server.stop()
        self.serve()
        equal = self.again(log, ended)
        self.server.stop()
        return host, same, codes, equal

    def again(self, log, ended):
        """Whether a log, done again on a server that has just begun, gives the knobs that the exercise ended with."""
        with obliq.connect(self.address, name="log") as server:
            def act(request):
                server._run(server._session.act(request))

            for radar in RADARS:
                act(wire.ClaimControl(radar=radar, kinds=[wire.SETTINGS_CLAIM]))
            for event in log:
                if event.kind == wire.SETTINGS_EVENT:
                    act(wire.SetSettings(radar=event.radar, settings=event.settings))
                elif event.kind == wire.AIM_EVENT:
                    act(wire.SetPose(radar=event.radar, pose=event.pose))
                elif event.kind == wire.SWITCH_EVENT and (event.HasField("transmit") or event.HasField("freeze")):
                    act(wire.SetState(radar=event.radar, transmit=event.transmit if event.HasField("transmit") else None,
                                      freeze=event.freeze if event.HasField("freeze") else None))
                elif event.kind == wire.LOAD_EVENT:
                    server.load_exercise(event.state)
                elif event.kind == wire.RESET_EVENT:
                    server.reset_exercise(event.radar)
                elif event.kind == wire.FREEZE_EVENT:
                    server.freeze_exercise(event.freeze)
            return [knobs(radar) for radar in server.exercise().radars] == [knobs(radar) for radar in ended.radars]

    def recorded_bookmarks(self, radar):
        return [event.text for event in obliq.Recording(self.folder / f"{radar}.obliq").events() if event.kind == wire.BOOKMARK_EVENT]

    def flown(self):
        """Poses and refusals of `obliq fly`, as it says at its end."""
        text = (self.folder / "fly-aircraft.log").read_text()
        sums = [tuple(map(int, found)) for found in re.findall(r"(\d+) poses, (\d+) datagrams that were none", text)]
        return sum(poses for poses, _ in sums), sum(none for _, none in sums)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "release" / "bin")
    arguments = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        exercise = Exercise(arguments.bin, pathlib.Path(folder), 2.0 if arguments.short else 55.0)
        try:
            host, same, codes, equal = exercise.rehearse()
            poses, none = exercise.flown()
            frames = []
            kept = all(exercise.recorded_bookmarks(radar) == exercise.bookmarks for radar in ("main", "host"))
            for radar in ("main", "host"):
                replayed = subprocess.run([arguments.bin / "obliq", "replay", f"{folder}/{radar}.obliq", "--speed", "max"], capture_output=True,
                                          text=True)
                frames.append(len(replayed.stdout.splitlines()))
                if replayed.returncode not in (0, 2):  # 2: the frame that the kill has cut
                    exercise.refusals.append(f"replay of {radar}: {replayed.stderr.strip()}")
        finally:
            exercise.server.kill()
    refused = host.refused + none + len(exercise.refusals)
    lag_s = sorted(host.lags_s)
    print(f"poses {host.sent + poses} sent, {host.refused + none} refused; {exercise.settings} settings by 3 stations, {len(exercise.refusals)} refused; "
          f"server and host killed once; lag (real time) median {lag_s[len(lag_s) // 2]:.3f} s, 99 % {lag_s[len(lag_s) * 99 // 100]:.3f} s, max {lag_s[-1]:.3f} s of {len(lag_s)} pictures; "
          f"settings as saved: {all(same)}; {len(exercise.bookmarks)} bookmarks, recorded: {kept}; replay of the log equal: {equal}; frames replayed: {frames[0]} and {frames[1]}")
    for refusal in exercise.refusals:
        print("exercise:", refusal, file=sys.stderr)
    late = not arguments.short and lag_s[-1] > MOST_LAG_S
    return int(refused > 0 or late or not all(same) or not kept or not equal or any(codes) or min(frames) == 0)


if __name__ == "__main__":
    sys.exit(main())
