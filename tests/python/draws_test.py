"""Data sets of scenes with a beam, a pulse and noise: each frame has noise and independent speckle that no other has.
OBLIQ_DRAWS: how many frames; 36 where it is not set."""
import itertools
import math
import os
import unittest

import support
from support import OBLIQD, Folder, obliq
import numpy as np
from obliq import _seeds

FRAMES = int(os.environ.get("OBLIQ_DRAWS", 36))
SCENES = support.ROOT / "deploy" / "scenes"
SMALL = {"azimuth_bins": 64, "range_bins": 128, "pixel_columns": 256}


def shipped(name):
    """A scene as it is shipped, over hills that need no file."""
    text = (SCENES / f"{name}.toml").read_text()
    terrain, rest = text.split("[[prisms]]", 1)
    head = terrain.split("[terrain]")[0]
    return f'{head}[terrain]\nsynthetic = "hills"\ncell_m = 100.0\n[[prisms]]{rest}'.replace(
        '"new_mexico_valleys.geojson"', f'"{SCENES / "new_mexico_valleys.geojson"}"')


def poses(n):
    """One place, again and again: whatever frames share shows."""
    return [{"id": k, "latitude_deg": 36.4, "longitude_deg": -107.58, "height_m": 3000.0, "bearing_deg": 20.0} for k in range(n)]


def coherences(frames):
    """Squared correlation of each pair of frames, and how many bins it is over. Bins that a beam or a pulse ties to each other
    are left out: azimuths 8 degrees apart (two-way, a beam 3 degrees wide is 60 dB down there) and every other range (each
    longer than the pulse)."""
    apart = math.ceil(8 / (frames[0].azimuth_deg[1] - frames[0].azimuth_deg[0]))
    with np.errstate(invalid="ignore"):  # of a complex number by NaN
        rows = np.stack([(frame.iq[::apart, ::2] / np.sqrt(scale_of(frame)[::apart, ::2])).ravel() for frame in frames])
    rows = rows[:, np.isfinite(rows).all(axis=0)].astype(np.complex128)
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    return (np.abs(rows @ rows.conj().T) ** 2)[np.triu_indices(len(frames), 1)], rows.shape[1]


def scale_of(frame):
    """Power where there are echoes; a frame of noise alone has the same everywhere."""
    return np.where(frame.power > 0, frame.power, np.nan) if frame.power.any() else np.ones_like(frame.power)


