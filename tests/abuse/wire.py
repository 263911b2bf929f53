"""The wire as proto/PROTOCOL.md has it: a client of its own, that shares no code with the project's."""
import os
import socket
import ssl
import struct
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HELLO, WELCOME, ERROR, HEARTBEAT = 1, 2, 4, 5
CLAIM, SET_POSE, SUBSCRIBE, RENDER_ONCE, GET_STATUS = 20, 23, 24, 26, 27
FIRST_OF_FRAMES, FRAME_END = 48, 50

TABLE = []
for i in range(256):
    c = i
    for _ in range(8):
        c = (c >> 1) ^ 0x82F63B78 if c & 1 else c >> 1
    TABLE.append(c)


def messages(folder):
    """The module that protoc makes of obliq.proto."""
    subprocess.run(["protoc", "-I", os.path.join(ROOT, "proto"), f"--python_out={folder}", "obliq.proto"], check=True)
    sys.path.insert(0, folder)
    import obliq_pb2

    return obliq_pb2


def crc32c(data):
    c = 0xFFFFFFFF
    for x in data:
        c = TABLE[(c ^ x) & 255] ^ (c >> 8)
    return c ^ 0xFFFFFFFF


def framed(kind, payload, number=1):
    head = struct.pack("<4sBBHHHIIIQqII", b"OBLQ", 1, 0, kind, 0, 48, len(payload), len(payload), 0, number,
                       time.time_ns(), 0, 0)
    return head[:40] + struct.pack("<I", crc32c(head + payload)) + head[44:] + payload


def tls_socket(port, source="127.0.0.1", timeout=10):
    """Nobody's certificate is looked at: what is tested is the server."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    raw = socket.create_connection(("127.0.0.1", port), timeout=timeout, source_address=(source, 0))
    try:
        return context.wrap_socket(raw)
    except BaseException:
        raw.close()
        raise


class Refused(Exception):
    """Error instead of what was asked for: its number and text."""


class Peer:
    def __init__(self, pb, port, token, name="abuse", timeout=10):
        self.pb, self.count = pb, 0
        self.socket = tls_socket(port, timeout=timeout)
        kind, payload = self.ask(HELLO, pb.Hello(major=1, client_name=name, token=token))
        if kind != WELCOME:
            self.socket.close()
            raise Refused(self.error_text(payload))

    def error_text(self, payload):
        error = self.pb.Error.FromString(payload)
        return f"{error.number}: {error.text}"

    def send(self, kind, message):
        self.count += 1
        message.request_id = self.count
        self.socket.sendall(framed(kind, message.SerializeToString(), self.count))

    def read(self, size):
        parts = []
        while size > 0:
            part = self.socket.recv(min(size, 1 << 20))
            if not part:
                raise EOFError
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def receive(self):
        """The type and the protobuf part of the next message."""
        head = self.read(48)
        (kind,) = struct.unpack("<H", head[6:8])
        size, descriptor = struct.unpack("<II", head[12:20])
        return kind, self.read(size)[:descriptor]

    def ask(self, kind, message):
        self.send(kind, message)
        while True:
            answer, payload = self.receive()
            if answer < FIRST_OF_FRAMES and answer != HEARTBEAT:
                return answer, payload

    def demand(self, kind, message):
        answer, payload = self.ask(kind, message)
        if answer == ERROR:
            raise Refused(self.error_text(payload))
        return payload
