"""The operator's console, by the Modbus application protocol V1.1b3: extreme and random values in all setpoints."""
import os
import re
import struct
import time

import wire
from place import CLOSES_S, attack

WRITE_COIL, WRITE_REGISTERS = 5, 16
APPLY, DISCARD = 2, 4  # server/modbus/REGISTERS.md, "Coils"
UNIT = 2  # "nose": "main" has a controller


class Master:
    def __init__(self, port):
        self.socket, self.count = wire.plain_socket(port, timeout=30), 0

    def read(self, size):
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            if not part:
                raise EOFError("the slave has closed the connection")
            data += part
        return data

    def ask(self, function, data):
        """The exception's number; 0: done."""
        self.count = (self.count + 1) % (1 << 16)
        self.socket.sendall(struct.pack(">HHHBB", self.count, 0, len(data) + 2, UNIT, function) + data)
        size = struct.unpack(">HHHB", self.read(7))[2] - 1
        answer = self.read(size)
        return answer[1] if answer[0] & 0x80 else 0

    def write(self, register, values):
        return self.ask(WRITE_REGISTERS, struct.pack(f">HHB{len(values)}H", register, len(values), 2 * len(values), *values))

    def coil(self, number):
        return self.ask(WRITE_COIL, struct.pack(">HH", number, 0xFF00))

    def close(self):
        self.socket.close()


def setpoints():
    with open(os.path.join(wire.ROOT, "server/modbus/REGISTERS.md"), encoding="utf-8") as file:
        return [int(number) for number in re.findall(r"^\| (2\d\d) \|", file.read(), re.MULTILINE)]


def answers_again(place, port):
    """Whether a master is answered once the server has seen the ends of those before it: modbus.max_masters counts them till then."""
    until = time.monotonic() + CLOSES_S * place.slack
    while time.monotonic() < until:
        master = place.kept(Master(port))
        try:
            master.coil(DISCARD)
            return True
        except (OSError, EOFError):
            time.sleep(0.05)
    return False


@attack()
def setpoint_values(place):
    """All setpoints, extremes, NaN, infinity and random values, applied again and again."""
    served, draw = place.daemon("modbus.enabled=true", "modbus.port=0", most_mb=600), place.random
    master = place.kept(Master(int(re.search(r"modbus: on \S+:(\d+)", served.log()).group(1))))
    registers, writes, applied, refused, until = setpoints(), 0, 0, 0, place.until()
    place.expect(len(registers) > 40, f"REGISTERS.md names {len(registers)} setpoints")
    while time.monotonic() < until:
        for _ in range(draw.randint(1, 6)):
            size = draw.choice([1, 2, 2, 4])
            value = draw.choice([[0] * size, [0xFFFF] * size, [0x7FFF] + [0xFFFF] * (size - 1), [0x8000] + [0] * (size - 1),
                                 [0x7FC0, 0, 0, 0][:size], [0x7F80, 0, 0, 0][:size], draw.choices(range(1 << 16), k=size),
                                 [0] * (size - 1) + [draw.randrange(10)], [0] * (size - 1) + [draw.randrange(8193)]])
            refused += master.write(draw.choice(registers), value) != 0
            writes += 1
        if master.coil(APPLY) == 0:
            applied += 1
        elif draw.random() < 0.5:
            master.coil(DISCARD)
    return f"{writes} writes, {refused} refused, {applied} applied"


@attack()
def broken_requests(place):
    """Lengths, functions and units that are none, random bytes, halves of requests."""
    served, count, until, draw = place.daemon("modbus.enabled=true", "modbus.port=0"), 0, place.until(0.5), place.random
    port = int(re.search(r"modbus: on \S+:(\d+)", served.log()).group(1))
    while time.monotonic() < until:
        try:
            with wire.plain_socket(port, timeout=1) as peer:
                head = struct.pack(">HHHB", 1, draw.choice([0, 1]), draw.choice([0, 1, 2, 6, 254, 255, 65535]),
                                   draw.randrange(256))
                peer.sendall(head + draw.randbytes(draw.randrange(300)))
        except OSError:
            pass  # shown the door
        count += 1
    place.expect(answers_again(place, port), f"no answer within {CLOSES_S} s of the visits' end")
    return f"{count} visits"
