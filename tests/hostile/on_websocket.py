"""At the HTTP port: handshakes, frames and JSON that are wrong, too large, or dear to read."""
import time

import web
import wire
from place import attack

LARGE = 300_000  # as JSON within max_request_bytes, as protobuf beyond its 256 KiB
MEGABYTE = 1_000_000
BEFORE_HELLO = 4096
# Of processor time: six times what they take, a third of what the fault took; processors differ.
MOST_MS_BEFORE_HELLO, MOST_MS_A_MEGABYTE = 15.0, 50.0


def binary(kind, descriptor, **more):
    return web.frame(web.BINARY, web.message(kind, descriptor, **more))


def listing(**more):
    return binary(wire.LIST, {"request_id": 7}, **more)


@attack("H1")
def large_message(place):
    """One message of hundreds of kilobytes, before and after a token, at obliqd and at a replay."""
    long_name = {"major": 1, "client_name": "a" * LARGE}
    later = ((wire.GET_RADAR, {"request_id": 7, "radar": "a" * 900_000}),
             (wire.SUBSCRIBE, b'{"request_id":7,"radar":"main","rate_hz":1,"planes":[' + b"4," * 400_000 + b"4]}"),
             (wire.QUERY, b'{"request_id":7,"latitude_deg":[' + b"0," * 490_000 + b"0]}"))
    recording = place.recording(4)
    daemon, replay = place.daemon(tokens=True), place.replay(recording, "--loop")
    for served in (daemon, replay):
        got = web.outcome(served.web_port, binary(wire.HELLO, long_name))
        place.expect(got == [wire.TOO_LONG], f"Hello of {LARGE} bytes: {got}; wanted: error {wire.TOO_LONG}")
    for kind, descriptor in later:
        got = web.outcome(daemon.web_port, binary(kind, descriptor), place.tokens["viewer"])
        place.expect(got[0] not in ("silence", "closed", "answer"), f"{wire.NAMES[kind]}: {got}; wanted: an Error in words")


@attack("H1")
def long_before_hello(place):
    """Messages above 4 KB before Hello, over TCP and over a WebSocket."""
    served = place.daemon(tokens=True)
    for size in (BEFORE_HELLO + 1000, LARGE, MEGABYTE - 200):
        got = web.outcome(served.web_port, binary(wire.HELLO, {"major": 1, "client_name": "a" * size}))
        place.expect(got == [wire.TOO_LONG], f"WebSocket, {size} bytes: {got}; wanted: error {wire.TOO_LONG}")
        with wire.plain_socket(served.port) as peer:
            hello = wire.framed(wire.HELLO, wire.pb.Hello(major=1, client_name="a" * size).SerializeToString())
            try:
                peer.sendall(hello)
                head = peer.recv(48, 256)  # 256: MSG_WAITALL
                said = wire.pb.Error.FromString(peer.recv(int.from_bytes(head[12:16], "little"), 256)).number
            except ConnectionError:
                said = wire.TOO_LONG  # the rest of the flood met a closed door, which the kernel tells first
            place.expect(said == wire.TOO_LONG, f"TCP, {size} bytes: error {said}; wanted: {wire.TOO_LONG}")


@attack("M1")
def long_log_lines(place):
    """A name and a number of 1 MB in JSON, before and after a token: what the log and the Error repeat of it."""
    served, count = place.daemon(tokens=True), 0
    texts = (b'{"' + b"a" * MEGABYTE + b'":1}', b'{"major":"' + b"9" * MEGABYTE + b'"}')
    said = set()
    for token, kind in ((None, wire.HELLO), (place.tokens["viewer"], wire.LIST)):
        until = place.until(0.5)
        while time.monotonic() < until:
            said.add(str(web.outcome(served.web_port, binary(kind, texts[count % 2]), token)[0]))
            count += 1
    place.expect(not said & {"silence", "closed", "answer"}, f"answers {sorted(said)}; wanted: an Error in words")
    return f"{count} messages"


def cost_ms(place, served, token, sent):
    """Of the daemon's processor time, a message."""
    count, used, until = 0, served.processor_s(), place.until(0.3)
    while time.monotonic() < until or count < 20:
        web.outcome(served.web_port, sent, token)
        count += 1
    return (served.processor_s() - used) * 1000 / count


