"""Who is told where targets are, by obliqd and by a replay with tokens, over TCP and WebSocket: server.truth_role and those above
it, as it was rendered or recorded; others get nothing of it."""
import contextlib
import os
import pathlib
import signal
import sys
import tempfile
import unittest

import numpy as np

import support
import obliq
from obliq import targets as obliq_targets
from targets_test import POSE, SCENE, north_of

sys.path.append(str(support.ROOT / "tests" / "hostile"))
import web  # noqa: E402
import wire  # noqa: E402

FRAMES = 3
GET_TARGETS, TARGET_BLOCK, ROLE_TOO_LOW, REPLAY_ONLY = 35, 52, 108, 125  # proto/PROTOCOL.md
TARGETS = [{"id": 5, "type": "truck", **north_of(3000, 5000), "velocity_north_m_s": 12.0}, {"id": 6, "rcs_dbsm": 30, **north_of(-4000, 100)},
           {"id": 1 << 40, "name": "far", "type": "truck", **north_of(4000, 4000)}]
ROLES = ("viewer", "controller", "admin")


def token_of(role):
    return f"truth-test-token-of-the-{role}"


class Served:
    """A server with a token for each role."""

    def __init__(self, test, *words):
        self.tokens = test.folder / "tokens"
        self.give({role: role for role in ROLES})
        served = support.programs.Served([*words, "--set", f"server.tokens={self.tokens}"])
        test.addCleanup(served.stop)
        self.process, self.address, self.port, self.web_port = served.process, served.address, served.port, served.web_port

    def give(self, roles):
        """The token of each name means this role."""
        self.tokens.write_text("".join(f"{role} {token_of(name)}\n" for name, role in roles.items()))
        os.chmod(self.tokens, 0o600)

    def connect(self, role):
        return obliq.connect(self.address, token=token_of(role))

    def web_socket(self, role):
        return contextlib.closing(web.Socket(self.web_port, token_of(role)))


class Roles(support.Folder):
    def refused(self, number, call):
        with self.assertRaises((obliq.Refused, wire.Refused)) as refusal:
            call()
        self.assertEqual(refusal.exception.number, number, refusal.exception)

    def truth_is_refused(self, server, radar):
        self.assertFalse(server.info.truth)
        self.refused(ROLE_TOO_LOW, lambda: server.radar(radar).frame(planes="power", truth=True))
        self.refused(ROLE_TOO_LOW, lambda: server.radar(radar).frame(planes="power target"))
        self.refused(ROLE_TOO_LOW, server.target_list)
        self.assertIsNone(server.radar(radar).frame(planes="power").targets)


class Live(Roles):
    def test_the_operator_names_the_role(self):
        for least in ROLES:
            served = Served(self, support.OBLIQD, "--config", support.scene(self.folder, SCENE), "--set", "server.port=0", "--set",
                            "http.port=0", "--set", f"server.truth_role={least}")
            with served.connect("admin") as server, server.targets() as world:
                world.set(*TARGETS)
            for role in ROLES:
                with self.subTest(truth_role=least, role=role), served.connect(role) as server:
                    if ROLES.index(role) < ROLES.index(least):
                        self.truth_is_refused(server, "main")
                        self.assertFalse(server.exercise().with_targets)
                    else:
                        self.assertTrue(server.info.truth)
                        self.assertEqual(len(server.radar("main").frame(planes="power", truth=True).targets), len(TARGETS))
                        self.assertEqual(len(server.target_list()), len(TARGETS))
                        self.assertEqual(len(server.exercise().targets), len(TARGETS))


