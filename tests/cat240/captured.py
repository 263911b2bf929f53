"""What capture.py wrote, read with the standard library alone: the programs that judge live in environments of their own."""
import array
import json
import pathlib
import sys


class Case:
    def __init__(self, path):
        for name, value in json.loads(path.read_text()).items():
            setattr(self, name, value)
        self.datagrams = [bytes.fromhex(text) for text in self.datagrams]
        self.rows = []
        for text in self.levels:
            row = array.array("H", bytes.fromhex(text))
            if sys.byteorder == "little":
                row.byteswap()
            self.rows.append(row.tolist())
        self.azimuth_of = {self.units(k): k for k in range(len(self.rows))}

    def units(self, bins):
        """A bin's left edge in parts of a turn."""
        return round(65536 * (self.azimuth_start_deg + bins * self.azimuth_width_deg) / 360) % 65536


def cases(folder):
    found = [Case(path) for path in sorted(pathlib.Path(folder).glob("*.json"))]
    assert found, f"{folder} holds no captures"
    return found
