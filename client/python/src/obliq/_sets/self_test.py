"""`python -m obliq.batch --self-test`: a small data set is made and looked at. Each line says what was found beside what is
wanted."""
from __future__ import annotations

import math
import pathlib
import tempfile
from collections.abc import Callable

import numpy as np

from .batch import batch
from .dataset import Dataset

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 100.0
[antenna]
height_m = 1500.0
[radar]
r_min_m = 1000.0
r_max_m = 8000.0
sector_deg = 60.0
power_w = 0.0
[bins]
azimuth = 64
range = 96
[receiver]
noise = true
"""
FRAMES = 24
RARE = 1e-6  # so seldom does a good program fail


def noise(folder: pathlib.Path, obliqd: str | None) -> tuple[bool, str]:
    """Of a radar that does not transmit, all is noise: no two frames may have the same. The squared correlation of independent
    complex Gaussian vectors of m values exceeds x with probability (1 - x)^(m - 1)."""
    scene = folder / "self_test.toml"
    scene.write_text(SCENE)
    poses = [{"latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1500.0}] * FRAMES
    batch(poses, folder / "noise", local=scene, obliqd=obliqd, planes="iq", shard_size=8, progress=False)
    rows = np.stack([frame.plane("iq").ravel() for frame in Dataset(folder / "noise")]).astype(np.complex128)
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    found = np.abs(rows @ rows.conj().T)[np.triu_indices(FRAMES, 1)]
    pairs, m = found.size, rows.shape[1]
    bound = math.sqrt(1 - (RARE / pairs) ** (1 / (m - 1)))
    good = bool(found.max() < bound)
    return good, (f"noise: the largest correlation of two of {FRAMES} frames is {found.max():.4f} over {m} bins; by chance "
                  f"{math.sqrt(math.log(pairs) / m):.4f}, allowed: below {bound:.4f}")


TOWN = """
[terrain]
synthetic = "hills"
cell_m = 50.0
[[prisms]]
per_km2 = 100.0
[antenna]
height_m = 900.0
[radar]
r_min_m = 1000.0
r_max_m = 6000.0
sector_deg = 30.0
[bins]
azimuth = 64
range = 96
[materials.building]
model = "constant_gamma"
gamma_db = {gamma_db}
"""
DARK_DB = -200.0
LABEL_BOUND = 1e-4
LEAST_POWER = 1e-6  # of the median: -60 dB


def labels(folder: pathlib.Path, obliqd: str | None) -> tuple[bool, str]:
    """The label `building` is the share of the power that goes where the buildings are dark."""
    poses = [{"latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 900.0, "bearing_deg": 60.0 * k} for k in range(3)]
    frames = []
    for name, gamma_db in (("lit", -5.0), ("dark", DARK_DB)):
        scene = folder / f"{name}.toml"
        scene.write_text(TOWN.format(gamma_db=gamma_db))
        batch(poses, folder / name, local=scene, obliqd=obliqd, planes="power building", progress=False)
        frames.append([(frame.plane("power"), frame.plane("building")) for frame in Dataset(folder / name)])
    off, bins, built = 0.0, 0, 0
    for (power, share), (dark, _) in zip(*frames):
        seen = power > LEAST_POWER * np.median(power[power > 0])
        expected = 1 - dark[seen] / power[seen]
        off = max(off, float(np.abs(share[seen] - expected).max()))
        bins, built = bins + int(seen.sum()), built + int((expected > 0.5).sum())
    return off < LABEL_BOUND and built > 0, (
        f"labels: building differs from 1 - power with dark buildings / power by {off:.1e} at most in {bins} bins, {built} of them "
        f"more than half buildings; allowed: below {LABEL_BOUND:.0e}")


TESTS: tuple[Callable[[pathlib.Path, str | None], tuple[bool, str]], ...] = (noise, labels)


def self_test(obliqd: str | None = None) -> bool:
    """Prints a line for each; True: all are good."""
    passed = True
    with tempfile.TemporaryDirectory() as folder:
        for test in TESTS:
            good, sentence = test(pathlib.Path(folder), obliqd)
            passed &= good
            print(f"{'good' if good else 'BAD '} {sentence}")
    return passed
