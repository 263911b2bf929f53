"""Trails of video: what moves leaves one, for so long as is chosen; true ones stay on the earth, relative ones with the antenna."""
import os
import pathlib
import unittest

import numpy as np

import support

SHOTS = os.environ.get("OBLIQ_SHOTS")  # a folder for pictures to look at
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 2500.0
bearing_deg = 60.0
tilt_deg = -8.0
[bins]
azimuth = 256
range = 256
[beam]
pattern = "gaussian"
width_deg = 3.0
[receiver]
noise = true
[video]
looks = 8
[target_types.ship]
rcs_dbsm = 50.0
swerling = 0
top_m = 20.0
TARGETS
[[radar]]
name = "round"
sector_deg = 360.0
r_min_m = 2600.0
r_max_m = 15000.0
frequency_ghz = 9.4
power_w = 50e3
gain_db = 33.0
"""
MOVES = """[[target]]
name = "fast"
type = "ship"
latitude_deg = 33.03
longitude_deg = -99.50
velocity_east_m_s = 80.0
"""
STANDS = """[[target]]
name = "rock"
type = "ship"
latitude_deg = 33.05
longitude_deg = -99.47
"""
CELLS = """
const { trails: { out, view } } = obliq.panes[0], found = [];
if (out) for (let k = 0; k < out.length; ++k)
  if (out[k]) found.push([view.right_m + (k % view.width + 0.5 - view.width / 2) * view.pixel_m,
    view.ahead_m - (Math.floor(k / view.width) + 0.5 - view.height / 2) * view.pixel_m, out[k] >>> 24]);
return found.length > 20000 ? found.slice(0, 20000) : found;
"""
M_PER_DEG = 111e3


class BaseTrails(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = support.Page()

    def show(self, targets, fragment):
        daemon = support.Daemon(SCENE.replace("TARGETS", targets))
        self.addCleanup(daemon.close)
        self.page.size(1280, 800)
        self.page.open(daemon.url, f"a=round&{fragment}")
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 3", "frames")

    def shot(self, name):
        if SHOTS:
            self.page.shot(pathlib.Path(SHOTS) / f"trails_{name}.png")

    def choose(self, minutes):
        self.page.script("const s = document.getElementById('trails'); s.value = arguments[0]; s.onchange()", minutes)


class Moving(BaseTrails):
    def test_the_switch_and_what_moves(self):
        self.show(MOVES, "glow=0&targets=1")
        self.assertEqual(self.page.script("return [...document.getElementById('trails').options].map(({ text }) => text)"),
                         ["off", "0.25 min", "0.5 min", "1 min", "2 min", "3 min", "6 min"])
        self.assertEqual(self.page.script("return document.querySelectorAll('.trails').length"), 0)
        self.choose("0.25")
        self.page.await_script("document.querySelectorAll('.trails').length === 1", "the trails' own picture")
        self.assertIn("trails=0.25", self.page.script("return location.hash"))
        self.page.await_script("document.querySelector('.annun.upper.left').textContent.includes('TRAILS 0.25 min T')", "words on the picture")
        start = self.page.script("const r = obliq.panes[0].ppi.truth.records.get('1'); return [r.longitude_deg, performance.now()]")
        self.page.await_script(f"performance.now() - {start[1]} > 12000", "twelve seconds")
        longitude, latitude = self.page.script("const r = obliq.panes[0].ppi.truth.records.get('1'); return [r.longitude_deg, r.latitude_deg]")
        cells = np.array(self.page.script(CELLS))
        self.assertGreater(len(cells), 30)
        self.shot("moves")
        east = lambda degrees: (degrees + 99.5) * M_PER_DEG * np.cos(np.radians(33.03))
        north = (latitude - 33) * M_PER_DEG
        beside = np.abs(cells[:, 1] - north) < 450  # half of beam and pulse
        self.assertGreater(beside.mean(), 0.9, "cells beside its way")
        self.assertLess(np.median(cells[beside, 0]), east(longitude), "cells behind it")
        old = cells[beside & (cells[:, 0] < east(start[0]) + 250)]
        new = cells[beside & (cells[:, 0] > east(longitude) - 450)]
        self.assertLess(np.mean(old[:, 2]), np.mean(new[:, 2]), "what is old is fainter")
        self.page.await_script(f"performance.now() - {start[1]} > 24000", "another twelve seconds")
        later = np.array(self.page.script(CELLS))
        self.assertGreater(np.min(later[np.abs(later[:, 1] - north) < 450, 0]), east(start[0]), "what is older than a quarter of a minute is gone")
        self.choose("0")
        self.page.await_script("document.querySelectorAll('.trails').length === 0", "no trails")
        self.assertNotIn("trails", self.page.script("return location.hash"))


class Flight(BaseTrails):
    def fly(self):
        """A kilometre to the north in steps; how many cells have a trail then."""
        refused = self.page.driver.execute_async_script("""const done = arguments[0];
            (async () => {
              for (let k = 1; k <= 20; ++k) {
                await obliq.control.pose({ latitude_deg: 33 + k * 0.00045 });
                await new Promise((go) => setTimeout(go, 350));
              }
            })().then(() => done(""), (error) => done(error.message));""")
        self.assertEqual(refused, "")
        self.page.await_frame(8)
        return len(self.page.script(CELLS))

    def test_true_trails_stay_on_the_earth_and_relative_ones_do_not(self):
        cells = {}
        for kind in ("true", "relative"):
            self.show(STANDS, "glow=0&trails=1")
            self.page.script(f"document.getElementById('trails-{kind}').click()")
            self.page.await_script(f"obliq.look.relative === {str(kind == 'relative').lower()}", kind)
            self.page.script("window.then = performance.now()")
            self.page.await_script("performance.now() - then > 4000", "what is usual")
            cells[kind] = self.fly()
            self.shot(kind)
        print(f"  cells with a trail behind a rock, seen from an antenna that goes a kilometre: {cells}")
        self.assertGreater(cells["relative"], 200)
        self.assertLess(cells["true"], 0.35 * cells["relative"])


class Following(BaseTrails):
    def test_trails_follow_zoom_and_b_scope_and_survive_a_range_scale(self):
        self.show(MOVES, "glow=0&trails=6")
        self.page.await_script("performance.now() > 9000", "a trail", 30)
        for change in ("obliq.pictures.zoom(3, 500, 200)", "obliq.pictures.zoom(0)", "obliq.display.set({ up: 'bearing' })", "obliq.display.set({ bscope: true })",
                       "obliq.display.set({ bscope: false })"):
            with self.subTest(change=change):
                self.page.script(change)
                self.page.await_frame(4)
                self.assertTrue(self.page.script("const { trails, ppi } = obliq.panes[0]; return trails.drawn === ppi.view && trails.canvas.width === ppi.view.width"))
        before = len(self.page.script(CELLS))
        self.page.driver.execute_async_script("const done = arguments[0]; obliq.link.ask('ClaimControl', { radar: 'round', kinds: ['SETTINGS_CLAIM'] })"
                                              ".then(() => obliq.controls.scale(18520)).then(done)")
        self.page.await_script("Math.abs(obliq.panes[0].bins.placement.rMax_m - 18520) < 1", "another range scale")
        self.page.await_frame(8)
        after = np.array(self.page.script(CELLS))
        print(f"  cells with a trail before and after another range scale: {before}, {len(after)}")
        self.assertGreater(len(after), 0.4 * before * (15000 / 18520) ** 2)


if __name__ == "__main__":
    unittest.main()
