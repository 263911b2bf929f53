"""Messages and bytes: framing, limits, CRC. Knows no sockets. PROTOCOL.md, "Header"."""
from __future__ import annotations

import struct
import time
from typing import Any, NamedTuple

import numpy as np
from google.protobuf.message import Message as ProtobufMessage

from .. import obliq_pb2 as wire
from .crc import crc32c
from ..errors import BadStream

MAJOR, MINOR = 1, 2
HEADER = struct.Struct("<4sBBHHHIIIQqII")
MOST_HEADER = 256
MOST_DESCRIPTOR = 1 << 18
MOST_PLANE = 1 << 20
MOST_PAYLOAD = MOST_DESCRIPTOR + MOST_PLANE
MAGIC = b"OBLQ"
CRC_AT = 40
NO_CRC = bytes(4)
WEDGE_BLOCK = 49

TYPES: dict[int, type[ProtobufMessage]] = {
    1: wire.Hello, 2: wire.Welcome, 3: wire.Ack, 4: wire.Error, 5: wire.Heartbeat, 16: wire.ListRadars,
    17: wire.RadarList, 18: wire.GetRadar, 19: wire.RadarInfo, 20: wire.ClaimControl, 21: wire.ReleaseControl,
    22: wire.SetSettings, 23: wire.SetPose, 24: wire.Subscribe, 25: wire.Unsubscribe, 26: wire.RenderOnce,
    27: wire.GetStatus, 28: wire.Status, 29: wire.SetState,
    30: wire.QueryGround, 31: wire.GroundAnswer, 32: wire.SetReplay, 33: wire.ReplayState,
    37: wire.ResetExercise, 38: wire.GetExercise, 39: wire.ExerciseState, 40: wire.LoadExercise, 41: wire.SetExercise,
    42: wire.GetEvents, 43: wire.ExerciseEvents, 44: wire.AddBookmark,
    34: wire.SetTargets, 35: wire.GetTargets, 36: wire.TargetList,
    48: wire.FrameBegin, 49: wire.WedgeBlock, 50: wire.FrameEnd, 51: wire.FrameAbort, 52: wire.TargetBlock,
}
NUMBERS = {kind: number for number, kind in TYPES.items()}
# RFC 9112, RFC 4253 4.2, RFC 8446 5.1 (records of type alert and handshake), RFC 5321 and RFC 959 (220).
STRANGERS = {b"HTTP": "an HTTP server (obliqd's own has another port than its stream)", b"SSH-": "an SSH server",
             b"\x15\x03": "a server that speaks TLS: give tls=obliq.Tls()",
             b"\x16\x03": "a server that speaks TLS: give tls=obliq.Tls()", b"220": "a mail or FTP server"}


class Header(NamedTuple):
    """What stands before each message."""

    type: int
    header_length: int
    payload_length: int
    descriptor_length: int
    stream_id: int
    utc_ns: int
    crc: int

    @property
    def size(self) -> int:
        """Of header and payload, in bytes."""
        return self.header_length + self.payload_length


class Message(NamedTuple):
    """One message. offset: of its first byte in the connection or the file."""

    header: Header
    payload: bytes | memoryview
    offset: int

    @property
    def plane(self) -> memoryview:
        """The bytes behind the protobuf part, not copied."""
        return memoryview(self.payload)[self.header.descriptor_length:]

    def parsed(self) -> Any:
        """The protobuf part. BadStream where it does not parse, None for a type that is not known."""
        kind = TYPES.get(self.header.type)
        if kind is None:
            return None
        try:
            return kind.FromString(bytes(self.payload[: self.header.descriptor_length]))
        except Exception:  # protobuf's DecodeError has moved between its versions
            raise BadStream(f"a message does not parse: {kind.DESCRIPTOR.name}", self.offset) from None


def encode(message: ProtobufMessage, sequence: int, stream_id: int = 0, plane: bytes = b"", utc_ns: int | None = None) -> bytes:
    """One message as bytes."""
    descriptor = message.SerializeToString()
    payload = descriptor + plane
    fields: list[Any] = [MAGIC, MAJOR, MINOR, NUMBERS[type(message)], 0, HEADER.size, len(payload), len(descriptor), stream_id,
              sequence, time.time_ns() if utc_ns is None else utc_ns, 0, 0]
    fields[11] = crc32c(payload, crc32c(HEADER.pack(*fields)))
    return HEADER.pack(*fields) + payload


