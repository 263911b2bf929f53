// Pointer, touch and keys.

import { PALETTES } from "./palettes.js";
import { UPS } from "./heading.js";
import { lineAt } from "./lines.js";
import { targetAt } from "./target_marks.js";
import { turned } from "./placement.js";

const LONG_PRESS_MS = 450;
const STILL_PX = 5;
const NEAR_PX = 14; // of a handle
const POSE_MS = 50; // between poses of a dragged bearing

/** @type {[string, string][]} what `?` shows */
export const KEYS = [
  ["← →", "turn the antenna by 1°, with Ctrl by 10°; without control: move the cursor"],
  ["Shift + arrows", "move the cursor"],
  ["+ − 0", "zoom in, out, all of the sector"],
  ["[ ]", "smaller, greater range scale"],
  ["1 2", "bearing line and range marker 1, 2 (EBL, VRM): at the cursor, or away"],
  ["A", "levels by what is shown now"],
  ["C", "next palette"],
  ["N", "north, bearing, heading or course up"],
  ["G", "to the gain: type a number; the wheel turns a field, too"],
  ["L", "places on the ground, or slant ranges"],
  ["B V", "B-scope: bearings across, ranges upwards; profile of the ground along bearing line 1"],
  ["R U", "rings; km or NM"],
  ["O", "overlay of shadow, not sampled, no ground"],
  ["F", "hold the picture"],
  ["S", "save a PNG"],
  ["P", "one picture or two"],
  ["K", "take or release control"],
  ["T Z", "standby; freeze the radar"],
  ["D", "next tab"],
  ["Esc", "cursor, bearing lines and range markers away"],
  ["space , .", "of a recording: pause; a second back, on, with Ctrl ten"],
  ["?", "this list"],
];

/** @param {import("./main.js").App} app */
export function listenKeys(app) {
  addEventListener("keydown", (event) => {
    if (event.target.closest?.("input, select, textarea, dialog[open]") || event.altKey || event.metaKey) return;
    if (event.target.closest?.("nav") && event.key.startsWith("Arrow")) return;
    if (app.debrief.state && event.key === " " && event.target.closest?.("button")) return;
    const step = { ",": -1, ".": 1 }[event.key];
    if (app.debrief.state && step) return void app.debrief.step(step * (event.ctrlKey ? 10 : 1));
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (arrow) {
      const mine = app.controls.isMine && !event.shiftKey && arrow[0] !== 0;
      if (mine) app.turn(arrow[0] * (event.ctrlKey ? 10 : 1));
      else app.moveCursor(arrow[0] * 4, arrow[1] * 4);
    } else if (event.ctrlKey || !press(app, event.key)) {
      return;
    }
    event.preventDefault();
  });
}

function press(app, key) {
  const { look, display, controls } = app;
  const does = {
    "+": () => app.zoom(1.5), "=": () => app.zoom(1.5), "-": () => app.zoom(1 / 1.5), 0: () => app.zoom(0),
    "[": () => controls.isMine && controls.nextScale(-1), "]": () => controls.isMine && controls.nextScale(1),
    1: () => app.toggleLine(["mark", 0]), 2: () => app.toggleLine(["mark", 1]),
    a: () => app.active.levelOnce(), c: () => display.next("palette", PALETTES),
    n: () => display.next("up", UPS), g: () => controls.toGain(), l: () => display.set({ slant: !look.slant }),
    b: () => display.set({ bscope: !look.bscope }), v: () => display.set({ profile: !look.profile }),
    r: () => display.set({ rings: !look.rings }), u: () => display.next("unit", ["km", "NM"]),
    o: () => display.set({ overlay: !look.overlay }), f: () => display.set({ hold: !look.hold }),
    s: () => app.save(), p: () => app.setPanes(app.panes.length === 1 ? 2 : 1),
    k: () => !controls.claim.disabled && controls.toggleControl(),
    t: () => controls.isMine && controls.toggleState("transmit"), z: () => controls.isMine && controls.toggleState("freeze"),
    d: () => controls.nextTab(),
    Delete: app.targets.holds && app.targets.chosen ? () => app.targets.remove() : null,
    " ": app.debrief.state ? () => app.debrief.togglePause() : null,
    Escape: () => (app.targets.cancel(), app.clearMarks()), "?": () => app.showKeys(),
  }[key.length === 1 ? key.toLowerCase() : key];
  if (does) does();
  return Boolean(does);
}

/**
 * @param {import("./main.js").App} app
 * @param {import("./pane.js").Pane} pane
 */