class Draws(Folder):
    def assert_by_chance(self, frames):
        """As of independent complex Gaussian vectors of m values, where a squared correlation exceeds x with probability
        (1 - x)^(m - 1) and has the mean 1/m: the greatest of all pairs in all but one of a million sets, the mean within five
        of its standard deviations, which are those of as many exponentials."""
        found, m = coherences(frames)
        self.assertGreater(m, 300)
        self.assertLess(found.max(), 1 - (1e-6 / found.size) ** (1 / (m - 1)), f"{m} bins, {found.size} pairs")
        self.assertLess(abs(found.mean() * m - 1), 5 / math.sqrt(found.size))
        print(f"{len(frames)} frames, {m} bins: greatest correlation {math.sqrt(found.max()):.4f} of {found.size} pairs; "
              f"by chance {math.sqrt(-math.log(1 / found.size) / m):.4f}, mean square {found.mean() * m:.4f} / m")

    def make(self, out, server, settings, n=FRAMES, planes="iq power", **options):
        done = obliq.batch(poses(n), self.folder / out, server=server, planes=planes, settings={**SMALL, **settings},
                           progress=False, **options)
        self.assertTrue(done.complete and not done.failed, done)
        return obliq.Dataset(self.folder / out)

    def test_no_two_frames_of_the_shipped_scenes_share_noise_or_independent_speckle(self):
        for name in ("x_band_sector", "x_band_circular"):
            with self.subTest(name), support.daemon(shipped(name)) as server:
                whole = self.make(f"{name}_as_it_is", server, {}, 3)
                self.assertTrue(whole[0].settings.noise and whole[0].settings.pulse_kind == "rectangular")
                self.assert_by_chance(list(self.make(f"{name}_noise", server, {"power_w": 0.0})))
                no_noise = {"noise": False, "speckle": "independent"}
                self.assert_by_chance(list(self.make(f"{name}_speckle", server, no_noise)))

    def test_speckle_of_the_ground_stays_unless_it_is_to_be_drawn_per_frame(self):
        settings = {"noise": False, "speckle": "ground"}
        with support.daemon(shipped("x_band_sector")) as server:
            same = self.make("same", server, settings, 3)
            self.assertEqual(len(set(same.verify().values())), 1)
            self.assert_by_chance(list(self.make("drawn", server, settings, speckle_per_frame=True)))

    def test_the_draw_follows_from_seed_and_place_alone(self):
        with support.daemon(shipped("x_band_sector")) as server:
            one = self.make("one", server, {}, 10, seed=5).verify()
            self.assertEqual(len(set(one.values())), 10)
            for share in ("2/2", "1/2"):
                obliq.batch(poses(10), self.folder / "two", server=server, planes="iq power", settings=SMALL, shard=share,
                            seed=5, shard_size=3)
            self.assertEqual(obliq.Dataset(self.folder / "two").verify(), one)
            other = self.make("other", server, {}, 10, seed=4)
            self.assertFalse(set(other.verify().values()) & set(one.values()))
            self.assertEqual(other.manifest["seed"], 4)
            with self.assertRaisesRegex(ValueError, "seed: found 4; this run has 5"):
                self.make("other", server, {}, 10, seed=5)
            with obliq.connect(server) as connection:
                base = connection.radar("x_band").settings.replace(scan_mode="frame", **SMALL)
                places = [{key: value for key, value in pose.items() if key != "id"} for pose in poses(10)]
                many = connection.render_many(places, base, planes="iq power", radar="x_band", seed=5)
                self.assertEqual([frame.sha256() for frame in many], list(one.values()))
                own = [dict(pose) for pose in poses(3)]
                own[1]["noise_frame"] = 77
                obliq.batch(own, self.folder / "own", server=server, planes="iq power", settings=SMALL, seed=5)
                mine = connection.render(base.replace(noise_frame=77), places[1], planes="iq power", radar="x_band")
            found = obliq.Dataset(self.folder / "own").verify()
            self.assertEqual(list(found.values()), [one[0], mine.sha256(), one[2]])

    def test_a_pattern_from_a_file_makes_a_data_set(self):
        (self.folder / "pattern.csv").write_text("cut,angle_deg,gain_db\n" + "".join(
            f"azimuth,{k / 2},{-3 * (k / 3) ** 2}\n" for k in range(-10, 11)))
        text = shipped("x_band_sector").replace('pattern = "gaussian"', f'pattern = "file"\nfile = "{self.folder}/pattern.csv"')
        scene = support.scene(self.folder, text)
        done = obliq.batch(poses(3), self.folder / "set", local=scene, obliqd=OBLIQD, settings=SMALL)
        self.assertTrue(done.complete and not done.failed, done.first_failed)


class Numbers(unittest.TestCase):
    def test_the_hash_is_splitmix64s(self):
        # Its first values after the states 0 and 1234567: https://prng.di.unimi.it/splitmix64.c.
        self.assertEqual(_seeds.mix64(0), 0xE220A8397B1DCDAF)
        self.assertEqual(_seeds.mix64(1234567), 6457827717110365317)

    def test_neighbouring_seeds_share_no_frame(self):
        # seed ^ place would: seeds 0 to 7 are the places of each other.
        numbers = [_seeds.draw(seed, place)["noise_frame"] for seed, place in itertools.product(range(8), range(1000))]
        self.assertEqual(len(set(numbers)), len(numbers))

    def test_a_seed_is_a_whole_number(self):
        for bad, kind in ((1.5, TypeError), ("1", TypeError), (-1, ValueError), (1 << 64, ValueError)):
            with self.assertRaisesRegex(kind, "seed: found"):
                _seeds.checked(bad)
        self.assertTrue(-(1 << 63) <= _seeds.draw(3, 4, True)["speckle_seed"] < 1 << 63)


if __name__ == "__main__":
    unittest.main()
