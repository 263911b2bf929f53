"""Servers that misbehave, and clients that are used wrongly: each ends with an error that says what it was."""
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest

import support
from support import fake, obliq, wire
from obliq._protocol import wire as _wire


def connected(server, **more):
    return obliq.connect(server.address, timeout=5.0, **more)


class Addresses(unittest.TestCase):
    def test_nobody_listens(self):
        with socket.create_server(("127.0.0.1", 0)) as held:
            port = held.getsockname()[1]
        with self.assertRaisesRegex(obliq.CannotConnect, "Is obliqd running there"):
            obliq.connect(f"127.0.0.1:{port}")
        with self.assertRaises(ConnectionError):
            obliq.connect("no-such-host.invalid:7420")

    def test_another_program_answers(self):
        for said, name in ((b"HTTP/1.1 400 Bad Request\r\n\r\n", "an HTTP server"), (b"SSH-2.0-x\r\n", "an SSH server"),
                           (b"hello world", "another program")):
            with fake(lambda peer: (peer.socket.sendall(said), time.sleep(0.2))) as server:
                with self.assertRaisesRegex(obliq.BadStream, name):
                    connected(server)

    def test_something_accepts_and_says_nothing(self):
        with fake(lambda peer: peer.stay()) as server:
            with self.assertRaisesRegex(obliq.BadStream, "Ack answers a request; allowed: Welcome"):
                obliq.connect(server.address, timeout=0.5)
        silent = socket.create_server(("127.0.0.1", 0))
        with silent, self.assertRaisesRegex(obliq.TimedOut, "not obliqd, or too busy"):
            obliq.connect(f"127.0.0.1:{silent.getsockname()[1]}", timeout=0.5)

    def test_tls_is_not_spoken_there(self):
        with self.assertRaisesRegex(obliq.Untrusted, "TLS is not spoken there|closed during the TLS"):
            obliq.connect(support.shared_daemon(), tls=obliq.Tls())

    def test_wrong_words_fail_before_anything_is_sent(self):
        for words, said in (({"timeout": "x"}, "timeout: found 'x'; allowed: a number"), ({"name": None}, "name: found NoneType"),
                            ({"tls": "cert.pem"}, "tls: found 'cert.pem'"), ({"token": 5}, "token: found int")):
            with self.assertRaisesRegex(TypeError, said):
                obliq.connect("127.0.0.1:1", **words)
        with self.assertRaisesRegex(ValueError, "timeout: found 0"):
            obliq.connect("127.0.0.1:1", timeout=0)

    def test_both_kinds_of_token_are_a_mistake(self):
        with self.assertRaises(TypeError):
            obliq.connect("127.0.0.1:1", token="a", token_file="b")


class Tls(support.Folder):
    def setUp(self):
        super().setUp()
        made = subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                               "-keyout", "key.pem", "-out", "cert.pem", "-days", "2", "-subj", "/CN=localhost", "-addext",
                               "subjectAltName=IP:127.0.0.1"], cwd=self.folder, capture_output=True)
        if made.returncode:
            self.skipTest("openssl made no certificate")
        tokens = self.folder / "tokens"
        tokens.write_text("viewer looktoken0123456789abcdef\ncontroller flytoken0123456789abcdef01\n")
        tokens.chmod(0o600)
        self.settings = {"server.tls_certificate": f'"{self.folder}/cert.pem"', "server.tls_key": f'"{self.folder}/key.pem"',
                         "server.tokens": f'"{tokens}"'}
        self.tls = obliq.Tls(ca_file=self.folder / "cert.pem")

    def test_certificates_tokens_and_roles(self):
        with support.daemon(settings=self.settings) as address:
            with obliq.connect(address, tls=self.tls, token="looktoken0123456789abcdef") as server:
                self.assertEqual(server.info.role, "viewer")
                self.assertEqual(server.radar("main").frame().shape, (64, 96))
                with self.assertRaises(PermissionError) as caught:
                    with server.radar("main").control():
                        pass
                self.assertEqual(caught.exception.number, 108)
            token_file = self.folder / "mine"
            token_file.write_text("flytoken0123456789abcdef01\n")
            with obliq.connect(address, tls=self.tls, token_file=token_file) as server:
                with server.radar("main").control() as control:
                    control.set_pose(bearing_deg=61.0)
            for token in ("wrong", None):
                with self.assertRaises(obliq.Unauthorized) as caught:
                    obliq.connect(address, tls=self.tls, token=token)
                self.assertEqual(caught.exception.number, 11)
            with self.assertRaisesRegex(obliq.Untrusted, "ca_file"):
                obliq.connect(address, tls=obliq.Tls())
            with self.assertRaisesRegex(obliq.Unauthorized, "tls=obliq.Tls"):
                obliq.connect(address)