@attack("M3")
def dear_json(place):
    """JSON that is long to read: blanks, escapes, repeated keys, long lists, before and after a token."""
    served, told = place.daemon(tokens=True), []
    before = {"blanks": b" " * MEGABYTE + b'{"major":1}',
              "escapes": b'{"major":1,"client_name":"' + b"\\u0041" * 160_000 + b'"}',
              "repeated keys": b'{"major":1' + b',"token":"n"' * 80_000 + b"}"}
    for what, text in before.items():
        ms = cost_ms(place, served, None, binary(wire.HELLO, text))
        told.append(f"{what} {ms:.1f} ms")
        place.expect(ms <= MOST_MS_BEFORE_HELLO * place.slack,
                     f"{what} before a token: {ms:.1f} ms a message; allowed: {MOST_MS_BEFORE_HELLO}")
    after = {"repeated settings": (wire.RENDER_ONCE,
                                   b'{"request_id":7,"radar":"x"' + b',"settings":{"noise":true}' * 38_000 + b"}"),
             "planes": (wire.SUBSCRIBE, b'{"request_id":7,"radar":"main","rate_hz":1,"planes":[' + b"9," * 100_000 + b"4]}"),
             "places": (wire.QUERY, b'{"request_id":7,"latitude_deg":[' + b"0," * 400_000 + b"0]}")}
    for what, (kind, text) in after.items():
        sent = binary(kind, text)
        ms = cost_ms(place, served, place.tokens["viewer"], sent) * MEGABYTE / len(sent)
        told.append(f"{what} {ms:.0f} ms/MB")
        place.expect(ms <= MOST_MS_A_MEGABYTE * place.slack, f"{what}: {ms:.0f} ms a megabyte; allowed: {MOST_MS_A_MEGABYTE:.0f}")
    got = web.outcome(served.web_port, binary(wire.LIST, b'{"request_id":7,"request_id":8}'), place.tokens["viewer"])
    place.expect(got == [wire.NOT_PARSED], f"a repeated key: {got}; wanted: error {wire.NOT_PARSED}")
    return ", ".join(told)


@attack("L1")
def impossible_lengths(place):
    """Frame lengths of 2^63 and more, keys that are none, two origins: turned away at once."""
    served = place.daemon()
    for length in (1 << 63, (1 << 64) - 1):
        got = web.outcome(served.web_port, web.frame(web.BINARY, b"OBLQ", length=length), "", timeout=5)
        place.expect(got in (["close 1002"], ["close 1009"]), f"a frame of {length} bytes: {got}; wanted: close 1002")
    own = f"Origin: http://127.0.0.1:{served.web_port}"
    for what, sent in (("a key of 5 letters", web.request(served.web_port, key="short")),
                       ("a key of 15 bytes", web.request(served.web_port, key="AAECAwQFBgcICQoLDA0O")),
                       ("two origins", web.request(served.web_port, lines=(own, "Origin: http://evil.example")))):
        status = web.answer_to(served.web_port, sent, timeout=5)[0]
        place.expect(status in (400, 403), f"{what}: {status or 'no answer'}; wanted: 400 or 403")


