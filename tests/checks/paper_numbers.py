#!/usr/bin/env python3
"""PAPER.md: its numbers worked out anew from the formulas, printed and corrected, and the tests that it names looked up in
the sources. Also: no comment cites a document that is not here.

  tests/checks/paper_numbers.py ROOT
"""
import pathlib
import re
import sys
from math import acos, asin, atan, cos, degrees, pi, radians, sin, sqrt, tan

Y, R_MAX, PIXELS, SECTOR, BOX = 1000.0, 37000.0, 2048, radians(120), 200.0
R_MIN = R_MAX / 10
G_MIN, G_MAX = sqrt(R_MIN**2 - Y**2), sqrt(R_MAX**2 - Y**2)


def angle(a, b):
    return acos(sum(x * y for x, y in zip(a, b)) / sqrt(sum(x * x for x in a) * sum(y * y for y in b)))


def numbers():
    """Of each equation: what its row must contain."""
    phi = atan(Y / G_MIN) - atan(Y / G_MAX)
    off_nadir = asin(G_MIN / R_MIN) + phi / 2
    pixel = atan(tan(phi / 2) * (1 - 2 / PIXELS))  # the edge of the row next to the outermost
    d = G_MIN * cos(SECTOR / 2)
    kappa = Y - BOX
    g_top = sqrt(R_MAX**2 - kappa**2)
    width, depth, nu = 2 * g_top * sin(SECTOR / 2), g_top - d, d * BOX / Y
    wide_phi = atan(Y / d) - atan(Y / G_MAX)
    beta = atan(Y / G_MAX) + wide_phi / 2
    theta = 2 * atan(max(g * sin(SECTOR / 2) / (g * cos(SECTOR / 2) * cos(beta) + Y * sin(beta)) for g in (G_MIN, G_MAX)))
    left, right = ((side * G_MAX * sin(SECTOR / 2), -Y, G_MAX * cos(SECTOR / 2)) for side in (-1, 1))
    step = (G_MAX - G_MIN) / PIXELS
    far_edge = sqrt((G_MAX - step) ** 2 + Y**2)
    return {
        1: [f"{(R_MAX - R_MIN) / 1024:.2f} m"],
        2: [f"{degrees(SECTOR) / 1024:.4f} degrees"],
        3: [f"w = {Y:.0f} m"],
        4: [f"{2 * kappa / width:.5f}", f"{2 * kappa / BOX:.3f}"],
        6: [f"{degrees(atan(Y / G_MAX) + phi / 2):.2f} degrees", f"{degrees(atan(Y / G_MAX) + phi):.2f}"],
        7: ["0 degrees"],
        8: [f"{degrees(theta):.2f} degrees", f"{degrees(angle(left, right)):.2f}"],
        9: [f"{degrees(wide_phi):.2f} degrees", f"{degrees(phi):.2f}"],
        10: [f"{R_MIN * cos(phi / 2):.1f} m", f"{R_MIN * sin(phi / 2):.1f}"],
        11: [f"{R_MAX * cos(phi / 2):.0f} m", f"{R_MAX * sin(phi / 2):.0f}"],
        12: [f"{4 * pi * cos(radians(60)) ** 2:.2f} times"],
        13: [f"{degrees(4 * pi / 8):.0f} degrees", f"{degrees(4 / 8):.1f}"],
        14: [f"{sqrt(G_MAX**2 + Y**2):.0f} m"],
        15: [f"{sqrt(G_MIN**2 + Y**2):.0f} m"],
        16: [f"{G_MIN:.1f} m"],
        17: [f"{g_top:.1f} m", f"{G_MAX:.1f}"],
        19: [f"{2 * R_MIN * cos(phi / 2) * tan(phi / 2):.1f} m"],
        20: [f"{Y / cos(off_nadir - pixel) - R_MIN:.3f} m", f"{G_MIN / sin(off_nadir - pixel) - R_MIN:.2f}"],
        21: [f"{R_MAX - Y / cos(off_nadir + pixel):.1f} m", f"{R_MAX - G_MIN / sin(off_nadir + pixel):.0f}"],
        22: [f"{kappa:.0f} m"],
        24: [f"{kappa + BOX:.0f} m"],
        25: [f"{width:.0f} m"],
        26: [f"{nu:.1f} m"],
        27: [f"{depth + nu:.0f} m"],
        28: [f"{d + (depth - nu) / 2:.0f} m", f"{(depth + nu) / 2 - d - nu:.0f}"],
        29: [f"{sqrt((G_MIN + step) ** 2 + Y**2) - R_MIN:.2f} m"],
        30: [f"{R_MAX - far_edge:.2f} m", f"{R_MIN - far_edge:.0f}"],
    }


def complaints(root):
    rows = {}
    for line in (root / "PAPER.md").read_text(encoding="utf-8").splitlines():
        if found := re.match(r"\| \((\d+)\) \|", line):
            rows[int(found[1])] = line
    cells = {equation: row.split("|")[5] for equation, row in rows.items()}  # "a number"
    if sorted(rows) != list(range(1, 31)):
        yield f"PAPER.md: found rows {sorted(rows)}; allowed: 1 to 30, each once"
    for equation in (equation for equation, cell in cells.items() if not cell.strip()):
        yield f"PAPER.md, ({equation}): found no number; allowed: one that shows it"
    for equation, texts in numbers().items():
        for text in texts:
            if text not in cells.get(equation, ""):
                yield f"PAPER.md, ({equation}): found no {text} in {cells.get(equation)}"
    sources = {path: path.read_text(encoding="utf-8", errors="replace")
               for folder in ("terrain", "server", "client", "proto", "tests") for path in (root / folder).rglob("*")
               if path.suffix in (".h", ".cpp")}
    tests = {f"{suite}.{name}" for text in sources.values() for suite, name in re.findall(r"^TEST(?:_[FP])?\((\w+),\s*(\w+)\)", text, re.M)}
    for name in re.findall(r"`(\w+\.[A-Z]\w+)`", "".join(rows.values())):
        if name not in tests:
            yield f"PAPER.md: found {name}, which is no test"
    for path, text in sources.items():
        if re.search(r"design\s+(?:///?\s*)?section", text, re.I):
            yield f"{path}: found a design section; allowed: PAPER.md, by equation or definition"


def main():
    found = list(complaints(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "PAPER.md has the numbers of its formulas, and its tests are there")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