class Streams(unittest.TestCase):
    """What arrives is wrong in one way."""

    def fails(self, script, error, words, planes="state"):
        def whole(peer):
            peer.greet()
            peer.await_subscribe()
            script(peer)

        with fake(whole) as server, connected(server) as client:
            with self.assertRaisesRegex(error, words):
                for _ in client.radar().stream(planes=planes, timeout=5.0):
                    pass
            # Over for good where the bytes are no longer to be trusted.
            if error is not obliq.TimedOut:
                with self.assertRaises(obliq.ObliqError):
                    client.status()

    def test_a_server_of_another_version(self):
        def script(peer):
            hello = peer.read()
            data = bytearray(peer.bytes_of(wire.Welcome(request_id=hello.request_id, major=2)))
            data[4] = 2
            peer.socket.sendall(data)

        with fake(script) as server, self.assertRaisesRegex(obliq.BadStream, "found 2.2; allowed: 1.x"):
            connected(server)

    def test_the_server_goes_away(self):
        message = _wire.encode(wire.WedgeBlock(plane=3, n_azimuth=8, n_range=4), 9, 1, bytes(32))
        for cut in (0, 20, 48, 60):
            self.fails(lambda peer, cut=cut: peer.socket.sendall(message[:cut]), obliq.ConnectionLost,
                       "between two messages" if cut == 0 else "in the middle of a message")

    def test_a_damaged_message(self):
        def script(peer):
            data = bytearray(peer.bytes_of(wire.FrameEnd(frame_id=1), 1))
            data[-1] ^= 1
            peer.socket.sendall(data)
            peer.stay()

        self.fails(script, obliq.BadStream, "CRC mismatch")

    def test_blocks_that_do_not_fit(self):
        def with_blocks(send):
            def script(peer):
                peer.begin()
                send(peer)
                peer.end()
                peer.stay()
            return script

        self.fails(with_blocks(lambda p: p.state_block(16)), obliq.BadStream, "does not fit the frame")
        self.fails(with_blocks(lambda p: p.state_block(first_azimuth=1)), obliq.BadStream, "does not fit the frame")
        self.fails(with_blocks(lambda p: (p.state_block(), p.state_block())), obliq.BadStream, "overlaps another")
        self.fails(with_blocks(lambda p: p.state_block(ranges=2, first_range=1)), obliq.BadStream, "leaves a gap")
        self.fails(with_blocks(lambda p: p.state_block(4)), obliq.BadStream, "16 values of state missing")
        self.fails(with_blocks(lambda p: p.state_block(plane=b"123")), obliq.BadStream, "wrong size")
        self.fails(with_blocks(lambda p: p.state_block(azimuth_step=2)), obliq.BadStream, "does not fit the frame")

    def test_frames_whose_sizes_lie(self):
        for azimuths, ranges in ((1 << 30, 4), (8, 1 << 30), (0, 4), (8, -1)):
            self.fails(lambda p, a=azimuths, r=ranges: (p.begin(a, r), p.stay()), obliq.BadStream, "allowed: 1 to 16384")
        self.fails(lambda p: (p.begin(16384, 1 << 24), p.stay()), obliq.BadStream, "allowed: at most")

    def test_more_missed_than_the_frame_has(self):
        def script(peer):
            peer.begin()
            peer.end(missed=[wire.AzimuthSpan(first_azimuth=0, n_azimuth=8)] * 1000)
            peer.stay()

        self.fails(script, obliq.BadStream, "more azimuth bins were missed")

    def test_what_a_server_says_does_not_steer_a_terminal(self):
        evil = "\x1b[31mred\x07\nobliq: all is well \u202eback\x9b"
        refused = wire.Error(request_id=1, number=100, text=evil, radar=evil, fields=[
            wire.FieldFault(field=evil, found=evil, allowed=evil)])
        error = obliq.errors.from_message(refused)
        self.assertIsInstance(error, obliq.InvalidValue)
        texts = [str(error), str(error.faults[0]), str(obliq.FrameAborted(evil)), str(obliq.BadStream(evil, 3)),
                 str(obliq.recording.Loss("aborted", 0, evil))]

        def script(peer):
            peer.greet(scene_name=evil)
            peer.stay()

        with fake(script) as server, connected(server) as client:
            texts.append(repr(client))
        for text in texts:
            self.assertTrue(text.isprintable(), repr(text))
            self.assertIn("\\x1b[31mred\\x07\\nobliq: all is well \\u202eback\\x9b", text)

    def test_a_server_that_falls_silent_is_taken_for_dead(self):
        def script(peer):
            peer.greet(heartbeat_s=0.1)
            peer.await_subscribe()
            time.sleep(3)

        with fake(script) as server, connected(server) as client:
            with self.assertRaisesRegex(obliq.ConnectionLost, "said nothing for"):
                next(client.radar().stream(planes="state", timeout=20))

    def test_what_a_later_version_adds_is_skipped(self):
        def script(peer):
            peer.greet()
            peer.await_subscribe()
            data = bytearray(peer.bytes_of(wire.Ack(request_id=99)))
            data[6:8] = (77).to_bytes(2, "little")  # a type that is not known
            data[40:44] = bytes(4)
            data[40:44] = _wire.crc32c(bytes(data[48:]), _wire.crc32c(bytes(data[:48]))).to_bytes(4, "little")
            peer.socket.sendall(data)
            peer.begin()
            peer.state_block(plane=bytes([9]) * 32)  # a state that is not known: kept as it came
            peer.end()
            peer.stay()

        with fake(script) as server, connected(server) as client:
            self.assertEqual(int(client.radar().frame(planes="state").state[0, 0]), 9)

    def test_video_is_decoded_in_eight_and_sixteen_bits(self):
        for width in (1, 2):
            def script(peer, width=width):
                peer.greet()
                request = peer.await_subscribe()
                assert list(request.planes) == [4]
                peer.begin()
                values = bytes(range(32 * width))
                peer.send(wire.WedgeBlock(frame_id=1, plane=4, n_azimuth=8, n_range=4), 1, values)
                peer.end()
                peer.stay()

            with fake(script) as server, connected(server) as client:
                frame = client.radar().frame(planes="video")
                self.assertEqual((frame.video.itemsize, frame.video.shape), (width, (8, 4)))
                self.assertEqual(frame.video.tobytes(), bytes(range(32 * width)))

    def test_an_aborted_render_and_an_aborted_live_frame(self):
        def script(peer):
            peer.greet()
            request = peer.read()
            peer.send(wire.Ack(request_id=request.request_id))
            peer.begin(request_id=request.request_id, stream_id=5)
            peer.send(wire.FrameAbort(frame_id=1, request_id=request.request_id, reason="stopping"), 5)
            peer.await_subscribe()
            peer.begin()
            peer.send(wire.FrameAbort(frame_id=1, reason="new settings"), 1)
            peer.begin(frame_id=2)
            peer.state_block(frame_id=2)
            peer.end(frame_id=2)
            peer.stay()

        with fake(script) as server, connected(server) as client:
            with self.assertRaisesRegex(obliq.FrameAborted, "stopping"):
                client.render(None, dict(latitude_deg=1, longitude_deg=2, height_m=3), planes="state")
            with client.radar().stream(planes="state", timeout=5) as frames:
                self.assertEqual(next(frames).frame_id, 2)
                self.assertEqual(frames.frames_aborted, 1)

    def test_errors_of_the_server_become_exceptions_with_advice(self):
        for number, kind in ((8, obliq.ServerFull), (9, obliq.ServerStopping), (10, obliq.Refused), (14, obliq.ServerFull)):
            def script(peer, number=number):
                peer.greet()
                peer.await_subscribe()
                peer.send(wire.Error(number=number, text="so it is"))

            with fake(script) as server, connected(server) as client:
                with self.assertRaises(kind) as caught:
                    next(client.radar().stream(planes="state", timeout=5))
                self.assertEqual(caught.exception.number, number)
                self.assertIn("so it is", str(caught.exception))


