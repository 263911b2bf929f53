"""The wire as proto/PROTOCOL.md has it: a client of its own. Of the project's it has the messages that protoc wrote, no more."""
import importlib.util
import os
import socket
import ssl
import struct
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HELLO, WELCOME, ACK, ERROR, HEARTBEAT = 1, 2, 3, 4, 5
LIST, GET_RADAR, CLAIM, SET_SETTINGS, SET_POSE, SUBSCRIBE, UNSUBSCRIBE, RENDER_ONCE = 16, 18, 20, 22, 23, 24, 25, 26
GET_STATUS, STATUS, SET_STATE, QUERY, GROUND_ANSWER, SET_REPLAY, REPLAY_STATE = 27, 28, 29, 30, 31, 32, 33
GET_EVENTS, EVENTS, ADD_BOOKMARK = 42, 43, 44
FRAME_BEGIN, WEDGE_BLOCK, FRAME_END, FRAME_ABORT = 48, 49, 50, 51
NAMES = {HELLO: "Hello", LIST: "ListRadars", GET_RADAR: "GetRadar", CLAIM: "ClaimControl", SET_SETTINGS: "SetSettings",
         SET_POSE: "SetPose", SUBSCRIBE: "Subscribe", UNSUBSCRIBE: "Unsubscribe", RENDER_ONCE: "RenderOnce",
         GET_STATUS: "GetStatus", SET_STATE: "SetState", QUERY: "QueryGround", SET_REPLAY: "SetReplay",
         GET_EVENTS: "GetEvents", ADD_BOOKMARK: "AddBookmark"}
TOO_LONG, NOT_PARSED, TIMED_OUT, NO_TOKEN = 3, 5, 7, 11  # PROTOCOL.md, "Errors"
INVALID, ABOVE_LIMIT, REPLAYED = 100, 109, 125


def load_messages():
    """protoc's module, without the package around it."""
    path = os.path.join(ROOT, "client/python/src/obliq/obliq_pb2.py")
    spec = importlib.util.spec_from_file_location("obliq_pb2", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


pb = load_messages()

TABLE = []
for i in range(256):
    c = i
    for _ in range(8):
        c = (c >> 1) ^ 0x82F63B78 if c & 1 else c >> 1
    TABLE.append(c)


def crc32c(data):
    c = 0xFFFFFFFF
    for x in data:
        c = TABLE[(c ^ x) & 255] ^ (c >> 8)
    return c ^ 0xFFFFFFFF


try:  # the same, quickly
    from crc32c import crc32c  # noqa: F811
except ImportError:
    pass


def framed(kind, payload, number=1, plane=b"", stream=0):
    head = struct.pack("<4sBBHHHIIIQqII", b"OBLQ", 1, 1, kind, 0, 48, len(payload) + len(plane), len(payload), stream, number,
                       time.time_ns(), 0, 0)
    return head[:40] + struct.pack("<I", crc32c(head + payload + plane)) + head[44:] + payload + plane


def encoded(kind, data=b"", stream=0, number=1, **fields):
    """A message of a server, by its fields; data: of a plane."""
    names = {WELCOME: "Welcome", ACK: "Ack", ERROR: "Error", FRAME_BEGIN: "FrameBegin", WEDGE_BLOCK: "WedgeBlock",
             FRAME_END: "FrameEnd"}
    return framed(kind, getattr(pb, names[kind])(**fields).SerializeToString(), number, data, stream)


def plain_socket(port, source="127.0.0.1", timeout=10, buffer=0):
    """buffer: of what the kernel holds for one that does not read."""
    made = socket.socket()
    try:
        if buffer:
            made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        made.settimeout(timeout)
        made.bind((source, 0))
        made.connect(("127.0.0.1", port))
        made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return made
    except BaseException:
        made.close()
        raise


def tls_socket(port, source="127.0.0.1", timeout=10, buffer=0):
    """Nobody's certificate is looked at: what is tested is the server."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    raw = plain_socket(port, source, timeout, buffer)
    try:
        return context.wrap_socket(raw)
    except BaseException:
        raw.close()
        raise


def reset(peer):
    """Gone without a word: the kernel sends RST."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    peer.close()


class Refused(Exception):
    """Error instead of what was asked for."""

    def __init__(self, error):
        fields = "; ".join(f"{fault.field}: found {fault.found}" for fault in error.fields)
        super().__init__(f"{error.number}: {error.text[:200]}{' (' + fields[:200] + ')' if fields else ''}")
        self.number, self.error = error.number, error


class Peer:
    """A connection over TCP or TLS."""

    def __init__(self, port, token="", name="guest", timeout=10, tls=False, source="127.0.0.1", buffer=0):
        self.count = 0
        self.socket = (tls_socket if tls else plain_socket)(port, source, timeout, buffer)
        try:
            self.welcome = pb.Welcome.FromString(self.demand(HELLO, major=1, client_name=name, token=token))
        except BaseException:
            self.socket.close()
            raise

    def packed(self, kind, **fields):
        self.count += 1
        fields.setdefault("request_id", self.count)
        return framed(kind, getattr(pb, NAMES[kind])(**fields).SerializeToString(), self.count)

    def send(self, kind, **fields):
        self.socket.sendall(self.packed(kind, **fields))
        return self.count

    def read(self, size):
        parts = []
        while size > 0:
            part = self.socket.recv(min(size, 1 << 20))
            if not part:
                raise EOFError("the server has closed the connection")
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def receive(self):
        """The type and the protobuf part of the next message."""
        head = self.read(48)
        (kind,) = struct.unpack("<H", head[6:8])
        size, descriptor = struct.unpack("<II", head[12:20])
        payload = self.read(size)
        self.plane = payload[descriptor:]
        return kind, payload[:descriptor]

    def answer(self):
        """The next that is no frame, heartbeat or news of a replay."""
        while True:
            kind, payload = self.receive()
            if kind == HEARTBEAT:
                self.beat(payload)
            elif kind < FRAME_BEGIN and kind != REPLAY_STATE:
                return kind, payload

    def beat(self, payload):
        beat = pb.Heartbeat.FromString(payload)
        if beat.answer_wanted:
            self.socket.sendall(framed(HEARTBEAT, pb.Heartbeat(request_id=beat.request_id).SerializeToString()))

    def ask(self, kind, **fields):
        self.send(kind, **fields)
        return self.answer()

    def demand(self, kind, **fields):
        answer, payload = self.ask(kind, **fields)
        if answer == ERROR:
            raise Refused(pb.Error.FromString(payload))
        return payload

    def outcome(self, kind, **fields):
        """0, or the number of the Error."""
        answer, payload = self.ask(kind, **fields)
        return pb.Error.FromString(payload).number if answer == ERROR else 0

    def close(self):
        self.socket.close()
