"""A client of the page's kind without a browser: it asks a daemon over WebSocket, in JSON. For what tests check at the server."""
import contextlib
import json
import struct

HEADER = struct.Struct("<4sBBHHHIIIQqII")
HELLO, SET_TARGETS, GET_TARGETS, CLAIM_CONTROL = 1, 34, 35, 20
ANSWERS = {2: "Welcome", 3: "Ack", 4: "Error", 36: "TargetList"}


class Asked:
    """One connection; ask() returns an answer's type and fields."""

    def __init__(self, url):
        import websocket  # comes with Selenium
        self._socket = websocket.create_connection(url.replace("http", "ws") + "stream", subprotocols=["obliq.v1.json"], timeout=30)
        self._number = 0
        self.welcome = self.ask(HELLO, major=1, minor=1, client_name="test")[1]

    def ask(self, kind, **fields):
        self._number += 1
        body = json.dumps({"request_id": self._number, **fields}).encode()
        self._socket.send_binary(HEADER.pack(b"OBLQ", 1, 2, kind, 1, HEADER.size, len(body), len(body), 0, self._number, 0, 0, 0) + body)
        while True:
            data = self._socket.recv()
            _, _, _, answer, _, start, _, length, *_ = HEADER.unpack_from(data)
            fields = json.loads(data[start:start + length] or "{}")
            if answer in ANSWERS and fields.get("request_id") == str(self._number):
                return ANSWERS[answer], fields

    def targets(self):
        """Of the world, by name."""
        return {target["name"]: target for target in self.ask(GET_TARGETS)[1].get("targets", [])}

    def close(self):
        with contextlib.suppress(Exception):
            self._socket.close()


def targets_of(url):
    """What another client is told now."""
    with contextlib.closing(Asked(url)) as asked:
        return asked.targets()
