"""Targets on the page: who may see them, where their marks are, what is set by hand."""
import os
import pathlib
import tempfile
import unittest

import numpy as np

import asked
import support
from obliq.places import World
from picture_test import expected

SHOTS = os.environ.get("OBLIQ_SHOTS")  # a folder for pictures to look at
MARK = (143, 220, 255)  # of what is seen
SCENE = support.SCENE.replace("[[radar]]", """[target_types.truck]
rcs_dbsm = 30.0
swerling = 1
top_m = 4.0
[target_types.ship]
rcs_dbsm = 40.0
top_m = 20.0
[[target]]
name = "tower"
type = "ship"
latitude_deg = 33.04
longitude_deg = -99.42
height_m = 400.0
height_reference = "datum"
[[radar]]""", 1)
PLACE = {"latitude_deg": 33.04, "longitude_deg": -99.42, "height_m": 400.0}
# All messages of the stream are counted by their type.
COUNTED = """
window.counts = {};
const emit = obliq.link.emit.bind(obliq.link);
obliq.link.emit = (type, message) => { counts[type] = (counts[type] ?? 0) + 1; emit(type, message); };
window.asks = [];
const ask = obliq.link.ask.bind(obliq.link);
obliq.link.ask = (type, body) => { asks.push([type, body]); return ask(type, body); };
"""
BLUE = """
const { canvases: [, , marks], density } = obliq.panes[0].ppi, [red, green, blue] = arguments[0];
const { data, width } = marks.getContext('2d').getImageData(0, 0, marks.width, marks.height);
let [n, x, y] = [0, 0, 0];
for (let k = 0; k < data.length; k += 4)
  if (data[k + 3] > 250 && Math.abs(data[k] - red) + Math.abs(data[k + 1] - green) + Math.abs(data[k + 2] - blue) < 12) {
    n += 1; x += (k / 4) % width + 0.5; y += Math.floor(k / 4 / width) + 0.5;
  }
return n ? [x / n / density, y / n / density, n] : null;
"""


