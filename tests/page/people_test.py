"""The page and people: sizes without scroll bars, keys, the order of Tab, contrast, a silent console, nothing from elsewhere."""
import base64
import os
import pathlib
import unittest
from urllib.parse import urlsplit

import support

SIZES = {"desk": (1366, 768, False), "phone": (390, 844, True)}
SHOTS = os.environ.get("OBLIQ_SHOTS")  # a folder for pictures to look at
# By how many pixels an element scrolls to the right and down; null: there is none.
OVER = "const s = %s; return s && [s.scrollWidth - s.clientWidth, s.scrollHeight - s.clientHeight];"
# WCAG 2.1: relative luminance, and contrast as (light + 0.05) / (dark + 0.05).
CONTRAST = """
const parse = (text) => { const v = text.match(/[\\d.]+/g).map(Number); return v.length > 3 ? v : [...v, 1]; };
const light = ([r, g, b]) => [r, g, b].map((c) => c / 255).map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
  .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
const behind = (element) => {
  for (let e = element; e; e = e.parentElement) {
    const colour = parse(getComputedStyle(e).backgroundColor);
    if (colour[3] > 0.7) return colour;
  }
  return [7, 11, 14, 1];
};
const bad = [];
for (const element of document.querySelectorAll("body *")) {
  const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  const box = element.getBoundingClientRect();
  if (!own || !box.width || !box.height || element.disabled || element.closest("option, noscript")) continue;
  const style = getComputedStyle(element);
  if (style.visibility === "hidden") continue;
  const [a, b] = [light(parse(style.color)), light(behind(element))].sort((x, y) => y - x);
  const ratio = (a + 0.05) / (b + 0.05);
  if (ratio < 4.5) bad.push(`${element.tagName}.${element.className}#${element.id} ${element.textContent.trim().slice(0, 20)} ${ratio.toFixed(2)}`);
}
return bad;
"""


