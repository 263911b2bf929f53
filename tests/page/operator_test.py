"""The page as an operator uses it: knobs that are seen, a picture without gaps, scales, words on the picture, lines by number."""
import re
import time
import unittest

import support
import obliq

NOISY = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 2500.0
bearing_deg = 60.0
tilt_deg = -8.0
[http]
range_scales = [3.0, 6.0, 12.0]
[bins]
azimuth = 256
range = 192
[beam]
pattern = "gaussian"
width_deg = 3.0
elevation = "cosecant"
elevation_width_deg = 6.0
cosecant_to_deg = 60.0
[receiver]
noise = true
[video]
looks = 8
[[radar]]
name = "nose"
sector_deg = 90.0
scan.mode = "frame"
RADAR
[[radar]]
name = "turning"
sector_deg = 360.0
scan.mode = "circular"
scan.rate_deg_s = 120.0
scan.dwell_bins = 32
RADAR
""".replace("RADAR", """r_min_m = 2600.0
r_max_m = 15000.0
frequency_ghz = 9.4
power_w = 50e3
gain_db = 33.0""")
BRIGHTNESS = """
const { out, table } = obliq.panes[0].ppi;
let sum = 0;
for (let k = 0; k < table.size; ++k) { const p = out[table.pixels[k]]; sum += (p & 255) + ((p >> 8) & 255) + ((p >> 16) & 255); }
return sum / table.size / 3;
"""


class BaseOperator(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon(NOISY)
        cls.page = support.Page()
        cls.server = obliq.connect(cls.daemon.address)
        cls.addClassCleanup(cls.server.close)

    def show(self, fragment="a=nose", daemon=None):
        self.page.size(1366, 768)
        self.page.open((daemon or self.daemon).url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1 && obliq.panes[0].info", "frames")

    def take_control(self):
        self.page.await_script("!document.getElementById('claim').disabled", "control to take")
        self.page.script("if (!obliq.control.isMine) document.getElementById('claim').click()")
        self.page.await_script("obliq.control.isMine && obliq.controls.fields.length > 3", "control")
        self.addCleanup(self.page.script, "obliq.control.isMine && obliq.control.toggle()")

    def set(self, **settings):
        self.page.driver.execute_async_script("const done = arguments[1]; obliq.link.ask('SetSettings', { radar: obliq.panes[0].radar, settings: arguments[0] })"
                                              ".then(() => done(''), (error) => done(error.message));", settings)
        name, value = next(iter(settings.items()))
        self.page.await_script(f"Number(obliq.panes[0].bins.descriptor.settings.{name} ?? 0) === {value}", "the next frame")
        self.page.await_frame(2)


class Echoes(BaseOperator):
    # ---- Levels

    def test_gain_is_seen_and_auto_sets_once(self):
        self.show("a=nose&palette=grey")
        self.take_control()
        low, noise = self.page.script("const { levels, bins } = obliq.panes[0]; return [levels.low_dB, bins.descriptor.video_floor_db]")
        self.assertEqual(low, noise, "black is the noise at 0 dB of gain")
        dark = self.page.script(BRIGHTNESS)
        self.set(receiver_gain_db=20)
        bright = self.page.script(BRIGHTNESS)
        print(f"  mean brightness {dark:.1f}, with 20 dB of gain {bright:.1f}")
        self.assertGreater(bright, dark + 30)
        self.assertEqual(self.page.script("return obliq.panes[0].levels.low_dB"), low)
        self.page.script("document.getElementById('auto').click()")
        after = self.page.script("return [obliq.panes[0].levels.low_dB, obliq.panes[0].levels.auto]")
        self.assertNotEqual(after[0], low)
        self.assertFalse(after[1])
        self.set(receiver_gain_db=0)
        time.sleep(1.5)
        self.assertEqual(self.page.script("return obliq.panes[0].levels.low_dB"), after[0], "it does not follow")
        self.page.script("document.getElementById('usual').click()")
        self.page.await_script(f"obliq.panes[0].levels.low_dB === {low}", "the receiver's levels again")

    def test_each_of_two_pictures_has_its_own_levels(self):
        self.show("a=nose&panes=2&b=radar%20turning")
        self.page.await_script("obliq.panes[1]?.bins.frames > 0", "two pictures")
        self.page.script("obliq.pictures.activate(obliq.panes[1]); document.getElementById('low').value = -90; document.getElementById('low').oninput()")
        levels = self.page.script("return obliq.panes.map(({ levels }) => levels.low_dB)")
        self.assertNotEqual(levels[0], levels[1])
        self.assertEqual(self.page.script("return obliq.panes.map(({ bins }) => bins.scale.low_dB)"), levels)
        self.assertIn("low2=", self.page.script("return location.hash"))

    # ---- Range scales

    def test_no_scale_is_refused_by_the_sea_knob(self):
        self.show("a=nose&tab=radar")
        self.take_control()
        self.assertEqual(self.page.script("return obliq.controls.scales.map(({ textContent }) => textContent)"), ["3", "6", "12"])
        self.set(stc_range_m=14000)
        for scale in (6, 3, 12):
            self.page.script("document.getElementById(arguments[0]).click()", f"scale-{scale}")
            self.page.await_script(f"Math.abs(obliq.panes[0].bins.placement.rMax_m - {scale * 1852}) < 1e-6", f"{scale} NM")
            self.assertEqual(self.page.script("return obliq.controls.general.textContent"), "")
        self.page.await_script("document.querySelector('.annun.upper.left').textContent.includes('RNG 12 NM')", "the scale on the picture")
        self.page.await_script("document.querySelector('.annun.lower.left').textContent.includes('SEA 7.6 NM')", "the sea knob on the picture")
        self.set(stc_range_m=0)
        self.page.script("document.getElementById('scale-own').click()")

    # ---- Bins without an echo

    def test_ground_that_no_file_has_is_hatched_without_the_overlay(self):
        scene = support.SCENE.replace('synthetic = "hills"', f'dem = ["{self.daemon.folder}/half.asc"]')
        lines = ["ncols 40", "nrows 40", "xllcorner -99.5", "yllcorner 32.9", "cellsize 0.005", "NODATA_value -9999"]
        lines += [" ".join(str(300 + (7 * x * y) % 90) for x in range(40)) for y in range(40)]
        (self.daemon.folder / "half.asc").write_text("\n".join(lines) + "\n")
        daemon = support.Daemon(scene, 'terrain.crs="EPSG:4326"', "round:radar.r_max_m=30000")
        self.addCleanup(daemon.close)
        self.show("a=round&palette=grey&auto=0&low=-300&span=120", daemon)
        self.page.await_script("obliq.panes[0].bins.hasStates && obliq.panes[0].bins.hasState[0]", "states unasked")
        self.page.await_frame(2)
        lines, unknown, sampled = self.page.script("""
            const { ppi, bins } = obliq.panes[0], { out, table } = ppi;
            let [lines, unknown, sampled] = [0, 0, 0];
            for (let k = 0; k < table.size; ++k) {
              const state = bins.state[table.bins[k]], isLine = (out[table.pixels[k]] & 0xffffff) === 0x6e685c;
              if (state === 3) { ++unknown; lines += isLine; } else if (isLine) ++sampled;
            }
            return [lines, unknown, sampled];""")
        self.assertGreater(unknown, 10000)
        self.assertAlmostEqual(lines / unknown, 3 / 8, delta=0.03)
        self.assertEqual(sampled, 0)

    def test_what_the_beam_has_not_told_yet_is_grey_and_not_what_was_not_sampled(self):
        self.show("a=turning")
        self.page.script("""window.take = obliq.pictures.take.bind(obliq.pictures);
            obliq.pictures.take = (message) => message.body.plane !== "STATE" && window.take(message);  // they have not come
            obliq.display.set({ overlay: true });""")
        self.page.await_script("obliq.look.overlay && !obliq.panes[0].bins.hasStates", "the overlay")
        self.page.script("obliq.pictures.take = window.take")
        self.page.await_script("obliq.panes[0].bins.hasStates", "first states")
        counts = self.page.script("""
            const { ppi, bins } = obliq.panes[0], { out, table } = ppi, counts = { grey: 0, magenta: 0, told: 0 };
            bins.hasState.fill(0, 0, 100);
            ppi.needs.all = true;
            ppi.draw(performance.now() + 100, performance.now());
            for (let k = 0; k < table.size; ++k) {
              const row = Math.floor(table.bins[k] / bins.placement.ranges), p = out[table.pixels[k]] & 0xffffff;
              if (row < 100) counts[p === 0x46423a ? "grey" : p === 0x8028b0 ? "magenta" : "told"]++;
            }
            return counts;""")
        self.assertGreater(counts["grey"], 1000)
        self.assertEqual([counts["magenta"], counts["told"]], [0, 0])

    def test_states_differ_by_their_hatches_too(self):
        self.show()
        tiles = self.page.driver.execute_async_script("""const done = arguments[1];
            import(arguments[0] + 'picture/palettes.js').then(({ stateTiles }) => done(stateTiles().map((tile) => [...tile].map((c) => c === Math.max(...tile)))));""",
                                                      self.daemon.url)
        patterns = {tuple(tile) for state, tile in enumerate(tiles) if state != 1}
        self.assertEqual(len(patterns), 4)


class Lines(BaseOperator):
    def test_lines_and_markers_are_set_by_number_and_stand_apart(self):
        self.show("a=turning&up=north&unit=NM")
        for field, value in (("ebl-1-at", "45"), ("vrm-2-at", "5.5")):
            self.page.script("const f = document.getElementById(arguments[0]); f.value = arguments[1]; f.dispatchEvent(new Event('change'))", field, value)
        self.assertEqual(self.page.script("return [obliq.look.lines.ebl, obliq.look.lines.vrm]"), [[45, None], [None, 5.5 * 1852]])
        self.page.await_script("!obliq.panes[0].ppi.needs.marks", "the lines")
        seen = self.page.script("""
            const { ppi } = obliq.panes[0], { marks, density } = ppi;
            const orange = (bearing, slant) => {
              const [x, y] = ppi.screenOf(bearing, slant).map((v) => Math.round(v * density));
              const { data } = marks.getImageData(x - 2, y - 2, 5, 5);
              for (let k = 0; k < data.length; k += 4) if (data[k + 3] > 90 && data[k] > 200 && data[k + 2] < 140) return true;
              return false;
            };
            const dashed = Array.from({ length: 40 }, (_, k) => orange(100 + k, 5.5 * 1852)).filter(Boolean).length;
            return [orange(45, 4000), orange(45, 12000), orange(225, 8000), orange(135, 12000), dashed];""")
        self.assertEqual(seen[:4], [True, True, False, False])
        self.assertGreater(seen[4], 15, "a ring, dashed")
        self.assertIn("045.0°", self.page.script("return document.querySelector('[data-of=m1]').textContent"))
        self.assertIn("5.50 NM", self.page.script("return document.querySelector('[data-of=m2]').textContent"))

    def test_a_line_is_placed_by_a_click_and_dragged_alone(self):
        self.show("a=turning&up=north")
        self.page.script("document.getElementById('vrm-1').click()")
        self.assertEqual(self.page.script("return obliq.look.armed"), ["vrm", 0])
        mouse = """
            const { ppi } = obliq.panes[0], box = ppi.element.getBoundingClientRect(), [kind, [x, y]] = [arguments[0], ppi.screenOf(arguments[1], arguments[2])];
            ppi.element.setPointerCapture = () => {};
            ppi.element.dispatchEvent(new PointerEvent(kind, { clientX: box.left + x, clientY: box.top + y, pointerId: 1, pointerType: 'mouse', bubbles: true }));"""
        for kind in ("pointerdown", "pointerup"):
            self.page.script(mouse, kind, 30, 8000)
        ebl, vrm = self.page.script("return [obliq.look.lines.ebl[0], obliq.look.lines.vrm[0]]")
        self.assertIsNone(ebl, "the range marker alone")
        self.assertAlmostEqual(vrm, 8000, delta=60)
        for kind, bearing, slant in (("pointerdown", 120, 8000), ("pointermove", 121, 9000), ("pointermove", 125, 10000), ("pointerup", 125, 10000)):
            self.page.script(mouse, kind, bearing, slant)
        self.assertAlmostEqual(self.page.script("return obliq.look.lines.vrm[0]"), 10000, delta=60)
        self.assertIsNone(self.page.script("return obliq.look.window"), "the picture stays")
        self.page.script("document.getElementById('vrm-1').click()")
        self.assertIsNone(self.page.script("return obliq.look.lines.vrm[0]"))

    def test_a_profile_along_a_bearing_line_is_the_ground_that_a_query_finds(self):
        self.show("a=turning&up=north&profile=1")
        with self.server.radar("turning").control() as control:
            control.set_pose(height_m=80.0, height_reference="ground")
        self.addCleanup(self.lift)
        self.page.script("obliq.markers.setLines({ ebl: [75, null], vrm: [null, null] })")
        self.page.await_script("obliq.panes[0].profile.points.length > 200", "a profile")
        time.sleep(1.5)
        self.page.await_script("obliq.panes[0].profile.points.filter(({ seen }) => !seen).length > 5", "hidden ground")
        points, places = self.page.script("""const [{ profile, bins: { placement } }] = obliq.panes;
            return [profile.points, profile.points.map(({ slant_m }) => placement.located(75, slant_m))];""")
        found = self.server.radar("turning").query([p["latitude_deg"] for p in places], [p["longitude_deg"] for p in places])
        for k in range(0, len(points), 9):
            self.assertAlmostEqual(points[k]["height_m"], found.height_m[k], delta=1e-6)
            self.assertEqual(points[k]["seen"], bool(found.visible[k]))
        colours = self.page.script("""const { canvas, context } = obliq.panes[0].profile;
            const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
            let [green, blue] = [0, 0];
            for (let k = 0; k < data.length; k += 4) { green += data[k + 1] === 125 && data[k] === 44; blue += data[k + 2] === 79 && data[k] === 29 && data[k + 1] === 47; }
            return [green, blue];""")
        self.assertGreater(min(colours), 50)

    def lift(self):
        with self.server.radar("turning").control() as control:
            control.set_pose(height_m=2500.0, height_reference="datum")

    def test_a_b_scope_has_bearings_across_and_ranges_upwards(self):
        self.show("a=nose&bscope=1")
        self.page.await_frame(2)
        wrong = self.page.script("""
            const { ppi, bins: { placement } } = obliq.panes[0], { table, view } = ppi, k = view.width / ppi.width;
            const under = new Int32Array(view.width * view.height).fill(-1);
            for (let n = 0; n < table.size; ++n) under[table.pixels[n]] = table.bins[n];
            let wrong = 0;
            for (let row = 3; row < placement.azimuths; row += 17)
              for (let column = 2; column < placement.ranges; column += 13) {
                const [x, y] = ppi.screenOf(placement.start_deg + (row + 0.5) * placement.width_deg, placement.r0_m + (column + 0.5) * placement.spacing_m);
                const at = ppi.read(ppi.fromScreen(x, y));
                if (under[Math.floor(y * k) * view.width + Math.floor(x * k)] !== row * placement.ranges + column || at.row !== row || at.column !== column) ++wrong;
              }
            return wrong;""")
        self.assertEqual(wrong, 0)

    def test_a_fan_fills_the_window_with_its_bearing_up(self):
        self.show("a=nose")
        wide = self.page.script("""const { ppi, bins: { placement } } = obliq.panes[0];
            const points = [0, 0.25, 0.5, 0.75, 1].map((k) => ppi.screenOf(placement.start_deg + k * placement.sector_deg, placement.rMax_m));
            const xs = points.map(([x]) => x), ys = [ppi.toScreen(0, 0)[1], ...points.map(([, y]) => y)];
            return [(Math.max(...xs) - Math.min(...xs)) / ppi.width, (Math.max(...ys) - Math.min(...ys)) / ppi.height, points[2][0] / ppi.width];""")
        self.assertGreater(max(wide[0], wide[1]), 0.85)
        self.assertAlmostEqual(wide[2], 0.5, delta=0.02)


class Turning(BaseOperator):
    def test_a_turning_antenna_leaves_no_gaps(self):
        self.show("a=turning&glow=0")
        pass_s = 3.0
        for rate_deg_s in (20, -20, 60):
            with self.server.radar("turning").control() as control:
                began = time.monotonic()
                while (since := time.monotonic() - began) < 2.2 * pass_s:
                    control.set_pose(bearing_deg=(60 + rate_deg_s * since + 180) % 360 - 180)
                    time.sleep(0.03)
                # While it still turns: how long ago was each azimuth shown?
                ages = self.page.script("const { seen_ms } = obliq.panes[0].bins, now = performance.now(); return [...seen_ms].map((ms) => ms > -1e12 ? now - ms : null)")
            self.assertNotIn(None, ages)
            # Against the scan a turn takes longer: 360 degrees at 120 less 20 a second.
            limit_s = 360 / (120 - max(0, -rate_deg_s)) + 1.0
            old = [round(age / 1000, 2) for age in ages if age > 1000 * limit_s]
            print(f"  {rate_deg_s} deg/s: {len(old)} of {len(ages)} azimuths older than a turn")
            self.assertLessEqual(len(old), 2, old)


class Words(BaseOperator):
    def test_the_picture_carries_its_own_numbers(self):
        with self.server.radar("turning").control() as control:
            control.set_pose(bearing_deg=60.0)
        self.show("a=turning&unit=NM")
        words = "return [...document.querySelectorAll('.annun')].map(({ textContent }) => textContent).join('|')"
        support.await_that(lambda: "HDG 060.0° T" in self.page.script(words), "words in the corners")
        text = self.page.script(words)
        for part in ("RNG 8.1 NM", "TURNING 20 RPM", "N UP  T", "HDG 060.0° T", "33°00.0′N", "099°30.0′W", "HGT 2500 m", "GAIN 0 dB", "SEA OFF", "RAIN OFF",
                     "TILT −8.0°"):
            self.assertIn(part, text)

    def test_the_course_of_a_flight_is_said_and_may_be_up(self):
        self.show("a=nose&up=course")
        with self.server.radar("nose").control() as control:
            began, seen = time.monotonic(), []

            def says_so():  # of 100 m/s to the south-east; a busy machine shows its poses unevenly at first
                since = time.monotonic() - began
                control.set_pose(latitude_deg=33 - 70.7 * since / 110900, longitude_deg=-99.5 + 70.7 * since / 93450, bearing_deg=60.0)
                time.sleep(0.05)
                seen[:] = self.page.script("""const { ppi, heading } = obliq.panes[0];
                    return [heading.course_deg, heading.speed_mps, ppi.view.up_deg, document.querySelector('.annun.upper.right').textContent];""")
                course, speed, up, words = seen
                return (course is not None and abs(course - 135) < 2 and abs(speed - 100) < 25 and abs(up - course) < 1
                        and "CRS UP  R" in words and re.search(r"CRS 13\d\.\d° T  [12]\d\d kt", words))
            support.await_that(says_so, lambda: f"course and speed: {seen}")
            control.set_pose(latitude_deg=33.0, longitude_deg=-99.5)

    def test_a_velocity_that_a_pose_gives_is_course_and_speed_at_once(self):
        self.show("a=nose&up=north")
        with self.server.radar("nose").control() as control:
            control.set_pose(velocity_north_m_s=-30.0, velocity_east_m_s=40.0)
            self.page.await_script("obliq.panes[0].heading.speed_mps === 50", "the speed of the pose")
            self.assertAlmostEqual(self.page.script("return obliq.panes[0].heading.course_deg"), 126.8699, delta=1e-3)
            control.set_pose(latitude_deg=33.0, longitude_deg=-99.5)

    def test_letters_follow_the_screen(self):
        self.show("a=nose")
        size = "return [parseFloat(getComputedStyle(document.querySelector('.annun')).fontSize), parseFloat(getComputedStyle(document.body).fontSize)]"
        small = self.page.script(size)
        self.page.size(3840, 2160)
        self.addCleanup(self.page.size, 1366, 768)
        self.page.await_script("obliq.look.px > 2.7", "the greater size")
        large = self.page.script(size)
        self.assertAlmostEqual(large[0] / small[0], 2160 / 768, delta=0.05)
        self.assertGreater(large[1], 30)
        self.page.script("const s = document.getElementById('size'); s.value = '1.25'; s.dispatchEvent(new Event('change'))")
        self.page.await_script("obliq.look.px > 3.4", "25 % more")
        self.assertIn("size=1.25", self.page.script("return location.hash"))

    def test_the_wheel_turns_a_field_and_g_goes_to_the_gain(self):
        self.show("a=nose&tab=radar")
        self.take_control()
        self.page.script("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'g', bubbles: true, cancelable: true }))")
        self.assertEqual(self.page.script("return document.activeElement.dataset.key"), "receiver.gain_db")
        self.page.script("for (let k = 0; k < 3; ++k) document.activeElement.dispatchEvent(new WheelEvent('wheel', { deltaY: -100, bubbles: true, cancelable: true }))")
        self.page.await_script("obliq.panes[0].info.settings.receiver_gain_db === 3", "3 dB")
        self.set(receiver_gain_db=0)

    def test_the_banner_stands_at_the_top_and_off_the_map_beats_stale_pose(self):
        self.show("a=nose")
        # In one script: between two a message of the server may say how its radar is.
        text, top, height = self.page.script("""obliq.watch.poll = async () => {};
            const [pane] = obliq.panes;
            Object.assign(pane.info, { pose_stale: true });
            pane.status = { ...pane.status, coverage: 0 };
            obliq.tell();
            const { banner } = pane, box = banner.getBoundingClientRect();
            return [banner.textContent, box.bottom - pane.element.getBoundingClientRect().top, pane.ppi.height];""")
        self.assertEqual(text, "OFF THE MAP")
        self.assertLess(top, 0.15 * height)

    def test_an_age_of_a_pose_that_stands_is_no_latency(self):
        self.show("a=nose")
        time.sleep(3.5)
        self.page.await_frame(2)
        self.assertNotIn("pose", self.page.script("return document.getElementById('meters').textContent"))


if __name__ == "__main__":
    unittest.main()
