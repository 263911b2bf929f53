#!/usr/bin/env python3
"""Writes and reads back every setpoint of REGISTERS.md with pymodbus.

  modbus_pymodbus.py REGISTERS.md HOST PORT

The page is read as an integrator reads it: what it says about addresses, types, counts and limits is what is tried.
"""
import re
import sys

from pymodbus.client import ModbusTcpClient

TYPES = ModbusTcpClient.DATATYPE
DATATYPE = {"u16": TYPES.UINT16, "u32": TYPES.UINT32, "i32": TYPES.INT32, "i64": TYPES.INT64, "u64": TYPES.UINT64,
            "f32": TYPES.FLOAT32}
ILLEGAL_ADDRESS, ILLEGAL_VALUE = 2, 3
AUTO = -2 ** 31  # the count, where "auto" is allowed
COIL = {"transmit": 0, "freeze": 1, "apply": 2, "clear_faults": 3, "discard": 4, "reset": 5, "exercise_freeze": 6}

faults = []


def expect(condition, text):
    if not condition:
        faults.append(text)
        print("WRONG:", text)


def tables(page):
    """Section title -> rows of cells."""
    sections, rows = {}, []
    for line in page.splitlines():
        if line.startswith("## "):
            rows = sections.setdefault(line[3:], [])
        elif line.startswith("| ") and not line.startswith("|---"):
            rows.append([cell.strip() for cell in line.strip("|").split(" |")])
    return {title: rows[1:] for title, rows in sections.items() if rows}


class Setpoint:
    def __init__(self, row):
        self.address, self.type, count, self.name, self.allowed, meaning = row
        self.step = 8 if "multiple of 8" in meaning else 1
        self.address = int(self.address)
        scale = re.match(r"1e-(\d+)", count)
        self.counts = 10 ** int(scale.group(1)) if scale else 1
        self.choices = [int(n) for n in re.findall(r"(?:^|, )(\d+) [a-z_]+(?=,|$)", self.allowed)]
        limits = re.match(r'(?:"auto" or a )?(?:number|integer) (?:above )?(\S+?),?(?: to | at most )(\S+)', self.allowed)
        self.limits = [float(x) for x in limits.groups()] if limits else None

    def another(self, value):
        """A value near this one, so that what belongs together still does."""
        if self.choices:
            return self.choices[(self.choices.index(value) + 1) % len(self.choices)]
        if self.type == "f32":
            return value * 1.5
        if self.type in ("i64", "u64"):
            return value + 2 ** 33 + 1  # more than 32 bits hold
        if self.type == "i32":
            return 1001 if value == AUTO else value + 1001
        return value + self.step if self.counts == 1 else value + 250

    def out_of_limits(self):
        """Values that must be refused."""
        if self.choices:
            return [max(self.choices) + 1, 65535]
        if self.limits is None or self.type == "f32":
            return []
        low, high = (round(x * self.counts) for x in self.limits)
        ends = [low - 1, high + 1]
        return [v for v in ends if 0 <= v < 65536] if self.type == "u16" else ends


class Console:
    def __init__(self, host, port):
        self.client = ModbusTcpClient(host, port=port, timeout=20)
        assert self.client.connect()

    def read(self, setpoint, function="holding"):
        kind = DATATYPE[setpoint.type]
        read = getattr(self.client, f"read_{function}_registers")
        answer = read(setpoint.address, count=kind.value[1], device_id=1)
        assert not answer.isError(), f"{setpoint.name}: {answer}"
        return self.client.convert_from_registers(answer.registers, kind, word_order="big")

    def write(self, setpoint, value):
        """The exception, 0 for none."""
        words = self.client.convert_to_registers(value, DATATYPE[setpoint.type], word_order="big")
        answer = self.client.write_registers(setpoint.address, words, device_id=1)
        return answer.exception_code if answer.isError() else 0

    def pull(self, coil):
        answer = self.client.write_coil(COIL[coil], True, device_id=1)
        return answer.exception_code if answer.isError() else 0


