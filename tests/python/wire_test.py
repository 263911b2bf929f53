"""Bytes, messages and places: what PROTOCOL.md prints."""
import dataclasses
import re
import sys
import unittest

import support
from support import ROOT, Folder
import numpy as np
from obliq import BadStream, Pose, Settings, Window, obliq_pb2, places, planes, wire
from obliq._protocol import crc as _crc, wire as _wire
from obliq._protocol.asked import Subscription
from obliq._protocol.session import Session

PROTOCOL = (ROOT / "proto" / "PROTOCOL.md").read_text()


def block(kind):
    return re.search(rf"```{kind}\n(.*?)```", PROTOCOL, re.S).group(1)


def example():
    return bytes.fromhex("".join(line.split(":")[1].split("|")[0] for line in block("hex").splitlines()))


def decoded(data):
    splitter = _wire.Splitter()
    splitter.space()[: len(data)] = data
    splitter.filled(len(data))
    return splitter.next()


class TheDocument(unittest.TestCase):
    def test_its_check_value_of_the_crc(self):
        self.assertEqual(_wire.crc32c(b"123456789"), 0xE3069283)
        self.assertEqual(_wire.crc32c(b"6789", _wire.crc32c(b"12345")), 0xE3069283)

    def test_its_example_is_a_message_that_decodes_to_what_it_says(self):
        message = decoded(example())
        self.assertEqual((message.header.type, message.header.stream_id), (49, 2))
        self.assertEqual(message.header.utc_ns, 1767225600000000000)
        parsed = message.parsed()
        self.assertEqual((parsed.frame_id, parsed.plane, parsed.first_azimuth, parsed.n_azimuth, parsed.n_range),
                         (1, wire.STATE, 8, 2, 3))
        values = planes.plain(parsed, message.payload[message.header.descriptor_length:])
        np.testing.assert_array_equal(values, [[1, 1, 2], [1, 0, 3]])

    def test_encoding_the_same_fields_gives_the_same_bytes(self):
        message = wire.WedgeBlock(frame_id=1, plane=wire.STATE, first_azimuth=8, n_azimuth=2, n_range=3, wedge_index=1)
        self.assertEqual(_wire.encode(message, 5, 2, bytes([1, 1, 2, 1, 0, 3]), 1767225600000000000), example())

    def test_its_worked_bin_lies_where_it_says(self):
        given = {name: float(value) for name, value in (line.split() for line in block("bin").splitlines())}
        wanted = {name: float(value) for name, value in (line.split() for line in block("place").splitlines())}
        bin_at = given.pop("azimuth_bin") + 0.5, given.pop("range_bin") + 0.5
        d = wire.FrameDescriptor(**given)
        azimuth = d.azimuth_start_deg + bin_at[0] * d.azimuth_width_deg
        r = d.range_start_m + bin_at[1] * d.range_spacing_m
        latitude, longitude, away = places.locate(d, np.array([azimuth]), np.array([r]))
        # The document prints millimetres and a thousandth of a micro-degree.
        self.assertAlmostEqual(away[0, 0], wanted["ground_range_m"], delta=0.6e-3)
        self.assertAlmostEqual(latitude[0, 0], wanted["latitude_deg"], delta=0.6e-9)
        self.assertAlmostEqual(longitude[0, 0], wanted["longitude_deg"], delta=0.6e-9)
        world = places.World(d.origin_latitude_deg, d.origin_longitude_deg, d.radius_factor)
        at = world.world(wanted["latitude_deg"], wanted["longitude_deg"], d.map_reference_height_m)
        for value, name in zip(at, ("x_m", "y_m", "z_m")):
            self.assertAlmostEqual(value, wanted[name], delta=0.6e-3)

    def test_each_message_of_its_table_is_known_by_its_number(self):
        rows = dict(re.findall(r"^\| (\d+) \| (\w+) \| [CS]", PROTOCOL, re.M))
        self.assertGreater(len(rows), 15)
        for number, name in rows.items():
            self.assertEqual(_wire.TYPES[int(number)].DESCRIPTOR.name, name)

    def test_each_error_number_has_an_exception_and_some_have_advice(self):
        numbers = {int(n) for n in re.findall(r"^\| (\d+) \| ", PROTOCOL.split("## Errors")[1], re.M)}
        self.assertIn(125, numbers)
        for number in list(support.obliq.errors.KINDS) + list(support.obliq.errors.ADVICE):
            self.assertIn(number, numbers)


