"""The figures of ACCURACY.md, kept in accuracy.json: what measures each part, and how ACCURACY.md, README.md and model.md show it.

Figures of tests are what the tests record (tests/support/figures.h). Where several tests record one name, all values are kept.
"""
import csv
import re
from dataclasses import dataclass
from typing import Callable

from tables import PAPER, Part, measured_at, read, table


# ---- How right it is

@dataclass
class Row:
    """What a test compares with what: texts, or functions of the figures. Numbers in a text are bounds that its test demands."""
    what: str | Callable
    against: str
    result: str | Callable
    short: bool = False  # in README.md too


# Programs and tests that record what the rows name.
RUNS = [("flat_plane_test", "*EchoesInFloats*:*ObliqueTotal*"), ("tracer_test", "*LosAngeles*:*HillsWithPrisms"),
        ("viewshed_test", "*SanGabriel*"), ("terrain_georeference_test", "*"), ("reference_order_test", "*"), ("convergence_test", "*"),
        ("sweep_embree_test", "*"), ("hard_range_test", "*AtFortyKilometresIs*"), ("hard_leaks_test", "*ThreeMillion*"), ("states_test", "*RaysAreDropped*")]

ROWS = [
    Row("bin power over a flat plane, 1024 x 1024 bins, sweep", "closed form",
        lambda f: f"median {f.percent('sweep_median')}, RMS {f.percent('sweep_rms')}, total {f.percent('sweep_total')}", short=True),
    Row("the same, oblique 2048 x 2048", "closed form",
        lambda f: f"total {f.percent('oblique_total')} (its bins, nearest bin: median {f.percent('oblique_median')}, RMS {f.percent('oblique_rms')})"),
    Row(lambda f: f"triangle and slant range of {f.total('tracer_.*_rays') / 1e6:.2f} M rays, buildings included", "CGAL's AABB tree, in double",
        lambda f: f"{f.total('tracer_.*_differ'):.0f} other triangles off their edges; ranges within {f.most('tracer_[a-z]+_worst_m'):.0e} m", short=True),
    Row("float range that Embree reports, on the same rays", "CGAL",
        lambda f: f"{1000 * f.least('tracer_.*_float_rms_m'):.1f} to {1000 * f.most('tracer_.*_float_rms_m'):.0f} mm rms by scene, "
                  f"{f.most('tracer_.*_float_worst_m'):.1f} m at worst: why it is not used"),
    Row("lit and shadowed ground, San Gabriel mountains", "`gdal_viewshed`",
        lambda f: f"{100 * f.least('viewshed_inner_same'):.1f} % of the cells off shadow edges agree, {100 * f.least('viewshed_same'):.1f} % of all", short=True),
    Row("grid heights at 1,000 random nodes of each of three models", "`gdallocationinfo`", lambda f: f"{1000 * f.most('grid_worst_m'):.1f} mm at worst"),
    Row("100 m tower at 20 km", "ECEF arithmetic, `gdallocationinfo`", "in its bin and its map pixel"),
    Row("reference renderer: flat plane, ramps, wall and shadow, curved earth, roofs and walls", "closed forms, independent quadrature",
        "every bin within 0.03 %", short=True),
    Row("reference renderer, finer and finer", "itself",
        lambda f: f"order {f.least('order_step.*'):.2f} in the step; {f.most('order_planes'):.1f} in the planes over ground, "
                  f"{f.most('order_planes_built'):.1f} with buildings"),
    Row("every source, more and more samples", "reference renderer",
        lambda f: f"E falls with order {f.least('converge_rays_least'):.1f} to {f.most('converge_rays_most'):.1f} (rays), "
                  f"{f.least('converge_sweep_least'):.1f} to {f.most('converge_sweep_most'):.1f} (sweep): terrain, buildings, both", short=True),
    Row(lambda f: f"triangle and range of the sweep, {f.most('sweep_hits'):,.0f} hits in thousands of random scenes", "Embree, re-intersected in double",
        lambda f: f"no other triangle ({100 * f.most('sweep_excluded'):.2f} % within 2 float steps of an edge left out); ranges within "
                  f"{f.most('sweep_worst_m'):.0e} m"),
    Row("slant range at 40 km", "multiple precision",
        lambda f: f"{f.most('range_worst_m'):.0e} m; Embree's float is {1000 * f.most('range_float_rms_m'):.1f} mm rms off"),
    Row(lambda f: f"{f.total('leak_rays.*') / 1e6:.0f} million rays aimed at vertices, tile seams, shared wall edges and roof corners, 0, 100 and 300 km from the "
                  "origin", "double-precision walk",
        lambda f: f"up to {100 * f.most('leaked'):.1f} % leak through Embree's mesh; after repair none passes more than 1 mm and 2 float steps below it"),
    Row("end of a wall's shadow", "g y_c / (y_c - H)", "within one bin"),
    Row("ground speckle of homogeneous ground, 1 to 16 samples a bin, every frustum", "the exponential law",
        "contrast within 5 standard errors of 1, Kolmogorov-Smirnov distance below 0.0076 on 100,000 independent bins", short=True),
    Row("phase of a building's face when the antenna moves 1 cm, 10 and 35 GHz", "long double arithmetic", "within 0.001 rad"),
    Row("loss of coherence with look angle, bins of 8 x 8 ground cells", "Dirichlet kernel", "within 0.03 and the statistics of 2,000 draws"),
    Row("power of thousands of random scenes, turned by 180 degrees", "each other", "the same to 1e-8"),
    Row("bits with 1, 2 and 8 threads", "each other", "the same, all planes, every frustum and speckle", short=True),
    Row("state of bins without samples", "dense profiles, 25 a bin",
        lambda f: f"none wrong; with a tenth of the rays {f.total('states_wrong'):,.0f} of {f.total('states_sampled'):,.0f} sampled bins become shadow, or "
                  "the other way, instead of \"not sampled\""),
]