class Replayed(Roles):
    """A recording of some frames."""

    radar, told = "main", {5, 6, 1 << 40}

    @classmethod
    def setUpClass(cls):
        held = tempfile.TemporaryDirectory()
        cls.addClassCleanup(held.cleanup)
        cls.recording = pathlib.Path(held.name) / "recording.obliq"
        with support.daemon(SCENE) as address, obliq.connect(address) as server, server.targets() as world:
            world.set(*TARGETS)
            support.run(support.OBLIQ, "record", "--server", address, "--radar", cls.radar, "--truth", "--planes", "power,target", "--rate",
                        "20", "--frames", FRAMES, "--out", cls.recording)
        # As the replay counts them: a busy machine may have left frames out.
        cls.recorded = dict(enumerate(obliq.open(cls.recording), start=1))
        assert [set(frame.targets["id"]) for frame in cls.recorded.values()] == [cls.told] * FRAMES, cls.recorded

    def replay(self, *words):
        return Served(self, support.OBLIQ, "replay", self.recording, "--serve", "--hold", "--port", "0", "--http-port", "0", *words)

    def frames_are_as_recorded(self, served, role):
        """The truth of each frame, and the plane, bit for bit. A viewer may miss frames; those after are counted without them."""
        lossless, last = role != "viewer", self.recorded[max(self.recorded)]
        left = {frame.targets.tobytes(): frame for frame in self.recorded.values()}
        with served.connect(role) as server:
            self.assertTrue(server.info.truth)
            self.refused(REPLAY_ONLY, server.target_list)
            with server.radar().stream(rate_hz=100, planes="power target", lossless=lossless, truth=True) as frames:
                for frame in frames:
                    recorded = left.pop(frame.targets.tobytes())
                    np.testing.assert_array_equal(frame.target, recorded.target)
                    if lossless:
                        self.assertIs(recorded, self.recorded[frame.frame_id])
                    if recorded is last:
                        break
        self.assertFalse(lossless and left)

    def nothing_comes(self, received):
        """received: type and bytes, for twice as many frames as a looped recording has: a viewer may miss some."""
        secrets = {record[name].tobytes() for frame in self.recorded.values() for record in frame.targets
                   for name in ("latitude_deg", "longitude_deg", "bearing_deg", "range_m")}
        kinds = []
        while kinds.count(wire.FRAME_END) < 2 * FRAMES:
            kind, data = next(received)
            kinds.append(kind)
            self.assertFalse([secret for secret in secrets if secret in data], f"type {kind}")
        self.assertIn(wire.WEDGE_BLOCK, kinds)
        self.assertNotIn(TARGET_BLOCK, kinds)

    def test_a_viewer_is_refused(self):
        with self.replay().connect("viewer") as server:
            self.truth_is_refused(server, self.radar)
            self.refused(REPLAY_ONLY, lambda: server.render(None, POSE, live_targets=True, truth=True))
            self.refused(REPLAY_ONLY, server.exercise)

    def test_nothing_of_it_is_among_the_bytes_for_a_viewer(self):
        with contextlib.closing(wire.Peer(self.replay("--loop").port, token_of("viewer"))) as peer:
            def received():
                while True:
                    kind, payload = peer.receive()
                    yield kind, payload + peer.plane

            peer.demand(wire.SUBSCRIBE, radar=self.radar, rate_hz=100, planes=[wire.pb.POWER])
            self.nothing_comes(received())

    def test_a_viewer_of_a_websocket_is_refused_and_gets_nothing_of_it(self):
        with self.replay("--loop").web_socket("viewer") as socket:
            power = {"radar": self.radar, "rate_hz": 100, "planes": ["POWER"]}
            self.refused(ROLE_TOO_LOW, lambda: socket.demand(wire.SUBSCRIBE, **power, truth=True))
            self.refused(ROLE_TOO_LOW, lambda: socket.demand(wire.SUBSCRIBE, **{**power, "planes": ["POWER", "TARGET"]}))
            self.refused(ROLE_TOO_LOW, lambda: socket.demand(GET_TARGETS))

            def received():
                while True:
                    kind, said = socket.receive()
                    self.assertNotEqual(said.get("plane"), "TARGET")
                    yield kind, socket.plane

            socket.demand(wire.SUBSCRIBE, **power)
            self.nothing_comes(received())

    def test_a_controller_gets_what_was_recorded(self):
        self.frames_are_as_recorded(self.replay(), "controller")

    def test_a_controller_of_a_websocket_does_too(self):
        with self.replay().web_socket("controller") as socket:
            socket.demand(wire.SUBSCRIBE, radar=self.radar, rate_hz=100, planes=["POWER"], lossless=True, truth=True)
            blocks, ended = {}, 0
            while ended < FRAMES:
                kind, said = socket.receive()
                ended += kind == wire.FRAME_END
                if kind == TARGET_BLOCK:
                    block = obliq.wire.TargetBlock(records=said["records"], record_bytes=said["record_bytes"])
                    blocks[int(said["frame_id"])] = obliq_targets.records_of(block, socket.plane)
        self.assertEqual(list(blocks), list(self.recorded))
        for frame_id, records in blocks.items():
            np.testing.assert_array_equal(records, self.recorded[frame_id].targets)

    def test_the_operator_names_the_role(self):
        self.frames_are_as_recorded(self.replay("--set", "server.truth_role=viewer"), "viewer")
        served = self.replay("--set", "server.truth_role=admin")
        with served.connect("controller") as server:
            self.truth_is_refused(server, self.radar)
        served = self.replay("--set", "server.truth_role=admin")
        self.frames_are_as_recorded(served, "admin")

    def test_it_ends_where_a_token_means_less(self):
        served = self.replay("--loop")
        with served.connect("controller") as server, server.radar().stream(rate_hz=100, planes="power", truth=True) as frames:
            self.assertEqual(set(next(frames).targets["id"]), self.told)
            served.give({"controller": "viewer"})
            served.process.send_signal(signal.SIGHUP)
            support.wait_until(lambda: next(frames).targets is None)
            self.assertEqual([next(frames).targets for _ in range(2 * FRAMES)], [None] * 2 * FRAMES)


class ReplayedPasses(Replayed):
    """Of a scanning antenna: dwells have what is in their bins, the replay has all at a pass's end."""

    radar, told = "scan", {5, 1 << 40}


if __name__ == "__main__":
    unittest.main()
