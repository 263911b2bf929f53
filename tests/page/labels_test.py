"""Labels over the picture: the page's colours against the planes that a client gets."""
import unittest

import numpy as np

import support
import obliq

TOWN = support.SCENE.replace("[antenna]", "[[prisms]]\nper_km2 = 60.0\nheight_m = [20.0, 60.0]\n[antenna]", 1)
FIRST = 16  # of the codes that have colours
CODES = "return Array.from(obliq.panes[0].bins.state);"


def expected(frame, label):
    """As the page codes them; 1: the level."""
    if label == "MATERIAL":
        return np.where(frame.material == 255, 1, FIRST + frame.material % 8)
    if label == "BUILDING":
        return np.where(frame.building >= 0.5, FIRST, np.where(frame.building >= 0.1, FIRST + 1, 1))
    if label == "RETURNS":
        return np.where(frame.returns < 2, 1, FIRST + np.minimum(frame.returns, 4).astype(int) - 2)
    low, high = frame.descriptor.ground.lowest_m, frame.descriptor.ground.highest_m
    band = np.floor((np.nan_to_num(frame.height.astype(float)) - low) * (8 / max(1.0, high - low)))
    return np.where(np.isnan(frame.height), 1, FIRST + np.clip(band, 0, 7))


class Labels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = support.Daemon(TOWN)
        cls.page = support.Page()
        cls.server = obliq.connect(cls.daemon.address)
        cls.addClassCleanup(cls.server.close)

    def test_each_label_is_coloured_as_its_plane_says_and_explained(self):
        frame = self.server.radar("main").frame(planes="material building height returns")
        for label in ("MATERIAL", "BUILDING", "HEIGHT", "RETURNS"):
            with self.subTest(label=label):
                self.page.open(self.daemon.url, f"a=main&label={label}")
                self.page.await_script("globalThis.obliq && obliq.panes[0].bins.hasStates && obliq.meter.drawn > 2", "labels")
                codes = np.array(self.page.script(CODES)).reshape(frame.shape)
                np.testing.assert_array_equal(codes, expected(frame, label))
                coloured = int((codes >= FIRST).sum())
                self.assertGreater(coloured, 20)
                self.page.await_script("document.querySelectorAll('#label-legend i').length > 0", "the legend")
                print(f"  {label}: {coloured} bins have a colour")

    def test_without_a_label_the_level_comes_back(self):
        self.page.open(self.daemon.url, "a=main&label=HEIGHT")
        self.page.await_script("globalThis.obliq && obliq.panes[0].bins.hasStates", "labels")
        self.page.script("obliq.display.set({ label: '' });")
        self.page.await_script("!obliq.panes[0].bins.hasStates && document.getElementById('label-legend').hidden", "the level")


if __name__ == "__main__":
    unittest.main()
