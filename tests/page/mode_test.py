"""The switch of the mode: what it says and sends, what it shows beside it, what pictures say; who may look only."""
import os
import pathlib
import tempfile
import unittest

import support
import obliq

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
velocity_north_m_s = -60.0
velocity_east_m_s = 34.641
[bins]
azimuth = 512
range = 256
[beam]
pattern = "gaussian"
width_deg = 3.0
[receiver]
noise = true
[video]
looks = 8
[[radar]]
name = "flies"
sector_deg = 60.0
RADAR
[[radar]]
name = "narrow"
sector_deg = 6.0
RADAR
[[radar]]
name = "sharp"
sector_deg = 60.0
beam.pattern = "off"
RADAR
""".replace("RADAR", """r_min_m = 3000.0
r_max_m = 15000.0
frequency_ghz = 9.4
power_w = 50e3
gain_db = 33.0""")
SHOWN = """return [...document.querySelectorAll('.mode-switch [data-key]')].filter((input) => input.offsetParent).map(({ dataset }) => dataset.key)"""
SAYS = "document.querySelector('.mode-switch .hint').textContent"
REFUSAL = "document.querySelector('.mode-switch .refusal').textContent"


class Modes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon(SCENE)
        cls.page = support.Page()
        cls.server = obliq.connect(cls.daemon.address)
        cls.addClassCleanup(cls.server.close)

    def show(self, fragment, url=None):
        self.page.size(1366, 768)
        self.page.open(url or self.daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1 && obliq.panes[0].info && obliq.controls.mode.buttons.length", "frames")

    def take_control(self):
        self.page.await_script("!document.getElementById('claim').disabled", "control to take")
        self.page.script("if (!obliq.control.isMine) document.getElementById('claim').click()")
        self.page.await_script("obliq.control.isMine && !document.getElementById('mode-mti').disabled", "control")
        self.addCleanup(self.release)

    def release(self):
        self.page.driver.execute_async_script("""const done = arguments[0];
            obliq.link.ask('ResetExercise', { radar: obliq.panes[0].radar }).catch(() => {}).then(() => obliq.control.toggle()).then(() => done());""")

    def press(self, mode):
        self.page.script("document.getElementById(`mode-${arguments[0]}`).click()", mode)

    def await_mode(self, mode):
        self.page.await_script(f"(obliq.panes[0].bins.descriptor.settings.mode ?? 'MAP_MODE') === '{mode.upper()}_MODE'", f"frames of {mode}")
        self.page.await_script(f"document.getElementById('mode-{mode}').ariaChecked === 'true'", f"{mode} on the switch")

    def words_of(self, pane=0):
        return self.page.script("return document.querySelectorAll('.pane')[arguments[0]].querySelector('.annun .mode').textContent", pane)

    def shot(self, name):
        if SHOTS:
            self.page.await_frame(2)
            self.page.shot(f"{SHOTS}/{name}.png")

    def test_the_switch_changes_frames_knobs_and_words(self):
        self.show("a=flies&tab=radar")
        self.take_control()
        self.assertEqual(self.words_of(), "", "a map says nothing")
        self.assertEqual(self.page.script(SHOWN), [])
        for mode, knobs, said in (
                ("mti", ["pulse.prf_hz", "doppler.canceller", "doppler.clutter_lock", "atmosphere.wind_m_s"], "15.9 m/s"),
                ("dbs", ["pulse.prf_hz", "doppler.pulses", "doppler.window"], "16 pulses; needs a beam"),
                ("map", [], "The mean echo")):
            with self.subTest(mode=mode):
                self.press(mode)
                self.await_mode(mode)
                self.page.await_script(f"document.querySelector('.annun .mode').textContent === '{'' if mode == 'map' else mode.upper()}'", "the picture's word")
                self.assertEqual(self.page.script(SHOWN), knobs)
                self.assertIn(said, self.page.script(f"return {SAYS}"))
                self.shot(f"mode-{mode}")

    def test_an_image_of_synthetic_aperture_of_a_narrow_sector(self):
        self.show("a=narrow&tab=radar")
        self.take_control()
        self.press("sar")
        self.await_mode("sar")
        self.assertEqual(self.page.script(SHOWN), ["pulse.prf_hz", "doppler.window", "doppler.resolution_m"])
        self.assertIn("at most 10°", self.page.script(f"return {SAYS}"))
        self.page.await_script("document.querySelector('.annun .mode').textContent === 'SAR'", "the picture's word")
        self.shot("mode-sar")

    def test_the_blind_speed_is_that_of_the_settings(self):
        self.show("a=flies&tab=radar")
        self.take_control()
        self.press("mti")
        self.await_mode("mti")
        self.page.script("const f = document.querySelector('[data-key=\"pulse.prf_hz\"]'); f.value = '2000'; f.dispatchEvent(new Event('change'))")
        # 299792458 / 9.4e9 x 2000 / 2
        self.page.await_script(f"{SAYS}.includes('31.9 m/s')", "another blind speed")

    def test_a_canceller_that_flies_asks_for_clutter_lock(self):
        self.show("a=flies&tab=radar")
        self.take_control()
        self.press("mti")
        self.await_mode("mti")
        lacks = "document.querySelector('.mode-switch .lack').textContent"
        self.page.await_script(f"{lacks}.includes('69 m/s without clutter lock')", "what it lacks")
        self.page.script("document.querySelector('.mode-switch [data-key=\"doppler.clutter_lock\"]').click()")
        self.page.await_script(f"obliq.panes[0].info.settings.clutter_lock && {lacks} === ''", "nothing that it lacks")

    def test_a_mode_that_is_refused_says_why(self):
        self.show("a=flies&tab=radar")
        self.take_control()
        self.press("sar")
        self.page.await_script(f"{REFUSAL}.includes('radar.sector_deg')", "the refusal")
        self.assertIn("at most 10.0 deg", self.page.script(f"return {REFUSAL}"))
        self.assertEqual(self.page.script("return document.getElementById('mode-map').ariaChecked"), "true")
        self.shot("mode-refused")
        self.press("mti")
        self.await_mode("mti")
        self.assertEqual(self.page.script(f"return {REFUSAL}"), "")
        self.show("a=sharp&tab=radar")
        self.take_control()
        self.press("dbs")
        self.page.await_script(f"{REFUSAL}.includes('beam.pattern')", "a refusal without a beam")

    def test_a_refusal_goes_when_settings_change(self):
        self.show("a=flies&tab=radar")
        self.take_control()
        self.press("sar")
        self.page.await_script(f"{REFUSAL}.includes('radar.sector_deg')", "the refusal")
        self.page.script("const f = document.querySelector('#radar [data-key=\"radar.sector_deg\"]'); f.value = '8'; f.dispatchEvent(new Event('change'))")
        self.page.await_script(f"obliq.panes[0].info.settings.sector_deg === 8 && {REFUSAL} === ''", "no refusal of other settings")

    def test_the_word_is_on_both_pictures_their_captions_and_a_phone(self):
        self.show("a=flies&panes=2&b=scale%2010%20NM&tab=radar")
        self.take_control()
        self.press("mti")
        self.await_mode("mti")
        self.page.await_script("[...document.querySelectorAll('.annun .mode')].map((b) => b.textContent).join() === 'MTI,MTI'", "words on both pictures")
        self.shot("mode-two")
        caption = self.page.script("return import('./export.js').then(({ captionOf }) => captionOf(obliq.panes[0], obliq)[0])")
        self.assertIn(" · MTI · ", caption)
        for size in ((1366, 768), (390, 844, True)):
            self.page.size(*size)
            self.page.await_frame(1)
            over = self.page.script("""
                return [...document.querySelectorAll('.pane')].flatMap((pane) => {
                  const own = pane.querySelector('.annun .mode').getBoundingClientRect();
                  const others = [...pane.querySelectorAll('.pick, .about, .annun.upper, .annun.lower span')].filter((e) => e.textContent);
                  return others.filter((e) => { const b = e.getBoundingClientRect();
                    return b.width && b.left < own.right && own.left < b.right && b.top < own.bottom - 1 && own.top < b.bottom - 1; }).map((e) => e.className || e.tagName);
                });""")
            self.assertEqual(over, [], f"words under the mode at {size}")
            # Numbers of bearings and rings are in the grid's canvas.
            under = self.page.script("""
                const { ppi, element } = obliq.panes[0], own = element.querySelector('.annun .mode').getBoundingClientRect(), at = ppi.element.getBoundingClientRect();
                const canvas = ppi.canvases[1], box = [own.left - at.left, own.top - at.top, own.width, own.height].map((v) => Math.round(v * ppi.density));
                return canvas.getContext('2d').getImageData(...box).data.filter((v, k) => k % 4 === 3 && v > 60).length;""")
            self.assertEqual(under, 0, f"the grid under the mode at {size}")
            self.shot(f"mode-two-{size[0]}")
        self.page.script("document.getElementById('two').click()")
        self.shot("mode-phone")

    def test_a_mode_is_no_ideal_map(self):
        self.show("a=sharp&tab=radar")
        self.take_control()
        ideal = "obliq.panes[0].bins.isIdeal"
        self.page.driver.execute_async_script("""const done = arguments[0];
            obliq.link.ask('SetSettings', { radar: 'sharp', settings: { noise: false } }).then(done, done)""")
        self.page.await_script(ideal, "an ideal map")
        self.press("mti")
        self.await_mode("mti")
        self.assertFalse(self.page.script(f"return {ideal}"))
        self.page.await_script("document.getElementById('compensated').disabled", "no levels that make up for the range")
        # Its ground is cancelled, so that no echo says which levels are best; what moves would still be seen.
        self.page.await_script("(({ bins, levels }) => levels.low_dB < bins.floor_dB + 254 * bins.step_dB)(obliq.panes[0])", "levels that the video has")

    def test_a_viewer_reads_the_mode_and_has_no_switch(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        tokens = pathlib.Path(folder.name) / "tokens"
        watch, fly = "watch-0123456789abcdef", "fly-0123456789abcdef0"
        tokens.write_text(f"viewer {watch} anna\ncontroller {fly} bert\n")
        tokens.chmod(0o600)
        daemon = support.Daemon(SCENE, 'radar.mode="mti"', f"server.tokens={tokens}")
        self.addCleanup(daemon.close)
        self.page.size(1366, 768)
        give = "document.getElementById('token').value = arguments[0]; document.querySelector('#ask button').click()"
        for token, may in ((watch, False), (fly, True)):
            with self.subTest(may=may):
                self.page.open(daemon.url, "a=flies&tab=radar")
                self.page.script("sessionStorage.clear()")
                self.page.open(daemon.url, "a=flies&tab=radar")
                self.page.await_script("globalThis.obliq && document.getElementById('ask').open", "the question for a token")
                self.page.script(give, token)
                self.page.await_script("obliq.meter.drawn > 1 && !document.querySelector('.mode-switch')?.hidden && document.querySelector('.annun .mode').textContent === 'MTI'",
                                       "the picture's word")
                self.assertIn("Cancels what stands still", self.page.script(f"return {SAYS}"))
                row = self.page.script("return document.querySelector('.mode-switch .row').innerText.split(/\\s+/)")
                self.assertEqual(row, ["Mode", "map", "MTI", "DBS", "SAR"] if may else ["Mode", "MTI"])
                self.assertTrue(self.page.script("return obliq.controls.mode.buttons.every(({ disabled }) => disabled)"), "without control")
                self.shot(f"mode-{'controller' if may else 'viewer'}")


if __name__ == "__main__":
    unittest.main()
