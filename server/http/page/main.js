// The page: it makes the parts and joins them. No other module knows all of them.

import { $, dialogOf } from "./dom.js";
import { Bins } from "./picture/bins.js";
import { Bookmarks } from "./bookmarks.js";
import { Control } from "./control.js";
import { Debrief } from "./debrief.js";
import { Display } from "./display.js";
import { Greeting } from "./greeting.js";
import { Link } from "./stream.js";
import { Look } from "./look.js";
import { Markers } from "./markers.js";
import { Meter, Readout } from "./readout.js";
import { Pictures } from "./pictures.js";
import { RadarControls } from "./radar.js";
import { RangeScales } from "./scales.js";
import { Sources } from "./sources.js";
import { StatusLine } from "./status.js";
import { Tabs } from "./tabs.js";
import { Targets } from "./targets.js";
import { Watch } from "./watch.js";
import { listenKeys } from "./keys.js";
import { listenPointer } from "./pointer.js";
import { readFragment, writeFragment } from "./fragment.js";
import { savePicture } from "./export.js";

const WORDS_MS = 250;
const AGAIN_MS = 3000; // between questions for the parameters
const CURSOR_PX = 4; // of an arrow key

// ---- The parts

const kept = readFragment();
const link = new Link();
const look = new Look(kept);
const debrief = new Debrief(link);
const pictures = new Pictures({ look, link, debrief }, kept);
const markers = new Markers(look, pictures);
const tabs = new Tabs(kept.tab);
const targets = new Targets({ link, pictures, look, debrief, tabs }, kept.targets);
const watch = new Watch({ link, pictures, look, debrief }, kept.rate, () => targets.isOn);
const control = new Control({ link, pictures, watch });
pictures.on("added", (pane) => listenPointer(pane, { look, pictures, markers, control, targets }));
pictures.add(`radar ${kept.a}`);
const display = new Display(look, pictures, markers);
const scales = new RangeScales();
const controls = new RadarControls({ link, control, pictures, debrief, scales, tabs });
const sources = new Sources({ link, pictures, debrief, scales, kept });
const bookmarks = new Bookmarks(link, debrief);
const greeting = new Greeting(link);
const status = new StatusLine();
const meter = new Meter();
const readout = new Readout();

// ---- What one says to the others

function keep() {
  writeFragment({ ...look.kept, ...pictures.keptLevels, expert: kept.expert, panes: pictures.panes.length, tab: tabs.current, rate: kept.rate,
    a: kept.a, b: kept.b, targets: targets.isWanted });
}

function tell() {
  const { first, panes } = pictures;
  if (debrief.isOn) debrief.show();
  meter.show(first, { isLive: link.isLive, isHeld: look.hold, isPaused: Boolean(debrief.state?.paused) });
  targets.show();
  status.show({ state: link.state, panes, replay: debrief.state, isHeld: look.hold, status: watch.status });
}

/** @param {string} text */
function tellNews(text) {
  status.tell(text);
  tell();
}

/** @param {number} count of pictures */
const setPanes = (count) => pictures.setCount(count, sources.other);
const save = () => savePicture({ look, link, panes: pictures.panes });
const showKeys = () => dialogOf("help").showModal();

link.on("scales", (offered) => {
  if (!scales.take(offered)) return;
  controls.offer(offered);
  sources.fill();
});
link.on("state", (state) => {
  if (state.kind !== "live" && state.kind !== "silent") {
    debrief.forget();
    targets.forget();
    pictures.forget();
  }
  greeting.show(state);
  controls.show();
  tell();
});
link.on("welcome", async (welcome) => {
  greeting.welcome(welcome);
  sources.fill();
  targets.begin(welcome);
  watch.forget();
  watch.subscribe();
  bookmarks.begin(welcome);
  await watch.poll(); // what there is to see beside it follows from the first radar
  if (kept.panes === 2 && pictures.panes.length === 1) setPanes(2);
});
link.on("Error", () => watch.poll());
debrief.on("begun", () => sources.fill());
bookmarks.on("news", tellNews);
control.on("taken", tellNews);
look.on("change", (change) => {
  if (("hold" in change || "overlay" in change || "label" in change) && !look.hold) watch.subscribe();
});
pictures.on("active", () => display.show());
pictures.on("set", keep);
pictures.on("chosen", () => {
  keep();
  watch.subscribe();
  watch.poll();
});
pictures.on("count", () => {
  sources.fill();
  watch.subscribe();
  watch.poll();
  display.show();
  keep();
});
pictures.on("received", () => meter.frameReceived());
pictures.on("drew", (drawn) => meter.drew(drawn));
pictures.on("frame", () => meter.frameDrawn());
markers.on("lines", () => display.show());
display.on("set", keep);
sources.on("expert", keep);
tabs.on("shown", keep);
controls.on("scaled", (unit) => display.set({ unit }));
targets.on("wanted", () => {
  keep();
  watch.subscribe();
});
watch.on("unknown", () => sources.fill());
watch.on("polled", () => {
  sources.refresh();
  controls.show();
  tell();
});

