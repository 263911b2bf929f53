"""Ground queries from Python, blocking and asyncio, against a daemon."""
import asyncio
import unittest

import support
from support import obliq, wire
import numpy as np
from obliq import ground


class Queries(unittest.TestCase):
    def setUp(self):
        self.server = obliq.connect(support.shared_daemon(), name="test")
        self.addCleanup(self.server.close)
        self.radar = self.server.radar("main")

    def places(self, n=40):
        """A raster around the antenna."""
        pose = self.radar.pose
        latitude, longitude = np.meshgrid(pose.latitude_deg + np.linspace(-0.08, 0.08, n),
                                          pose.longitude_deg + np.linspace(-0.08, 0.08, n), indexing="ij")
        return latitude, longitude

    def test_arrays_have_the_shape_of_the_places(self):
        latitude, longitude = self.places()
        got = self.radar.query(latitude, longitude)
        self.assertEqual(got.shape, latitude.shape)
        np.testing.assert_array_equal(got.latitude_deg, latitude)
        self.assertTrue(got.known.all())
        self.assertTrue(np.isfinite(got.height_m).all())
        self.assertTrue(got.visible.all())  # hills of 100 m from 1500 m
        self.assertEqual(set(got.sight_name.ravel()), {"visible"})
        self.assertEqual(got.antenna.height_m, 1500.0)
        self.assertEqual(got.material_name.shape, latitude.shape)
        np.testing.assert_allclose(got.point_height_m, got.height_m, atol=1e-3)
        self.assertEqual(got.sight.dtype, np.uint8)

    def test_a_hidden_point_is_seen_once_it_is_raised_by_its_angle(self):
        latitude, longitude = self.places()
        low = self.radar.pose.replace(height_m=float(self.radar.query(latitude, longitude).height_m.max()) + 5)
        got = self.server.query(latitude, longitude, antenna=low)
        hidden = ~got.visible
        self.assertTrue(0.1 < hidden.mean() < 0.99, hidden.mean())
        again = self.server.query(latitude[hidden], longitude[hidden], got.height_m[hidden] + 2000, antenna=low)
        self.assertTrue(again.visible.all())
        self.assertTrue((again.clearance_deg > 0).all())
        self.assertTrue((got.clearance_deg[hidden] < 0).all())

    def test_more_points_than_the_limit_are_asked_in_several_queries(self):
        latitude, longitude = self.places(110)
        got = self.server.query(latitude, longitude)
        self.assertEqual(got.shape, (110, 110))
        one = self.server.query(latitude[90, 5], longitude[90, 5])
        self.assertEqual(one.shape, ())
        self.assertEqual(float(one.height_m), got.height_m[90, 5])
        self.assertIsNone(got.antenna)
        self.assertEqual(set(got.sight_name.ravel()), {"not_asked"})

    def test_bearing_and_range_lead_to_the_ground_of_that_range(self):
        got = self.radar.query(bearing_deg=np.arange(0, 360, 30.0), range_m=5000.0)
        self.assertEqual(got.shape, (12,))
        self.assertTrue(got.known.all())
        back = self.server.query(got.latitude_deg, got.longitude_deg, antenna=self.radar.pose)
        np.testing.assert_allclose(back.height_m, got.height_m, atol=1e-3)
        near = self.radar.query(bearing_deg=0.0, range_m=10.0)
        self.assertEqual(int(near.state), ground.STATES.index("too_near"))
        self.assertTrue(np.isnan(near.height_m) and np.isnan(near.latitude_deg))

    def test_places_off_the_model_are_said(self):
        got = self.radar.query([0.0], [0.0])
        self.assertEqual(ground.STATES[got.state[0]], "outside")
        self.assertTrue(np.isnan(got.height_m[0]))
        self.assertEqual(got.sight_name[0], "no_height")
        self.assertEqual(got.material_name[0], "")

    def test_what_cannot_be_asked_fails_before_or_is_refused_by_field(self):
        with self.assertRaisesRegex(TypeError, "latitude_deg and longitude_deg, or bearing_deg and range_m"):
            self.server.query(1.0)
        with self.assertRaisesRegex(TypeError, "latitude_deg and longitude_deg, or bearing_deg and range_m"):
            self.radar.query(1.0, 2.0, bearing_deg=3.0, range_m=4.0)
        with self.assertRaisesRegex(ValueError, r"latitude_deg\[1\]: found nan"):
            self.server.query([1.0, np.nan], 2.0)
        with self.assertRaisesRegex(ValueError, "height_reference='sea'"):
            self.server.query(1.0, 2.0, 3.0, height_reference="sea")
        with self.assertRaises(obliq.InvalidValue) as refused:
            self.server.query([1.0, 91.0], 2.0)
        self.assertEqual(refused.exception.faults[0].field, "latitude_deg[1]")
        with self.assertRaisesRegex(obliq.InvalidValue, "below the ground"):
            self.server.query(1.0, 2.0, antenna=self.radar.pose.replace(height_m=-900.0))
        self.radar.info()  # the connection goes on

    def test_asyncio_says_the_same(self):
        latitude, longitude = self.places(12)

        async def ask():
            async with obliq.aio.connect(support.shared_daemon()) as server:
                both = await asyncio.gather(server.radar("main").query(latitude, longitude, 2000.0), server.query(
                    latitude, longitude))
                with self.assertRaises(obliq.InvalidValue):
                    await server.query(91.0, 0.0)
                return both
        seen, there = asyncio.run(ask())
        expected = self.radar.query(latitude, longitude, 2000.0)
        for name, _ in ground.MEMBERS:
            np.testing.assert_array_equal(getattr(seen, name), getattr(expected, name), name)
        np.testing.assert_array_equal(there.height_m, expected.height_m)


class OtherServers(unittest.TestCase):
    def test_an_old_server_is_told_apart(self):
        with support.fake(lambda peer: (peer.greet(), peer.stay())) as server, obliq.connect(server.address) as client:
            with self.assertRaisesRegex(obliq.ObliqError, "answers no ground queries"):
                client.query(1.0, 2.0)

    def test_records_of_a_later_version_are_longer(self):
        def script(peer):
            peer.greet(max_query_points=10)
            request = peer.read()
            record = np.zeros(1, ground.RECORD)
            record["height_m"], record["building"] = 12.5, 7
            peer.send(wire.GroundAnswer(request_id=request.request_id, points=1, record_bytes=72),
                      plane=record.tobytes() + bytes(8))
            peer.stay()
        with support.fake(script) as server, obliq.connect(server.address) as client:
            got = client.query(1.0, 2.0)
            self.assertEqual((float(got.height_m), int(got.building)), (12.5, 7))

    def test_sizes_that_lie_are_a_bad_stream(self):
        for points, record_bytes, plane in ((2, 64, 64), (1, 32, 32), (1, 64, 65)):
            def script(peer):
                peer.greet(max_query_points=10)
                request = peer.read()
                peer.send(wire.GroundAnswer(request_id=request.request_id, points=points, record_bytes=record_bytes),
                          plane=bytes(plane))
                peer.stay()
            with support.fake(script) as server, obliq.connect(server.address) as client:
                with self.assertRaisesRegex(obliq.BadStream, "GroundAnswer"):
                    client.query(1.0, 2.0)


if __name__ == "__main__":
    unittest.main()
