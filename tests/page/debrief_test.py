"""A served recording on the page: pause, seek, speed; two stations see the same."""
import datetime
import re
import unittest

import support

SECONDS = 6


class Debrief(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        live = support.Daemon(support.SCENE, "receiver.noise=true")  # so that no two passes are alike
        cls.file = live.folder / "scan.obliq"
        live.run("record", "--server", live.address, "--radar", "scan", "--planes", "video,state", "--seconds", SECONDS, "--out", cls.file)
        live.stop()
        cls.live = live  # its folder has the file
        cls.replay = support.programs.replay(cls.file, "--hold", "--http-port", "0")
        cls.addClassCleanup(cls.end)
        cls.url = f"http://127.0.0.1:{cls.replay.web_port}/"
        cls.page, cls.other = support.Page(), support.Page()

    @classmethod
    def end(cls):
        cls.replay.kill()

    def both(self, script, what):
        for page in (self.page, self.other):
            page.await_script(script, what)

    def test_a_recording_is_steered_by_one_station_and_seen_by_two(self):
        for page in (self.page, self.other):
            page.open(self.url)
            page.await_script("globalThis.obliq?.debrief?.state && obliq.panes[0].bins.scanRow >= 0", "a recording that runs")
        self.page.script("return obliq.link.ask('SetReplay', { paused: false, speed: 1, seek_s: 0 })")
        self.both("obliq.debrief.state.running", "a recording that runs")
        self.assertFalse(self.page.script("return document.getElementById('replay').hidden"))
        self.assertTrue(self.page.script("return obliq.panes[0].bins.scan !== null"), "a pass of a scanning antenna")
        for button in ("claim", "two"):  # nothing to set, nothing else to see
            self.assertTrue(self.page.script(f"return document.getElementById('{button}').disabled"), button)
            self.assertIn("recording", self.page.script(f"return document.getElementById('{button}').title"))
        self.page.script("obliq.setPanes(2)")
        self.assertEqual(self.page.script("return obliq.panes.length"), 1)
        self.page.script("document.getElementById('replay-pause').click()")
        self.both("obliq.debrief.state.paused", "a pause")
        self.page.await_words("A recording; paused.")
        self.page.script("const p = document.getElementById('replay-place'); p.value = 1000; p.dispatchEvent(new Event('change'))")
        self.both(f"Math.abs(obliq.debrief.position_s - obliq.debrief.state.duration_s / 2) < 1", "the middle")
        # The picture of that place is whole, and the same at both stations.
        support.await_that(lambda: self.sum_of(self.page) == self.sum_of(self.other) != 0, "the same picture at both stations")
        middle = self.sum_of(self.page)
        self.page.script("obliq.debrief.step(-1.5)")
        support.await_that(lambda: self.sum_of(self.page) != middle, "another picture 1.5 s earlier")
        self.page.script("const s = document.getElementById('replay-speed'); s.value = '4'; s.dispatchEvent(new Event('change'))")
        self.both("obliq.debrief.state.speed === 4", "four times the speed")
        self.page.script("document.getElementById('replay-pause').click()")
        self.both("obliq.debrief.state.ended", "the end")
        self.page.await_script("document.getElementById('replay-pause').textContent === 'again'", "what begins again")
        self.page.script("document.getElementById('replay-pause').click()")
        self.both("!obliq.debrief.state.ended", "the beginning")
        self.assertEqual([entry for entry in self.page.console() if entry["level"] == "SEVERE"], [])

    def pause(self, page, at_s):
        """A recording that stands at a place of it."""
        page.open(self.url)
        page.await_script("globalThis.obliq?.debrief?.state && obliq.panes[0].bins.scanRow >= 0", "a recording")
        page.script(f"return obliq.link.ask('SetReplay', {{ paused: true, speed: 1, seek_s: {at_s} }})")
        page.await_script(f"obliq.debrief.state.paused && Math.abs(obliq.debrief.position_s - {at_s}) < 0.01", "a pause there")
        page.await_script("obliq.panes[0].bins.scanRow >= 0 && !obliq.panes[0].bins.held.length", "the picture of the place")

    def test_a_bookmark_is_seen_by_all_stations_and_takes_all_of_them_there(self):
        from selenium.webdriver.common.by import By
        from selenium.webdriver.common.keys import Keys
        self.pause(self.page, 2)
        self.other.open(self.url)
        self.other.await_script("globalThis.obliq?.debrief?.state?.paused", "the same recording")
        text = "near <b>it</b>"
        self.page.driver.find_element(By.ID, "mark-text").send_keys(text, Keys.ENTER)
        for page in (self.page, self.other):
            page.await_script(f"document.querySelector('#marks button')?.textContent.endsWith({text!r})", "the bookmark")
            self.assertIsNone(page.script("return document.querySelector('#marks b')"), "a text is a text")
        self.page.script("return obliq.link.ask('SetReplay', { seek_s: 0.5 })")
        self.both("Math.abs(obliq.debrief.position_s - 0.5) < 0.01", "another place")
        self.other.script("document.querySelector('#marks button').click()")
        self.both("Math.abs(obliq.debrief.position_s - 2) < 0.01", "the place of the bookmark")
        self.page.script("document.getElementById('mark-text').value = 'x'.repeat(1001); document.getElementById('mark').click()")
        self.page.await_script("document.getElementById('mark-refusal').textContent.includes('1001 bytes')", "a refusal")
        self.assertEqual(self.page.script("return document.querySelectorAll('#marks button').length"), 1)

    def test_the_bar_follows_a_click_and_keys(self):
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.by import By
        from selenium.webdriver.common.keys import Keys
        self.pause(self.page, 1)
        place = self.page.driver.find_element(By.ID, "replay-place")
        part = "(obliq.debrief.state.position_s ?? 0) / obliq.debrief.state.duration_s"
        quarter = place.size["width"] // 4
        ActionChains(self.page.driver, duration=0).move_to_element_with_offset(place, quarter, 0).click().perform()
        self.page.await_script(f"Math.abs({part} - 0.75) < 0.02", "three quarters, by a click", 10)
        for key, low, high in ((Keys.HOME, 0, 0.001), (Keys.PAGE_UP, 0.05, 0.2), (Keys.END, 0.999, 1), (Keys.PAGE_DOWN, 0.8, 0.95),
                               (Keys.HOME, 0, 0.001), (3 * Keys.ARROW_RIGHT, 0.0014, 0.0016)):
            place.send_keys(key)
            self.page.await_script(f"{part} >= {low} && {part} <= {high}", f"a place by a key, {low} to {high}", 10)
        ActionChains(self.page.driver).move_to_element(place).click_and_hold().move_by_offset(-quarter, 0).release().perform()
        self.page.await_script(f"Math.abs({part} - 0.25) < 0.02", "the place where the bar was released", 10)

    def test_a_paused_picture_does_not_fade_and_has_ages(self):
        self.pause(self.page, 4)
        self.page.script("window.then = performance.now(); obliq.look.change({ afterglow_s: 2 })")
        self.page.await_script("performance.now() - then > 5000", "more than twice the afterglow")
        self.page.script("obliq.look.change({ palette: 'grey' })")
        self.page.await_script("!obliq.panes[0].ppi.needs.all", "a picture")
        least, most = self.page.script("const { ages } = obliq.panes[0].ppi; return [Math.min(...ages), Math.max(...ages)]")
        self.assertEqual(least, 0, "where the beam stands nothing has faded")
        self.assertGreater(most, 5, "what the beam saw a pass ago has faded")

    def test_a_png_says_when_its_picture_was_recorded(self):
        self.pause(self.page, 2)
        then = self.page.script("return obliq.debrief.state.start_utc_ns / 1e9 + 2")
        self.assertGreater(datetime.datetime.now().timestamp() - then, 4, "the recording is older than what this test tells apart")

        def says_then():
            caption = self.page.script("return import('./export.js').then(({ captionOf }) => captionOf(obliq.panes[0], obliq)[0])")
            said = datetime.datetime.fromisoformat(re.search(r"[\d-]+T[\d:]+", caption)[0] + "+00:00").timestamp()
            return abs(said + 0.5 - then) < 1.5
        support.await_that(says_then, "the caption's time to be that of the place")  # until then it is of the picture before

    def test_a_viewer_reads_why_the_bar_is_grey(self):
        self.pause(self.page, 1)
        self.page.script("obliq.link.welcome.role = 'viewer'; obliq.debrief.show()")
        self.assertTrue(self.page.script("return document.getElementById('replay-place').disabled"))
        self.assertIn("viewers", self.page.script("return document.getElementById('replay-refusal').textContent"))

    @staticmethod
    def sum_of(page):
        return page.script("let s = 0; obliq.panes[0].bins.video.forEach((v, k) => { s = (s + v * (1 + k % 97)) % 1e9; }); return s;")


if __name__ == "__main__":
    unittest.main()