class BasePeople(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon()
        cls.page = support.Page()

    def show(self, fragment="a=main", size="desk"):
        self.page.size(*SIZES[size])
        self.page.open(self.daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")

    def await_parameters(self):
        self.page.await_script("obliq.controls.table.length && obliq.panes[0].info", "the parameters")


class Layout(BasePeople):
    def test_sizes_without_scroll_bars(self):
        for size, (width, height, _) in SIZES.items():
            for panes in (1, 2):
                self.show(f"a=main&overlay=1&panes={panes}", size)
                for tab in ("view", "radar", "setup", "targets"):
                    with self.subTest(size=size, panes=panes, tab=tab):
                        self.page.await_value(f"obliq.tabs.show('{tab}'); return obliq.tabs.current", tab, "the tab")
                        self.page.await_script(f"obliq.panes.length === {panes} && obliq.panes.every(({{ ppi }}) => ppi.draws > 2)", "the panes")
                        # As soon as neither scrolls: a busy machine lays the page out late.
                        self.page.await_value(OVER % "document.scrollingElement", [0, 0], "a page that does not scroll")
                        if panes == 1:
                            self.await_parameters()
                            self.page.await_value(OVER % f"document.querySelector('aside > section#{tab}:not([hidden])')", [0, 0],
                                                  "a panel that does not scroll")
                        pictures = self.page.script("""return obliq.panes.map(({ ppi, bins: { placement } }) => {
                              const edge = [0, 0.5, 1].map((k) => placement.start_deg + k * placement.azimuths * placement.width_deg);
                              const places = [[0, 0], ...edge.map((bearing) => ppi.placed(bearing, placement.rMax_m))].map((p) => ppi.toScreen(...p));
                              return Math.max(...[0, 1].map((k) => Math.max(...places.map((p) => p[k])) - Math.min(...places.map((p) => p[k]))));
                            })""")
                        self.assertGreaterEqual(min(pictures), 0.6 * min(width, height), "the sector's greater side")
                        self.assertGreater(self.page.script("return obliq.panes[0].scope.canvas.clientHeight"), 40, "the A-scope")
                        if SHOTS:
                            self.page.shot(pathlib.Path(SHOTS) / f"{size}_{panes}_{tab}.png")

    def test_keys(self):
        self.show("a=main")
        look = "obliq.look"
        for key, before, after in (("c", f"{look}.palette === 'green'", f"{look}.palette === 'grey'"),
                                   ("n", f"{look}.up === 'auto'", f"{look}.up === 'heading'"),
                                   ("b", f"!{look}.bscope", f"{look}.bscope"), ("b", f"{look}.bscope", f"!{look}.bscope"),
                                   ("l", f"!{look}.slant", f"{look}.slant"), ("u", f"{look}.unit === 'km'", f"{look}.unit === 'NM'"),
                                   ("o", f"!{look}.overlay", f"{look}.overlay"), ("r", f"{look}.rings", f"!{look}.rings"),
                                   ("a", "obliq.panes[0].levels.auto", "!obliq.panes[0].levels.auto"), ("+", f"!{look}.window", f"{look}.window.zoom > 1"),
                                   ("0", f"{look}.window", f"!{look}.window"), ("f", f"!{look}.hold", f"{look}.hold"),
                                   ("p", "obliq.panes.length === 1", "obliq.panes.length === 2"),
                                   ("d", "obliq.tabs.current === 'view'", "obliq.tabs.current === 'radar'"),
                                   ("k", "!obliq.control.isMine", "obliq.control.isMine")):
            with self.subTest(key=key):
                self.assertTrue(self.page.script(f"return Boolean({before})"), before)
                self.press(key)
                self.page.await_script(f"Boolean({after})", f"what {key} does")
        self.press("f")
        self.press("ArrowRight")
        self.page.await_script("obliq.panes[0].bins.placement.bearing_deg === 61", "an antenna turned by a degree")
        self.press("ArrowLeft")
        self.page.await_script("obliq.panes[0].bins.placement.bearing_deg === 60", "an antenna turned back")
        self.press("k")
        self.page.await_script("!obliq.control.isMine", "control released")
        self.press("ArrowRight")
        self.page.await_script("obliq.look.cursor !== null", "a cursor")
        self.press("1")
        self.page.await_script("obliq.look.lines.ebl[0] !== null && obliq.look.lines.vrm[0] !== null", "a bearing line and a range marker")
        self.press("Escape")
        self.page.await_script("obliq.look.cursor === null && obliq.look.lines.ebl[0] === null", "neither")
        self.press("?")
        self.page.await_script("document.getElementById('help').open", "the list of keys")

    def press(self, key):
        self.page.script("""document.activeElement?.blur?.();
            document.body.dispatchEvent(new KeyboardEvent('keydown', { key: arguments[0], bubbles: true, cancelable: true }))""", key)

    def test_settings_stay_in_the_fragment_and_come_back(self):
        self.show("a=main")
        for key in ("c", "n", "u"):
            self.press(key)
        fragment = self.page.script("return location.hash")
        self.page.driver.refresh()
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")
        self.assertEqual(self.page.script("return [obliq.look.palette, obliq.look.up, obliq.look.unit]"), ["grey", "heading", "NM"])
        self.assertEqual(self.page.script("return location.hash"), fragment)

    def test_tab_reaches_every_control_in_the_order_of_the_page(self):
        from selenium.webdriver.common.by import By
        from selenium.webdriver.common.keys import Keys
        self.show("a=main&tab=view")
        self.await_parameters()
        wanted = self.page.script("""
            document.activeElement?.blur();
            window.focusable = [...document.querySelectorAll('button, select, input, [tabindex="0"]')]
              .filter((e) => e.getBoundingClientRect().width && !e.disabled && e.tabIndex >= 0 && !e.closest('dialog:not([open])'));
            return focusable.length;""")
        self.assertGreater(wanted, 20)
        body = self.page.driver.find_element(By.TAG_NAME, "body")
        seen = []
        for _ in range(wanted):
            (body if not seen else self.page.driver.switch_to.active_element).send_keys(Keys.TAB)
            seen.append(self.page.script("return focusable.indexOf(document.activeElement)"))
            self.assertNotEqual(self.page.script("return getComputedStyle(document.activeElement).outlineStyle"), "none")
        self.assertEqual(seen, list(range(wanted)))

    def test_every_button_and_field_has_a_name_and_a_title(self):
        self.show("a=main&tab=radar")
        self.page.await_script("document.querySelector('#radar [data-key]')", "the form")
        nameless = self.page.script("""return [...document.querySelectorAll('main button, main select, main input, header button')]
            .filter((e) => !e.closest('nav') && !(e.title || e.closest('[title]')) || !(e.textContent.trim() || e.ariaLabel || e.closest('label')))
            .map((e) => e.outerHTML.slice(0, 80))""")
        self.assertEqual(nameless, [])

    def test_contrast(self):
        for tab in ("view", "radar", "setup", "targets"):
            self.show(f"a=main&tab={tab}&overlay=1")
            self.page.await_script(f"obliq.tabs.current === '{tab}'", "the tab")
            self.assertEqual(self.page.script(CONTRAST), [], f"texts with less than 4.5:1 in {tab}")


class Pictures(BasePeople):
    press = Layout.press

    def test_the_console_is_silent_and_nothing_comes_from_elsewhere(self):
        """Of a server that is ready: one that is away or loads refuses requests, which the browser itself notes (connection_test)."""
        self.show("a=main&panes=2&b=frustum%20oblique&overlay=1")
        self.page.await_script("obliq.panes[1].bins.frames > 0", "a frame of another frustum")
        self.page.script("obliq.pictures.zoom(3, 300, 300); obliq.save()")
        self.page.await_frame(3)
        requested = set(self.page.requested())
        self.assertGreater(len(requested), 15)
        self.page.driver.get(self.daemon.url + "help")
        requested.update(self.page.requested())
        self.assertIn("obliq", self.page.driver.title)
        grave = [entry for entry in self.page.console() if entry["level"] == "SEVERE"]
        self.assertEqual(grave, [])
        own = urlsplit(self.daemon.url).netloc
        foreign = {url for url in requested
                   if urlsplit(url).scheme not in ("about", "blob") and urlsplit(url).netloc != own}
        self.assertEqual(foreign, set())

    def test_a_png_has_legend_and_caption(self):
        self.show("a=main")
        size = self.page.script("""return import('./export.js').then(({ pictureOf, captionOf }) => {
            const canvas = pictureOf(obliq);
            return [canvas.width, canvas.height, canvas.toDataURL('image/png'), captionOf(obliq.panes[0], obliq).join(' ')];
        })""")
        self.assertTrue(base64.b64decode(size[2].split(",")[1]).startswith(b"\x89PNG"))
        self.assertGreaterEqual(size[1], self.page.script("return obliq.panes[0].ppi.height") + 50)
        for word in ("main", "33.00000° N", "bearing 060.0°", "km", "dB re W"):
            self.assertIn(word, size[3])

    def test_a_held_picture_takes_palette_and_zoom_and_keeps_its_time(self):
        self.show("a=scan&auto=0&low=-140&span=80")
        self.page.await_script("obliq.panes[0].bins.frames > 2", "passes")
        self.press("f")
        state = """const { ppi, bins } = obliq.panes[0], { data } = ppi.image; let s = 0;
            data.forEach((v, k) => { s = (s + v * (1 + k % 97)) % 1e9; });
            return import('./export.js').then(({ captionOf }) => [s, bins.seen_ms.join(), captionOf(obliq.panes[0], obliq)[0]])"""
        sums = [self.page.script(state)]
        for key in ("c", "+"):
            self.press(key)
            self.page.await_script("!obliq.panes[0].ppi.needs.table && !obliq.panes[0].ppi.needs.all", f"the picture after {key}", 10)
            sums.append(self.page.script(state))
            self.assertNotEqual(sums[-1][0], sums[-2][0], f"the picture after {key}")
        self.page.script("window.then = Date.now()")
        self.page.await_script("Date.now() - then > 2000", "two seconds")
        sums.append(self.page.script(state))
        self.assertEqual(sums[-1][0], sums[-2][0], "a held picture")
        self.assertEqual({sums[0][1:][0]}, {s[1] for s in sums}, "when its azimuths were seen")
        self.assertEqual({sums[0][2]}, {s[2] for s in sums}, "its time")

    def test_a_view_rendered_once_does_not_fade(self):
        self.show("a=scan&panes=2&b=frustum%20oblique&glow=1")
        self.page.await_script("obliq.panes[1].bins.frames > 0", "a frame of another frustum")
        self.page.script("window.then = performance.now()")
        self.page.await_script("performance.now() - then > 2500", "more than twice the afterglow")
        self.page.script("obliq.look.change({ palette: 'grey' })")
        self.page.await_script("!obliq.panes[1].ppi.needs.all", "a picture")
        oldest = "return Math.max(...obliq.panes[arguments[0]].ppi.ages)"
        self.assertEqual(self.page.script(oldest, 1), 0, "whole frames have no beam")
        self.assertGreater(self.page.script(oldest, 0), 3, "echoes of a beam fade")
        caption = self.page.script("return import('./export.js').then(({ captionOf }) => captionOf(obliq.panes[1], obliq)[0])")
        self.assertIn("rendered once", caption)
        self.assertNotIn("undefined", caption)

    def test_zooms_and_pans_between_two_pictures_add_up(self):
        self.show()
        pixel_m, zoom, right_m = self.page.script("""obliq.pictures.zoom(2);
            const ppi = obliq.panes[0].ppi, { right_m } = obliq.look.window;
            obliq.pictures.zoom(2);
            ppi.pan(100, 0);
            ppi.pan(100, 0);
            const pixel_m = ppi.view.pixel_m * (ppi.view.width / ppi.width) / 4;
            return [pixel_m, obliq.look.window.zoom, obliq.look.window.right_m - right_m];""")
        self.assertAlmostEqual(zoom, 4)
        self.assertAlmostEqual(right_m, -200 * pixel_m, 3)

    def test_touch_zooms_pans_and_sets_the_cursor(self):
        self.show("a=main", "phone")
        cdp = self.page.driver.execute_cdp_cmd
        cdp("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
        self.addCleanup(cdp, "Emulation.setTouchEmulationEnabled", {"enabled": False})
        x, y = self.page.script("const b = document.querySelector('.ppi').getBoundingClientRect(); return [b.x + 150, b.y + 150]")

        def touch(kind, *points):
            cdp("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [
                {"x": px, "y": py, "id": k} for k, (px, py) in enumerate(points)]})
        touch("touchStart", (x - 20, y), (x + 20, y))
        for k in range(1, 6):
            touch("touchMove", (x - 20 - 8 * k, y), (x + 20 + 8 * k, y))
        touch("touchEnd")
        self.page.await_script("obliq.look.window && obliq.look.window.zoom > 1.5", "a pinch that zooms")
        before = self.page.script("return obliq.look.window.right_m")
        touch("touchStart", (x, y))
        for k in range(1, 6):
            touch("touchMove", (x + 10 * k, y))
        touch("touchEnd")
        self.page.await_script(f"obliq.look.window.right_m < {before} - 1", "a drag that pans")
        self.page.script("obliq.markers.clear()")
        touch("touchStart", (x, y))
        self.page.await_script("obliq.look.cursor !== null", "a long press that sets the cursor")
        touch("touchEnd")


if __name__ == "__main__":
    unittest.main()
