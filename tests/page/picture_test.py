"""The page's picture: which bin lies under a pixel, against a mapping of its own in numpy, and against ground_map.png."""
import base64
import json
import types
import unittest

import numpy as np

import support
from obliq import mapping
from obliq.places import World

PIXELS = 60_000  # of all of the picture; at least 10,000 of them have a bin
AT_PIXELS = """
const { table, view } = obliq.panes[0].ppi, { bins } = obliq.panes[0];
const under = new Int32Array(view.width * view.height).fill(-1);
for (let k = 0; k < table.size; ++k) under[table.pixels[k]] = table.bins[k];
return { view, value: arguments[0].map(([x, y]) => {
  const bin = under[Math.floor(y * view.height) * view.width + Math.floor(x * view.width)];
  return [bin, bin < 0 ? -1 : bins.video[bin]];
}) };
"""


def expected(d, view, pixels):
    """Azimuth and range bin, not rounded, of pixels: PROTOCOL.md, "Where a bin lies", from the plane to the bin."""
    up = np.radians(view["up_deg"])
    right = view["right_m"] + (pixels[:, 0] + 0.5 - view["width"] / 2) * view["pixel_m"]
    ahead = view["ahead_m"] - (pixels[:, 1] + 0.5 - view["height"] / 2) * view["pixel_m"]
    east, north = right * np.cos(up) + ahead * np.sin(up), ahead * np.cos(up) - right * np.sin(up)
    if view["slant"]:
        slant, bearing = np.hypot(east, north), np.degrees(np.arctan2(east, north))
    else:
        pose = d["pose"]
        latitude, longitude = mapping.direct(pose["latitude_deg"], pose["longitude_deg"], east, north)
        world = World(d["origin_latitude_deg"], d["origin_longitude_deg"], float(d["radius_factor"]))
        x, y, z = world.world(latitude, longitude, d["map_reference_height_m"])
        dx, dy, dz = x - d["antenna_x_m"], y - d["antenna_y_m"], z - d["antenna_z_m"]
        slant, bearing = np.sqrt(dx**2 + dy**2 + dz**2), np.degrees(np.arctan2(dx, dz) - d["north_rad"])
    turns = (bearing - d["azimuth_start_deg"]) % 360 / d["azimuth_width_deg"]
    return turns, (slant - d["range_start_m"]) / d["range_spacing_m"]


