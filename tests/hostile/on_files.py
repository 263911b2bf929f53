"""Files at their extremes, each through `obliq render`: pattern tables, keys, TOML, footprints. Refused in words or
rendered, within some seconds of processor time and some memory."""
import json
import math
import os

from place import attack

SCENE = """
[terrain]
synthetic = "hills"
cell_m = 200.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1500.0
[[radar]]
name = "main"
sector_deg = 40.0
r_min_m = 3000.0
r_max_m = 8000.0
[frustum]
quality = "draft"
[bins]
azimuth = 32
range = 64
"""
HOUSE = (-99.5, 33.05)  # within the sector
MOST_S, MOST_BY_COUNT_S, MOST_OUTLINE_S = 12.0, 4.0, 6.0  # of processor time
MOST_MB, MOST_WORDS = 1200, 3000
SECRET = "root:$6$wK1ZqLx9:20000:0:99999:7:::"


def render(place, what, *words, text=SCENE, most_s=MOST_S, refused=None, most_words=MOST_WORDS):
    """The words of `obliq render`; refused: it must be (True), must not (False), or may."""
    program = place.command("render", place.write("scene.toml", text), "--out", place.path("out"), *words, gigabytes=8)
    most_s *= place.slack
    code = program.finish(60, processor=4 * most_s)
    said = program.log()
    place.expect(program.used_s <= most_s and code != "still at work", f"{what}: {program.used_s:.1f} s of processor time"
                 f"{', not done' if code == 'still at work' else ''}; allowed: {most_s:g}")
    place.expect(code in (0, 1, 2, "still at work"), f"{what}: exit code {code}")
    place.expect(program.most_mb <= MOST_MB * place.slack, f"{what}: {program.most_mb:.0f} MB")
    place.expect(len(said) <= most_words, f"{what}: {len(said)} letters are said")
    place.expect(all(c.isprintable() or c == "\n" for c in said), f"{what}: control characters are said: {said[-80:]!r}")
    place.expect(refused is None or code == "still at work" or refused == (code != 0), f"{what}: exit code {code}: {said[-200:]}")
    place.expect(code in (0, "still at work") or said.strip(), f"{what}: refused without a word")
    return said


def pattern(place, what, content, refused=None):
    path = place.path("pattern.csv")
    if os.path.lexists(path):
        os.remove(path)
    content(path) if callable(content) else place.write("pattern.csv", content)
    return render(place, f"table: {what}", text=SCENE + '[beam]\npattern = "file"\nfile = "pattern.csv"\n', refused=refused)


def rows(angles, gains):
    return "cut,angle_deg,gain_db\n" + "".join(f"azimuth,{a},{g}\n" for a, g in zip(angles, gains))


@attack("L3")
def quoted_secrets(place):
    """A pattern table that is a link to a secret, one whose name is NUL: nothing of a file is quoted."""
    secret = place.write("secret", SECRET + "\nmore\n")
    said = pattern(place, "a link to a secret", lambda path: os.symlink(secret, path), refused=True)
    place.expect(not any(SECRET[k:k + 6] in said for k in range(len(SECRET) - 5)), f"a secret is quoted: {said[-160:]}")
    said = render(place, "a name of NUL", text=SCENE + '[beam]\npattern = "file"\nfile = "\\u0000"\n', refused=True)
    place.expect("beam.file" in said, f"a name of NUL: the key is not named: {said[-160:]!r}")


@attack("L2")
def long_scene_files(place):
    """Three megabytes of unknown keys, 100,000 radars, 200,000 surfaces and materials: refused by their count."""
    radars = "".join(f"[[radar]]\nname='r{k}'\n" for k in range(100_000))
    for what, text in (("300,000 unknown keys", "[beam]\n" + "".join(f"k{k} = 1\n" for k in range(300_000))),
                       ("100,000 radars", radars),
                       ("200,000 surfaces", "[[surfaces]]\nsource='x'\nmaterial='water'\n" * 200_000),
                       ("200,000 materials", "".join(f"[materials.m{k}]\ngamma_db = -10\n" for k in range(200_000)))):
        render(place, what, text=SCENE + text, most_s=MOST_BY_COUNT_S, refused=True)


