"""A served recording on the page: pause, seek, speed; two stations see the same."""
import subprocess
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
        port, http = support.free_ports(2)
        cls.replay = subprocess.Popen([support.OBLIQ, "replay", str(cls.file), "--serve", "--hold", "--port", str(port), "--http-port",
                                       str(http)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(cls.end)
        cls.url = f"http://127.0.0.1:{http}/"
        support.await_that(lambda: support.listens(http), "the replay")
        cls.page, cls.other = support.Page(), support.Page()

    @classmethod
    def end(cls):
        cls.replay.kill()
        cls.replay.wait()

    def both(self, script, what):
        for page in (self.page, self.other):
            page.await_script(script, what)

    def test_a_recording_is_steered_by_one_station_and_seen_by_two(self):
        for page in (self.page, self.other):
            page.open(self.url)
            page.await_script("globalThis.obliq?.debrief?.state && obliq.panes[0].bins.scanRow >= 0", "a recording that runs")
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

    @staticmethod
    def sum_of(page):
        return page.script("let s = 0; obliq.panes[0].bins.video.forEach((v, k) => { s = (s + v * (1 + k % 97)) % 1e9; }); return s;")


if __name__ == "__main__":
    unittest.main()
