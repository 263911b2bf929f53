"""What `obliq frontier` says of a scene's sweep with one and two planes in each azimuth bin, `draft` and `standard`."""
import csv
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
REFERENCE = ("--against", "reference", "--azimuths", "0")
TRUTH = ("--azimuths", "64", "--truth-planes", "128", "--truth-planes-limit", "128")
# Fewer houses, for a quicker reference.
THINNER = {"million": ("per_km2 = 700.0", "per_km2 = 210.0")}


def errors_of(obliq, scene):
    """A line for each number of planes; one that says why there are none."""
    with tempfile.TemporaryDirectory() as folder:
        options = TRUTH if scene.stem == "losangeles" else REFERENCE
        if scene.stem in THINNER:
            thinner = pathlib.Path(folder) / "scene.toml"
            thinner.write_text(scene.read_text(encoding="utf-8").replace(*THINNER[scene.stem]), encoding="utf-8")
            scene = thinner
        ran = subprocess.run([obliq, "frontier", scene, *options, "--kinds", "sweep", "--quick", "--repeats", "1", "--out", f"{folder}/frontier"],
                             cwd=ROOT, capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            return [ran.stderr.strip().splitlines()[-1]]
        with open(f"{folder}/frontier/frontier.csv", encoding="utf-8", newline="") as file:
            found = {int(line["columns"]): line for line in csv.DictReader(file) if line["returns"] == "all" and line["sub_columns"] == "64"}
    lines = []
    for planes in (1, 2):
        e = {key: float(value) for key, value in found[1024 * planes].items()
             if key in ("power_error", "energy_error", "gap_fraction", "false_light", "false_light_energy", "buildings_missed", "buildings_visible")}
        lines.append(f"{planes} planes: E {e['power_error']:.3g}, energy {e['energy_error']:+.2g}, gaps {100 * e['gap_fraction']:.3g} %, "
                     f"false light in {e['false_light']:.0f} bins ({e['false_light_energy']:.1g} of the energy), "
                     f"{e['buildings_missed']:.0f} of {e['buildings_visible']:.0f} buildings missed")
    return lines