def try_setpoint(console, setpoint):
    before = console.read(setpoint)
    value = setpoint.another(before)
    expect(console.write(setpoint, value) == 0, f"{setpoint.name}: {value} was refused")
    staged = console.read(setpoint)
    value = staged if setpoint.type == "f32" and abs(staged / value - 1) < 1e-6 else value
    expect(staged == value, f"{setpoint.name}: wrote {value}, staged {staged}")
    in_effect = console.read(setpoint, "input")
    expect(in_effect == before, f"{setpoint.name}: {in_effect} in effect before apply, not {before}")
    expect(console.pull("apply") == 0, f"{setpoint.name}: apply of {value} was refused")
    in_effect = console.read(setpoint, "input")
    close = setpoint.type == "f32" and abs(in_effect / value - 1) < 1e-6
    expect(close or in_effect == value, f"{setpoint.name}: {in_effect} in effect after apply, not {value}")
    for bad in setpoint.out_of_limits():
        expect(console.write(setpoint, bad) == ILLEGAL_VALUE, f"{setpoint.name}: {bad} was not refused by 03")
        expect(console.read(setpoint) == in_effect, f"{setpoint.name}: the refused {bad} was staged")


def try_status(client, rows):
    for registers, kind, *_, name, _ in rows:
        ends = [int(x) for x in re.findall(r"\d+", registers)]
        count = ends[-1] - ends[0] + 1
        for read in (client.read_input_registers, client.read_holding_registers):
            answer = read(ends[0], count=count, device_id=1)
            expect(not answer.isError() and len(answer.registers) == count, f"{name}: {answer}")
        answer = client.write_registers(ends[0], [0] * count, device_id=1)
        expect(answer.isError() and answer.exception_code == ILLEGAL_ADDRESS, f"{name} could be written")


def try_bits(client, coils, inputs):
    answer = client.read_coils(0, count=len(coils), device_id=1)
    expect(not answer.isError() and answer.bits[:len(coils)] == [True] + [False] * (len(coils) - 1), f"coils: {answer}")
    answer = client.read_discrete_inputs(0, count=len(inputs), device_id=1)
    expect(not answer.isError() and answer.bits[0] and not answer.bits[1], f"inputs: {answer}")
    for address, name, _ in coils:
        expect(COIL[name.strip("`")] == int(address), f"coil {name} is not where it was")
    for coil, on in ((1, True), (0, False), (1, False), (0, True)):
        expect(not client.write_coil(coil, on, device_id=1).isError(), f"coil {coil}")
        expect(client.read_coils(coil, count=1, device_id=1).bits[0] == on, f"coil {coil} is not {on}")
    answer = client.write_coils(0, [True, False, False, True, True], device_id=1)
    expect(not answer.isError(), f"coils: {answer}")


def try_other_functions(client):
    answer = client.mask_write_register(address=255, and_mask=0xFFF0, or_mask=0x0003, device_id=1)
    expect(not answer.isError(), f"mask write: {answer}")
    answer = client.readwrite_registers(read_address=254, read_count=2, write_address=254, values=[40], device_id=1)
    expect(not answer.isError() and answer.registers[0] == 40 and answer.registers[1] % 16 == 3, f"23: {answer}")
    expect(not client.write_coil(COIL["discard"], True, device_id=1).isError(), "discard")
    answer = client.read_holding_registers(60, count=1, device_id=1)
    expect(answer.isError() and answer.exception_code == ILLEGAL_ADDRESS, f"a gap: {answer}")
    answer = client.read_holding_registers(0, count=2, device_id=77)
    expect(answer.isError() and answer.exception_code == 0x0B, f"unit 77: {answer}")


def main():
    page, host, port = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with open(page, encoding="utf-8") as file:
        sections = tables(file.read())
    console = Console(host, port)
    setpoints = [Setpoint(row) for row in sections["Setpoints"]]
    for setpoint in setpoints:
        try_setpoint(console, setpoint)
    try_status(console.client, sections["Identity"] + sections["Status"])
    try_bits(console.client, sections["Coils"], sections["Discrete inputs"])
    try_other_functions(console.client)
    print(f"{len(setpoints)} setpoints, {len(faults)} faults")
    return 1 if faults or len(setpoints) < 24 else 0


if __name__ == "__main__":
    sys.exit(main())
