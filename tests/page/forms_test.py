"""The page's forms and words: numbers that no radar takes, what a second picture shows, what is said and where."""
import json
import unittest

import support

ONE_RADAR = support.SCENE[:support.SCENE.index("[[radar]]")] + """
[[radar]]
name = "round"
sector_deg = 360.0
r_min_m = 3500.0
r_max_m = 15000.0
"""


class Forms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon()
        cls.page = support.Page()

    def show(self, fragment="a=main", url=None):
        self.page.open(url or self.daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")

    def take_control(self):
        self.page.await_script("!document.getElementById('claim').disabled", "control to take")
        self.page.script("if (!obliq.control.isMine) document.getElementById('claim').click()")
        self.page.await_script("obliq.control.isMine && document.querySelector('#setup [data-key]')", "the form")

    def test_a_mistyped_number_is_refused_beside_its_field(self):
        self.show("a=main&tab=setup")
        self.take_control()
        for key, section, typed, allowed in (("bins.azimuth", "bins", "1.5", "integer 1 to 8192"), ("bins.azimuth", "bins", "4294967295", "8192"),
                                             ("bins.azimuth", "bins", "1e12", "8192"), ("bins.azimuth", "bins", "", "8192"),
                                             ("radar.sector_deg", "radar", "0", "above 0"), ("radar.sector_deg", "radar", "361", "360")):
            with self.subTest(key=key, typed=typed):
                refusal = self.page.script("""
                    obliq.controls.section.value = arguments[0];
                    obliq.controls.section.onchange();
                    const field = document.querySelector(`#setup [data-key="${arguments[1]}"]`);
                    window.asked = obliq.link.sequence;
                    field.value = arguments[2];
                    field.dispatchEvent(new Event('change'));
                    window.sent = obliq.link.sequence - window.asked;
                    return field.closest('.field').querySelector('.refusal').textContent;""", section, key, typed)
                self.assertIn(allowed, refusal)
                self.assertIn(f"found {typed}" if typed else "no number", refusal)
                self.assertEqual(self.page.script("return sent"), 0, "requests")
        self.page.script("const f = document.querySelector('#setup [data-key=\"radar.sector_deg\"]'); f.value = '50'; f.dispatchEvent(new Event('change'))")
        self.page.await_script("obliq.panes[0].info.settings.sector_deg === 50", "a value that is allowed")
        self.assertTrue(self.page.script("return obliq.link.isLive && obliq.control.isMine"))

    def test_the_tab_radar_has_what_the_table_calls_knobs_and_no_form_what_is_of_programs(self):
        table = [p for p in json.loads(self.daemon.run("parameters", "--json")) if p["message_field"]]
        self.show("a=main&tab=radar")
        self.page.await_script("document.querySelector('#radar [data-key]')", "the forms")
        shown = self.page.script("return [...document.querySelectorAll('#radar .field')].map((field) => "
                                 "[field.querySelector('[data-key]').dataset.key, field.querySelector('.name').textContent])")
        # The switch of the mode stands for its own, and those of single modes beside it.
        knobs = sorted((p for p in table if "knob" in p and p["key"] != "radar.mode"), key=lambda p: "modes" not in p)
        self.assertEqual(shown, [[p["key"], p["knob"]] for p in knobs])
        modes = next(p for p in table if p["key"] == "radar.mode")["limits"]["one_of"]
        self.assertEqual(self.page.script("return obliq.controls.mode.buttons.map(({ value }) => value)"), [each for each in modes if each != "pulses"])
        self.assertLessEqual({mode for p in knobs for mode in p.get("modes", [])}, set(modes))
        self.assertIn(["receiver.stc_range_m", "sea (STC)"], shown)
        forms = self.page.script("""const { section } = obliq.controls;
            return [...section.options].flatMap(({ value }) => {
              section.value = value;
              section.onchange();
              return [...document.querySelectorAll('#setup [data-key]')].map(({ dataset }) => dataset.key);
            });""")
        self.assertEqual(sorted(forms), sorted(p["key"] for p in table if "of_programs" not in p))
        self.assertNotIn("antenna.pose_id", forms)

    def test_a_session_that_ends_by_an_error_is_said_and_begun_anew(self):
        self.show()
        why = self.page.driver.execute_async_script("""const done = arguments[arguments.length - 1];
            obliq.link.ask('SetPose', { radar: 'main', nonsense: 1 }).catch((error) => setTimeout(() => done([error.message, document.getElementById('words').textContent])));""")
        self.assertIn("nonsense", why[0])
        self.assertIn("nonsense", why[1])
        self.page.await_script("obliq.link.isLive", "the connection again")
        self.page.await_frame(1)

    def test_the_second_picture_is_one_that_the_radar_allows(self):
        daemon = support.Daemon(ONE_RADAR)
        self.addCleanup(daemon.close)
        self.show("", daemon.url)
        self.page.await_script("obliq.panes[0].info", "the radar")
        self.page.script("document.getElementById('two').click()")
        self.page.await_script("obliq.panes[1]?.bins.frames > 0", "a second picture")
        self.assertEqual(self.page.script("return obliq.panes[1].source"), "scale 10 NM")
        self.page.await_script("Math.abs(obliq.panes[1].bins.placement.rMax_m - 18520) < 1e-6", "the same radar at 10 NM")
        options = "return [...obliq.panes[1].pick.options].map(({ value }) => value)"
        self.assertEqual(self.page.script(options), ["radar round", *(f"scale {scale} NM" for scale in (10, 20, 40, 80))], "words of operators")
        self.page.script("document.getElementById('expert').click()")
        self.assertIn("frustum oblique", self.page.script(options))
        self.assertNotIn("frustum symmetric", self.page.script(options))
        self.show("panes=2", daemon.url)
        self.page.await_script("obliq.panes[1]?.bins.frames > 0", "a second picture of a bookmark")
        self.page.script("obliq.pictures.choose(obliq.panes[1], 'frustum symmetric')")
        banner = "obliq.panes[{}].banner"
        self.page.await_script(f"{banner.format(1)}.textContent.includes('symmetric') && !{banner.format(1)}.hidden", "a refusal in its picture")
        self.assertTrue(self.page.script(f"return {banner.format(0)}.hidden"))

    def test_a_range_scale_has_rings_in_its_unit_and_a_way_back(self):
        self.show("a=round&tab=radar")
        self.take_control()
        self.addCleanup(self.page.script, "obliq.control.isMine && obliq.control.toggle()")
        rings = "obliq.panes[0].ppi.ringStep"
        for button, unit, reach in (("scale-10", "NM", 10), ("scale-20", "NM", 20), ("scale-own", "km", 15)):
            with self.subTest(button=button):
                self.page.script("document.getElementById(arguments[0]).click()", button)
                self.page.await_script(f"{rings}.unit === '{unit}' && {rings}.last * {rings}.step > 0.75 * {reach} && {rings}.last * {rings}.step < 1.001 * {reach}",
                                       "rings of the scale")
                self.assertIn(self.page.script(f"return {rings}.last - {rings}.first + 1"), (4, 5, 6))
                self.page.await_script(f"document.getElementById('{button}').ariaPressed === 'true'", "its button pressed")

    def test_every_range_has_four_to_six_rings(self):
        few = self.page.driver.execute_async_script("""const done = arguments[1];
            import(arguments[0] + 'picture/grid.js').then(({ ringSteps }) => {
              const wrong = [];
              for (let far = 0.02; far < 900; far *= 1.007)
                for (const near of [0, 0.1 * far, 0.37 * far, 0.8 * far, 0.99 * far]) {
                  const { step, first, last } = ringSteps(near, far);
                  if (last - first < 3 || last - first > 5 || first * step < near - 1e-9 || last * step > far + 1e-9) wrong.push([near, far, step]);
                }
              done(wrong);
            });""", self.daemon.url)
        self.assertEqual(few, [])

    def test_an_address_has_what_was_chosen_and_no_more(self):
        self.show("")
        self.page.script("document.getElementById('tab-radar').click()")
        self.assertEqual(self.page.script("return location.hash"), "#tab=radar")
        self.page.script("document.getElementById('tab-view').click()")
        self.assertEqual(self.page.script("return location.hash"), "")

    def test_a_pose_is_set_though_the_page_knows_a_claim_that_is_over(self):
        self.show()
        self.take_control()
        height_m, said = self.page.driver.execute_async_script("""const done = arguments[0];
            obliq.panes[0].info.claimed_by_you = ['SETTINGS_CLAIM', 'POSE_CLAIM'];  // as a poll reads it within a pose's moment
            obliq.control.pose({ height_m: 2600 }).catch((error) => error.message)
              .then((said) => obliq.link.ask('GetRadar', { radar: 'main' }).then(({ pose, claimed_by_you }) => done([pose.height_m, [said ?? '', ...claimed_by_you]])));""")
        self.addCleanup(self.page.driver.execute_async_script, "const done = arguments[0]; obliq.control.pose({ height_m: 2500 }).then(done, done)")
        self.assertEqual([height_m, said], [2600, ["", "SETTINGS_CLAIM"]])

    def test_a_picture_that_has_not_come_is_waited_for(self):
        self.show()
        self.page.script("window.take = obliq.pictures.take; obliq.pictures.take = () => {}; obliq.pictures.choose(obliq.panes[0], 'radar wide')")
        self.page.await_words("Waiting for the first picture of wide.")
        self.assertFalse(self.page.script("return obliq.panes[0].banner.hidden"))
        self.page.script("obliq.pictures.take = window.take")
        self.page.await_script("obliq.panes[0].banner.hidden && !document.getElementById('words').textContent.includes('Waiting')", "the picture")

    def test_what_two_radars_have_in_common_is_said_once(self):
        self.show("a=main&panes=2&b=radar%20wide")
        self.page.await_script("obliq.panes[1]?.info && obliq.panes[1].bins.frames", "two pictures")
        self.page.size(390, 844, True)
        self.addCleanup(self.page.size, 1366, 768)
        text, one, all_lines, closed = self.page.script("""
            const words = document.getElementById('words');
            for (const { info } of obliq.panes) Object.assign(info, { pose_stale: true, frozen: true, fault: 'that '.repeat(20) });
            obliq.tell();
            const cut = () => words.scrollHeight - words.clientHeight;
            const one = [cut(), words.tabIndex];
            words.click();
            const open = cut();
            words.click();
            return [words.textContent, one, open, cut()];""")
        self.assertEqual(text.count("stale"), 1, text)
        self.assertIn("main, wide: The pose is stale", text)
        self.assertGreater(one[0], 0)
        self.assertEqual(one[1], 0, "reached by Tab")
        self.assertLessEqual(all_lines, 1)
        self.assertEqual(closed, one[0])


if __name__ == "__main__":
    unittest.main()
