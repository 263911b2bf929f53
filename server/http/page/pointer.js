// Pointer and touch on a picture.

import { lineAt } from "./picture/lines.js";
import { targetAt } from "./picture/target_marks.js";
import { turned } from "./picture/placement.js";

const LONG_PRESS_MS = 450;
const STILL_PX = 5;
const NEAR_PX = 14; // of a handle
const POSE_MS = 50; // between poses of a dragged bearing

/** What moves. @typedef {"pan"|"cursor"|"bearing"|"pinch"|import("./picture/lines.js").Line|{target: string}|null} Drag */

/** The dragged target's id; null: another thing is dragged. @param {Drag} drag */
const targetOf = (drag) => (drag && typeof drag === "object" && "target" in drag ? drag.target : null);

/**
 * @param {import("./picture/pane.js").Pane} pane
 * @param {object} parts
 * @param {import("./look.js").Look} parts.look
 * @param {import("./pictures.js").Pictures} parts.pictures
 * @param {import("./markers.js").Markers} parts.markers
 * @param {import("./control.js").Control} parts.control
 * @param {import("./targets.js").Targets} parts.targets
 */
export function listenPointer(pane, { look, pictures, markers, control, targets }) {
  const { ppi } = pane;
  const { element } = ppi;
  /** Pointers by id. @type {Map<number, [number, number]>} */
  const down = new Map();
  /** @type {Drag} */
  let drag = null;
  let moved = 0;
  let pressTimer = 0;
  let posed_ms = 0;

  /** @returns {[number, number]} the page's pixels of the picture */
  const at = (/** @type {MouseEvent} */ event) => {
    const box = element.getBoundingClientRect();
    return [(event.clientX - box.left) / look.px, (event.clientY - box.top) / look.px];
  };
  /** @param {number} x @param {number} y @param {[number, number]} point */
  const near = (x, y, point) => point && Math.hypot(x - point[0], y - point[1]) < NEAR_PX;
  const bearingAt = (/** @type {number} */ x, /** @type {number} */ y) => turned(ppi.read(ppi.fromScreen(x, y)).bearing_deg);
  /** @returns {Drag} */
  const grabbed = (/** @type {number} */ x, /** @type {number} */ y) => {
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
        markers.setCursor(ppi.fromScreen(x, y));
      }, LONG_PRESS_MS);
    }
  });

  element.addEventListener("pointermove", (event) => {
    if (!pane.bins.placement) return;
    const [x, y] = at(event);
    const was = down.get(event.pointerId);
    if (!was) {
      if (event.pointerType === "mouse") markers.setCursor(ppi.fromScreen(x, y));
      element.classList.toggle("grab", grabbed(x, y) !== "pan");
      return;
    }
    const before = down.size === 2 ? spread() : null;
    down.set(event.pointerId, [x, y]);
    moved += Math.hypot(x - was[0], y - was[1]);
    if (moved > STILL_PX) clearTimeout(pressTimer);
    if (before) {
      const after = spread();
      pictures.pan(after.x - before.x, after.y - before.y, pane);
      pictures.zoom(after.distance / Math.max(1, before.distance), after.x, after.y, pane);
    } else if (drag === "cursor") {
      markers.setCursor(ppi.fromScreen(x, y));
    } else if (drag === "bearing") {
      ppi.draggedBearing_deg = bearingAt(x, y);
      ppi.needs.marks = true;
      if (performance.now() - posed_ms > POSE_MS) {
        posed_ms = performance.now();
        control.setBearing(ppi.draggedBearing_deg);
      }
    } else if (Array.isArray(drag)) {
      markers.placeLine(drag, pane, x, y);
    } else if (targetOf(drag) !== null && targets.holds) {
      if (moved > STILL_PX) targets.drag(pane, targetOf(drag), x, y);
    } else if ((drag === "pan" || targetOf(drag) !== null) && moved > STILL_PX) {
      pictures.pan(x - was[0], y - was[1], pane);
    }
  });

  const up = (/** @type {PointerEvent} */ event) => {
    if (!down.delete(event.pointerId)) return;
    clearTimeout(pressTimer);
    const [x, y] = at(event);
    if (drag === "bearing" && event.type === "pointerup") control.setBearing(bearingAt(x, y));
    if (drag === "bearing") ppi.draggedBearing_deg = undefined;
    const isClick = moved <= STILL_PX && event.type === "pointerup";
    const id = targetOf(drag);
    if (id !== null && !isClick && targets.dragged) {
      if (event.type === "pointerup") targets.drop(pane, id, x, y);
      else targets.cancel();
    }
    if (isClick && id !== null) targets.click(pane, x, y, { id, isRoutePoint: event.shiftKey && id !== targets.chosen });
    if (isClick && drag === "pan") {
      if (look.armed !== null) markers.placeLine(look.armed, pane, x, y);
      else if (targets.click(pane, x, y, { id: null, isRoutePoint: event.shiftKey })) markers.setCursor(null);
      else markers.setCursor(ppi.fromScreen(x, y));
    }
    drag = down.size ? "pan" : null;
    ppi.needs.marks = true;
  };
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", up);
  element.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && !down.size && element.classList.remove("grab"));
  element.addEventListener("dblclick", () => look.armed === null && !targets.holds && pictures.zoom(0));
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    pictures.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...at(event), pane);
  }, { passive: false });
}