export function listenPointer(app, pane) {
  const { ppi } = pane;
  const { element } = ppi;
  const down = new Map(); // pointers by id: [x, y]
  let drag = null; // what moves: "pan", "cursor", "bearing", a line as lineAt() names it, { target: its id }
  let moved = 0;
  let pressTimer = 0;
  let posed_ms = 0;

  const at = (event) => {
    const box = element.getBoundingClientRect();
    return [(event.clientX - box.left) / app.look.px, (event.clientY - box.top) / app.look.px];
  };
  const near = (x, y, point) => point && Math.hypot(x - point[0], y - point[1]) < NEAR_PX;
  const bearingAt = (x, y) => turned(ppi.read(ppi.fromScreen(x, y)).bearing_deg);
  const grabbed = (x, y) => {
    if (ppi.handle && near(x, y, ppi.handleAt)) return "bearing";
    const target = targetAt(ppi, x, y);
    return target === null ? lineAt(ppi, x, y) ?? "pan" : { target };
  };
  const spread = () => {
    const [[x0, y0], [x1, y1]] = [...down.values()];
    return { distance: Math.hypot(x1 - x0, y1 - y0), x: (x0 + x1) / 2, y: (y0 + y1) / 2 };
  };

  element.addEventListener("pointerdown", (event) => {
    if (!pane.bins.placement || event.button > 1) return;
    const [x, y] = at(event);
    element.setPointerCapture(event.pointerId);
    down.set(event.pointerId, [x, y]);
    moved = 0;
    drag = down.size === 1 ? grabbed(x, y) : "pinch";
    clearTimeout(pressTimer);
    if (event.pointerType === "touch" && drag === "pan") {
      pressTimer = setTimeout(() => {
        drag = "cursor";
        app.setCursor(ppi.fromScreen(x, y));
      }, LONG_PRESS_MS);
    }
  });

  element.addEventListener("pointermove", (event) => {
    if (!pane.bins.placement) return;
    const [x, y] = at(event);
    const was = down.get(event.pointerId);
    if (!was) {
      if (event.pointerType === "mouse") app.setCursor(ppi.fromScreen(x, y));
      element.classList.toggle("grab", grabbed(x, y) !== "pan");
      return;
    }
    const before = down.size === 2 ? spread() : null;
    down.set(event.pointerId, [x, y]);
    moved += Math.hypot(x - was[0], y - was[1]);
    if (moved > STILL_PX) clearTimeout(pressTimer);
    if (before) {
      const after = spread();
      ppi.pan(after.x - before.x, after.y - before.y);
      app.zoom(after.distance / Math.max(1, before.distance), after.x, after.y, pane);
    } else if (drag === "cursor") {
      app.setCursor(ppi.fromScreen(x, y));
    } else if (drag === "bearing") {
      ppi.draggedBearing_deg = bearingAt(x, y);
      ppi.needs.marks = true;
      if (performance.now() - posed_ms > POSE_MS) {
        posed_ms = performance.now();
        app.setBearing(ppi.draggedBearing_deg);
      }
    } else if (Array.isArray(drag)) {
      app.placeLine(drag, pane, x, y);
    } else if (drag?.target && app.targets.holds) {
      if (moved > STILL_PX) app.targets.drag(pane, drag.target, x, y);
    } else if ((drag === "pan" || drag?.target) && moved > STILL_PX) {
      ppi.pan(x - was[0], y - was[1]);
      app.change({});
    }
  });

  const up = (event) => {
    if (!down.delete(event.pointerId)) return;
    clearTimeout(pressTimer);
    const [x, y] = at(event);
    if (drag === "bearing" && event.type === "pointerup") app.setBearing(bearingAt(x, y));
    if (drag === "bearing") ppi.draggedBearing_deg = undefined;
    const isClick = moved <= STILL_PX && event.type === "pointerup";
    const id = drag?.target ?? null;
    if (id !== null && !isClick && app.targets.dragged) {
      if (event.type === "pointerup") app.targets.drop(pane, id, x, y);
      else app.targets.cancel();
    }
    if (isClick && id !== null) app.targets.click(pane, x, y, { id, isRoutePoint: event.shiftKey && id !== app.targets.chosen });
    if (isClick && drag === "pan") {
      if (app.look.armed !== null) app.placeLine(app.look.armed, pane, x, y);
      else if (app.targets.click(pane, x, y, { id: null, isRoutePoint: event.shiftKey })) app.setCursor(null);
      else app.setCursor(ppi.fromScreen(x, y));
    }
    drag = down.size ? "pan" : null;
    ppi.needs.marks = true;
  };
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", up);
  element.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && !down.size && element.classList.remove("grab"));
  element.addEventListener("dblclick", () => app.look.armed === null && !app.targets.holds && app.zoom(0));
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    app.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...at(event), pane);
  }, { passive: false });
}
