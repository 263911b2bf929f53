"""The asyncio client: the same bits, many tasks, no thread, an event loop that is never held."""
import asyncio
import contextlib
import threading
import time
import unittest

import support
from support import fake, obliq
import numpy as np


class Aio(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        self.server = await obliq.aio.connect(support.shared_daemon(), name="aio")
        self.radar = self.server.radar("main")

    async def asyncTearDown(self):
        await self.server.close()

    async def test_frames_are_those_of_the_blocking_client(self):
        with obliq.connect(support.shared_daemon()) as blocking:
            wanted = blocking.radar("main").frame().sha256()
        self.assertEqual((await self.radar.frame()).sha256(), wanted)
        frame = await self.server.render(await self.radar.settings, await self.radar.pose)
        self.assertEqual(frame.sha256(), wanted)
        async for frame in self.radar.stream(rate_hz=50):
            self.assertEqual(frame.sha256(), wanted)
            break
        self.assertEqual(threading.active_count(), 1)

    async def test_many_tasks_share_a_connection(self):
        pose, settings = await self.radar.pose, await self.radar.settings

        async def look(radar, count):
            ids = []
            async with self.server.radar(radar).stream(rate_hz=50, planes="state") as frames:
                async for frame in frames:
                    ids.append(frame.frame_id)
                    if len(ids) == count:
                        return ids

        async def render(bearing):
            return await self.server.render(settings, pose.replace(bearing_deg=bearing), planes="state")

        results = await asyncio.gather(look("main", 10), look("scan", 2), *(render(b) for b in range(4)),
                                       *(self.radar.info() for _ in range(10)))
        self.assertEqual(results[0], sorted(set(results[0])))
        self.assertEqual([frame.pose.bearing_deg for frame in results[2:6]], [0, 1, 2, 3])

    async def test_many_renders_come_in_their_order(self):
        pose, settings = await self.radar.pose, await self.radar.settings
        poses = [pose.replace(bearing_deg=b) for b in range(9)]
        found = [frame.pose.bearing_deg async for frame in self.server.render_many(poses, settings, planes="iq")]
        self.assertEqual(found, list(range(9)))
        poses[4] = pose.replace(height_m=1e6)
        found = [item async for item in self.server.render_many(poses, settings, planes="iq", return_exceptions=True)]
        self.assertIsInstance(found[4], obliq.InvalidValue)
        self.assertEqual(len(found), 9)

    async def test_control_is_claimed_and_released(self):
        async with self.radar.control() as control:
            await control.set_pose(bearing_deg=10.0)
            with self.assertRaises(obliq.InvalidValue):
                await control.set(r_min_m=-1.0)
            await control.set_state(freeze=False)
            control.send_pose(bearing_deg=20.0)
            self.assertEqual((await self.radar.pose).bearing_deg, 20.0)
            control.send_pose(bearing_deg=1e9)
            await self.radar.info()
            with self.assertRaises(obliq.InvalidValue):
                control.send_pose(bearing_deg=30.0)
            await control.set_pose(bearing_deg=60.0)
        self.assertEqual((await self.radar.info()).controller, "")

    async def test_wedges_make_the_frame(self):
        whole = await self.radar.frame(planes="iq")
        seen, count = np.zeros_like(whole.iq), 0
        async with self.radar.wedges(planes="iq") as wedges:
            async for wedge in wedges:
                seen[wedge.azimuth] = wedge.iq
                count += 1
                if count == 8:
                    break
        np.testing.assert_array_equal(seen, whole.iq)

    async def test_a_slow_reader_gets_the_newest_and_others_are_not_disturbed(self):
        slow = self.radar.stream(rate_hz=100, planes="state")
        await slow.__anext__()
        async with self.server.radar("scan").stream(planes="state") as passes:
            await passes.__anext__()
        await asyncio.sleep(0.5)
        frame = await slow.__anext__()
        self.assertGreater(frame.frames_skipped, 5)
        await slow.close()

    async def test_a_lossless_reader_that_is_slow_makes_the_radar_wait(self):
        async with self.radar.stream(rate_hz=100, planes="state", lossless=True) as frames:
            first = await frames.__anext__()
            await asyncio.sleep(0.3)
            ids = [(await frames.__anext__()).frame_id for _ in range(20)]
            await asyncio.sleep(0.3)
            # Frames wait before the answer to this, and are read on for it.
            self.assertEqual((await self.radar.info()).watchers, 1)
            await asyncio.sleep(0.3)
        self.assertEqual(ids, list(range(first.frame_id + 1, first.frame_id + 21)))
        self.assertEqual((await self.radar.info()).watchers, 0)

    async def test_cancelling_a_wait_leaves_a_connection_that_works(self):
        task = asyncio.create_task(self.server.render(None, dict(latitude_deg=33, longitude_deg=-99.5, height_m=2000),
                                                      planes="state"))
        await asyncio.sleep(0)
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
        self.assertEqual((await self.radar.frame(planes="state")).shape, (64, 96))


class Wrong(unittest.IsolatedAsyncioTestCase):
    async def test_errors_are_those_of_the_blocking_client(self):
        with self.assertRaises(obliq.CannotConnect):
            await obliq.aio.connect("127.0.0.1:1")
        with self.assertRaisesRegex(obliq.Untrusted, "TLS"):
            await obliq.aio.connect(support.shared_daemon(), tls=obliq.Tls())
        with fake(lambda peer: peer.socket.sendall(b"HTTP/1.1 400\r\n\r\n")) as server:
            with self.assertRaisesRegex(obliq.BadStream, "an HTTP server"):
                await obliq.aio.connect(server.address)
        with fake(lambda peer: peer.read() and time.sleep(1.5)) as server:
            with self.assertRaises(obliq.TimedOut):
                await obliq.aio.connect(server.address, timeout=0.3)

    async def test_a_server_that_goes_away_wakes_all_who_wait(self):
        def script(peer):
            peer.greet()
            peer.await_subscribe()
            time.sleep(0.2)

        with fake(script) as server:
            client = await obliq.aio.connect(server.address)
            waits = [asyncio.create_task(client.radar().frame(planes="state")), asyncio.create_task(client.status())]
            for result in await asyncio.gather(*waits, return_exceptions=True):
                self.assertIsInstance(result, obliq.ConnectionLost)
            with self.assertRaises(obliq.ConnectionLost):
                await client.status()
            await client.close()

    async def test_damage_reaches_who_waits_not_the_event_loop(self):
        seen = []
        asyncio.get_running_loop().set_exception_handler(lambda _, context: seen.append(context))

        def script(peer):
            peer.greet()
            peer.await_subscribe()
            peer.begin()
            peer.state_block(16)
            peer.stay()

        with fake(script) as server:
            async with obliq.aio.connect(server.address) as client:
                with self.assertRaisesRegex(obliq.BadStream, "does not fit"):
                    await client.radar().frame(planes="state")
        self.assertEqual(seen, [])

    async def test_a_stream_goes_on_when_the_daemon_is_back(self):
        with support.daemon() as address:
            port = address.split(":")[1]
            client = await obliq.aio.connect(address)
            stream = client.radar("main").stream(rate_hz=20, planes="state", reconnect=60)
            before = await stream.__anext__()
        with support.daemon(settings={"server.port": port}):
            for _ in range(4):
                after = await stream.__anext__()
            self.assertEqual(after.sha256(), before.sha256())
            await stream.close()
            await client.close()


if __name__ == "__main__":
    unittest.main()