class Picture(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon()
        cls.page = support.Page()

    def video(self, radar):
        out = self.daemon.folder / "got"
        self.daemon.run("get", "--server", self.daemon.address, "--radar", radar, "--planes", "iq,power,count,state,video",
                        "--out", out)
        return np.load(out / "video.npy"), json.loads((out / "frame.json").read_text())["frame"]

    def check(self, radar, fragment, then=""):
        self.page.open(self.daemon.url, f"a={radar}&{fragment}")
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")
        if then:
            self.page.script(then)
            self.page.await_frame(2)
        video, d = self.video(radar)
        random = np.random.default_rng(7)
        parts = random.random((PIXELS, 2))
        got = self.page.script(AT_PIXELS, parts.tolist())
        view = got["view"]
        pixels = np.floor(parts * [view["width"], view["height"]])
        turns, ranges = expected(d, view, pixels)
        azimuths, columns = video.shape
        row, column = np.floor(turns).astype(int), np.floor(ranges).astype(int)
        inside = (row < azimuths) & (column >= 0) & (column < columns)
        want = np.where(inside, row * columns + column, -1)
        found, value = np.array(got["value"]).T
        same = found == want
        counted = inside | (found >= 0)
        wrong = np.flatnonzero(~same)
        # What differs lies on an edge between two bins, or on the sector's.
        for off in (turns[wrong], ranges[wrong]):
            self.assertTrue(np.isfinite(off).all())
        edge = np.minimum(np.abs(turns - np.round(turns)), np.abs(ranges - np.round(ranges)))
        self.assertLess(edge[wrong].max(initial=0), 0.05, "a pixel shows a bin that is not beside it")
        self.assertGreaterEqual(same[counted].mean(), 0.99)
        shown = video.ravel()[want[same & inside]]
        self.assertTrue((value[same & inside] == shown).all(), "values differ from those of obliq get")
        print(f"  {radar} {fragment}: {100 * same[counted].mean():.3f} % of {counted.sum()} pixels have the same bin")

    def test_sixty_degrees_north_up(self):
        self.check("main", "up=north")

    def test_sixty_degrees_bearing_up(self):
        self.check("main", "up=bearing")

    def test_hundred_and_twenty_degrees_far_from_the_origin(self):
        self.check("wide", "up=north")

    def test_all_round_bearing_up(self):
        self.check("round", "up=bearing")

    def test_zoomed(self):
        self.check("main", "up=north", "obliq.pictures.zoom(6, 700, 250)")

    def test_zoomed_out_and_slant_range(self):
        self.check("round", "slant=1", "obliq.pictures.zoom(0.6, 300, 250)")

    def test_values_are_grey_as_the_ground_map_is(self):
        """In the grey palette, after range compensation, beside ground_map.png's own greys."""
        self.page.open(self.daemon.url, "a=main&up=north&palette=grey&auto=0&low=-60&span=40")
        self.page.await_script("globalThis.obliq && obliq.meter.drawn > 1", "frames")
        _, frame = self.video("main")
        low = self.page.script("return import('./picture/levels.js').then(({ bestScale }) => bestScale(obliq.panes[0].bins, obliq.panes[0].ppi.table).low_dB)")
        self.page.script(f"obliq.pictures.active.setLevels({low}, 45)")
        self.page.await_frame(2)
        self.daemon.run("get", "--server", self.daemon.address, "--radar", "main", "--north-up", "--db-range",
                        f"{low}:{low + 45}", "--out", self.daemon.folder / "map")
        correlation = self.correlate(frame)
        print(f"  correlation with ground_map.png: {correlation:.4f}")
        self.assertGreaterEqual(correlation, 0.98)

    def correlate(self, frame):
        """Over the pixels that show a sampled bin here and bare grey there: rings and words are masked."""
        d = frame
        places = np.random.default_rng(3).random((80_000, 2))
        got = self.page.script("""
            const { view, out } = obliq.panes[0].ppi;
            return { view, red: arguments[0].map(([x, y]) =>
              out[Math.floor(y * view.height) * view.width + Math.floor(x * view.width)] & 255) };
            """, places.tolist())
        view = got["view"]
        pixels = np.floor(places * [view["width"], view["height"]])
        turns, ranges = expected(d, view, pixels)
        east = view["right_m"] + (pixels[:, 0] + 0.5 - view["width"] / 2) * view["pixel_m"]
        north = view["ahead_m"] - (pixels[:, 1] + 0.5 - view["height"] / 2) * view["pixel_m"]
        azimuths, columns = d["settings"]["azimuth_bins"], d["settings"]["range_bins"]
        off = np.minimum(np.abs(turns - np.round(turns)), np.abs(ranges - np.round(ranges)))
        inside = (turns > 0) & (turns < azimuths) & (ranges > 0) & (ranges < columns) & (off > 0.25)
        state = np.load(self.daemon.folder / "map" / "state.npy")
        inside[inside] = state[turns[inside].astype(int), ranges[inside].astype(int)] == 1
        left, top, pixel = png_grid(frame)
        x = np.floor((east[inside] - left) / pixel).astype(int)
        y = np.floor((top - north[inside]) / pixel).astype(int)
        png = (self.daemon.folder / "map" / "ground_map.png").read_bytes()
        theirs = np.array(self.page.script(PNG_PIXELS, base64.b64encode(png).decode(), MARGIN_PX, x.tolist(), y.tolist()))
        # grey_of in picture_caption.cpp: red, green, blue as 0.96, 1, 0.94.
        bare = (np.abs(theirs - theirs[:, 1:2] * [0.96, 1, 0.94]) < 1.5).all(axis=1)
        self.assertGreater(bare.sum(), 1500)
        return np.corrcoef(np.array(got["red"])[inside][bare], theirs[bare, 1])[0, 1]


# Of the PNG of obliq get: ground_map_png.h's side, and the margins around its map.
SIDE_PX, MARGIN_PX, LEAST_WIDTH_PX = 1400, 60, 800
PNG_PIXELS = """
const [text, margin, xs, ys] = arguments;
const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
return createImageBitmap(new Blob([bytes])).then((image) => {
  const canvas = new OffscreenCanvas(image.width, image.height), c = canvas.getContext("2d");
  c.drawImage(image, 0, 0);
  const { data } = c.getImageData(0, 0, image.width, image.height);
  return xs.map((x, k) => [...data.slice(4 * ((ys[k] + margin / 2) * image.width + x + margin), 4 * ((ys[k] + margin / 2) * image.width + x + margin) + 3)]);
});
"""


def png_grid(frame):
    """Left and top edges and pixel size of the map on ground_map.png: the sector's bounds, north up, with the antenna."""
    d = types.SimpleNamespace(**frame)
    start, end = d.azimuth_start_deg, d.azimuth_start_deg + d.settings["azimuth_bins"] * d.azimuth_width_deg
    quarters = np.arange(np.ceil(start / 90), end / 90 + 1e-12) * 90
    bearings = np.unique(np.concatenate([np.linspace(start, end, int(np.ceil((end - start) / 2)) + 1), quarters]))
    edges = d.range_start_m + np.array([0, d.settings["range_bins"]]) * d.range_spacing_m
    latitude, longitude, _ = mapping.locate_exactly(d, bearings, edges)
    east, north = mapping.inverse(d.pose["latitude_deg"], d.pose["longitude_deg"], latitude, longitude)
    left, right, bottom, top = (f(np.append(v, 0)) for v, f in ((east, np.min), (east, np.max), (north, np.min), (north, np.max)))
    pixel = max(right - left, top - bottom) / SIDE_PX
    assert (right - left) / pixel >= LEAST_WIDTH_PX, "the map is not as wide as its caption"
    return left, top, pixel


if __name__ == "__main__":
    unittest.main()