keep();

// ---- Keys and buttons

/** @type {Record<string, () => void>} */
const PRESSED = {
  "+": () => pictures.zoom(1.5), "=": () => pictures.zoom(1.5), "-": () => pictures.zoom(1 / 1.5), 0: () => pictures.zoom(0),
  "[": () => control.isMine && controls.nextScale(-1), "]": () => control.isMine && controls.nextScale(1),
  1: () => markers.toggleLine(["mark", 0]), 2: () => markers.toggleLine(["mark", 1]),
  a: () => pictures.active.levelOnce(), c: () => display.nextPalette(), n: () => display.nextUp(), g: () => controls.toGain(),
  l: () => display.set({ slant: !look.slant }), b: () => display.set({ bscope: !look.bscope }), v: () => display.set({ profile: !look.profile }),
  r: () => display.set({ rings: !look.rings }), u: () => display.set({ unit: look.unit === "km" ? "NM" : "km" }),
  o: () => display.set({ overlay: !look.overlay }), f: () => display.set({ hold: !look.hold }),
  s: save, p: () => setPanes(pictures.panes.length === 1 ? 2 : 1),
  k: () => !controls.claim.disabled && control.toggle(),
  t: () => control.isMine && control.toggleState("transmit"), z: () => control.isMine && control.toggleState("freeze"),
  d: () => tabs.next(),
  Escape: () => {
    targets.cancel();
    markers.clear();
  },
  "?": showKeys,
};
listenKeys({
  press(key, isFast) {
    const step = key === "," ? -1 : key === "." ? 1 : 0;
    if (debrief.isOn && step) return () => debrief.step(step * (isFast ? 10 : 1));
    if (isFast) return null;
    if (key === "Delete") return targets.holds && targets.chosen ? () => targets.remove() : null;
    if (key === " ") return debrief.isOn ? () => debrief.togglePause() : null;
    return Object.hasOwn(PRESSED, key) ? PRESSED[key] : null;
  },
  arrow(dx, dy, isCursor, isFast) {
    if (control.isMine && !isCursor && dx !== 0) control.turn(dx * (isFast ? 10 : 1));
    else markers.moveCursor(dx * CURSOR_PX, dy * CURSOR_PX);
  },
});
$("two").onclick = () => setPanes(pictures.panes.length === 1 ? 2 : 1);
$("keys").onclick = showKeys;
$("png").onclick = save;
addEventListener("hashchange", () => location.reload());

// ---- All the time

async function loadParameters() {
  try {
    /** @type {import("./form.js").Parameter[]} */
    const table = await (await fetch("parameters.json")).json();
    controls.use(table);
    Bins.notIdeal = table.filter(({ not_ideal }) => not_ideal);
    look.change({ compensated: look.compensated });
    display.show();
  } catch {
    setTimeout(loadParameters, AGAIN_MS);
  }
}

/** @param {number} now_ms */
function draw(now_ms) {
  const { first, panes } = pictures;
  for (const pane of panes) {
    pane.draw(now_ms);
    if (pane !== first) pane.renderAgain(first, watch.planesOf(first.radar), targets.isOn);
  }
  readout.show(first, look, link.isLive);
  requestAnimationFrame(draw);
}

setInterval(tell, WORDS_MS);
requestAnimationFrame(draw);
link.open();
loadParameters();

// For tests and benches.
Object.assign(globalThis, { obliq: {
  link, look, debrief, pictures, panes: pictures.panes, markers, tabs, targets, watch, control, display, controls, bookmarks, meter, tell, save, setPanes,
} });
