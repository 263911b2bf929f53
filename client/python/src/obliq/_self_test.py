"""`python -m obliq.batch --self-test`: a small data set is made and looked at. Each line says what was found beside what is
wanted."""
from __future__ import annotations

import math
import pathlib
import tempfile
from collections.abc import Callable

import numpy as np

from ._batch import batch
from ._dataset import Dataset

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


# Labels have their place here.
TESTS: tuple[Callable[[pathlib.Path, str | None], tuple[bool, str]], ...] = (noise,)


def self_test(obliqd: str | None = None) -> bool:
    """Prints a line for each; True: all are good."""
    passed = True
    with tempfile.TemporaryDirectory() as folder:
        for test in TESTS:
            good, sentence = test(pathlib.Path(folder), obliqd)
            passed &= good
            print(f"{'good' if good else 'BAD '} {sentence}")
    return passed
