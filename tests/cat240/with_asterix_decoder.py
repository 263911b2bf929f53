"""asterix_decoder reads the cells: they must be the video plane.

  with_asterix_decoder.py FOLDER       what capture.py wrote
"""
import sys

import asterix

from captured import cases


def value(record, item, name):
    return record[item][name]["val"]


def check(case):
    cells = 0
    seen = {}
    for data in case.datagrams:
        parsed = asterix.parse(data, verbose=False)
        assert len(parsed) == 1 and parsed[0]["category"] == 240, parsed
        record = parsed[0]
        if value(record, "I000", "TYP") == 1:
            continue
        row = case.azimuth_of[round(value(record, "I041", "START_AZ") * 65536 / 360) % 65536]
        first = value(record, "I041", "START_RG") - round(case.range_start_m / case.range_spacing_m)
        n, valid = value(record, "I049", "NB_CELLS"), value(record, "I049", "NB_VB")
        item, block = ("I051", 64) if "I051" in record else ("I052", 256)
        raw = bytes.fromhex("".join(one["VIDEO"]["val"] for one in record[item]))
        assert len(raw) % block == 0
        step = case.bits // 8
        assert valid == n * step and not any(raw[valid:]), case.name
        got = [int.from_bytes(raw[at:at + step], "big") for at in range(0, valid, step)]
        assert got == case.rows[row][first:first + n], f"{case.name}: azimuth {row}"
        cells += n
        seen.setdefault(row, set()).update(range(first, first + n))
    whole = sum(len(found) == len(case.rows[0]) for found in seen.values())
    assert whole == len(case.rows) or case.scans and whole > len(case.rows) // 2, f"{case.name}: {whole} whole radials"
    return cells


def main():
    counted = {case.name: check(case) for case in cases(sys.argv[1])}
    print(f"{sum(counted.values())} cells of {len(counted)} captures are those of the video plane")


main()
