"""The WebSocket of proto/PROTOCOL.md, by RFC 6455: every part of it can be made wrong."""
import base64
import contextlib
import json
import os
import re
import struct

import wire

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10
KEY = base64.b64encode(bytes(range(16))).decode()


def request(port, path="/stream", method="GET", version="1.1", host=None, key=KEY, protocol="obliq.v1.json", lines=()):
    """The bytes of an opening handshake (RFC 6455, 4.1)."""
    head = [f"{method} {path} HTTP/{version}", f"Host: 127.0.0.1:{port}" if host is None else f"Host: {host}",
            "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13"]
    if key is not None:
        head.append(f"Sec-WebSocket-Key: {key}")
    if protocol:
        head.append(f"Sec-WebSocket-Protocol: {protocol}")
    return ("\r\n".join([*head, *lines]) + "\r\n\r\n").encode()


def whole(got):
    """All of an answer of HTTP, whose connection may stay open."""
    head, found, body = got.partition(b"\r\n\r\n")
    size = re.search(rb"(?i)\r\ncontent-length: *(\d+)", head)
    return bool(found) and len(body) >= (int(size.group(1)) if size else 0)


def answer_to(port, sent, timeout=10):
    """Status, head and body of what HTTP says to these bytes; status 0 when it hangs up without a word."""
    with wire.plain_socket(port, timeout=timeout) as peer:
        got = b""
        try:
            peer.sendall(sent)
            while not whole(got):
                part = peer.recv(1 << 16)
                if not part:
                    break
                got += part
        except ConnectionError:
            pass
    head, _, body = got.partition(b"\r\n\r\n")
    words = head.split(None, 2)
    return (int(words[1]) if len(words) > 1 else 0), head.decode(errors="replace"), body


def frame(opcode, data, final=True, masked=True, reserved=0, length=None):
    """One frame (RFC 6455, 5.2); length: what it says of itself in place of the truth."""
    size = len(data) if length is None else length
    mask = 0x80 if masked else 0
    head = bytes([(0x80 if final else 0) | reserved << 4 | opcode])
    if size < 126:
        head += bytes([mask | size])
    elif size < 1 << 16:
        head += struct.pack(">BH", mask | 126, size)
    else:
        head += struct.pack(">BQ", mask | 127, size)
    return head + (bytes(4) if masked else b"") + data  # masked by zeros: as it is


def message(kind, descriptor, flags=1, header=48, payload_length=None, descriptor_length=None, major=1):
    """A message of the stream with JSON: a dict, or bytes as they are to be sent."""
    data = descriptor if isinstance(descriptor, bytes) else json.dumps(descriptor).encode()
    sizes = (len(data) if n is None else n for n in (payload_length, descriptor_length))
    return struct.pack("<4sBBHHHIIIQqII", b"OBLQ", major, 1, kind, flags, header, *sizes, 0, 0, 0, 0, 0) + data


class Closed(EOFError):
    """A close frame: its code."""

    def __init__(self, data):
        self.code = struct.unpack(">H", data[:2])[0] if len(data) > 1 else 0
        super().__init__(f"close {self.code}")


class Socket:
    """A WebSocket of /stream; with a token or without a Hello."""

    def __init__(self, port, token="", hello=True, timeout=10, source="127.0.0.1", lines=()):
        self.count, self.kept = 0, b""
        self.socket = wire.plain_socket(port, source, timeout)
        try:
            key = base64.b64encode(os.urandom(16)).decode()
            self.socket.sendall(request(port, key=key, lines=lines))
            while b"\r\n\r\n" not in self.kept:
                self.more()
            head, self.kept = self.kept.split(b"\r\n\r\n", 1)
            if not head.startswith(b"HTTP/1.1 101"):
                raise EOFError(head[:80].decode(errors="replace"))
            if hello:
                self.demand(wire.HELLO, major=1, client_name="guest", token=token)
        except BaseException:
            self.socket.close()
            raise

    def more(self):
        part = self.socket.recv(1 << 18)
        if not part:
            raise EOFError("the server has closed the connection")
        self.kept += part

    def read(self, size):
        while len(self.kept) < size:
            self.more()
        data, self.kept = self.kept[:size], self.kept[size:]
        return data

    def receive_frame(self):
        first, size = self.read(2)
        size &= 127
        if size == 126:
            (size,) = struct.unpack(">H", self.read(2))
        elif size == 127:
            (size,) = struct.unpack(">Q", self.read(8))
        return first & 15, self.read(size)

    def receive(self):
        """The type and the descriptor of the next message; Closed at a close frame."""
        while True:
            opcode, data = self.receive_frame()
            if opcode == CLOSE:
                raise Closed(data)
            if opcode in (BINARY, CONTINUATION):
                (kind,) = struct.unpack("<H", data[6:8])
                (header,), (size,) = struct.unpack("<H", data[10:12]), struct.unpack("<I", data[16:20])
                self.plane = data[header + size:]
                return kind, json.loads(data[header:header + size] or b"{}")

    def answer(self):
        while True:
            kind, said = self.receive()
            if kind < wire.FRAME_BEGIN and kind not in (wire.HEARTBEAT, wire.REPLAY_STATE):
                return kind, said

    def send(self, kind, **fields):
        self.count += 1
        fields.setdefault("request_id", self.count)
        self.socket.sendall(frame(BINARY, message(kind, fields)))

    def demand(self, kind, **fields):
        self.send(kind, **fields)
        answer, said = self.answer()
        if answer == wire.ERROR:
            raise wire.Refused(wire.pb.Error(number=said.get("number", 0), text=said.get("text", "")))
        return said

    def close(self):
        self.socket.close()


def outcome(port, sent, token=None, answers=1, timeout=10):
    """What a new socket gets for these bytes: a list of numbers of Errors, "close CODE", "answer" or "closed"; "silence"
    where nothing comes. token None: without a Hello before."""
    said = []
    try:
        peer = Socket(port, token or "", hello=token is not None, timeout=timeout)
    except (OSError, EOFError) as error:
        return [f"not opened: {error}"]
    try:
        with contextlib.suppress(ConnectionError):  # refused before its end; why is there to read
            peer.socket.sendall(sent)
        for _ in range(answers):
            kind, descriptor = peer.receive()
            said.append(descriptor.get("number", 0) if kind == wire.ERROR else "answer")
    except Closed as closed:
        said.append(str(closed))
    except TimeoutError:
        said.append("silence")
    except (OSError, EOFError):
        said.append("closed")
    finally:
        peer.close()
    return said