class Checksums(unittest.TestCase):
    # RFC 3720, appendix B.4.
    VALUES = {bytes(32): 0x8A9136AA, bytes([255] * 32): 0x62A8AB43, bytes(range(32)): 0x46DD794E}

    def test_each_library_that_is_here_gives_the_published_values_from_bytes_and_from_the_middle_of_an_array(self):
        found = 0
        for name, load in _crc.LIBRARIES.items():
            try:
                crc32c = load()
            except ImportError:
                continue
            found += 1
            for data, value in self.VALUES.items():
                array = np.frombuffer(b"odd" + data + b"end", "u1").copy()[3:35]
                for given in (data, array):
                    self.assertEqual(crc32c(given), value, name)
                    self.assertEqual(crc32c(given[5:], crc32c(given[:5])), value, name)
        self.assertGreater(found, 0)

    def test_the_first_library_that_loads_is_taken_and_none_is_said(self):
        def absent():
            raise ImportError

        self.assertEqual(_crc.choose({"a": absent, "b": lambda: 1, "c": lambda: 2}), ("b", 1))
        with self.assertRaisesRegex(ImportError, "obliq needs a CRC-32C"):
            _crc.choose({"a": absent})


class Bytes(unittest.TestCase):
    def test_pieces_of_any_length_bring_the_values_that_were_sent(self):
        rows, ranges, frames = 24, 5000, 6
        sent = np.random.default_rng(1).standard_normal((frames, rows, ranges * 2)).astype("<f4").view("<c8")
        stream = bytearray()
        for number, values in enumerate(sent):
            begin = wire.FrameBegin(frame_id=number)
            begin.frame.radar, begin.frame.settings.azimuth_bins, begin.frame.settings.range_bins = "main", rows, ranges
            stream += _wire.encode(begin, 1, 2)
            for row in range(0, rows, 8):
                block = wire.WedgeBlock(frame_id=number, plane=wire.IQ, first_azimuth=row, n_azimuth=8, n_range=ranges)
                stream += _wire.encode(block, 1, 2, values[row: row + 8].tobytes())
            stream += _wire.encode(wire.FrameEnd(frame_id=number), 1, 2)
        for longest in (700, 70_000, _wire.Splitter.PIECE):
            lengths = np.random.default_rng(longest)
            splitter, session, at, found = _wire.Splitter(), Session(), 0, []
            session.subscriptions["main"] = watch = Subscription(wire.Subscribe(radar="main", lossless=True), ("iq",))
            while at < len(stream):
                space = splitter.space()
                count = min(len(space), len(stream) - at, int(lengths.integers(1, longest + 1)))
                space[:count] = stream[at: at + count]
                at += count
                splitter.filled(count)
                while (message := splitter.next()) is not None:
                    session.feed(message)
                while watch.ready:
                    found.append(watch.take())
            self.assertEqual([frame.frame_id for frame in found], list(range(frames)))
            for frame, values in zip(found, sent):
                np.testing.assert_array_equal(frame.iq, values)

    def test_an_answer_is_whole_after_later_messages_have_come(self):
        splitter = _wire.Splitter()
        for number in (1, 2):  # the second where the first lay
            data = _wire.encode(wire.GroundAnswer(request_id=number), 1, 0, bytes([number] * 1000))
            splitter.space()[: len(data)] = data
            splitter.filled(len(data))
            if number == 1:
                first = splitter.next()
        self.assertEqual((first.parsed().request_id, bytes(first.plane)), (1, bytes([1] * 1000)))

    def test_a_message_that_comes_byte_by_byte_is_read_when_it_is_whole(self):
        splitter = _wire.Splitter()
        for at, byte in enumerate(example()):
            splitter.space()[0] = byte
            splitter.filled(1)
            message = splitter.next()
            self.assertEqual(message is not None, at + 1 == len(example()))

    def test_every_damaged_byte_is_found(self):
        for at in range(len(example())):
            data = bytearray(example())
            data[at] ^= 0x10
            # A longer payload may be claimed, or an unknown minor version: nothing whole comes of it.
            try:
                message = decoded(bytes(data))
            except BadStream:
                continue
            self.assertIsNone(message, f"byte {at}")

    def test_lengths_that_lie_are_refused_before_anything_is_allocated(self):
        for place, value in ((10, 47), (10, 257), (16, 0x7FFFFFFF), (12, 0x7FFFFFFF)):
            data = bytearray(example())
            data[place: place + (2 if place == 10 else 4)] = value.to_bytes(2 if place == 10 else 4, "little")
            with self.assertRaises(BadStream):
                decoded(bytes(data))

    def test_a_longer_header_of_a_later_version_is_read(self):
        data = bytearray(example())
        head, payload = data[:48] + bytes([7] * 8), data[48:]
        head[5], head[10:12] = 9, (56).to_bytes(2, "little")
        head[40:44] = bytes(4)
        crc = _wire.crc32c(bytes(payload), _wire.crc32c(bytes(head)))
        head[40:44] = crc.to_bytes(4, "little")
        self.assertEqual(decoded(bytes(head + payload)).parsed().frame_id, 1)

    def test_another_major_version_is_named(self):
        data = bytearray(example())
        data[4] = 2
        with self.assertRaisesRegex(BadStream, "found 2.2; allowed: 1.x"):
            decoded(bytes(data))


