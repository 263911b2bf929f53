"""Prints what corners_test.cpp has as constants: a wall of 20 x 8 m and a house of 20 x 20 x 8 m on level ground.

Equation: sigma = 4 |Rw|^2 |Rg|^2 A (1 + t^2)^2 exp(-t^2 / 2 s^2) / (2 s^2), t = sin(phi) / tan(grazing),
A = L cos(phi) min(h cot(grazing), lit ground). Nothing of the project is used.
"""

from cmath import sqrt as complex_sqrt
from math import cos, exp, log10, pi, radians, sin, sqrt, tan

WALL, GROUND = 5.3 - 0.3j, 6 - 0.6j


def reflectivity(permittivity: complex, cosine: float, vertical: bool) -> float:
    root = complex_sqrt(permittivity - 1 + cosine * cosine)
    direct = permittivity * cosine if vertical else cosine
    return abs((direct - root) / (direct + root)) ** 2


def cross_section(phi: float, grazing: float, slope: float, vertical: bool, lit: float = 1e9) -> float:
    if cos(phi) <= 0:
        return 0
    t = sin(phi) / tan(grazing)
    on_wall = cos(grazing) * cos(phi)
    on_ground = sqrt(1 - on_wall * on_wall)
    area = 20 * cos(phi) * min(8 / tan(grazing), lit)
    lobe = (1 + t * t) ** 2 * exp(-t * t / (2 * slope * slope)) / (2 * slope * slope)
    return 4 * reflectivity(WALL, on_wall, vertical) * reflectivity(GROUND, on_ground, vertical) * area * lobe


def half_power(grazing: float, slope: float, vertical: bool) -> float:
    peak = cross_section(0, grazing, slope, vertical)
    phi = 0.0
    while cross_section(phi, grazing, slope, vertical) > peak / 2:
        phi += 1e-5
    return phi * 180 / pi


def house_mean(grazing: float, slope: float, vertical: bool) -> float:
    """Over orientations, four walls, 30 m of lit ground."""
    turns = 20000
    return 4 / turns * sum(
        cross_section(2 * pi * k / turns, grazing, slope, vertical, 30) for k in range(turns)
    )


for vertical in (False, True):
    for degrees in (5, 10, 20, 30):
        for slope in (0.05, 0.1):
            grazing = radians(degrees)
            print(
                "V" if vertical else "H",
                f"{degrees:2} deg, slope {slope}:",
                f"{10 * log10(cross_section(0, grazing, slope, vertical)):.2f} dBsm,",
                f"half power at {half_power(grazing, slope, vertical):.2f} deg,",
                f"mean of a house {10 * log10(house_mean(grazing, slope, vertical)):.2f} dBsm",
            )
