"""Targets by Python: set, listed, seen in frames with the truth beside them; in a recording; what is refused."""
import asyncio
import math
import pathlib
import tempfile
import time
import unittest

import numpy as np

import support
import obliq
from obliq import targets as obliq_targets

SCENE = support.SCENE + """
[target_types.truck]
rcs_dbsm = 40.0
swerling = 0
top_m = 4.0
"""
POSE = {"latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1500.0, "bearing_deg": 60.0, "sim_time_ns": 0}


def north_of(metres, east=0.0):
    """A place so far from the antenna, good enough for a bin or two."""
    return {"latitude_deg": 33.0 + metres / 110920.0, "longitude_deg": -99.5 + east / 93450.0}


class Targets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = support.daemon(SCENE)
        cls.address = cls.daemon.__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.daemon.__exit__(None, None, None)
        cls.folder.cleanup()

    def server(self):
        return obliq.connect(self.address)

    def test_are_set_listed_and_removed(self):
        with self.server() as server, server.targets() as world:
            self.assertEqual(world.clear(), ())
            world.set({"id": 2, "type": "truck", **north_of(4000)}, obliq.Target(id=3, **north_of(5000), sim_time_ns=0))
            world.set(id=7, name="seven", velocity_north_m_s=12.0, **north_of(3000),
                      route=None, height_reference="datum", height_m=900.0)
            found = world.list()
            self.assertEqual([target.id for target in found], [2, 3, 7])
            self.assertEqual((found[0].rcs_dbsm, found[0].swerling, found[0].top_m), (40, 0, 4))
            self.assertEqual((found[2].name, found[2].height_reference), ("seven", "datum"))
            self.assertGreaterEqual(found[2].age_s, 0)
            self.assertEqual(found[1].sim_time_ns, 0)
            world.remove(2, 7)
            self.assertEqual([target.id for target in server.target_list()], [3])
            route = obliq.Route((33.01, 33.02), (-99.5, -99.49), 15.0, loops=True)
            world.set(id=3, route=route)
            again = world.list()[0].route
            self.assertEqual((again.latitude_deg, again.loops), ((33.01, 33.02), True))
            world.replace([{"id": 9, **north_of(3000)}])
            self.assertEqual([target.id for target in world.list()], [9])
            world.set(*world.list())  # what was listed can be set

    def test_stand_in_frames_with_the_truth_beside_them(self):
        own = [{"id": 5, "type": "truck", **north_of(3000, 5000)}, {"id": 6, "rcs_dbsm": 30, **north_of(-4000)}]
        with self.server() as server:
            bare = server.render(None, POSE, planes="power")
            frame = server.render(None, POSE, planes="power", targets=own, truth=True)
            self.assertIsNone(bare.targets)
            self.assertEqual(list(frame.targets["id"]), [5, 6])
            first = frame.targets[0]
            self.assertAlmostEqual(first["bearing_deg"], math.degrees(math.atan2(5000, 3000)), 1)
            self.assertEqual(frame.targets["azimuth_bin"][1], -1)
            if first["share_seen"] > 0:
                bin_of = np.unravel_index(np.argmax(frame.power - bare.power), frame.power.shape)
                self.assertEqual(bin_of, (first["azimuth_bin"], first["range_bin"]))
                labels = server.render(None, POSE, planes="target power", targets=own)
                self.assertEqual(labels.target[bin_of], 5)
                self.assertEqual(set(np.unique(labels.target)), {0, 5})
            self.assertIn(obliq_targets.HIDDEN_BY[first["hidden_by"]], obliq_targets.HIDDEN_BY)
            many = list(server.render_many([POSE, (POSE, None, own)], planes="power", truth=True))
            self.assertEqual([len(each.targets) for each in many], [0, 2])
            np.testing.assert_array_equal(many[1].power, frame.power)

    def test_of_the_world_come_with_streams_and_recordings(self):
        with self.server() as server, server.targets() as world:
            world.replace([{"id": 1, "type": "truck", "name": "one", **north_of(3000, 4000)}])
            for radar in ("main", "scan"):
                with server.radar(radar).stream(rate_hz=10, planes="power", truth=True) as frames:
                    for frame in frames:
                        if frame.descriptor.targets and not frame.missed:
                            break
                self.assertEqual(list(frame.targets["id"]), [1], radar)
                self.assertIsNone(server.radar(radar).frame(planes="power").targets)
            path = pathlib.Path(self.folder.name) / "targets.obliq"
            support.run(support.OBLIQ, "record", "--server", self.address, "--radar", "main", "--truth", "--rate", "20",
                        "--frames", "3", "--out", path)
            self.assertEqual([list(frame.targets["id"]) for frame in obliq.open(path)], [[1]] * 3)
            lines = support.run(support.OBLIQ, "replay", path, "--targets", "-").splitlines()
            self.assertEqual(len(lines), 4)
            self.assertEqual(dict(zip(lines[0].split(","), lines[1].split(",")))["id"], "1")

    def test_a_thousand_take_ten_milliseconds_of_its_own_time(self):
        many = [{"id": k + 1, "type": "truck", "sim_time_ns": 0, "velocity_north_m_s": 3.0, **north_of(2000 + k)}
                for k in range(1000)]
        with self.server() as server, server.targets() as world:
            times = []
            for _ in range(7):
                begin = time.process_time()
                world.replace(many)
                times.append(time.process_time() - begin)
            self.assertEqual(len(world.list()), 1000)
            world.clear()
        print(f"1,000 targets: {1e3 * min(times):.1f} ms of Python's own time", flush=True)

    def test_mistakes_are_told(self):
        with self.server() as server:
            with server.targets() as world:
                with self.assertRaisesRegex(TypeError, "lattitude_deg"):
                    world.set(id=1, lattitude_deg=3)
                with self.assertRaisesRegex(ValueError, "target 1: found 700.* bytes; allowed: at most 65536"):
                    world.set(id=1, name="x" * 70_000)
                world.remove(*range(1, 50_000))  # more than one message holds
                with self.assertRaisesRegex(TypeError, "rcs_dbsm='much'"):
                    world.set({"id": 1, "rcs_dbsm": "much"})
                with self.assertRaisesRegex(ValueError, "without an id"):
                    world.set(latitude_deg=3.0)
                with self.assertRaisesRegex(ValueError, "height_reference"):
                    world.set(id=1, height_reference="sea")
                with self.assertRaises(obliq.InvalidValue) as refused:
                    world.set({"id": 1, **north_of(3000), "type": "tank"})
                self.assertIn("targets[0].type", str(refused.exception))
                with self.server() as other, self.assertRaises(obliq.NotInControl), other.targets():
                    pass

    def test_of_a_data_set_are_its_labels(self):
        own = [{"id": 5, "type": "truck", **north_of(3000, 5000)}, {"id": 6, "rcs_dbsm": 30, **north_of(-4000)}]
        lines = [{"id": "with", **POSE, "targets": own}, {"id": "without", **POSE}, {"id": "none", **POSE, "targets": []}]
        done = obliq.batch(lines, self.folder.name + "/set", server=self.address, planes="power")
        self.assertEqual((done.frames, done.failed), (3, 0))
        frames = {frame.id: frame for frame in obliq.Dataset(self.folder.name + "/set")}
        self.assertEqual(list(frames["with"].targets["id"]), [5, 6])
        self.assertIsNone(frames["without"].targets)
        self.assertEqual(len(frames["none"].targets), 0)
        with self.server() as server:
            alone = server.render(None, POSE, planes="power", targets=own, truth=True).targets
        for name in ("latitude_deg", "elevation_deg", "share_seen", "hidden_by"):
            np.testing.assert_array_equal(alone[name], frames["with"].targets[name], name)
        with self.assertRaisesRegex(ValueError, r"line 1: targets\[0\]"):
            obliq.batch([{"id": 1, **POSE, "targets": [{"id": 1, "rcs": 3}]}], self.folder.name + "/bad", server=self.address)

    def test_by_asyncio_it_is_the_same(self):
        async def session():
            async with obliq.aio.connect(self.address) as server:
                async with server.targets() as world:
                    await world.replace([{"id": 4, **north_of(3000, 4000)}])
                    frame = await server.render(None, POSE, planes="power", live_targets=True, truth=True)
                    found = await server.target_list()
                    return list(frame.targets["id"]), [target.id for target in found]

        self.assertEqual(asyncio.run(session()), ([4], [4]))


if __name__ == "__main__":
    unittest.main()
