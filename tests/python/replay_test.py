"""Pause, speed and place of a served replay."""
import asyncio
import unittest

import made_recording
import support
from support import Folder, obliq, programs


class Replayed(Folder):
    def setUp(self):
        super().setUp()
        path = self.folder / "made.obliq"
        self.begins = made_recording.write(path, seconds=60, azimuths=32, ranges=16)
        self.replay = programs.replay(path, "--hold")
        self.addCleanup(self.replay.stop)
        self.address = self.replay.address

    def test_its_state_is_that_of_the_recording(self):
        with obliq.connect(self.address) as server:
            state = server.replay.state()
            self.assertEqual(server.radar().settings.frustum, "polar")
            self.assertEqual(server.radar().frame(planes="video").settings.frustum, "polar")
        self.assertEqual((state.radar, state.position_s, state.speed), ("main", 0.0, 1.0))
        self.assertAlmostEqual(state.duration_s, 59.91, places=2)
        self.assertEqual(state.start.astype("i8"), made_recording.START_NS)
        self.assertFalse(state.paused or state.running or state.loop or state.ended)

    def test_what_one_client_sets_holds_for_the_other(self):
        with obliq.connect(self.address) as server, obliq.connect(self.address) as other:
            server.replay.pause()
            with server.radar().stream(rate_hz=100, planes="video") as frames:
                for number in (300, 20, 598):
                    server.replay.seek(self.begins[number] * 1e-9 + 0.05)
                    frame = next(frames)
                    # The one before the place, unless that of the place has replaced it: a newer frame wins.
                    while frame.pose.pose_id not in (number, number + 1):
                        frame = next(frames)
                    self.assertEqual(frame.video[0, 0], (frame.pose.pose_id - 1) % 251)
                    self.assertAlmostEqual(other.replay.state().position_s, number * 0.1 + 0.05, places=6)
                other.replay.seek(sim_time_ns=made_recording.SIM_START_NS + self.begins[77])
                while next(frames).pose.pose_id not in (77, 78):
                    pass
                self.assertTrue(server.replay.state().paused)
                self.assertEqual(server.replay.state().seeks, 4)
                other.replay.set_speed(50)
                other.replay.resume()
                ids = [next(frames).pose.pose_id for _ in range(5)]
                self.assertEqual(ids, sorted(ids))
                self.assertEqual(server.replay.state().speed, 50)

    def test_bad_wishes_are_refused_by_name(self):
        with obliq.connect(self.address) as server:
            with self.assertRaisesRegex(obliq.InvalidValue, "seek_s: found 1000.0; allowed: 0 to 59.9"):
                server.replay.seek(1000)
            with self.assertRaisesRegex(obliq.InvalidValue, "speed: found 0.0; allowed: 0.01 to 1000000"):
                server.replay.set_speed(0)
            with self.assertRaisesRegex(TypeError, "a position in seconds, or sim_time_ns"):
                server.replay.seek()

    def test_a_bookmark_is_a_place_for_all(self):
        with obliq.connect(self.address) as server, obliq.connect(self.address) as other:
            server.replay.pause()
            for place_s, text in ((30.05, "the butte"), (4.05, "früher")):
                server.replay.seek(place_s)
                server.bookmark(text)
            marks = other.bookmarks()
            self.assertEqual([mark.text for mark in marks], ["the butte", "früher"])
            self.assertEqual([mark.utc_ns - made_recording.START_NS for mark in marks], [30_050_000_000, 4_050_000_000])
            other.replay.seek(bookmark=marks[0].number)
            self.assertAlmostEqual(server.replay.state().position_s, 30.05, places=6)
            self.assertEqual(server.events(after=marks[0].number), marks[1:])
            for text, size in (("", 0), ("x" * 1_000_000, 1_000_000), ("ö" * 501, 1002)):
                with self.assertRaisesRegex(ValueError, f"text: found {size} bytes; allowed: 1 to 1000 bytes"):
                    server.bookmark(text)
            with self.assertRaisesRegex(obliq.InvalidValue, "found a control character at byte 1"):
                server.bookmark("a\nb")
            with self.assertRaisesRegex(obliq.InvalidValue, "seek_bookmark: found 99; allowed: the number of an event"):
                server.replay.seek(bookmark=99)
            with self.assertRaisesRegex(TypeError, "or bookmark"):
                server.replay.seek(1.0, bookmark=1)

    def test_asyncio_has_the_same(self):
        async def run():
            async with obliq.aio.connect(self.address) as server:
                await server.replay.pause()
                await server.replay.seek(12.05)
                async for frame in server.radar().stream(rate_hz=100, planes="video"):
                    if frame.pose.pose_id in (120, 121):
                        return await server.replay.state()

        state = asyncio.run(run())
        self.assertTrue(state.paused)
        self.assertAlmostEqual(state.position_s, 12.05, places=6)


class Live(unittest.TestCase):
    def test_a_live_server_is_none(self):
        with obliq.connect(support.shared_daemon()) as server:
            with self.assertRaisesRegex(obliq.ReplayOnly, "radars are live"):
                server.replay.state()
            with self.assertRaisesRegex(obliq.ReplayOnly, "radars are live.*error 126"):
                server.replay.pause()


if __name__ == "__main__":
    unittest.main()
