"""The figures of SPEED.md, kept in speed.json: what measures each part, and how SPEED.md and README.md show it."""
import csv
import os
import pathlib

from tables import CITY, PAPER, Part, measured_at, ms, read, share, table

ROOT = pathlib.Path(__file__).resolve().parents[2]


# ---- What the qualities cost, and how far from the truth they are

# As in server/control/quality_presets.cpp, with the run's name: the paper's by Embree is what the paper has.
QUALITIES = {"paper, by Embree": ["frustum.quality=paper", "run.rays=embree"], "paper": ["frustum.quality=paper"],
             "draft": ["frustum.quality=draft"], "standard": ["frustum.quality=standard"], "reference": ["frustum.quality=reference"]}
# Rows of the demo's frontier: kind, planes or pixels across (512 azimuth bins), plates, sub-columns.
OF_DEMO = {"paper": ("oblique", "2048", "nearest"), "draft": ("sweep", "512", "spread"), "standard": ("sweep", "1024", "spread")}


def in_turn(programs, folder, runs, turns=7):
    words = [word for name, sets in runs.items() for word in ("--run", name, *sets)]
    return ["tests/bench/in_turn.py", PAPER, *words, "--turns", str(turns), "--bin", programs, "--json", folder / "turns.json"]


def demo_ground():
    """The demo's elevation model where the quick start has not fetched it but the shared data have it: the same file."""
    shared = pathlib.Path(os.environ.get("OBLIQ_SHARED", ROOT.parent / "shared")) / "data/nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif"
    fetched = ROOT / "deploy/scenes/data/new_mexico_ned13.tif"
    return ["--set", f'terrain.dem=["{shared}"]'] if shared.exists() and not fetched.exists() else []


def quality_commands(programs, folder):
    return [in_turn(programs, folder, QUALITIES),
            [programs / "obliq", "frontier", "deploy/scenes/demo.toml", *demo_ground(), "--quick", "--kinds", "oblique,sweep", "--pixels", "2048", "--out", folder]]


def quality_figures(_, folder):
    turns, rows = read(folder / "turns.json"), frontier_rows(folder)
    figures = {name: {key: f[key] for key in ("processor_s", "wall_s")} for name, f in turns.items()}
    for name, (kind, columns, plates) in OF_DEMO.items():
        row = next(r for r in rows if (r["kind"], r["columns"], r["plates"], r["returns"]) == (kind, columns, plates, "all"))
        figures[name]["demo"] = {key: float(row[key]) for key in ("power_error", "median_db", "gap_fraction", "false_light_fraction",
                                                                  "buildings_missed", "buildings_visible")}
    return figures


def quality_rows(figures):
    paper_s, error = figures["paper"]["processor_s"], figures["paper"]["demo"]["power_error"]
    rows = []
    for name, f in figures.items():
        demo = f.get("demo")
        rows.append([name if name not in OF_DEMO and "," in name else f"`{name}`", ms(f["processor_s"]), f"{f['processor_s'] / paper_s:.2f}"]
                    + ([f"{demo['power_error']:.2g}", f"{error / demo['power_error']:.2g}", f"{demo['median_db']:.2g} dB",
                        f"{100 * demo['gap_fraction']:.2g} %", f"{100 * demo['false_light_fraction']:.2g} %",
                        f"{demo['buildings_missed']:.0f} of {demo['buildings_visible']:.0f}"] if demo else [""] * 6))
    return rows


QUALITY_HEAD = ["quality", "processor time, hills", "over the paper's", "E, demo", "E lower by", "median", "gaps", "false light", "buildings missed"]


def quality_words(figures):
    return ("Time: `tests/bench/in_turn.py tests/bench/paper_hills.toml`, 1024 x 1024 bins over bare hills with all planes, plan included, the "
            "least of seven frames in turn. The paper's setting marches its rays; by Embree (`run.rays = \"embree\"`) it has the same bits. "
            "Error: `obliq frontier deploy/scenes/demo.toml --quick`, the demo's ground and towns against the reference renderer."
            + table(QUALITY_HEAD, quality_rows(figures)))