class Blocks(unittest.TestCase):
    def test_integers_are_scaled_as_the_document_says(self):
        made = wire.WedgeBlock(plane=wire.IQ, n_azimuth=1, n_range=2, iq_encoding=wire.CI16_LE, scale=2 / 32767)
        values = np.empty((1, 2), "<c8")
        planes.plain(made, bytes.fromhex("0020018000400000")).into(values)
        np.testing.assert_allclose(values, [[0.5 - 2j, 1 + 0j]], atol=1 / 32767)

    def test_video_has_one_or_two_bytes_a_bin(self):
        made = wire.WedgeBlock(plane=4, n_azimuth=2, n_range=3)
        self.assertEqual(planes.plain(made, bytes(range(6))).dtype, np.dtype("u1"))
        two = planes.plain(made, bytes(range(12)))
        self.assertEqual((two.dtype, two[0, 1]), (np.dtype("<u2"), 0x0302))
        with self.assertRaises(BadStream):
            planes.plain(made, bytes(18))

    def test_sizes_and_codings_that_cannot_be_are_refused(self):
        good = dict(plane=3, n_azimuth=2, n_range=3)
        for fault in (dict(n_range=4), dict(plane=5), dict(plane=11), dict(iq_encoding=7), dict(compression=2), dict(plane=1),
                      dict(n_azimuth=1 << 31, n_range=1 << 31)):
            with self.assertRaises(BadStream, msg=str(fault)):
                planes.plain(wire.WedgeBlock(**{**good, **fault}), bytes(6))
        for scale in (-1.0, float("nan"), 1e300):
            with self.assertRaises(BadStream):
                planes.plain(wire.WedgeBlock(plane=0, n_azimuth=1, n_range=1, iq_encoding=1, scale=scale), bytes(4))

    @support.needs("zstandard")
    def test_compressed_blocks_that_lie_are_refused(self):
        import zstandard

        packed = zstandard.ZstdCompressor().compress(bytes(600))
        made = wire.WedgeBlock(plane=3, n_azimuth=6, n_range=100, compression=1, plain_bytes=600)
        self.assertEqual(planes.plain(made, packed).shape, (6, 100))
        for data in (packed[:-3], b"", b"nonsense", zstandard.ZstdCompressor().compress(bytes(1 << 28))):
            with self.assertRaises(BadStream):
                planes.plain(made, data)