def stranger(first: bytes | memoryview) -> str:
    """What answers where obliqd was expected, told by its first bytes."""
    program = next((text for start, text in STRANGERS.items() if bytes(first).startswith(start)), "another program")
    return (f"not an obliq stream: found {bytes(first)[:8]!r}, which is {program}; allowed: where obliqd listens "
            "(server.port, 7420 unless its scene file says otherwise)")


def decode_header(data: bytes | memoryview, offset: int, at: int = 0) -> Header:
    """Checks all lengths before anything is allocated. data: which holds the header from byte `at` on."""
    magic, major, minor, kind, _, header_length, payload, descriptor, stream_id, _, utc_ns, crc, _ = HEADER.unpack_from(data, at)
    if magic != MAGIC:
        raise BadStream(stranger(data[at: at + HEADER.size]) if offset == 0 else "not a message: its magic is wrong", offset)
    if major != MAJOR:
        raise BadStream(f"protocol version: found {major}.{minor}; allowed: {MAJOR}.x. Install the obliq package of the "
                        "server's version", offset)
    if not HEADER.size <= header_length <= MOST_HEADER:
        raise BadStream(f"header_length: found {header_length}; allowed: {HEADER.size} to {MOST_HEADER}", offset)
    if descriptor > payload or descriptor > MOST_DESCRIPTOR:
        raise BadStream(f"descriptor_length: found {descriptor}; allowed: at most {min(payload, MOST_DESCRIPTOR)}", offset)
    if payload - descriptor > MOST_PLANE:
        raise BadStream(f"plane data of {payload - descriptor} bytes; allowed: at most {MOST_PLANE}", offset)
    return Header(kind, header_length, payload, descriptor, stream_id, utc_ns, crc)


class Splitter:
    """Bytes in, messages out. A reader writes into space() and says how much with filled(). A WedgeBlock's payload lies in
    the buffer itself, until the next space()."""

    PIECE = 1 << 18  # read at a time, so that an event loop is not held for long
    SIZE = 2 * (MOST_HEADER + MOST_PAYLOAD)

    def __init__(self) -> None:
        self._buffer = np.zeros(self.SIZE, "u1")
        self._view = memoryview(self._buffer)  # type: ignore[arg-type, unused-ignore]
        self._begin = self._end = 0
        self.offset = 0  # of what is not yet used
        self._header: Header | None = None

    def space(self) -> memoryview:
        """Where the next bytes go."""
        here = self._end - self._begin
        # To the front whenever that is cheap: what is written again and again stays in the processor's cache.
        if here <= min(self._begin, self.PIECE) or self.SIZE - self._end < self.PIECE:
            self._buffer[:here] = self._buffer[self._begin: self._end]
            self._begin, self._end = 0, here
        return self._view[self._end: self._end + self.PIECE]

    def filled(self, count: int) -> None:
        """So many bytes have come into space()."""
        self._end += count

    @property
    def waiting(self) -> int:
        """Bytes of a message that is not yet whole."""
        return self._end - self._begin

    def next(self) -> Message | None:
        """The next whole message, or None until more bytes have come."""
        begin, here = self._begin, self._end - self._begin
        header = self._header
        if header is None:
            if here < HEADER.size:
                # What is not obliq is known by its first bytes, however little it says.
                if here >= 4 and self._view[begin: begin + 4] != MAGIC:
                    raise BadStream(stranger(self._view[begin: self._end]), self.offset)
                return None
            header = self._header = decode_header(self._view, self.offset, begin)
        size = header.header_length + header.payload_length
        if here < size:
            return None
        self._view[begin + CRC_AT: begin + CRC_AT + 4] = NO_CRC
        if crc32c(self._buffer[begin: begin + size]) != header.crc:
            raise BadStream("a message is damaged (CRC mismatch)", self.offset)
        payload: bytes | memoryview = self._view[begin + header.header_length: begin + size]
        if header.type != WEDGE_BLOCK:
            payload = bytes(payload)
        offset = self.offset
        self._begin = begin + size
        self.offset += size
        self._header = None
        return Message(header, payload, offset)
