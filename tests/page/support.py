"""What the tests of the page share: a daemon that serves it, a browser without a screen, questions to the page."""
import atexit
import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "client" / "python" / "src"), str(ROOT / "tests" / "support")]
import programs  # noqa: E402
from programs import BIN, OBLIQ, OBLIQD, free_ports  # noqa: E402, F401

os.environ.setdefault("OBLIQ_CACHE_DIR", "")
PATIENCE_S = 100  # of a test on a busy machine; a figure that matters is printed

# The second radar stands 25 km away, so that the scene's origin is far from both.
SCENE = """
[terrain]
synthetic = "hills"
cell_m = 60.0
[earth]
radius_factor = 1.3333333333333333
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 2500.0
bearing_deg = 60.0
[bins]
azimuth = 128
range = 192
[frustum]
kind = "sweep"
[[radar]]
name = "main"
sector_deg = 60.0
r_min_m = 3000.0
r_max_m = 15000.0
[[radar]]
name = "wide"
sector_deg = 120.0
r_min_m = 3000.0
r_max_m = 15000.0
[radar.antenna]
latitude_deg = 33.2
longitude_deg = -99.35
bearing_deg = -20.0
[[radar]]
name = "round"
sector_deg = 360.0
r_min_m = 3500.0
r_max_m = 15000.0
[[radar]]
name = "scan"
sector_deg = 90.0
r_min_m = 3000.0
r_max_m = 15000.0
scan.mode = "sector"
scan.rate_deg_s = 90.0
"""


def listens(port):
    """Whether a program answers on a port of this machine."""
    with socket.socket() as tried:
        return tried.connect_ex(("127.0.0.1", port)) == 0


def await_that(question, what, patience_s=PATIENCE_S):
    """The first true answer; an AssertionError with `what` where none comes."""
    return programs.await_that(question, what, patience_s)


class Daemon:
    """obliqd with its page, on ports that stay the same when it is started again."""

    def __init__(self, scene=SCENE, *settings, wait=True):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._folder.name)
        if isinstance(scene, pathlib.Path):
            self.scene = scene
        else:
            self.scene = self.folder / "scene.toml"
            self.scene.write_text(scene)
        self.port, self.http_port = programs.free_ports(2)
        self._settings = (f"server.port={self.port}", f"http.port={self.http_port}", *settings)
        self._process = None
        self.start(wait)
        atexit.register(self.close)

    def start(self, wait=True):
        if wait:
            self._process = programs.daemon(self.scene, *self._settings, log=self.folder / "log")
        else:
            words = [word for setting in self._settings for word in ("--set", setting)]
            self._process = programs.Program([programs.OBLIQD, self.scene, *words], log=self.folder / "log")

    def log(self):
        return (self.folder / "log").read_text(errors="replace")

    def signal(self, number):
        self._process.send(number)

    def stop(self):
        self._process.stop(seconds=PATIENCE_S)

    @property
    def url(self):
        return f"http://127.0.0.1:{self.http_port}/"

    @property
    def address(self):
        return f"127.0.0.1:{self.port}"

    def run(self, *words):
        """A command of obliq; its standard output."""
        done = subprocess.run([OBLIQ, *map(str, words)], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"obliq {words}: exit code {done.returncode}: {done.stderr}")
        return done.stdout

    def close(self):
        if self._process:
            self._process.kill()
        with contextlib.suppress(OSError):
            self._folder.cleanup()


def missing():
    """What a test of the page lacks here, in words; nothing: it has all."""
    lacks = [name for name in ("chromium", "chromedriver") if not shutil.which(name)]
    for module in ("selenium", "numpy", "google.protobuf"):
        try:
            __import__(module)
        except ImportError:
            lacks.append(f"Python's {module}")
    return ", ".join(lacks)


class Page:
    """A browser that shows the page."""

    def __init__(self, width=1366, height=768, touch=False):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        options = webdriver.ChromeOptions()
        for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--js-flags=--expose-gc",
                     "--enable-precise-memory-info", f"--window-size={width},{height}"):
            options.add_argument(word)
        # Not "performance": its log has a copy of every message of the WebSocket, which holds up a fast stream.
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        # By name: Selenium would else look for a driver on the network.
        self.driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
        self.driver.set_script_timeout(PATIENCE_S)
        self._console = []
        self.size(width, height, touch)
        atexit.register(self.close)

    def size(self, width, height, touch=False):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": touch})

    def open(self, url, fragment=""):
        self.driver.get("about:blank")
        self.driver.get(f"{url}#{fragment}")

    def script(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def await_script(self, text, what, patience_s=PATIENCE_S):
        return await_that(lambda: self.script(f"return {text}"), f"{what} ({text})", patience_s)

    def await_value(self, text, wanted, what):
        """Until the script returns `wanted`; an AssertionError with what it returns then where it does not."""
        return await_that(lambda: self.script(text) == wanted, lambda: f"{what}: {self.script(text)}, wanted {wanted}")

    def await_frame(self, more=1):
        """Until so many more whole frames are drawn."""
        before = self.script("return obliq.meter.drawn")
        self.await_script(f"obliq.meter.drawn >= {before + more}", "a drawn frame")

    def words(self):
        return self.script("return document.getElementById('words').textContent")

    def await_words(self, part):
        return await_that(lambda: part in self.words(), lambda: f"the words {part!r}; the page says {self.words()!r}")

    def shot(self, path):
        pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
        self.driver.save_screenshot(str(path))

    def console(self):
        """What the browser has complained of so far."""
        self._console += self.driver.get_log("browser")
        return self._console

    def requested(self):
        """URLs of what this page has loaded; what its policy forbids is in the console."""
        return self.script("return [location.href, ...performance.getEntriesByType('resource').map(({ name }) => name)]")

    def close(self):
        with contextlib.suppress(Exception):
            self.driver.quit()
