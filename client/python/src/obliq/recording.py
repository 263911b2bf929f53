"""Recordings: the stream itself in a file. PROTOCOL.md, "Recordings"."""
from __future__ import annotations

import dataclasses
import os
import pathlib
import warnings
from collections.abc import Iterator
from typing import BinaryIO

from . import obliq_pb2 as wire
from . import planes as _planes
from ._protocol.assembly import Assembler
from ._protocol.crc import crc32c
from ._protocol.wire import HEADER, MAGIC, Message, decode_header
from .errors import BadStream, FrameAborted, printable
from .frame import Frame

# Searched for whole messages behind damage, over the whole file, as obliq replay does.
MOST_SEARCHED = 8 << 30
PIECE = 1 << 20


@dataclasses.dataclass(frozen=True)
class Loss:
    """What is missing, and where. kind: "frame" (begun and not whole), "damage", "aborted" by the server, or given up as
    nearly all of it was missed, or "cut": the end of the file is in the middle of something."""

    kind: str
    offset: int
    text: str

    def __str__(self) -> str:
        return printable(f"at byte {self.offset}: {self.text}")


class _Reader:
    """Whole messages of a file, or what was skipped."""

    def __init__(self, file: BinaryIO, offset: int = 0):
        self._file, self._data, self._start = file, b"", offset  # _data begins at byte _start
        self._at = 0  # in _data
        self._searched = 0

    def _hold(self, count: int) -> bool:
        if len(self._data) - self._at < count:
            rest = self._data[self._at:]
            self._start += self._at
            self._at = 0
            self._data = rest + self._file.read(max(PIECE, count - len(rest)))
        return len(self._data) >= self._at + count

    @property
    def offset(self) -> int:
        """In the file."""
        return self._start + self._at

    def _message(self) -> tuple[Message | None, str | None]:
        """The message here, and None; or None, and the reason. need: the file ends in it."""
        if not self._hold(HEADER.size):
            return None, "need"
        try:
            header = decode_header(self._data[self._at: self._at + HEADER.size], self.offset or 1)
        except BadStream as error:
            return None, error.reason
        if not self._hold(header.size):
            return None, "need"
        head = bytearray(self._data[self._at: self._at + header.header_length])
        head[40:44] = bytes(4)
        payload = self._data[self._at + header.header_length: self._at + header.size]
        if crc32c(payload, crc32c(bytes(head))) != header.crc:
            self._searched += header.size
            return None, "CRC mismatch"
        return Message(header, payload, self.offset), None

    def messages(self) -> Iterator[Message | Loss]:
        """Message, or Loss for bytes that are none."""
        while self._hold(1):
            message, reason = self._message()
            if message is not None:
                yield message
                self._at += message.header.size
                continue
            offset = self.offset
            found = self._seek()
            skipped = self.offset - offset
            if reason == "need" and not found:
                yield Loss("cut", offset, f"the recording is cut: the last {skipped} bytes are no whole message")
            else:
                text = "the length in its header reaches beyond the end" if reason == "need" else str(reason)
                yield Loss("damage", offset, f"{text}; {skipped} bytes skipped")

    def _seek(self) -> bool:
        """To the next whole message; False: there is none, and all bytes are used."""
        self._at += 1
        while self._searched <= MOST_SEARCHED and self._hold(HEADER.size):
            place = self._data.find(MAGIC, self._at)
            if place < 0:
                self._at = len(self._data) - (len(MAGIC) - 1)
                continue
            self._at = place
            if self._message()[0] is not None:
                return True
            self._at += 1
        while self._hold(1):
            self._at = len(self._data)
        return False