def test_commands(programs, folder, runs=tuple(RUNS)):
    return [[programs / name, f"--gtest_filter={tests}", "--gtest_brief=1", f"--gtest_output=json:{folder / name}.json"] for name, tests in runs]


def recorded(_, folder):
    """{name: values}; exits where a test was skipped."""
    figures = {}
    for path in sorted(folder.glob("*.json")):
        for suite in read(path)["testsuites"]:
            for test in suite["testsuite"]:
                if test["result"] != "COMPLETED":
                    raise RuntimeError(f"{path.stem}: {test['name']} was {test['result'].lower()}")
                for name, text in test.items():
                    if name not in KNOWN:
                        figures.setdefault(name, []).append(float(text))
    return figures


# What GoogleTest itself writes of a test.
KNOWN = {"name", "value_param", "type_param", "file", "line", "status", "result", "timestamp", "time", "classname", "failures"}


class Figures:
    """What tests have recorded, by a pattern of names."""

    def __init__(self, kept):
        self.kept = kept

    def values(self, pattern):
        found = [value for name, values in self.kept.items() if re.fullmatch(pattern, name) for value in values]
        if not found:
            raise RuntimeError(f"found no figure {pattern}; allowed: {', '.join(self.kept)}")
        return found

    def least(self, pattern):
        return min(self.values(pattern), key=abs)

    def most(self, pattern):
        return max(self.values(pattern), key=abs)

    def total(self, pattern):
        return sum(self.values(pattern))

    def percent(self, pattern):
        return f"{100 * self.most(pattern):.2g} %"


def check_rows(figures, short=False):
    f = Figures(figures)
    return [[text(f) if callable(text) else text for text in (row.what, row.against, row.result)] for row in ROWS if row.short or not short]


# ---- Coherence of a moving antenna

SAMPLINGS = {"draft": "`draft`", "standard": "`standard`", "reference": "`reference`", "oblique": "oblique, 2048 x 2048, spread"}
MOVES = {"sideways": (0.01, 0.1, 1, 3), "along": (0.01, 0.1, 1, 3), "up": (0.1, 1, 3)}
RANGES_KM = (4, 12, 30)


def length(move_m):
    return f"{100 * move_m:g} cm" if move_m < 1 else f"{move_m:g} m"


def coherence_rows(figures, samplings):
    rows = []
    for direction, moves in MOVES.items():
        for move in moves:
            for name in (*samplings, "theory"):
                found = [figures[f"{name}_{direction}_{move:g}_{km}"][0] for km in RANGES_KM]
                rows.append([f"{direction} {length(move)}" if name == samplings[0] else "", SAMPLINGS.get(name, "*theory*"),
                             *(f"{value:.4f}" if min(found) > 0.98 else f"{value:.3f}" for value in found)])
    return rows


COHERENCE_HEAD = ["moved", "sampling", *(f"at {km} km" for km in RANGES_KM)]


def coherence_words(figures):
    return ("`clutter_coherence_test.cpp`: all bins within 6 degrees of the sector's middle with those of an antenna that has moved, the geometry of each bin's "
            "middle removed; the paper's view over hills of 800 m (`paper_hills.toml`), bins of 0.117 degrees x 32.5 m, sharp. *Theory*: what an evenly "
            "rough, level cell keeps, by the ground that both looks have in the bin and the phase over it."
            + table(COHERENCE_HEAD, coherence_rows(figures, tuple(SAMPLINGS))))


# ---- Through a radar

HILLS = ["--set", "beam.pattern=gaussian", "--set", "beam.width_deg=3", "--set", "beam.elevation=cosecant", "--set", "antenna.tilt_auto=true",
         "--set", "pulse.kind=rectangular", "--set", "pulse.length_us=0.25"]


def frontier_figures(_, folder):
    with open(folder / "frontier.csv", encoding="utf-8", newline="") as file:
        return {"rows": list(csv.DictReader(file))}


