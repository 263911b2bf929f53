"""The page and its connection: a daemon that stops and starts, loads, is silent; tokens; a radar that is taken over."""
import signal
import time
import unittest

import support
import obliq

STALE = "document.body.classList.contains('stale')"
GREY = "getComputedStyle(document.querySelector('.picture')).filter.includes('grayscale(1)')"


class Connection(unittest.TestCase):
    def setUp(self):
        self.page = support.Page()
        self.addCleanup(self.page.close)

    def daemon(self, *settings, **more):
        daemon = support.Daemon(support.SCENE, *settings, **more)
        self.addCleanup(daemon.close)
        return daemon

    def open(self, daemon, fragment="a=main"):
        self.page.open(daemon.url, fragment)
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")

    def seconds_until(self, script, what):
        began = time.monotonic()
        self.page.await_script(script, what)
        return time.monotonic() - began

    def test_a_daemon_that_stops_and_starts(self):
        daemon = self.daemon()
        self.open(daemon)
        self.assertFalse(self.page.script(f"return {STALE}"))
        daemon.signal(signal.SIGKILL)
        took = self.seconds_until(f"{STALE} && {GREY}", "a grey picture")
        print(f"  grey {took:.2f} s after the daemon was killed")
        self.page.await_words("No connection to the server.")
        self.page.await_words("Next attempt in")
        daemon.stop()
        before = self.page.script("return obliq.meter.drawn")
        daemon.start()
        took = self.seconds_until(f"!{STALE} && obliq.meter.drawn > {before} + 1", "a live picture")
        print(f"  live again {took:.2f} s after the daemon was ready")
        self.assertFalse(self.page.script(f"return {GREY}"))
        # The browser itself notes each request that is refused, as grave; the page adds nothing to that.
        grave = [entry for entry in self.page.console() if entry["level"] == "SEVERE"]
        self.assertEqual([entry for entry in grave if entry["source"] != "network"], [])

    def test_a_daemon_that_is_silent(self):
        daemon = self.daemon()
        self.open(daemon)
        daemon.signal(signal.SIGSTOP)
        took = self.seconds_until(f"{STALE} && {GREY}", "a grey picture")
        print(f"  grey {took:.2f} s after the daemon fell silent")
        self.assertIn("silent", self.page.words())
        daemon.signal(signal.SIGCONT)
        self.page.await_script(f"!{STALE} && obliq.link.isLive", "a live picture")

    def test_a_daemon_that_loads(self):
        daemon = self.daemon("terrain.cell_m=15.0", wait=False)
        support.await_that(lambda: "HTTP on" in daemon.log(), "HTTP")
        self.page.open(daemon.url, "a=main")
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 0", "frames")
        self.assertFalse(self.page.script(f"return {STALE}"))

    def test_tokens(self):
        folder = support.tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = support.pathlib.Path(folder.name) / "tokens"

        def write(*lines):
            path.write_text("".join(f"{line}\n" for line in lines))
            path.chmod(0o600)

        watch, fly = "watch-0123456789abcdef", "fly-0123456789abcdef0"
        write(f"viewer {watch} anna", f"controller {fly} bert")
        daemon = self.daemon(f"server.tokens={path}")
        self.page.open(daemon.url, "a=main&tab=radar")
        self.page.await_words("This server wants a token.")
        self.page.await_script("document.getElementById('ask').open", "the question for it")
        give = "document.getElementById('token').value = arguments[0]; document.querySelector('#ask button').click()"
        # Esc leaves the question; a button asks it again.
        from selenium.webdriver.common.keys import Keys
        again = "!document.getElementById('again').hidden && document.getElementById('again').click()"
        for _ in range(2):
            self.page.driver.switch_to.active_element.send_keys(Keys.ESCAPE)
            self.page.await_script("!document.getElementById('ask').open", "a dialog that is left")
            self.page.script(again)
            self.page.await_script("document.getElementById('ask').open", "the question again")
        self.page.script(give, "not-a-token-of-this-server")
        self.page.await_words("does not accept this token")
        self.page.script(give, watch)
        self.page.await_script("obliq.meter.drawn > 1", "frames")
        self.assertEqual(self.page.script("return document.getElementById('role').textContent"), "viewer")
        self.assertTrue(self.page.script("return document.getElementById('claim').disabled"))
        self.assertIn("may watch", self.page.script("return document.getElementById('claim').title"))
        self.assertTrue(self.page.script("return document.getElementById('again').hidden"))
        self.assertNotIn(watch, self.page.script("return location.href"))
        self.assertNotIn(watch, daemon.log())
        # It stays in the tab.
        self.page.driver.refresh()
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames after loading again")
        write(f"controller {fly} bert")
        daemon.signal(signal.SIGHUP)
        self.page.await_script("obliq.link.state.kind === 'token'", "a revoked token")
        self.page.await_words("token")
        self.assertTrue(self.page.script(f"return {STALE}"))
        self.page.script(give, fly)
        self.page.await_script("obliq.link.isLive && document.getElementById('role').textContent === 'controller'", "the controller")
        self.page.await_script("!document.getElementById('claim').disabled", "control to take")

    def test_a_radar_that_is_taken_over(self):
        daemon = self.daemon()
        self.open(daemon, "a=main&tab=radar")
        self.page.script("document.getElementById('claim').click()")
        self.page.await_script("obliq.control.isMine", "control")
        self.page.await_script("!document.querySelector('#radar [data-key]').hidden", "the form")
        with obliq.connect(daemon.address, name="instructor") as server, server.radar("main").control(force=True):
            self.page.await_script("!obliq.control.isMine && document.querySelector('#radar [data-key]').hidden", "a closed form")
            self.page.await_script("document.querySelector('#radar > .refusal').textContent.includes('instructor')", "who took it")
            self.page.await_script("document.querySelector('.holder').textContent.includes('instructor')", "who holds it")
            self.assertIn("instructor", self.page.words())

    def test_standby_and_freeze_are_said(self):
        daemon = self.daemon()
        self.open(daemon)
        with obliq.connect(daemon.address) as server, server.radar("main").control() as control:
            control.set_state(transmit=False)
            self.page.await_words("the transmitter is off")
            self.page.await_script("document.querySelector('.banner').textContent === 'STANDBY'", "the banner")
            control.set_state(transmit=True, freeze=True)
            self.page.await_words("The radar is frozen")
            control.set_state(freeze=False)
            control.set_pose(valid_s=0.3)
            self.page.await_words("The pose is stale")
            control.set_pose(valid_s=0)
            support.await_that(lambda: self.page.words() == "", f"no more words than {self.page.words()!r}")

    def test_a_hidden_page_asks_for_nothing_and_comes_back(self):
        daemon = self.daemon()
        self.open(daemon, "a=scan")
        hide = """Object.defineProperty(document, 'hidden', { configurable: true, get: () => arguments_hidden });
            document.dispatchEvent(new Event('visibilitychange'))"""
        self.page.script(hide.replace("arguments_hidden", "true"))
        with obliq.connect(daemon.address) as server:
            support.await_that(lambda: all(r.subscribers == 0 for r in server.status().radars), "no subscriber")
            self.page.script(hide.replace("arguments_hidden", "false"))
            support.await_that(lambda: any(r.subscribers for r in server.status().radars), "a subscriber")
        self.page.await_frame(2)
        self.assertLess(self.page.script("return obliq.panes[0].bins.held.length"), 200, "a backlog")


if __name__ == "__main__":
    unittest.main()