class Use(unittest.TestCase):
    def test_after_close(self):
        server = obliq.connect(support.shared_daemon())
        stream = server.radar("main").stream(planes="state")
        server.close()
        server.close()
        for use in (server.status, lambda: list(stream), lambda: server.radar("main").frame()):
            with self.assertRaisesRegex(obliq.ConnectionLost, "closed by close"):
                use()

    def test_from_two_threads_at_once(self):
        with obliq.connect(support.shared_daemon()) as server:
            with server.radar("main").control() as control:
                control.set_state(transmit=False)
                failures = []

                def wait():
                    try:
                        server.radar("main").frame(timeout=1.0)
                    except Exception as error:
                        failures.append(error)

                thread = threading.Thread(target=wait)
                thread.start()
                time.sleep(0.3)
                with self.assertRaisesRegex(RuntimeError, "another thread"):
                    server.status()
                thread.join()
                self.assertIsInstance(failures[0], obliq.TimedOut)
                control.set_state(transmit=True)

    def test_after_a_fork(self):
        with obliq.connect(support.shared_daemon()) as server:
            read, write = os.pipe()
            child = os.fork()
            if child == 0:
                try:
                    server.status()
                    said = b"nothing"
                except RuntimeError as error:
                    said = str(error).encode()
                os.write(write, said)
                os._exit(0)
            os.waitpid(child, 0)
            self.assertIn(b"after a fork", os.read(read, 1000))
            os.close(read)
            os.close(write)
            self.assertEqual(server.radar("main").frame(planes="state").shape, (64, 96))

    def test_ctrl_c_leaves_a_connection_that_works(self):
        code = ("import sys, obliq\n"
                "with obliq.connect(sys.argv[1]) as server:\n"
                "    radar = server.radar('main')\n"
                "    try:\n"
                "        for frame in radar.stream(rate_hz=100, planes='iq'): print('frame', flush=True)\n"
                "    except KeyboardInterrupt: pass\n"
                "    print('then', radar.frame(planes='state').shape)\n")
        child = subprocess.Popen([sys.executable, "-c", code, support.shared_daemon()], stdout=subprocess.PIPE, text=True,
                                 env={**os.environ, "PYTHONPATH": str(support.ROOT / "client/python/src")})
        child.stdout.readline()
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=30)
        self.assertIn("then (64, 96)", out)
        self.assertEqual(child.returncode, 0)

    def test_ctrl_c_in_the_middle_of_a_message_waits_for_its_end(self):
        code = ("import os, signal, sys, obliq\n"
                "from obliq._protocol.session import Session\n"
                "fed = 0\n"
                "def feed(self, message, before=Session.feed):\n"
                "    global fed\n"
                "    fed += 1\n"
                "    if fed == 40: os.kill(os.getpid(), signal.SIGINT)\n"
                "    before(self, message)\n"
                "Session.feed = feed\n"
                "with obliq.connect(sys.argv[1]) as server:\n"
                "    radar = server.radar('main')\n"
                "    try:\n"
                "        for frame in radar.stream(rate_hz=100, planes='iq'): pass\n"
                "    except KeyboardInterrupt: print('interrupted')\n"
                "    print('then', radar.frame(planes='state').shape)\n")
        child = subprocess.run([sys.executable, "-c", code, support.shared_daemon()], capture_output=True, text=True, timeout=30, check=False,
                               env={**os.environ, "PYTHONPATH": str(support.ROOT / "client/python/src")})
        self.assertEqual((child.stdout, child.returncode), ("interrupted\nthen (64, 96)\n", 0), child.stderr)

    def test_exceptions_pass_between_processes(self):
        import pickle

        for error in (obliq.InvalidValue(100, "no", [obliq.Fault("radar.r_min_m", "1", "2")], "main"),
                      obliq.BadStream("why", 5), obliq.FrameAborted("why"), obliq.TimedOut("so")):
            back = pickle.loads(pickle.dumps(error))
            self.assertEqual((type(back), str(back)), (type(error), str(error)))


if __name__ == "__main__":
    unittest.main()