def frontier_row(row, errors):
    rays = f"{row['kind']} {row['columns']} x {row['rows']}, {row['plates']}"
    planes = int(row["columns"]) // 1024
    name = f"sweep, {planes} plane{'s' * (planes > 1)} an azimuth bin" if row["kind"] == "sweep" else rays
    def cell(key, form, factor=1):  # a run of before had fewer figures
        return form.format(factor * float(row[key])) if key in row else ""

    return [name, f"{float(row['processor_ms']):.0f} ms", *errors, cell("median_db", "{:.2f} dB"), cell("percentile95_db", "{:.2f} dB"),
            cell("energy_error", "{:+.2f} %", 100)]


def hills_words(figures):
    rows = [frontier_row(row, [f"{float(row['power_error']):.2g}"]) for row in figures["rows"] if row["returns"] == "all" and float(row["frame_ms"]) > 0]
    return ("`obliq frontier tests/bench/paper_hills.toml --quick --truth-planes 8` with a Gaussian beam of 3 degrees, a cosecant squared and a pulse of 0.25 us, "
            "1024 x 1024 bins; 95 % of the lit bins are nearer than the fifth column says; the last is the total."
            + table(["sampling", "processor time", "E", "median", "95 %", "energy"], rows))


def city_words(figures):
    by = {}
    for row in figures["rows"]:
        by.setdefault((row["kind"], row["columns"], row["rows"], row["plates"], row["sub_columns"], row["cell_m"]), {})[row["returns"]] = row
    rows = []
    for parts in by.values():
        if float(parts["all"]["frame_ms"]) == 0:
            continue
        row = frontier_row(parts["all"], [f"{float(parts[k]['power_error']):.2g}" for k in ("all", "terrain", "buildings") if k in parts])
        rows.append([*row, f"{float(parts['all']['buildings_missed']):.0f} of {float(parts['all']['buildings_visible']):,.0f}"])
    return ("The same radar over Los Angeles, 14,535 buildings, `deploy/scenes/losangeles.toml` on 16 azimuth bins (`--azimuths 16 --kinds sweep`)."
            + table(["sampling", "processor time", "E, all", "E, terrain", "E, buildings", "median", "95 %", "energy", "buildings missed"], rows))


def frontier_of(scene, *more):
    return lambda programs, folder: [[programs / "obliq", "frontier", scene, *HILLS, "--quick", *more, "--repeats", "3", "--out", folder]]


def rows_words(figures):
    rows = []
    for mode, name, cells in (("dbs", "dbs of 8 pulses", 1), ("mti", "mti, double canceller, clutter lock", 1)):
        for beside in (1, 2, 3):
            total, rms, worst, ms = (figures[f"{mode}_{beside}_{what}"][0] for what in ("total", "rms", "worst", "ms"))
            rows.append([name if beside == 1 else "", f"B + {beside} = {cells + beside}", f"{100 * total:+.3f} %", f"{100 * rms:.2g} %",
                         f"{100 * worst:.2g} %", f"{ms:.1f} ms"])
    return ("`tests/figures/figures.py --measure doppler_rows` (`doppler_rows_test`): power of the bins of a sector from 30 degrees off the course to abeam, "
            "150 m/s over low hills, a beam of 3 degrees with B = 1 Doppler cell in it, against 40 rows a beamwidth; root mean square and worst of lit bins; "
            "processor time of a frame of 20 x 512 bins with one plane a row." + table(["mode", "rows a beamwidth", "total", "RMS", "worst bin", "processor time"], rows))


PARTS = [
    Part("checks", "Against what shares no code", test_commands, recorded,
         lambda figures: "Each line is from tests, which ctest runs." + table(["what", "against", "result"], check_rows(figures)), quick=True),
    Part("coherence", "Coherence", lambda programs, folder: test_commands(programs, folder, [("speckle_test", "*CoherenceOfClutter*")]), recorded,
         coherence_words, quick=True),
    Part("radar_hills", "Hills through a radar", frontier_of(PAPER, "--kinds", "sweep", "--truth-planes", "8"), frontier_figures, hills_words, quick=True),
    Part("radar_city", "A city through a radar", frontier_of("deploy/scenes/losangeles.toml", "--kinds", "sweep", "--azimuths", "16"), frontier_figures,
         city_words),
    Part("doppler_rows", "Rows of a beam", lambda programs, folder: test_commands(programs, folder, [("doppler_rows_test", "*")]), recorded, rows_words,
         quick=True),
]

SHORT = {"short_checks": (["what", "against", "result", "measured"], lambda kept: [[*row, measured_at(kept["checks"])]
                                                                                   for row in check_rows(kept["checks"]["figures"], short=True)]),
         "short_coherence": ([*COHERENCE_HEAD, "measured"], lambda kept: [[*row, measured_at(kept["coherence"])]
                                                                          for row in coherence_rows(kept["coherence"]["figures"], ("standard",))])}
