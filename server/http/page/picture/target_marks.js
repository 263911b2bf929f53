// Marks of targets above a picture: where each is, where it goes, how much of it is seen; the chosen one's route.

import { measured, soon } from "../truth.js";

const SIDE_PX = 6; // from a mark's middle to its corners
const NEAR_PX = 12;
const MOST_DRAWN = 600;
const MOST_NAMES = 120;
const CORNERS_MS = 1000; // between looks at the words in the picture's corners
const LINE_PX = 14;
const SEEN = "#8fdcff";
const DIM = "rgba(143, 180, 205, 0.75)";
const CHOSEN = "#ffffff";
const HALO = "rgba(7, 11, 14, 0.85)";
const PLATE = "rgba(7, 11, 14, 0.78)"; // below a name
const LEAST_SPEED_MPS = 0.3; // with a leader

/** In the page's pixels. @typedef {[number, number]} Point @typedef {import("./ppi.js").Box} Box */
/** A mark that lies on the picture. @typedef {{record: TargetRecord, at: Point}} Mark */

/**
 * @typedef {object} TargetsShown what marks say of targets
 * @property {string} chosen
 * @property {{ppi: Ppi, at: Point}|null} dragged
 * @property {{ppi: Ppi, bearing_deg: number, range_m: number}|null} fresh
 * @property {(id: string) => string} nameOf
 * @property {(id: string) => import("../target_route.js").RoutePoint[]} pointsAhead
 * @property {(id: string) => boolean} loops
 * @property {(id: string, truth: import("../truth.js").Truth) => import("../truth.js").Velocity|null} velocityOf
 */

/** @typedef {import("./ppi.js").Ppi} Ppi @typedef {import("../truth.js").TargetRecord} TargetRecord */

/** Of the picture; on a B-scope of its axes. @param {Ppi} ppi */
const edges = (ppi) => (ppi.look.bscope ? ppi.box : { left: 0, right: ppi.width, top: 0, bottom: ppi.height });
/** @param {Ppi} ppi @param {Point} at */
function isOn(ppi, [x, y]) {
  const { left, right, top, bottom } = edges(ppi);
  return x >= left && x <= right && y >= top && y <= bottom;
}

/** Records that lie on the picture, with their pixels. @param {Ppi} ppi */
function placed(ppi) {
  /** @type {Mark[]} */
  const found = [];
  for (const record of ppi.truth.records.values()) {
    const at = ppi.screenOf(record.bearing_deg, record.range_m);
    if (isOn(ppi, at)) found.push({ record, at });
    if (found.length === MOST_DRAWN) break;
  }
  return found;
}

/** The target under a place of the picture; null: none. @param {Ppi} ppi @param {number} x @param {number} y */
export function targetAt(ppi, x, y) {
  if (!ppi.truth) return null;
  /** @type {string|null} */
  let best = null;
  let least = NEAR_PX;
  for (const { record, at } of placed(ppi)) {
    const away = Math.hypot(at[0] - x, at[1] - y);
    if (away < least) [least, best] = [away, record.id];
  }
  return best;
}

/**
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 * @param {TargetsShown} targets
 */
export function drawTargets(ppi, c, targets) {
  const shown = placed(ppi);
  const chosen = shown.find(({ record }) => record.id === targets.chosen);
  c.save();
  c.lineJoin = "round";
  if (chosen) route(ppi, c, chosen, targets.pointsAhead(chosen.record.id), targets.loops(chosen.record.id));
  for (const one of shown) leader(ppi, c, one, targets);
  for (const { record, at } of shown) mark(c, at, record, record.id === targets.chosen);
  names(ppi, c, shown, targets);
  const { dragged, fresh } = targets;
  if (dragged?.ppi === ppi) {
    if (chosen) lines(c, CHOSEN, [chosen.at, dragged.at], [3, 3]);
    diamond(c, dragged.at, SIDE_PX);
    outline(c, CHOSEN, [2, 2]);
  }
  if (fresh?.ppi === ppi) {
    const at = ppi.screenOf(fresh.bearing_deg, fresh.range_m);
    diamond(c, at, SIDE_PX + 2);
    outline(c, CHOSEN, [3, 2]);
  }
  c.restore();
}

/** @param {CanvasRenderingContext2D} c @param {Point} at @param {number} side */
function diamond(c, [x, y], side) {
  c.beginPath();
  c.moveTo(x, y - side);
  c.lineTo(x + side, y);
  c.lineTo(x, y + side);
  c.lineTo(x - side, y);
  c.closePath();
}

/** @param {CanvasRenderingContext2D} c @param {string} colour @param {number[]} dashes */
function outline(c, colour, dashes = []) {
  c.setLineDash([]);
  [c.strokeStyle, c.lineWidth] = [HALO, 3.5];
  c.stroke();
  c.setLineDash(dashes);
  [c.strokeStyle, c.lineWidth] = [colour, 1.4];
  c.stroke();
  c.setLineDash([]);
}

const isIn = (/** @type {TargetRecord} */ { azimuth_bin, range_bin }) => azimuth_bin >= 0 && range_bin >= 0;
const colourOf = (/** @type {TargetRecord} */ record) => (isIn(record) && record.share > 0 ? SEEN : DIM);

/**
 * Filled as far as it is seen: all, its lower half, nothing. One beside sector and swath is small.
 * @param {CanvasRenderingContext2D} c
 * @param {Point} at
 * @param {TargetRecord} record
 * @param {boolean} isChosen
 */