# ---- What a radar's parts cost

BEAM = ["frustum.quality=standard", "beam.pattern=gaussian", "beam.width_deg=3", "beam.elevation=cosecant", "antenna.tilt_auto=true",
        "pulse.kind=rectangular", "pulse.length_us=0.5"]
RADAR = {"sharp": ["frustum.quality=standard"], "beam and pulse, `radar.speckle = \"independent\"`": [*BEAM, "radar.speckle=independent"],
         "beam and pulse, speckle of the ground": [*BEAM, "radar.speckle=ground"]}


def radar_words(figures):
    sharp_s = figures["sharp"]["processor_s"]
    rows = [[name, ms(f["processor_s"]), f"{f['processor_s'] / sharp_s:.2f}"] for name, f in figures.items()]
    return ("`tests/bench/in_turn.py tests/bench/paper_hills.toml`, `standard`, sharp and behind a Gaussian beam of 3 degrees with a cosecant squared and a "
            "pulse of 0.5 us; without the receiver, whose work is small. Speckle of the ground behind a beam draws each scatterer."
            + table(["frame", "processor time", "over sharp"], rows))


# ---- Where a frame's time goes

# As in terrain/base/stage_clock.h.
STAGES = ("plan", "rays", "trace", "refine", "plates", "buildings", "ground", "scatter", "bin", "states", "encode", "send", "wait",
          "other", "idle")
FRUSTA = {"the paper's (oblique, nearest bin)": [], "oblique, spread plates": ["--set", "frustum.plates=spread"],
          "sweep, `standard`": ["--set", "frustum.quality=standard"]}


def stage_commands(programs, folder):
    return [[programs / "obliq", "render", PAPER, "--profile", "--out", folder / str(number), *more]
            for number, more in enumerate(FRUSTA.values())]


def stage_figures(_, folder):
    return {name: read(folder / str(number) / "timing.json")["profile"] for number, name in enumerate(FRUSTA)}


def stage_words(figures):
    used = {stage for profile in figures.values() for stage in profile["frame"]["stages"]}
    stages = [stage for stage in STAGES if stage in used]
    rows = []
    for name, profile in figures.items():
        frame = profile["frame"]
        cells = [share(frame["stages"][stage]["share"]) if stage in frame["stages"] else "" for stage in stages]
        rows.append([name, ms(frame["wall_s"]), *cells])
    cost = max(profile["probes"]["processor_ratio"] for profile in figures.values()) - 1
    return ("`obliq render tests/bench/paper_hills.toml --profile`: 1024 x 1024 bins over hills, encoded with all planes and sent over "
            "the loopback; shares of the thread time, which add up to the frame. Measuring costs "
            f"{max(0.0, 100 * cost):.1f} % of the processor time or less, and nothing when it is off."
            + table(["sampling", "frame", *stages], rows))


# ---- Beside the truth

def frontier_commands(programs, folder):
    return [[programs / "obliq", "frontier", "deploy/scenes/losangeles.toml", "--out", folder, "--azimuths", "128",
             "--truth-planes", "128", "--repeats", "3"]]


# Of all that obliq frontier measures; it writes the rest itself.
FRONTIER_ROWS = ("oblique 2048 x 2048 nearest", "oblique 2048 x 2048 spread", "symmetric 2048 x 2048 nearest",
                 "sweep 1024, 16 sub-columns", "sweep 1024, 64 sub-columns",
                 "sweep 2048, 16 sub-columns", "sweep 2048, 64 sub-columns", "sweep 1024, exact", "sweep 2048, exact", "sweep 4096, exact", "sweep 4096, 64 sub-columns",
                 "sweep 8192, exact")