class Targets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon(SCENE)
        cls.page = support.Page()

    def show(self, fragment="a=main&targets=1", url=None):
        self.page.size(1280, 800)
        self.page.open(url or self.daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")

    def shot(self, name):
        if SHOTS:
            self.page.shot(pathlib.Path(SHOTS) / f"targets_{name}.png")

    def mouse(self, kind, x, y, shift=False):
        left, top = self.page.script("const b = document.querySelector('.ppi').getBoundingClientRect(); return [b.left, b.top]")
        px = self.page.script("return obliq.look.px")
        self.page.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": left + x * px, "y": top + y * px, "modifiers": 8 if shift else 0, "clickCount": 1,
            "button": "left" if kind != "mouseMoved" or self.is_down else "none", "buttons": 1 if self.is_down else 0})

    is_down = False

    def click(self, x, y, shift=False):
        self.mouse("mouseMoved", x, y, shift)
        self.mouse("mousePressed", x, y, shift)
        self.mouse("mouseReleased", x, y, shift)

    def drag(self, from_x, from_y, to_x, to_y):
        self.mouse("mouseMoved", from_x, from_y)
        self.mouse("mousePressed", from_x, from_y)
        self.is_down = True
        for k in range(1, 6):
            self.mouse("mouseMoved", from_x + k * (to_x - from_x) / 5, from_y + k * (to_y - from_y) / 5)
        self.is_down = False
        self.mouse("mouseReleased", to_x, to_y)

    def mark_of(self, name):
        """The page's pixels of a mark, when it is there."""
        return self.page.await_script(f"""(() => {{ const {{ ppi }} = obliq.panes[0];
            const record = [...ppi.truth.records.values()].find(({{ id }}) => obliq.targets.nameOf(id) === '{name}');
            return record && ppi.screenOf(record.bearing_deg, record.range_m); }})()""", f"the mark of {name}")

    def set_targets(self):
        self.page.script("obliq.tabs.show('targets')")
        self.page.await_script("!document.getElementById('targets-set').disabled", "a claim to take")
        self.page.script("document.getElementById('targets-set').click()")
        self.page.await_script("obliq.targets.holds", "the claim")

    def fill(self, **values):
        self.page.await_script("!document.getElementById('target-form').hidden", "the form")
        self.page.script("""const { elements } = document.getElementById('target-form');
            for (const [name, value] of Object.entries(arguments[0])) {
              elements[name].value = value;
              elements[name].dispatchEvent(new Event('change'));
            }""", values)

    def add(self, name, x, y, **values):
        self.click(x, y)
        self.fill(name=name, **values)
        self.page.script("document.querySelector('#target-form button').click()")
        return support.await_that(lambda: asked.targets_of(self.daemon.url).get(name), f"the target {name} at the server")

    def place_under(self, x, y):
        return self.page.script("const { ppi } = obliq.panes[0]; const at = ppi.read(ppi.fromScreen(...arguments[0])); "
                                "return [at.bearing_deg, at.slant_m]", [x, y])

    def seen(self, target):
        """Bearing and slant range of a target that stands above ground, by the server's own block."""
        return self.page.await_script(f"""(() => {{ const record = obliq.panes[0].ppi.truth.records.get('{target["id"]}');
            return record && Math.abs(record.latitude_deg - {target["latitude_deg"]}) < 1e-6 && [record.bearing_deg, record.range_m]; }})()""",
                                      "its place in a frame")

    # ---- Who may see them

    def test_a_viewer_has_no_switch_and_gets_no_block(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        tokens = pathlib.Path(folder.name) / "tokens"
        watch, fly = "watch-0123456789abcdef", "fly-0123456789abcdef0"
        tokens.write_text(f"viewer {watch} anna\ncontroller {fly} bert\n")
        tokens.chmod(0o600)
        daemon = support.Daemon(SCENE, f"server.tokens={tokens}")
        self.addCleanup(daemon.close)
        give = "document.getElementById('token').value = arguments[0]; document.querySelector('#ask button').click()"
        for token, may in ((watch, False), (fly, True)):
            with self.subTest(may=may):
                self.page.open(daemon.url, "a=main&targets=1&tab=targets")
                self.page.script("sessionStorage.clear()")
                self.page.open(daemon.url, "a=main&targets=1&tab=targets")
                self.page.await_script("globalThis.obliq && document.getElementById('ask').open", "the question for a token")
                self.page.script(COUNTED)
                self.page.script(give, token)
                self.page.await_script("obliq.meter.drawn > 5 && counts.FrameEnd > 5", "frames")
                self.assertEqual(self.page.script("return Boolean(document.getElementById('targets-on') || document.getElementById('tab-targets'))"), may)
                self.assertEqual(self.page.script("return (counts.TargetBlock ?? 0) > 0"), may)
                self.assertEqual(self.page.script("return asks.some(([type, body]) => type === 'GetTargets' || body?.truth)"), may)
                self.assertEqual(self.page.script("return obliq.panes[0].ppi.truth !== null"), may)
                self.assertEqual(self.page.script("return [...document.querySelectorAll('#key-table td')].some((cell) => cell.textContent === 'Delete')"), may)
                self.assertEqual(self.page.script("return obliq.tabs.current"), "targets" if may else "view")
                self.page.script("const s = document.getElementById('trails'); s.value = '3'; s.onchange()")
                self.page.await_script("document.querySelectorAll('.trails').length === 1", "trails, for everyone")

    def test_the_switch_asks_for_truth_and_ends_it(self):
        self.show("a=main")
        self.page.script(COUNTED)
        self.page.await_frame(5)
        self.assertEqual(self.page.script("return [counts.TargetBlock ?? 0, asks.filter(([type]) => type === 'GetTargets').length]"), [0, 0])
        self.assertIsNone(self.page.script(BLUE, MARK))
        self.page.script("document.getElementById('targets-on').click()")
        self.page.await_script("counts.TargetBlock > 2", "where targets are")
        self.page.await_script("obliq.targets.nameOf('1') === 'tower'", "their names")
        self.page.await_frame(2)
        self.assertIsNotNone(self.page.script(BLUE, MARK))
        self.assertIn("targets=1", self.page.script("return location.hash"))
        self.page.script("document.getElementById('targets-on').click()")
        self.page.await_script("obliq.panes[0].ppi.truth === null", "no marks")
        self.page.await_frame(3)
        self.page.script("counts.TargetBlock = 0")
        self.page.await_frame(5)
        self.assertEqual(self.page.script("return counts.TargetBlock"), 0)
        self.assertIsNone(self.page.script(BLUE, MARK))
        self.assertNotIn("targets=1", self.page.script("return location.hash"))

    # ---- Where marks are

    def check_mark(self, fragment, then=""):
        self.show(f"a=main&targets=1&{fragment}")
        self.mark_of("tower")
        # What is drawn beside marks has their colour, too.
        self.page.script(f"obliq.targets.nameOf = () => ''; {then}")
        self.page.await_frame(3)
        x, y, n = self.page.script(BLUE, MARK)
        self.assertGreater(n, 20, "pixels of a mark")
        view, d, width = self.page.script("const { ppi, bins } = obliq.panes[0]; return [ppi.view, bins.descriptor, ppi.width]")
        d.setdefault("north_rad", 0)  # JSON leaves out what is 0
        k = view["width"] / width
        turns, ranges = expected(d, view, np.array([[x * k - 0.5, y * k - 0.5]]))
        bearing = d["azimuth_start_deg"] + turns[0] * d["azimuth_width_deg"]
        slant = d["range_start_m"] + ranges[0] * d["range_spacing_m"]
        world = World(d["origin_latitude_deg"], d["origin_longitude_deg"], float(d["radius_factor"]))
        at = np.array(world.world(*(np.array(PLACE[key]) for key in PLACE))) - [d["antenna_x_m"], d["antenna_y_m"], d["antenna_z_m"]]
        want_slant, want_bearing = np.linalg.norm(at), np.degrees(np.arctan2(at[0], at[2]) - d["north_rad"]) % 360
        off_m = np.hypot(slant - want_slant, np.radians((bearing - want_bearing + 180) % 360 - 180) * slant)
        print(f"  {fragment}{' zoomed' if then else ''}: the mark is {off_m / view['pixel_m']:.2f} pixels off")
        # The middle of some 100 pixels of an outline, of whole ones: within one.
        self.assertLess(off_m, 1.0 * view["pixel_m"])

    def test_a_mark_lies_at_its_bearing_and_slant_range(self):
        self.check_mark("up=north")
        self.check_mark("up=bearing")

    def test_a_mark_follows_zoom_and_slant_ranges(self):
        self.check_mark("up=north", "const { ppi } = obliq.panes[0], { bearing_deg, range_m } = ppi.truth.records.get('1');"
                        "obliq.pictures.zoom(4, ...ppi.screenOf(bearing_deg, range_m));")
        self.check_mark("up=north&slant=1")

    def test_a_mark_follows_range_scale_and_b_scope(self):
        self.show()
        self.mark_of("tower")
        self.page.script("obliq.targets.nameOf = () => ''; obliq.display.set({ bscope: true })")
        self.page.await_frame(3)
        x, y, _ = self.page.script(BLUE, MARK)
        box, start, sector, near, far = self.page.script("""const { ppi, bins: { placement: p } } = obliq.panes[0];
            return [ppi.box, p.start_deg, p.sector_deg, p.r0_m, p.rMax_m]""")
        record = self.page.script("return obliq.panes[0].ppi.truth.records.get('1')")
        want = [box["left"] + (record["bearing_deg"] - start) / sector * (box["right"] - box["left"]),
                box["bottom"] - (record["range_m"] - near) / (far - near) * (box["bottom"] - box["top"])]
        self.assertLess(np.hypot(x - want[0], y - want[1]), 1)
        self.show("a=main&targets=1&panes=2&b=scale%2010%20NM")
        self.page.await_script("obliq.panes[1]?.ppi.truth?.records.has('1')", "the mark on another range scale", 30)
        self.page.await_script("obliq.panes[1].ppi.draws > 0", "its picture")
        far = self.page.script("""return obliq.panes.map(({ ppi }) => { const { bearing_deg, range_m } = ppi.truth.records.get('1');
            const [[x0, y0], [x, y]] = [ppi.toScreen(0, 0), ppi.screenOf(bearing_deg, range_m)]; return Math.hypot(x - x0, y - y0); })""")
        self.assertAlmostEqual(far[1] / far[0], 15000 / 18520, 1)

    def test_a_hidden_target_is_hollow(self):
        self.show()
        self.mark_of("tower")
        self.page.script("obliq.targets.nameOf = () => ''")
        self.page.await_frame(2)
        whole = self.page.script(BLUE, MARK)[2]
        self.page.script("""const { truth } = obliq.panes[0].ppi, take = truth.take.bind(truth);
            truth.take = (...all) => { take(...all); for (const record of truth.records.values()) record.share = window.share; };
            window.share = 0.5""")
        self.page.await_frame(3)
        part = self.page.script(BLUE, MARK)[2]
        self.page.script("window.share = 0")
        self.page.await_frame(3)
        self.assertLess(part, 0.9 * whole)
        self.assertIsNone(self.page.script(BLUE, MARK), "a dim outline alone")

    def test_a_scanning_radar_has_marks_too(self):
        self.show("a=scan&targets=1")
        self.mark_of("tower")
        record = self.page.script("return obliq.panes[0].ppi.truth.records.get('1')")
        self.assertGreaterEqual(record["azimuth_bin"], 0)

    # ---- By hand

    def test_add_move_route_and_delete_reach_the_server(self):
        self.show()
        self.mark_of("tower")
        self.set_targets()
        x, y = 460, 300
        bearing, slant = self.place_under(x, y)
        truck = self.add("truck 7", x, y, type="truck", speed="0", course="90", height_m="2")
        self.assertEqual((truck["type"], truck["rcs_dbsm"], truck["height_m"], truck["height_reference"]), ("truck", 30, 2, "GROUND"))
        got = self.seen(truck)
        self.assertLess(abs(got[0] - bearing) * np.pi / 180 * slant, 20, "metres across")
        self.assertLess(abs(got[1] - slant), 20, "metres of range")
        self.shot("added")

        heli = self.add("heli", 560, 380, type="", rcs_dbsm="12", speed="100", course="30", height_m="300")
        self.assertEqual((heli["type"], heli["rcs_dbsm"], heli["height_m"]), ("", 12, 300))
        speed = 100 * 1852 / 3600
        self.assertAlmostEqual(heli["velocity_north_m_s"], speed * np.cos(np.radians(30)), 3)
        self.assertAlmostEqual(heli["velocity_east_m_s"], speed * np.sin(np.radians(30)), 3)

        at = self.mark_of("truck 7")
        to = (520, 240)
        bearing, slant = self.place_under(*to)
        self.drag(*at, *to)
        moved = support.await_that(lambda: (lambda t: t if t["latitude_deg"] != truck["latitude_deg"] else None)(
            asked.targets_of(self.daemon.url)["truck 7"]), "the target elsewhere")
        got = self.seen(moved)
        self.assertLess(abs(got[0] - bearing) * np.pi / 180 * slant, 20)
        self.assertLess(abs(got[1] - slant), 20)

        self.page.await_script("obliq.targets.dragged === null", "the end of the drag")
        self.page.script("document.getElementById('route-speed').value = '36'; document.getElementById('route-loops').click()")
        for n, place in enumerate(((600, 220), (640, 280)), 1):
            self.click(*place, shift=True)
            support.await_that(lambda: len(asked.targets_of(self.daemon.url)["truck 7"].get("route", {}).get("latitude_deg", [])) == n, f"{n} points")
        route = asked.targets_of(self.daemon.url)["truck 7"]["route"]
        self.assertTrue(route["loops"])
        np.testing.assert_allclose(route["speed_m_s"], 36 * 1852 / 3600, rtol=1e-3)
        self.assertEqual(route["height_m"], [2, 2])
        self.shot("route")
        self.page.script("document.getElementById('route-loops').click()")
        support.await_that(lambda: not asked.targets_of(self.daemon.url)["truck 7"]["route"].get("loops"), "a route that does not loop")

        at = self.mark_of("truck 7")
        self.drag(*at, at[0] - 30, at[1] + 20)
        support.await_that(lambda: len(asked.targets_of(self.daemon.url)["truck 7"]["route"]["latitude_deg"]) == 2, "its route after a move")

        from selenium.webdriver.common.keys import Keys
        self.page.script("document.activeElement?.blur?.()")
        self.page.driver.find_element("tag name", "body").send_keys(Keys.DELETE)
        support.await_that(lambda: "truck 7" not in asked.targets_of(self.daemon.url), "no such target")
        self.page.script("obliq.targets.choose([...obliq.targets.list.values()].find(({ name }) => name === 'heli').id);"
                         "document.getElementById('target-remove').click()")
        support.await_that(lambda: list(asked.targets_of(self.daemon.url)) == ["tower"], "the scene's own alone")
        self.page.script("document.getElementById('targets-set').click()")
        self.page.await_script("!obliq.targets.holds && !obliq.targets.controller", "a claim given back")
        self.assertEqual(self.page.script("return document.getElementById('targets-refusal').textContent"), "")

    def test_a_refusal_stands_in_the_panel(self):
        self.show()
        self.mark_of("tower")
        self.set_targets()
        refusal = "return document.getElementById('targets-refusal').textContent"
        self.click(460, 300)
        self.fill(name="fast", speed="a lot")
        self.page.script("document.querySelector('#target-form button').click()")
        self.assertIn("speed: found a lot", self.page.script(refusal))
        self.fill(speed="10", rcs_dbsm="9999")
        self.page.script("document.querySelector('#target-form button').click()")
        self.page.await_script("document.getElementById('targets-refusal').textContent.includes('rcs_dbsm')", "the server's refusal")
        self.assertFalse(self.page.script("return document.getElementById('target-form').hidden"), "a form that may be mended")
        self.assertNotIn("fast", asked.targets_of(self.daemon.url))
        self.page.script("document.getElementById('target-cancel').click(); document.getElementById('targets-set').click()")
        self.page.await_script("!obliq.targets.holds", "a claim given back")

    def test_one_client_at_a_time_sets_targets(self):
        self.show()
        other = asked.Asked(self.daemon.url)
        self.addCleanup(other.close)
        self.assertEqual(other.ask(asked.CLAIM_CONTROL, kinds=["TARGETS_CLAIM"])[0], "Ack")
        self.page.script("obliq.tabs.show('targets')")
        self.page.await_script("document.getElementById('targets-set').textContent === 'Take over'", "who has the claim")
        self.page.script("document.getElementById('targets-set').click()")
        self.page.await_script("obliq.targets.holds", "the claim, taken over by an admin")
        self.assertEqual(other.ask(asked.CLAIM_CONTROL, kinds=["TARGETS_CLAIM"], force=True)[0], "Ack")
        self.page.await_script("!obliq.targets.holds && document.getElementById('targets-refusal').textContent.includes('taken over')", "a claim that is lost")


if __name__ == "__main__":
    unittest.main()
