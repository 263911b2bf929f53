"""libasterix builds every message anew from the radar's own numbers: its bytes must be those that arrived, and it must read them.

  with_libasterix.py FOLDER       what capture.py wrote
"""
import sys

from asterix.base import Bits, RawDatablock
from asterix.generated import Cat_240_1_3 as Cat240

from captured import cases

OVERHEAD = 35  # octets of a video message that are no cells


def summary_of(case, offset_m):
    return (f"{case.radar}; floor {case.floor_db:.2f} dB; span {case.span_db:.2f} dB; 0 no return; range offset {offset_m:.3f} m; "
            f"latitude {case.latitude_deg:.7f}; longitude {case.longitude_deg:.7f}; height {case.height_m:.1f} m above the datum")


def blocks(levels, octets, block):
    data = b"".join(level.to_bytes(octets, "big") for level in levels)
    data += bytes(-len(data) % block)
    return [int.from_bytes(data[at:at + block], "big") for at in range(0, len(data), block)]


def expected_messages(case, row, index, time):
    """All that a radial becomes."""
    octets = case.bits // 8
    item, block = "051", 64
    if len(case.rows[row]) * octets > 255 * 64 and (case.max_datagram - OVERHEAD) // 64 > 255:
        item, block = "052", 256
    most = min(255, (case.max_datagram - OVERHEAD) // block) * block // octets
    start = round(case.range_start_m / case.range_spacing_m)
    for first in range(0, len(case.rows[row]), most):
        levels = case.rows[row][first:first + most]
        yield Cat240.create([Cat240.cv_record.create({
            "010": (("SAC", case.sac), ("SIC", case.sic)),
            "000": 2,
            "020": index,
            "041": (("STARTAZ", case.units(row)), ("ENDAZ", case.units(row + 1)), ("STARTRG", start + first),
                    ("CELLDUR", round(2e15 * case.range_spacing_m / 299792458))),
            "048": (("C", 0), 0, ("RES", 5 if octets == 2 else 4)),
            "049": (("NBVB", len(levels) * octets), ("NBCELLS", len(levels))),
            item: blocks(levels, octets, block),
            "140": time,
        })]).unparse().to_bytes()
        index += 1


def record_of(data):
    datablocks = RawDatablock.parse(Bits.from_bytes(data))
    assert not isinstance(datablocks, ValueError) and len(datablocks) == 1, datablocks
    records = Cat240.cv_uap.parse(datablocks[0].get_raw_records())
    assert not isinstance(records, ValueError) and len(records) == 1, records
    assert Cat240.create(records).unparse().to_bytes() == data
    return records[0]


def number(record, name):
    return record.get_item(name).as_uint()


def check(case):
    summaries, index, rows = 0, 0, []
    waiting = []
    for data, arrived in zip(case.datagrams, case.arrived):
        record = record_of(data)
        time = number(record, "140")
        late_s = (arrived - time / 128) % 86400
        assert late_s < 2 or late_s > 86398, f"{case.name}: time of day {time / 128} s, arrived at {arrived % 86400}"
        if number(record, "000") == 1:
            start = round(case.range_start_m / case.range_spacing_m)
            text = summary_of(case, start * case.range_spacing_m - case.range_start_m)
            characters = [ord(c) for c in text]
            anew = Cat240.create([Cat240.cv_record.create({
                "010": (("SAC", case.sac), ("SIC", case.sic)), "000": 1, "030": characters, "140": time})]).unparse().to_bytes()
            assert anew == data, f"{case.name}: {data} is not {anew}"
            summaries += 1
            continue
        if not waiting:
            row = case.azimuth_of[number(record, "041") >> 80]
            rows.append(row)
            waiting = list(expected_messages(case, row, index, time))
        anew = waiting.pop(0)
        anew = anew[:-3] + data[-3:]  # the parts of a radial may be sent in different 1/128 s
        assert anew == data, f"{case.name}: message {index} differs"
        index += 1
    assert summaries >= 1 and not waiting
    n = len(case.rows)
    if not case.scans:
        assert rows == list(range(n)) * case.frames, f"{case.name}: radials {rows}"
    else:  # a machine that is busy may miss dwells, never change their order
        assert len(rows) > n * case.frames // 2, f"{case.name}: {len(rows)} radials"
        steps = [b - a for a, b in zip(rows, rows[1:])]
        turns = sum(1 for a, b in zip(steps, steps[1:]) if (a > 0) != (b > 0))
        assert turns <= 2 * case.frames, f"{case.name}: radials {rows}"
    return len(case.datagrams)


def main():
    counted = {case.name: check(case) for case in cases(sys.argv[1])}
    print(f"{sum(counted.values())} messages of {len(counted)} captures are byte for byte those of libasterix")


main()