def frontier_rows(folder):
    with open(folder / "frontier.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def frontier_figures(_, folder):
    return {"rows": frontier_rows(folder)}


def frontier_words(figures):
    finest = min(float(row["cell_m"]) for row in figures["rows"])
    def name_of(row):
        if row["kind"] != "sweep":
            return f"{row['kind']} {row['columns']} x {row['rows']} {row['plates']}"
        return f"sweep {row['columns']}, " + (f"{row['sub_columns']} sub-columns" if row.get("sub_columns", "0") != "0" else "exact")

    found = {name_of(row): row for row in figures["rows"] if float(row["cell_m"]) == finest and row["returns"] == "all"}
    paper = found[FRONTIER_ROWS[0]]
    rows = []
    for name in FRONTIER_ROWS:
        if name not in found:  # an older run
            continue
        row = found[name]
        quicker, truer = (float(paper[figure]) / float(row[figure]) for figure in ("frame_ms", "power_error"))
        rows.append([name, f"{float(row['frame_ms']):.0f} ms", f"{1 / quicker:.2f}", f"{float(row['power_error']):.2g}", f"{truer:.3g}",
                     f"{float(row['median_db']):.2g} dB", f"{100 * float(row['gap_fraction']):.2g} %",
                     f"{100 * float(row['false_light_fraction']):.2g} %", f"{row['buildings_missed']} of {row['buildings_visible']}"])
    return ("`obliq frontier deploy/scenes/losangeles.toml`: Los Angeles from 3 km, terrain and 14,535 buildings, frames with all planes "
            "against the reference renderer. The first row is the paper's setting."
            + table(["sampling", "frame", "over the paper's", "E", "E lower by", "median", "gaps", "false light", "buildings missed"], rows))


# ---- Rays

def ray_commands(programs, folder):
    return [[programs / "ray_bench", PAPER, "--set", f"frustum.kind={kind}", "--json", folder / f"{kind}.json"]
            for kind in ("oblique", "symmetric")]


def ray_figures(_, folder):
    return {kind: read(folder / f"{kind}.json") for kind in ("oblique", "symmetric")}


def ray_words(figures):
    rows = []
    for kind, f in figures.items():
        least = {name: f[name]["least_ms"] for name in ("trace", "march", "frame", "embree_frame")}
        rows.append([kind, f"{f['rays'] / 1e6:.2f} M", f"{least['trace']:.0f} ms", f"{least['march']:.0f} ms", f"{least['frame']:.0f} ms",
                     f"{f['frame_over_trace']:.2f}", f"{f['frame']['least_cpu_ms'] / f['trace']['least_cpu_ms']:.2f}",
                     f"{least['embree_frame']:.0f} ms", f"{least['embree_frame'] / least['trace']:.2f}"])
    first = next(iter(figures.values()))
    return ("`ray_bench`: the same rays traced by Embree alone and by our march alone, whole frames of nearest bins, and whole frames with "
            f"`run.rays = \"embree\"`, the least of {first['repeats']} in turn."
            + table(["frustum", "rays", "Embree's trace", "march", "frame", "over Embree's trace", "of processor time", "frame by Embree",
                     "over its trace"], rows))


# ---- The sweep

SWEEPS = {"paper_hills.toml": "30 m, no buildings", "fine.toml": "10 m, no buildings", "city.toml": "30 m, 100,000 buildings"}


def sweep_commands(programs, folder):
    return [["/usr/bin/env", f"OBLIQ_BENCH_SCENE=tests/bench/{scene}", programs / "obliq_bench",
             "--benchmark_filter=WholeSweepFrame/planes_per_bin:[12]/|WholeFrame/frustum:1/speckle:0/plates:1/",
             "--benchmark_min_time=2", "--benchmark_format=json",
             f"--benchmark_out={folder / scene}.json"] for scene in SWEEPS]


def sweep_figures(_, folder):
    return {scene: {row["name"]: row["real_time"] / 1000 for row in read(folder / f"{scene}.json")["benchmarks"]}
            for scene in SWEEPS}


def sweep_words(figures):
    rows = []
    for scene, words in SWEEPS.items():
        found = {name.split("/real_time")[0]: seconds for name, seconds in figures[scene].items()}
        paper, traced = (found[f"WholeFrame/frustum:1/speckle:0/plates:1/rays:{rays}"] for rays in (0, 1))
        draft, standard = (found[f"WholeSweepFrame/planes_per_bin:{planes}"] for planes in (1, 2))
        rows.append([f"`{scene}`: {words}", ms(traced), ms(paper), ms(draft), ms(standard), f"{1 / standard:.1f}",
                     f"{standard / traced:.2f}"])
    return ("`obliq_bench`: whole frames of 1024 x 1024 bins with I&Q and all planes."
            + table(["scene", "the paper's, by Embree", "marched", "sweep, `draft`", "sweep, `standard`", "frames/s", "over the paper's by Embree"],
                    rows))


# ---- Peers

PEER_RUNS = {f"oblique, {cell} m": ["--set", "frustum.kind=oblique", "--set", f"terrain.cell_m={cell}"] for cell in (30, 10)}


def peer_commands(_, folder):
    return [["tests/bench/peers.sh", PAPER, *settings, "--json", folder / f"peers{number}.json"]
            for number, settings in enumerate(PEER_RUNS.values())]


def peer_figures(_, folder):
    return {name: read(folder / f"peers{number}.json") for number, name in enumerate(PEER_RUNS)}


def peer_words(figures):
    rows = []
    for name, run in figures.items():
        for key, row in run["tracers"].items():
            ours = key in ("obliq", "march")
            rows.append([name, row["name"], f"{row['least_ms']:.0f} ms", f"{run['rays'] / 1e3 / row['least_ms']:.1f}",
                         f"{row['march_speedup']:.2f}" if key != "march" else "",
                         "" if ours else f"{row['speedup']:.2f}"])
    return ("`tests/bench/peers.sh`: the rays of the paper's frame on the triangles of one mesh, the same for all, two threads, the "
            "least of 15 in turn. All but our march, which is what frames use, run Embree inside."
            + table(["rays, cells", "tracer", "trace", "Mray/s", "its time over our march's", "over our Embree's"], rows))


# ---- A client's view

def light_commands(programs, folder):
    program = programs / "first_light"
    return [[program, PAPER, "--json", folder / "light.json"],
            [program, CITY, "--frames", "5", "--json", folder / "light_city.json"]]


def light_figures(_, folder):
    return {scene: read(folder / f"{file}.json") for scene, file in (("hills", "light"), ("100,000 buildings", "light_city"))}


LIGHT_FRUSTA = {"default": "oblique"}  # what first_light calls them, and we do


def light_words(figures):
    rows = [[scene, LIGHT_FRUSTA.get(name, name), ms(f["frame_s"]), share(f["first_wedge"]), share(f["last_byte"]), f"{f['standing_frames_per_s']:.0f}"]
            for scene, of_scene in figures.items() for name, f in of_scene["frusta"].items()]
    figures = figures["hills"]
    return ("`first_light`: the time until a client on the loopback has the first wedge with all planes, and the time from binning the last "
            f"wedge to the client's last byte, as shares of the frame's time. A radar that stands still does not render its frame again; the last column gives the "
            "frames per second that a client gets from it."
            + table(["scene", "frustum", "frame", "first wedge", "last byte", "standing still, frames/s"], rows))


def many_commands(programs, folder):
    return [[programs / "many_radars", PAPER, "--frames", "20", "--seconds", "30", "--json", folder / "many.json"]]


def many_words(figures):
    rows = []
    for alike, slow in zip(figures["all_alike"], figures["one_slow"]):
        row = [f"{alike['load']:g}"]
        for f in (alike, slow):
            row += [f"{f['delivered']} of {f['asked']}", str(f["shed"]), ms(f["p50_s"]), ms(f["p99_s"])]
        rows.append(row)
    return (f"`many_radars`: {figures['radars']} radars of {figures['bins']} x {figures['bins']} bins (sweep, I&Q) share a server; a "
            f"frame alone takes {ms(figures['frame_s'])}. At load 1 the radars ask for as many frames as fit into the time. Latency counts from a frame's "
            f"due time to its last byte at the client. In the second half one radar has {figures['slower']} times as many planes, frames of "
            f"{ms(figures['slow_frame_s'])}; the figures are those of the {figures['radars'] - 1} others."
            + table(["load", "frames", "shed", "median", "99 %", "frames beside a slow one", "shed", "median", "99 %"], rows))


# ---- Programs that say it themselves

def median_line(outputs, _):
    return {"line": next(line for line in outputs[0].splitlines() if line.startswith("median "))}


def text_of(outputs, _):
    return {"lines": outputs[0].strip().splitlines()}


PARTS = [
    Part("qualities", "What a quality costs, and its error", quality_commands, quality_figures, quality_words, quick=True),
    Part("radar", "A radar's parts", lambda programs, folder: [in_turn(programs, folder, RADAR)],
         lambda _, folder: {name: {key: f[key] for key in ("processor_s", "wall_s")} for name, f in read(folder / "turns.json").items()},
         radar_words, quick=True),
    Part("stages", "Where a frame's time goes", stage_commands, stage_figures, stage_words, quick=True),
    Part("frontier", "Frames beside their error", frontier_commands, frontier_figures, frontier_words),
    Part("rays", "Beside the bare trace", ray_commands, ray_figures, ray_words, quick=True),
    Part("sweep", "The sweep", sweep_commands, sweep_figures, sweep_words, quick=True),
    Part("peers", "Beside other ray tracers", peer_commands, peer_figures, peer_words),
    Part("first_light", "First light", light_commands, light_figures, light_words, quick=True),
    Part("many_radars", "Many radars, one scene", many_commands, lambda _, folder: read(folder / "many.json"), many_words),
    Part("stream", "The stream beside a bare socket loop", lambda programs, _: [[programs / "stream_bench"]], median_line,
         lambda figures: f"`stream_bench`: {figures['line']}.", quick=True),
    Part("start", "From an elevation model to a scene", lambda programs, _: [[programs / "load_bench"]], text_of,
         lambda figures: "`load_bench`:\n\n```\n" + "\n".join(figures["lines"]) + "\n```", quick=True),
]


# ---- README's few rows

def few_sweeps(figures):
    rows = []
    for scene, words in SWEEPS.items():
        draft, standard = (figures[scene][f"WholeSweepFrame/planes_per_bin:{planes}/real_time"] for planes in (1, 2))
        paper = figures[scene]["WholeFrame/frustum:1/speckle:0/plates:1/rays:0/real_time"]
        rows.append([f"frame of 1024 x 1024 bins, cells of {words}", f"`standard` {ms(standard)}, `draft` {ms(draft)}, the paper's setting {ms(paper)}"])
    return rows


def few_lights(figures):
    frame = figures["hills"]["frusta"]["sweep"]
    return [["first wedge at a client on the loopback", f"after {share(frame['first_wedge'])} of the frame's time"],
            ["radar that stands still", f"{frame['standing_frames_per_s']:.0f} frames/s"]]


def few_many(figures):
    busy = next(row for row in figures["all_alike"] if row["load"] == 0.75)
    return [[f"latency of {figures['radars']} radars of {figures['bins']} x {figures['bins']} bins at {100 * busy['load']:.0f} % load",
             f"median {ms(busy['p50_s'])}, 99 % {ms(busy['p99_s'])}"]]


def few_starts(figures):
    seconds = {line.split("  ")[0]: line[len(line.split("  ")[0]):].split()[0] for line in figures["lines"][1:]}
    return [[f"start with {figures['lines'][0].split(',')[0]}",
             f"first {seconds['first start, which is kept']} s, second {seconds['second start']} s (GDAL alone {seconds['GDAL reads and warps']} s)"]]


FEW = [("sweep", few_sweeps), ("first_light", few_lights), ("many_radars", few_many), ("start", few_starts)]


def short_frames(kept):
    return [[*row, measured_at(kept[name])] for name, few in FEW if name in kept for row in few(kept[name]["figures"])]


SHORT = {"short_qualities": ([*QUALITY_HEAD, "measured"], lambda kept: [[*row, measured_at(kept["qualities"])] for row in quality_rows(kept["qualities"]["figures"])]),
         "short_frames": (["what", "result", "measured"], short_frames)}
