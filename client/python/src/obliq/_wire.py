"""Messages and bytes: framing, limits, CRC. Knows no sockets. PROTOCOL.md, "Header"."""
from __future__ import annotations

import struct
import time
import typing

from . import obliq_pb2 as wire
from .errors import BadStream

try:  # Google's, or the one that Debian packages
    from google_crc32c import extend as _extend

    def crc32c(data, crc=0):
        return _extend(crc, data)
except ImportError:
    try:
        from crc32c import crc32c
    except ImportError:
        raise ImportError("obliq needs a CRC-32C: pip install google-crc32c, or Debian's python3-crc32c") from None

MAJOR, MINOR = 1, 1
HEADER = struct.Struct("<4sBBHHHIIIQqII")
MOST_HEADER = 256
MOST_DESCRIPTOR = 1 << 18
MOST_PLANE = 1 << 20
MOST_PAYLOAD = MOST_DESCRIPTOR + MOST_PLANE
MAGIC = b"OBLQ"

TYPES = {
    1: wire.Hello, 2: wire.Welcome, 3: wire.Ack, 4: wire.Error, 5: wire.Heartbeat, 16: wire.ListRadars,
    17: wire.RadarList, 18: wire.GetRadar, 19: wire.RadarInfo, 20: wire.ClaimControl, 21: wire.ReleaseControl,
    22: wire.SetSettings, 23: wire.SetPose, 24: wire.Subscribe, 25: wire.Unsubscribe, 26: wire.RenderOnce,
    27: wire.GetStatus, 28: wire.Status, 29: wire.SetState,
    30: wire.QueryGround, 31: wire.GroundAnswer, 32: wire.SetReplay, 33: wire.ReplayState, 48: wire.FrameBegin, 49: wire.WedgeBlock,
    50: wire.FrameEnd, 51: wire.FrameAbort,
}
NUMBERS = {kind: number for number, kind in TYPES.items()}
# RFC 9112, RFC 4253 4.2, RFC 8446 5.1 (records of type alert and handshake), RFC 5321 and RFC 959 (220).
STRANGERS = {b"HTTP": "an HTTP server (obliqd's own has another port than its stream)", b"SSH-": "an SSH server",
             b"\x15\x03": "a server that speaks TLS: give tls=obliq.Tls()",
             b"\x16\x03": "a server that speaks TLS: give tls=obliq.Tls()", b"220": "a mail or FTP server"}


class Header(typing.NamedTuple):
    type: int
    header_length: int
    payload_length: int
    descriptor_length: int
    stream_id: int
    utc_ns: int
    crc: int

    @property
    def size(self):
        return self.header_length + self.payload_length


class Message(typing.NamedTuple):
    header: Header
    payload: bytes
    offset: int  # of its first byte in the connection or the file

    @property
    def plane(self):
        """The bytes behind the protobuf part, not copied."""
        return memoryview(self.payload)[self.header.descriptor_length:]

    def parsed(self):
        """The protobuf part. BadStream where it does not parse, None for a type that is not known."""
        kind = TYPES.get(self.header.type)
        if kind is None:
            return None
        try:
            return kind.FromString(self.payload[: self.header.descriptor_length])
        except Exception:  # protobuf's DecodeError has moved between its versions
            raise BadStream(f"a message does not parse: {kind.DESCRIPTOR.name}", self.offset) from None


def encode(message, sequence, stream_id=0, plane=b"", utc_ns=None):
    """One message as bytes."""
    descriptor = message.SerializeToString()
    payload = descriptor + plane
    fields = [MAGIC, MAJOR, MINOR, NUMBERS[type(message)], 0, HEADER.size, len(payload), len(descriptor), stream_id,
              sequence, time.time_ns() if utc_ns is None else utc_ns, 0, 0]
    fields[11] = crc32c(payload, crc32c(HEADER.pack(*fields)))
    return HEADER.pack(*fields) + payload


def stranger(first):
    """What answers where obliqd was expected, told by its first bytes."""
    program = next((text for start, text in STRANGERS.items() if bytes(first).startswith(start)), "another program")
    return (f"not an obliq stream: found {bytes(first)[:8]!r}, which is {program}; allowed: where obliqd listens "
            "(server.port, 7420 unless its scene file says otherwise)")


def decode_header(data, offset):
    """Checks all lengths before anything is allocated."""
    magic, major, minor, kind, _, header_length, payload, descriptor, stream_id, _, utc_ns, crc, _ = HEADER.unpack(data)
    if magic != MAGIC:
        raise BadStream(stranger(data) if offset == 0 else "not a message: its magic is wrong", offset)
    if major != MAJOR:
        raise BadStream(f"protocol version: found {major}.{minor}; allowed: {MAJOR}.x. Install the obliq package of the "
                        "server's version", offset)
    if not HEADER.size <= header_length <= MOST_HEADER:
        raise BadStream(f"header_length: found {header_length}; allowed: {HEADER.size} to {MOST_HEADER}", offset)
    if descriptor > min(payload, MOST_DESCRIPTOR):
        raise BadStream(f"descriptor_length: found {descriptor}; allowed: at most {min(payload, MOST_DESCRIPTOR)}", offset)
    if payload - descriptor > MOST_PLANE:
        raise BadStream(f"plane data of {payload - descriptor} bytes; allowed: at most {MOST_PLANE}", offset)
    return Header(kind, header_length, payload, descriptor, stream_id, utc_ns, crc)


class Splitter:
    """Bytes in, messages out. A reader writes into space() and says how much with filled()."""

    PIECE = 1 << 18  # read at a time, so that an event loop is not held for long
    SIZE = 2 * (MOST_HEADER + MOST_PAYLOAD)

    def __init__(self):
        self._buffer = bytearray(self.SIZE)
        self._view = memoryview(self._buffer)
        self._begin = self._end = 0
        self.offset = 0  # of what is not yet used
        self._header = None

    def space(self):
        if self._begin == self._end:
            self._begin = self._end = 0
        elif self.SIZE - self._end < self.PIECE:
            rest = bytes(self._view[self._begin: self._end])
            self._view[: len(rest)] = rest
            self._begin, self._end = 0, len(rest)
        return self._view[self._end: self._end + self.PIECE]

    def filled(self, count):
        self._end += count

    @property
    def waiting(self):
        """Bytes of a message that is not yet whole."""
        return self._end - self._begin

    def next(self):
        """The next whole message, or None until more bytes have come."""
        here = self._end - self._begin
        if self._header is None:
            if here < HEADER.size:
                # What is not obliq is known by its first bytes, however little it says.
                if here >= 4 and self._view[self._begin: self._begin + 4] != MAGIC:
                    raise BadStream(stranger(self._view[self._begin: self._end]), self.offset)
                return None
            head = bytes(self._view[self._begin: self._begin + HEADER.size])
            self._header = decode_header(head, self.offset)
        header = self._header
        if here < header.size:
            return None
        start = self._begin + header.header_length
        head = bytearray(self._view[self._begin: start])
        head[40:44] = bytes(4)
        payload = bytes(self._view[start: self._begin + header.size])
        if crc32c(payload, crc32c(bytes(head))) != header.crc:
            raise BadStream("a message is damaged (CRC mismatch)", self.offset)
        message = Message(header, payload, self.offset)
        self._begin += header.size
        self.offset += header.size
        self._header = None
        return message
