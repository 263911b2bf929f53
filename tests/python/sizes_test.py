"""Servers and recordings that claim sizes: memory follows what they bring."""
import pathlib
import tempfile
import unittest

from support import fake, obliq, wire
from obliq._protocol import wire as _wire


def connected(server):
    return obliq.connect(server.address, timeout=5.0)


def resident_mb():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 >> 20


def peak_mb():
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM")) >> 10


def lies(ranges, rows):
    """A pass of 16,384 azimuths, of which some come; the end says that the others were missed."""
    begin = wire.FrameBegin(frame_id=1, wedges=1)
    begin.frame.radar, begin.frame.frame_id = "main", 1
    begin.frame.settings.azimuth_bins, begin.frame.settings.range_bins = 16384, ranges
    yield begin, b""
    for row in range(0, rows, 16):
        n = min(16, rows - row)
        yield wire.WedgeBlock(frame_id=1, plane=3, first_azimuth=row, n_azimuth=n, n_range=ranges), bytes([1]) * (n * ranges)
    yield wire.FrameEnd(frame_id=1, missed=[wire.AzimuthSpan(first_azimuth=rows, n_azimuth=16384 - rows)]), b""


class Sizes(unittest.TestCase):
    def test_claims_of_size_cost_no_memory(self):
        def script(peer):
            peer.greet()
            peer.await_subscribe()
            peer.begin(16384, 1 << 18)  # 4 GB of states
            peer.state_block(8, 4)
            peer.stay()

        with fake(script) as server, connected(server) as client:
            before = resident_mb()
            with self.assertRaises(obliq.TimedOut):
                next(client.radar().stream(planes="state", timeout=0.5))
            self.assertLess(resident_mb() - before, 200)

    def test_what_is_said_to_be_missed_costs_no_memory(self):
        # 4 GB of states, of which one azimuth comes; then 1 GB, of which a thirty-second comes.
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "lies.obliq"
            for ranges, rows, whole in ((1 << 18, 1, 0), (1 << 16, 512, 1)):
                def script(peer, ranges=ranges, rows=rows):
                    for message, plane in lies(ranges, rows):
                        peer.send(message, 1, plane)
                    peer.stay()

                def subscribed(peer, script=script):
                    peer.greet()
                    peer.await_subscribe()
                    script(peer)

                path.write_bytes(b"".join(_wire.encode(message, number + 1, 1, plane)
                                          for number, (message, plane) in enumerate(lies(ranges, rows))))
                before = peak_mb()
                recording = obliq.open(path)
                frames = [(frame.state.shape, frame.missed, int(frame.state[-1].max())) for frame in recording]
                self.assertEqual(frames, whole * [((16384, ranges), (slice(rows, 16384),), 0)])
                self.assertEqual([loss.kind for loss in recording.losses], (1 - whole) * ["aborted"])
                with fake(subscribed) as server, connected(server) as client:
                    stream = client.radar().stream(planes="state", timeout=2.0)
                    if whole:
                        self.assertEqual(next(stream).state.shape, (16384, ranges))
                    else:
                        with self.assertRaises(obliq.TimedOut):
                            next(stream)
                        self.assertEqual(stream.frames_aborted, 1)
                self.assertLess(peak_mb() - before, 400)


if __name__ == "__main__":
    unittest.main()