@attack()
def foreign_sites(place):
    """Hosts and origins of others, odd methods, versions, bodies and paths."""
    served = place.daemon()
    port = served.web_port

    def status(**more):
        return web.answer_to(port, web.request(port, **more))[0]
    place.expect(status() == 101, f"a good handshake: {status()}")
    for host in ("evil.example", f"127.0.0.1.evil.example:{port}", "0x7f000001", "2130706433", "localhost:abc", "a@127.0.0.1",
                 "[::1"):
        place.expect((got := status(host=host)) in (400, 403), f"Host {host}: {got}")
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port}.evil.example",
                   "file://"):
        place.expect((got := status(lines=(f"Origin: {origin}",))) == 403, f"Origin {origin}: {got}")
    for what, more, allowed in (("no subprotocol", {"protocol": ""}, (400,)), ("another", {"protocol": "chat"}, (400,)),
                                ("POST", {"method": "POST"}, (400, 405, 426)), ("HTTP/1.0", {"version": "1.0"}, (400, 426, 505)),
                                ("no key", {"key": None}, (400, 426)), ("a body", {"lines": ("Content-Length: 5",)}, (400, 413)),
                                ("chunks", {"lines": ("Transfer-Encoding: chunked",)}, (400, 413)),
                                ("100 kB of header", {"lines": ("X: " + "a" * 100_000,)}, (0, 400, 431)),
                                ("two hosts", {"lines": ("Host: 127.0.0.1",)}, (400,))):
        place.expect((got := status(**more)) in allowed, f"{what}: {got}; allowed: {allowed}")
    head = web.answer_to(port, web.request(port, lines=("Sec-WebSocket-Extensions: permessage-deflate",)))[1]
    place.expect("deflate" not in head, "compression was agreed on")
    for path in ("/<script>alert(1)</script>", "/../../etc/passwd", "/index.html/..", "/%3Cscript%3E", "/parameters.json?x=<b>"):
        code, head, body = web.answer_to(port, f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n".encode())
        place.expect(b"<script>alert" not in body and b"root:" not in body, f"GET {path}: it comes back")
        place.expect(code in (200, 400, 403, 404), f"GET {path}: {code}")


@attack()
def bad_frames(place):
    """Frames that RFC 6455 forbids, cut ones, silences, headers of messages that lie."""
    served = place.daemon("server.message_timeout_s=1", "server.handshake_timeout_s=1")
    whole = web.message(wire.LIST, {"request_id": 7})
    half = web.frame(web.BINARY, whole[:9], final=False)
    closing, timed_out = ("close 1002", "close 1007", "close 1003"), (wire.TIMED_OUT,)
    cases = {"unmasked": (web.frame(web.BINARY, whole, masked=False), closing),
             "RSV1": (web.frame(web.BINARY, whole, reserved=4), closing),
             "opcode 3": (web.frame(3, whole), closing), "opcode 11": (web.frame(11, b""), closing),
             "a continuation first": (web.frame(web.CONTINUATION, whole), closing),
             "a message in a message": (half + web.frame(web.BINARY, whole), closing),
             "a ping in parts": (web.frame(web.PING, b"x", final=False), closing),
             "a ping of 126": (web.frame(web.PING, b"x" * 126), closing),
             "a close of one byte": (web.frame(web.CLOSE, b"x"), closing),
             "close 1005": (web.frame(web.CLOSE, b"\x03\xed"), closing),
             "text": (web.frame(web.TEXT, b"hello"), (wire.TOO_LONG, *closing)),
             "47 bytes": (web.frame(web.BINARY, whole[:47]), (1, 3, 5)),
             "2 GB announced": (web.frame(web.BINARY, b"OBLQ" + bytes(1 << 21), length=2 << 30),
                                (1, 2, 3, "close 1009", "closed")),
             "1.2 MB": (binary(wire.LIST, b" " * 1_200_000), (wire.TOO_LONG, "closed")),
             "half a message, silence": (half, timed_out),
             "half a frame, silence": (web.frame(web.BINARY, whole)[:20], timed_out),
             "one byte, silence": (b"\x82", ("silence", *timed_out)),
             "flags 0": (listing(flags=0), (3, 4, 5)), "major 2": (listing(major=2), (2,)),
             "header of 47": (listing(header=47), (3,)),
             "header of 65535": (listing(header=65535), (3,)),
             "payload of 2^32 - 1": (listing(payload_length=(1 << 32) - 1), (3,)),
             "descriptor beyond the payload": (listing(descriptor_length=500), (3,))}
    for what, (sent, allowed) in cases.items():
        got = web.outcome(served.web_port, sent, "", timeout=6)
        place.expect(got[0] in allowed, f"{what}: {got}; allowed: {allowed}")
    parts = b"".join(web.frame(web.CONTINUATION if i else web.BINARY, whole[i:i + 1], final=i + 1 == len(whole))
                     for i in range(len(whole)))
    empty = [web.frame(web.BINARY, b"", final=False), web.frame(web.CONTINUATION, b"", final=False) * 20_000,
             web.frame(web.CONTINUATION, whole)]
    for what, sent in (("a fragment a byte", parts), ("20,000 empty fragments", b"".join(empty))):
        got = web.outcome(served.web_port, sent, "")
        place.expect(got == ["answer"], f"{what}: {got}; wanted: an answer")
    for what, sent, allowed in (("silence", b"", (6, 7)), ("another message than Hello", listing(), (6,))):
        got = web.outcome(served.web_port, sent, timeout=8)
        place.expect(got[0] in allowed, f"no Hello, {what}: {got}; allowed: {allowed}")
    return f"{len(cases) + 4} cases"


@attack()
def bad_json(place):
    """JSON that is none, too deep, of other types, with numbers and texts beyond what can be."""
    served = place.daemon()
    wrong = [b"", b"{", b"null", b"[]", b"1", b"{}{}", b"{} x", b'{"x":1}', b'{"request_id":1e400}', b'{"request_id":-1}',
             b'{"request_id":18446744073709551616}', b'{"request_id":7.5}', b'{"request_id":[7]}', b'{"request_id":{"a":1}}',
             b'{"request_id":NaN}', b'{"a\\u0000b":1}', b'{"\xff":1}', b"[" * 17, b"[" * MEGABYTE,
             b'{"a":' * 20 + b"1" + b"}" * 20,
             b"{\"'\":" + b"[" * 200_000, b"\0" * 100, b'{"@type":"type.googleapis.com/obliq.wire.Hello"}']
    for text in wrong:
        got = web.outcome(served.web_port, binary(wire.LIST, text), "")
        place.expect(got[0] in (wire.TOO_LONG, wire.NOT_PARSED),
                     f"{text[:30]!r} of {len(text)} bytes: {got}; wanted: error 3 or 5")
    odd = [(wire.GET_RADAR, b'{"request_id":7,"radar":"\\ud800"}'), (wire.GET_RADAR, b'{"request_id":7,"radar":"\xed\xa0\x80"}'),
           (wire.GET_RADAR, b'{"request_id":7,"radar":"a\\u0000<img src=x onerror=alert(1)>\\u202e"}'),
           (wire.SUBSCRIBE, b'{"request_id":7,"radar":"main","rate_hz":"NaN"}'),
           (wire.SUBSCRIBE, b'{"request_id":7,"radar":"main","rate_hz":"-Infinity"}'),
           (wire.SUBSCRIBE, b'{"request_id":7,"radar":"main","rate_hz":1,"planes":[99]}'),
           (wire.SUBSCRIBE,
            b'{"request_id":7,"radar":"main","rate_hz":1,"window":{"first_azimuth":4294967295,"n_azimuth":4294967295}}'),
           (wire.SET_SETTINGS, b'{"request_id":7,"radar":"nose","settings":{"r_max_m":1e308}}'),
           (wire.RENDER_ONCE, b'{"request_id":7,"radar":"x","pose":{"latitude_deg":"NaN","longitude_deg":0,"height_m":0}}'),
           (wire.QUERY, b'{"request_id":7,"latitude_deg":["NaN"],"longitude_deg":["Infinity"]}'),
           (wire.SET_REPLAY, b'{"request_id":7,"speed":"Infinity"}'),
           (wire.HELLO, b'{"major":1,"client_name":"<img src=x>\\u001b[31m\\n"}'), (wire.FRAME_BEGIN, b'{"frame_id":"1"}'),
           (wire.ERROR, b'{"number":5}')]
    for kind, text in odd:
        got = web.outcome(served.web_port, binary(kind, text) + listing(), "")
        place.expect(got[0] != "silence", f"type {kind}, {text[:60]!r}: {got}; wanted: an answer or the end")
    return f"{len(wrong) + len(odd)} texts"


@attack()
def random_bytes(place):
    """Messages with bytes changed, cut, many sockets a second, some of them reset."""
    served, count, until = place.daemon(), 0, place.until()
    good = binary(wire.RENDER_ONCE, {"request_id": 1, "radar": "x", "settings": {"azimuth_bins": 8, "range_bins": 8},
                                     "pose": {"latitude_deg": 33, "longitude_deg": -99.5, "height_m": 2500}})
    while time.monotonic() < until:
        try:
            peer = web.Socket(served.web_port, timeout=5)
            for _ in range(6):
                data = bytearray(good)
                for _ in range(place.random.randint(1, 4)):
                    data[place.random.randrange(len(data))] = place.random.randrange(256)
                peer.socket.sendall(data[: place.random.randint(1, len(data))] if place.random.random() < 0.3 else data)
            wire.reset(peer.socket) if count % 2 else peer.close()
        except (OSError, EOFError):
            pass  # shown the door, as it should be
        count += 1
    return f"{count} sockets"