class Names(unittest.TestCase):
    def test_a_wrong_name_is_refused_with_the_one_that_was_meant(self):
        with self.assertRaisesRegex(TypeError, "did you mean r_max_m"):
            Settings.of(r_maxm=1)
        with self.assertRaisesRegex(ValueError, "planes: found 'stat'; did you mean state"):
            planes.plane_names("iq stat")
        with self.assertRaisesRegex(ValueError, "frustum='sweeep'; allowed: .*sweep"):
            Settings.of(frustum="sweeep")

    def test_wrong_types_are_refused(self):
        for fields in (dict(r_max_m="5"), dict(azimuth_bins=2.5), dict(r_min_m=True), dict(range_normalisation="yes")):
            with self.assertRaises(TypeError, msg=str(fields)):
                Settings.of(fields)
        with self.assertRaisesRegex(TypeError, "got Pose; allowed: Settings or a dict"):
            Settings.of(Pose.of(height_m=1.0))
        with self.assertRaisesRegex(TypeError, "planes: found 5"):
            planes.plane_names(5)
        for value in (float("nan"), float("inf"), 1e400):
            with self.assertRaises(ValueError):
                Pose.of(height_m=value)
        with self.assertRaises(ValueError):
            Settings.of(azimuth_bins=1 << 40).write(wire.RadarSettings())

    def test_a_bearing_of_zero_is_sent(self):
        message = Pose.of(bearing_deg=0).write(wire.Pose())
        self.assertTrue(message.HasField("bearing_deg"))
        self.assertFalse(message.HasField("height_m"))

    def test_settings_and_messages_are_the_same_there_and_back(self):
        given = Settings(r_max_m=1e4, frustum="sweep", plates="nearest", speckle="geometric", scan_mode="sector")
        self.assertEqual(Settings.read(given.write(wire.RadarSettings())), given)
        self.assertEqual(given.replace(r_max_m=2.0).r_max_m, 2.0)
        with self.assertRaises(dataclasses.FrozenInstanceError):
            given.r_max_m = 3.0

    def test_windows_without_bins_are_refused(self):
        for window in (Window(azimuth=slice(5, 5)), Window(range=slice(-3, None)), Window(range=slice(0, 5, -1))):
            with self.assertRaises(ValueError):
                window.write(wire.BinWindow())
        with self.assertRaises(TypeError):
            Window(azimuth=3).write(wire.BinWindow())
        with self.assertRaisesRegex(TypeError, "whole numbers"):
            Window(azimuth=slice(0, 10, 2.5)).write(wire.BinWindow())

    def test_an_address_is_read_in_all_its_forms(self):
        from obliq._requests import parse_address

        for text, wanted in (("a:1", ("a", 1)), ("a", ("a", 7420)), (":5", ("127.0.0.1", 5)), ("7421", ("127.0.0.1", 7421)),
                             ("[::1]:7", ("::1", 7)), ("[::1]", ("::1", 7420)), ("::1", ("::1", 7420))):
            self.assertEqual(parse_address(text), wanted)
        for text in ("a:b", "a:0", "a:70000", "[::1", "[::1]7", "http://a:7420", "http://a", "a:b:c"):
            with self.assertRaises(ValueError, msg=text):
                parse_address(text)
        for other in (None, 1.5, ("a", 1)):
            with self.assertRaisesRegex(TypeError, "address: found"):
                parse_address(other)


class Generated(Folder):
    @unittest.skipIf(sys.version_info < (3, 9), "old Python")
    def test_messages_and_parameters_are_those_of_the_sources(self):
        import shutil

        version = shutil.which("protoc") and support.run("protoc", "--version")
        made_by = "Protobuf Python Version" in (ROOT / "client/python/src/obliq/obliq_pb2.py").read_text()
        if not version or ("3.21" not in version) != made_by:
            self.skipTest(f"protoc: found {version or 'none'}; the files are of another version")
        support.run(sys.executable, ROOT / "client/python/generate.py", "--obliq", support.OBLIQ, "--check")


assert obliq_pb2 is wire