class Recording:
    """Frames of one radar, in order. Iterate any number of times; `losses` is of the newest pass over the file."""

    def __init__(self, path: str | os.PathLike[str], radar: str | None = None, planes: _planes.Planes = None):
        self.path = pathlib.Path(path)
        if self.path.exists() and not self.path.is_file():
            raise ValueError(f"{path}: found a folder or a device; allowed: a file that `obliq record` wrote")
        self._only = None if planes is None else _planes.plane_names(planes)
        self.losses: list[Loss] = []
        self.radar: str = radar or self._first_radar()

    def _messages(self, offset: int = 0) -> Iterator[Message | Loss]:
        with open(self.path, "rb") as file:
            file.seek(offset)
            yield from _Reader(file, offset).messages()

    def _first_radar(self) -> str:
        for number, item in enumerate(self._messages()):
            if isinstance(item, Loss):
                if number == 0:
                    raise BadStream(f"{self.path}: not a recording of obliq: {item.text}", item.offset)
            elif item.header.type == 48:
                first = item.parsed().frame
                if not first.scene_hash:
                    warnings.warn(f"{self.path}: recorded without a scene hash: nothing tells which world it shows", stacklevel=4)
                return str(first.radar)
        raise BadStream(f"{self.path}: no frame begins in it")

    def _names_of(self, offset: int) -> tuple[str, ...]:
        """The planes of the frame that begins there: those that its blocks bring."""
        found: set[str | None] = set()
        stream = None
        for item in self._messages(offset):
            if isinstance(item, Loss):
                break
            if item.header.type == 48 and stream is None:
                stream = item.header.stream_id
            elif item.header.stream_id == stream:
                if item.header.type != 49:
                    break
                found.add(_planes.NAMES.get(item.parsed().plane))
        return tuple(name for name in _planes.NUMBERS if name in found and (not self._only or name in self._only))

    def events(self) -> list[wire.ExerciseEvent]:
        """Who changed what of the exercise, and when, bookmarks too; Frame.utc has the same clock. Reads the whole file."""
        found: list[wire.ExerciseEvent] = []
        for item in self._messages():
            if not isinstance(item, Loss) and item.header.type == 43:
                found += item.parsed().events
        return found

    def __iter__(self) -> Iterator[Frame]:
        self.losses = []
        hand = _Hand(self)
        for item in self._messages():
            if isinstance(item, Loss):
                self.losses.append(item)
                if item.kind == "damage":  # a block of the current frame may be among what was skipped
                    hand.lose("the frame begun there is incomplete")
                continue
            try:
                frame = hand.take(item)
            except BadStream as error:
                hand.lose(None)
                self.losses.append(Loss("frame", item.offset, error.reason))
                continue
            if frame is not None:
                yield frame
        if hand.assembler is not None and not any(loss.kind == "cut" for loss in self.losses):
            self.losses.append(Loss("cut", hand.began_at, "the recording ends in the frame that begins there"))


class _Hand:
    """The frame that is being put together."""

    def __init__(self, recording: Recording):
        self._recording = recording
        self._names: tuple[str, ...] = ()
        self._stream: int | None = None  # the radar's, of this connection
        self._told: int | None = None  # the newest frame_id that began, or whose missing beginning was told
        self.assembler: Assembler | None = None
        self.began_at = 0

    def lose(self, text: str | None) -> None:
        """Message for an incomplete frame."""
        if self.assembler is not None and text:
            self._recording.losses.append(Loss("frame", self.began_at, text))
        self.assembler = None

    def take(self, message: Message) -> Frame | None:
        """The frame that a message completes, or None."""
        kind, header = message.header.type, message.header
        if kind == 2:  # another connection, whose streams may have other numbers
            self.lose("the connection was lost in the frame begun there")
            self._stream = None
        if not 48 <= kind <= 52:
            return None
        parsed = message.parsed()
        if kind == 48:
            if parsed.frame.radar == self._recording.radar:
                self.lose("the end of the frame begun there is missing")
                self._names = self._names or self._recording._names_of(message.offset)
                self._stream, self._told, self.began_at = header.stream_id, parsed.frame_id, message.offset
                self.assembler = Assembler(parsed, header, self._names)
            return None
        if header.stream_id != self._stream:
            return None
        if self.assembler is None or not self.assembler.is_mine(header, parsed.frame_id):
            if parsed.frame_id != self._told:
                self._told = parsed.frame_id
                raise BadStream(f"frame {parsed.frame_id}: its beginning is missing")
            return None
        if kind == 49:
            self.assembler.block(header, parsed, message.plane)
            return None
        if kind == 52:
            self.assembler.targets(parsed, message.plane)
            return None
        assembler, self.assembler = self.assembler, None
        if kind == 51:
            self._recording.losses.append(
                Loss("aborted", message.offset, f"the server aborted the frame: {parsed.reason}"))
            return None
        try:
            return assembler.end(parsed)
        except FrameAborted as given_up:
            self._recording.losses.append(Loss("aborted", message.offset,
                                               f"the frame that ends there was given up: {given_up.reason}"))
            return None


def open_recording(path: str | os.PathLike[str], radar: str | None = None, planes: _planes.Planes = None) -> Recording:
    """The frames of a file that `obliq record` wrote: `for frame in obliq.open("minute.obliq")`. radar: the first that
    comes unless named. What is missing is in .losses after the loop; whole frames come all the same."""
    return Recording(path, radar, planes)