function mark(c, [x, y], record, isChosen) {
  const { share } = record;
  const colour = colourOf(record);
  const side = isIn(record) ? SIDE_PX : SIDE_PX - 2;
  diamond(c, [x, y], side);
  outline(c, colour);
  if (share > 0 && isIn(record)) {
    c.fillStyle = colour;
    if (share >= 0.999) diamond(c, [x, y], side - 1);
    else {
      c.beginPath();
      c.moveTo(x - side, y);
      c.lineTo(x, y + side);
      c.lineTo(x + side, y);
    }
    c.fill();
  }
  if (!isChosen) return;
  const r = SIDE_PX + 5;
  c.beginPath();
  for (const [dx, dy] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
    c.moveTo(x + dx * r, y + dy * (r - 5));
    c.lineTo(x + dx * r, y + dy * r);
    c.lineTo(x + dx * (r - 5), y + dy * r);
  }
  outline(c, CHOSEN);
}

/** @param {CanvasRenderingContext2D} c @param {string} colour @param {Point[]} points @param {number[]} dashes */
function lines(c, colour, points, dashes = []) {
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  outline(c, colour, dashes);
}

/**
 * To where it will be in a minute.
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 * @param {Mark} mark
 * @param {TargetsShown} targets
 */
function leader(ppi, c, { record, at }, targets) {
  const velocity = targets.velocityOf(record.id, ppi.truth);
  if (!velocity || Math.hypot(velocity.north, velocity.east) < LEAST_SPEED_MPS) return;
  const there = soon(ppi.bins.placement, record, velocity);
  const end = ppi.screenOf(there.bearing_deg, there.range_m);
  if (ppi.look.bscope && !isOn(ppi, end)) return;
  lines(c, colourOf(record), [at, end]);
}

/**
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 * @param {Mark} mark
 * @param {import("../target_route.js").RoutePoint[]} points still ahead
 * @param {boolean} loops back to its first place, near where it is
 */
function route(ppi, c, { record, at }, points, loops) {
  if (!points.length) return;
  const pixels = points.map(({ latitude_deg, longitude_deg }) => {
    const there = measured(ppi.bins.placement, latitude_deg, longitude_deg, record.height_m);
    return ppi.screenOf(there.bearing_deg, there.range_m);
  });
  lines(c, SEEN, [at, ...pixels], [6, 3]);
  if (loops) lines(c, DIM, [pixels.at(-1), at], [2, 4]);
  for (const [x, y] of pixels) {
    c.beginPath();
    c.arc(x, y, 2.5, 0, 2 * Math.PI);
    outline(c, SEEN);
  }
}

/** Of a picture: where its corners have words. @type {WeakMap<Element, {boxes: import("./ppi.js").Box[], at_ms: number}>} */
const corners = new WeakMap();

/** @param {Ppi} ppi @returns {import("./ppi.js").Box[]} */
function cornersOf({ element, look }) {
  const now = performance.now();
  const known = corners.get(element);
  if (known && now - known.at_ms < CORNERS_MS) return known.boxes;
  const own = element.getBoundingClientRect();
  const boxes = [...element.parentElement.querySelectorAll(".annun, .pick, .about")].map((one) => one.getBoundingClientRect()).filter(({ width }) => width).map((box) => (
    { left: (box.left - own.left) / look.px, right: (box.right - own.left) / look.px, top: (box.top - own.top) / look.px, bottom: (box.bottom - own.top) / look.px }));
  corners.set(element, { boxes, at_ms: now });
  return boxes;
}

/**
 * Beside their marks, where no other word and no mark stands; the chosen one's first, then those that the radar looks at.
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 * @param {Mark[]} shown
 * @param {TargetsShown} targets
 */
function names(ppi, c, shown, targets) {
  /** @type {Box[]} */
  const taken = shown.map(({ at: [x, y] }) => ({ left: x - SIDE_PX, right: x + SIDE_PX, top: y - SIDE_PX, bottom: y + SIDE_PX }));
  taken.push(...ppi.words, ...cornersOf(ppi));
  /** @param {Box} a @param {Box} b */
  const meets = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  const rank = (/** @type {Mark} */ { record }) => (record.id === targets.chosen ? 2 : isIn(record) ? 1 : 0);
  const order = [...shown].sort((a, b) => rank(b) - rank(a)).slice(0, MOST_NAMES);
  const { left, right, top, bottom } = edges(ppi);
  c.textAlign = "left";
  c.textBaseline = "middle";
  for (const { record, at: [x, y] } of order) {
    const text = targets.nameOf(record.id);
    const width = c.measureText(text).width;
    const off = SIDE_PX + (record.id === targets.chosen ? 11 : 7);
    /** @type {Point[]} */
    const places = [[x + off, y - 9], [x + off, y + 9], [x - off - width, y - 9], [x - off - width, y + 9], [x - width / 2, y - off - 8], [x - width / 2, y + off + 8]];
    const box = places.map(([x0, middle]) => ({ left: x0 - 3, right: x0 + width + 3, top: middle - LINE_PX / 2, bottom: middle + LINE_PX / 2, at: /** @type {Point} */ ([x0, middle]) }))
      .find((one) => one.left > left && one.right < right && one.top > top && one.bottom < bottom && !taken.some((other) => meets(one, other)));
    if (!box) continue;
    taken.push(box);
    c.fillStyle = PLATE;
    c.fillRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    c.fillStyle = record.id === targets.chosen ? CHOSEN : colourOf(record);
    c.fillText(text, ...box.at);
  }
}
