"""What the page reads out: cursor against places() and the values of `obliq get`, rings against the cursor, controls."""
import unittest

import numpy as np

import support
import obliq
from obliq import mapping

POINTS = 50
READ = """
const [pane] = obliq.panes, { ppi } = pane;
return arguments[0].map(([east, north]) => {
  const at = ppi.read({ east_m: east, north_m: north });
  const screen = ppi.toScreen(east, north), back = ppi.fromScreen(...screen);
  return [at.row, at.column, at.value_dB, at.latitude_deg, at.longitude_deg, at.slant_m, at.bearing_deg, at.ground_m, at.state,
    back.east_m - east, back.north_m - north];
});
"""


class Readings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon()
        cls.page = support.Page()
        cls.server = obliq.connect(cls.daemon.address)
        cls.addClassCleanup(cls.server.close)

    def show(self, fragment):
        self.page.open(self.daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")

    def check_cursor(self, name):
        self.show(f"a={name}&overlay=1")
        self.page.await_script("obliq.panes[0].bins.hasStates && obliq.meter.drawn > 4", "states")
        frame = self.server.radar(name).frame(planes="iq state")
        latitude, longitude = frame.places()
        rows, columns = frame.shape
        random = np.random.default_rng(11)
        bins = np.column_stack([random.integers(0, rows, POINTS), random.integers(0, columns, POINTS)])
        lat, lon = latitude[tuple(bins.T)], longitude[tuple(bins.T)]
        east, north = mapping.inverse(frame.pose.latitude_deg, frame.pose.longitude_deg, lat, lon)
        got = np.array(self.page.script(READ, np.column_stack([east, north]).tolist()), float)  # None becomes NaN
        self.assertTrue((got[:, 0] == bins[:, 0]).all() and (got[:, 1] == bins[:, 1]).all(), "the cursor names another bin")
        m_per_deg = 111e3
        off = np.hypot((got[:, 3] - lat) * m_per_deg, (got[:, 4] - lon) * m_per_deg)
        self.assertLess(off.max(), 1, "metres between the cursor's place and that of places()")
        self.assertLess(np.abs(got[:, 5] - frame.range_m[bins[:, 1]]).max(), 1)
        turned = (got[:, 6] - frame.azimuth_deg[bins[:, 0]] + 180) % 360 - 180
        self.assertLess(np.abs(turned).max(), 0.01)
        self.assertLess(np.abs(got[:, 9:]).max(), 1e-6)
        self.assertTrue((got[:, 8] == frame.state[tuple(bins.T)]).all())
        power = np.abs(frame.iq[tuple(bins.T)].astype(complex)) ** 2
        seen = power > 0
        step_dB = frame.descriptor.settings.video_span_db / 254
        floor_dB = frame.descriptor.video_floor_db  # the video has nothing lower
        power_dB = np.clip(10 * np.log10(power[seen]), floor_dB, floor_dB + frame.descriptor.settings.video_span_db)
        self.assertGreater(seen.sum(), 10)
        self.assertLessEqual(np.abs(got[seen, 2] - power_dB).max(), step_dB / 2 + 0.01)
        self.assertTrue(np.isnan(got[~seen, 2]).all(), "a level where there is no echo")
        print(f"  {name}: {POINTS} points, at most {off.max():.2f} m and {np.abs(got[seen, 2] - power_dB).max():.3f} dB off")

    def test_cursor_of_a_sector(self):
        self.check_cursor("main")

    def test_cursor_far_from_the_origin(self):
        self.check_cursor("wide")

    def test_cursor_all_round(self):
        self.check_cursor("round")

    def test_ring_lies_where_the_cursor_reads_its_range(self):
        """A ring is looked for on the grid's canvas, along the middle of the sector, without knowing how it was drawn."""
        for unit, metres in (("km", 1000), ("NM", 1852)):
            self.show(f"a=main&unit={unit}")
            step, worst = self.page.script("""
                const { ppi } = obliq.panes[0], { grid, density, bins: { placement } } = ppi;
                obliq.markers.clear();
                const bearing = placement.bearing_deg + 7;  // beside the lines of bearings
                const { data, width } = grid.getImageData(0, 0, grid.canvas.width, grid.canvas.height);
                const found = [];
                let run = [];
                for (let r = placement.r0_m + 200; r < placement.rMax_m - 200; r += 5) {
                  const [x, y] = ppi.toScreen(...placement.place(bearing, r)).map((v) => Math.floor(v * density));
                  if (data[4 * (y * width + x) + 3] > 40) run.push(r);
                  else if (run.length) { found.push(run[Math.floor(run.length / 2)]); run = []; }
                }
                return [ppi.ringStep.step, found.map((r) => r)];
                """)
            found = np.array(worst) / (step * metres)
            self.assertGreaterEqual(len(found), 2, "rings")
            pixel_m = self.page.script("return obliq.panes[0].ppi.view.pixel_m")
            off = np.abs(found - np.round(found)) * step * metres
            self.assertLess(off.max(), 1.5 * pixel_m, f"rings at {found}")
            self.assertIn(step, (1, 2, 5))

    def test_levels_are_compensated_for_ideal_maps_only(self):
        self.show("a=main")
        self.assertTrue(self.page.script("return obliq.panes[0].bins.mayCompensate"))
        with self.server.radar("main").control() as control:
            for field, value, off in (("noise", True, False), ("rain_mm_h", 4.0, 0.0), ("beam_elevation", "gaussian", "off")):
                with self.subTest(field=field):
                    control.set(**{field: value})
                    self.page.await_script("obliq.panes[0].bins.mayCompensate === false", "more than echoes")
                    self.page.await_script("document.getElementById('compensated').disabled", "no choice of compensation")
                    control.set(**{field: off})
                    self.page.await_script("obliq.panes[0].bins.mayCompensate", "an ideal map")

    def test_a_frustum_that_is_refused_is_said_and_another_is_shown(self):
        self.show("a=round&panes=2&b=frustum%20symmetric")
        self.page.await_words("No picture through the symmetric frustum")
        self.page.script("obliq.pictures.choose(obliq.panes[1], 'frustum oblique')")
        self.page.await_script("obliq.panes[1].bins.frames > 0 && (obliq.panes[1].bins.descriptor.settings.frustum ?? 'OBLIQUE') === 'OBLIQUE'",
                               "a frame through the oblique frustum")

    def test_a_refusal_stands_beside_its_field(self):
        self.show("a=main&tab=radar")
        self.page.await_script("document.querySelector('#radar [data-key]')", "the form")
        self.assertTrue(self.page.script("return document.querySelector('#radar [data-key]').hidden"), "a form without control")
        self.page.script("document.getElementById('claim').click()")
        self.page.await_script("!document.querySelector('#radar [data-key]').hidden", "the form")
        field = "document.querySelector('[data-key=\"radar.sector_deg\"]')"
        limits = self.page.script(f"const f = {field}; return [f.min, f.max]")
        self.assertEqual(limits[1], "360")
        self.page.script(f"const f = {field}; f.value = '500'; f.dispatchEvent(new Event('change'))")
        self.page.await_script(f"{field}.closest('.field').querySelector('.refusal').textContent.includes('360')", "the refusal")
        self.page.script(f"const f = {field}; f.value = '50'; f.dispatchEvent(new Event('change'))")
        self.page.await_script(f"!{field}.closest('.field').querySelector('.refusal').textContent", "no refusal")
        self.page.await_script("obliq.panes[0].bins.placement.azimuths * obliq.panes[0].bins.placement.width_deg < 50.01", "50 degrees")
        self.page.script("document.getElementById('scale-10').click()")  # a scale of nautical miles
        self.page.await_script("Math.abs(obliq.panes[0].bins.placement.rMax_m - 18520) < 1e-6", "10 NM")
        self.page.script(f"const f = {field}; f.value = '60'; f.dispatchEvent(new Event('change'))")
        self.page.script("obliq.control.set('RadarSettings.r_max_m', 15000)")
        self.page.await_script("obliq.panes[0].bins.placement.rMax_m === 15000", "15 km")
        self.page.script("document.getElementById('claim').click()")
        self.page.await_script("document.querySelector('#radar [data-key]').hidden", "no form")


if __name__ == "__main__":
    unittest.main()