@attack("L2")
def dear_outlines(place):
    """One outline of 4,000 corners as a spiral, a star, a comb."""
    def there_and_back(inner, outer):
        return inner + outer[::-1]
    spiral = [there_and_back([(1e-6 * k * math.cos(k / 5), 1e-6 * k * math.sin(k / 5)) for k in range(2000)],
                             [(1e-6 * (k + 0.5) * math.cos(k / 5), 1e-6 * (k + 0.5) * math.sin(k / 5)) for k in range(2000)])]
    star = [[((1 if k % 2 else 0.3) * 1e-3 * math.cos(k * math.pi / 2000),
              (1 if k % 2 else 0.3) * 1e-3 * math.sin(k * math.pi / 2000)) for k in range(4000)]]
    comb = [[(0, 0)] + [(k * 1e-5 + x, y) for k in range(1000) for x,
                        y in ((0, 1e-3), (5e-6, 1e-3), (5e-6, 1e-5), (1e-5, 1e-5))] + [(1e-2, 0)]]
    for what, rings in (("a spiral", spiral), ("a star", star), ("a comb", comb)):
        houses(place, what, [polygon(*rings)], most_s=MOST_OUTLINE_S, refused=False)


@attack()
def pattern_tables(place):
    """Pattern tables that are no tables, of other encodings, of numbers that are none, or no files at all."""
    good = rows([k / 10 for k in range(-100, 101)], [-0.3 * (k / 10) ** 2 for k in range(-100, 101)])
    pattern(place, "good", good, refused=False)
    for what, content in (("empty", ""), ("the heading alone", rows([], [])), ("NUL", "cut,angle_deg,gain_db\nazimuth,\0,0\n"),
                          ("NaN", rows([-1, 0, 1], ["nan"] * 3)),
                          ("1e400", rows([-1, 0, 1], ["1e400"] * 3)), ("falling angles", rows([1, 0, -1], [-20, 0, -20])),
                          ("one angle", rows([0, 0, 0], [-20, 0, -20])),
                          ("5 MB without a line's end", good + "a" * 5_000_000),
                          ("bytes that are no UTF-8", good.encode() + b"\xff\xfe\n"),
                          ("a pipe", os.mkfifo), ("/dev/zero", lambda path: os.symlink("/dev/zero", path)),
                          ("a folder", os.mkdir), ("itself", lambda path: os.symlink(path, path)),
                          ("/proc/self/mem", lambda path: os.symlink("/proc/self/mem", path))):
        if what == "itself":
            os.rmdir(place.path("pattern.csv"))
        pattern(place, what, content, refused=True)
    for what, content in (("a spike of 1e-9 degrees", rows([-1, -1e-9, 0, 1e-9, 1], [-300, -300, 0, -300, -300])),
                          ("denormal steps", rows([-1, -5e-324, 0, 5e-324, 1], [-20, -1, 0, -1, -20])),
                          ("flat all round", rows([-180, 0, 180], [0, 0, 0])),
                          ("300,000 rows",
                           rows([k / 10_000 for k in range(-150_000, 150_000)],
                                [-abs(k) / 5000 for k in range(-150_000, 150_000)]))):
        pattern(place, what, content)
    return "19 tables"


@attack()
def odd_keys(place):
    """Keys at and beyond their limits, of other types, and long."""
    values = {"beam.width_deg": ("0", "nan", "1e400", '"3"', "[3]", "true"), "scan.rate_deg_s": ("0", "1e300"),
              "frustum.sub_columns": ("1025", "-1"),
              "scan.bars": ("[" + "1.0," * 17 + "]", "[91]", "[nan]", '["a"]', "[[1]]"), "frustum.quality": ('"nope"', "1"),
              "video.looks": ("1025",),
              "pulse.length_us": ("nan",), "antenna.tilt_deg": ('"x"', "91"), "video.floor_db": ("401", "nan"),
              "beam.file": ('"/"',), "http.names": ("[1]",)}
    count = 0
    for key, wrong in values.items():
        for value in wrong:
            said = render(place, f"{key} = {value[:30]}", "--set", f"{key}={value}",
                          *(("--set", "beam.pattern=file") if key == "beam.file" else ()), refused=True)
            place.expect(key.split(".")[1] in said, f"{key} = {value[:30]}: the key is not named: {said[-120:]}")
            count += 1
    for key, value in (("beam.file", '"' + "a" * 100_000 + '"'), ("scan.bars", "[" + "1.0," * 500_000 + "]")):
        section, name = key.split(".")
        render(place, f"{key} of {len(value)} letters", text=SCENE + f"[{section}]\n{name} = {value}\n",
               most_words=MOST_WORDS + len(value))
        count += 1
    return f"{count} values"


@attack()
def odd_toml(place):
    """Scene files that nest, repeat, are no text, no files."""
    for what, text in (("100,000 nested arrays", "x = " + "[" * 100_000 + "]" * 100_000),
                       ("100,000 nested tables", "x = " + "{a=" * 100_000 + "1" + "}" * 100_000),
                       ("a key of 100,000 parts", "a" + ".a" * 100_000 + " = 1"),
                       ("two radars of one name", "[[radar]]\nname='main'\n"),
                       ("a name of markup", "[[radar]]\nname='<img src=x onerror=alert(1)>'\n"),
                       ("a name of escapes", '[[radar]]\nname="\\u001b[31m\\n\\u0000"\n'),
                       ("a name of 1 MB", f"[[radar]]\nname='{'n' * 1_000_000}'\n"),
                       ("bytes that are no UTF-8", SCENE.encode() + b'[scan]\nmode = "\xff"\n'),
                       ("300 radars", "".join(f"[[radar]]\nname='r{k}'\n" for k in range(300)))):
        # The operator's own words may come back.
        render(place, what, text=text if isinstance(text, bytes) else SCENE + text, refused=True,
               most_words=MOST_WORDS + len(text))
    for what, make in (("a pipe", os.mkfifo), ("/dev/zero", lambda path: os.symlink("/dev/zero", path))):
        make(place.path(path := "odd.toml"))
        program = place.command("render", place.path(path), "--out", place.path("out"))
        place.expect((code := program.finish(20)) in (1, 2, 105, 106), f"a scene file that is {what}: {code}")
        os.remove(place.path(path))
    return "11 files"


def polygon(*rings):
    closed = [[*ring, ring[0]] if ring and ring[0] != ring[-1] else ring for ring in rings]
    return {"type": "Polygon", "coordinates": [[[HOUSE[0] + x, HOUSE[1] + y] for x, y in ring] for ring in closed]}


def houses(place, what, shapes, properties=None, raw=None, **more):
    features = [{"type": "Feature", "properties": properties[k] if properties else {"height": 12}, "geometry": shape} for k,
                shape in enumerate(shapes)]
    place.write("houses.geojson", json.dumps({"type": "FeatureCollection", "features": features}) if raw is None else raw)
    return render(place, f"houses: {what}", text=SCENE + "[[buildings]]\nsource = 'houses.geojson'\n", **more)


@attack()
def footprints(place):
    """Footprints that cross themselves, are needles, lie in one place, over the pole, or are no JSON."""
    def square(side):
        return [(0, 0), (side, 0), (side, side), (0, side)]
    circle = [(1e-3 * math.cos(k * math.pi / 100_000), 1e-3 * math.sin(k * math.pi / 100_000)) for k in range(200_000)]
    houses(place, "a square", [polygon(square(1e-4))], refused=False)
    cases = {"a bow tie": [polygon([(0, 0), (1e-3, 1e-3), (1e-3, 0), (0, 1e-3)])], "200,000 corners": [polygon(circle)],
             "30,000 in one place": [polygon(square(1e-4))] * 30_000,
             "needles": [polygon([(0, 0), (1e-2, 1e-14), (1e-2, 0)])] * 1000,
             "holes outside": [polygon(square(1e-3), square(5e-4), [(1, 1), (1.1, 1), (1, 1.1)], square(1e-3))],
             "a pentagram wound 200 times": [polygon([(1e-3 * math.cos(2 * math.pi * k * 200 / 401),
                                                       1e-3 * math.sin(2 * math.pi * k * 200 / 401)) for k in range(402)])],
             "points, lines, nothing": [None, {"type": "Point", "coordinates": [0, 0]}, {"type": "Polygon", "coordinates": []},
                                        {"type": "GeometryCollection", "geometries": []}],
             "1e308 degrees": [{"type": "Polygon", "coordinates": [[[1e308, 0], [-1e308, 1e308], [0, -1e308], [1e308, 0]]]}],
             "over the pole": [{"type": "Polygon",
                                "coordinates": [[[-180, 89], [180, 89], [180, -89], [-180, -89], [-180, 89]]]}]}
    for what, shapes in cases.items():
        houses(place, what, shapes)
    heights = [float("nan"), float("inf"), "1e400", "-5", "12 m", "", None, "x" * 100_000, [1]]
    houses(place, "odd heights", [polygon(square(1e-4))] * len(heights), [{"height": height} for height in heights])
    begin = '{"type":"FeatureCollection","features":'
    deep = '{"type":"GeometryCollection","geometries":[' * 5000 + "]}" * 5000
    for what, raw in (("cut in the middle", begin + '[{"type":"Fea'),
                      ("100,000 brackets", begin + "[" * 100_000 + "]" * 100_000 + "}"),
                      ("collections 5,000 deep", begin + '[{"type":"Feature","properties":{},"geometry":' + deep + "}]}")):
        houses(place, what, [], raw=raw)
    return f"{len(cases) + 5} files"
