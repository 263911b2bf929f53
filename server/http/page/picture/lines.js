// Electronic bearing lines and variable range markers: two of each, apart, by pointer or by number.

import { DEGREE, turned } from "./placement.js";

export const ORANGE = "#ffa94d"; // as S-52 has it for a navigator's own marks
const DASHES = [[], [6, 4]]; // of the first and of the second
const EACH = /** @type {const} */ ([0, 1]);

/** @typedef {import("./ppi.js").Ppi} Ppi @typedef {import("./placement.js").Point} Point */
/** A bearing line, a range marker, or both, and its number. @typedef {[kind: "ebl"|"vrm"|"mark", k: 0|1]} Line */
/** @typedef {{ebl: [number|null, number|null], vrm: [number|null, number|null]}} Lines true bearings, slant ranges in metres */

/** @returns {Lines} */
export const noLines = () => ({ ebl: [null, null], vrm: [null, null] });

/**
 * Where bearing line and range marker k cross, as bearing and slant range; null: one of them is not there.
 * @param {Lines} lines
 * @param {0|1} k
 */
export function crossing({ ebl, vrm }, k) {
  return ebl[k] === null || vrm[k] === null ? null : { bearing_deg: ebl[k], slant_m: vrm[k] };
}

/** @param {Ppi} ppi @param {CanvasRenderingContext2D} c */
export function drawLines(ppi, c) {
  const { look, bins: { placement } } = ppi;
  c.strokeStyle = c.fillStyle = ORANGE;
  c.lineWidth = 1;
  for (const k of EACH) {
    c.setLineDash(DASHES[k]);
    const { ebl, vrm } = look.lines;
    if (ebl[k] !== null) path(ppi, c, [[ebl[k], 0], [ebl[k], 1.6 * placement.rMax_m]]);
    if (vrm[k] !== null) path(ppi, c, Array.from({ length: 121 }, (_, n) => [placement.start_deg + n * (placement.sector_deg / 120), vrm[k]]));
    c.setLineDash([]);
    const at = crossing(look.lines, k);
    if (!at) continue;
    const [x, y] = ppi.screenOf(at.bearing_deg, at.slant_m);
    c.beginPath();
    c.arc(x, y, 5, 0, 2 * Math.PI);
    c.stroke();
    c.fillText(String(k + 1), x + 8, y - 8);
  }
}

/** @param {Ppi} ppi @param {CanvasRenderingContext2D} c @param {Point[]} points bearings and slant ranges */
function path(ppi, c, points) {
  c.beginPath();
  for (const [bearing_deg, slant_m] of points) c.lineTo(...ppi.screenOf(bearing_deg, slant_m));
  c.stroke();
}

const NEAR_PX = 8;

/**
 * What lies under a place of the picture: ["mark", k] the crossing, ["ebl", k], ["vrm", k]; null: nothing.
 * @param {Ppi} ppi
 * @param {number} x
 * @param {number} y
 * @returns {Line|null}
 */
export function lineAt(ppi, x, y) {
  const { lines } = ppi.look;
  const at = ppi.read(ppi.fromScreen(x, y));
  if (!at) return null;
  const near = (/** @type {number} */ bearing_deg, /** @type {number} */ slant_m) => {
    const [px, py] = ppi.screenOf(bearing_deg, slant_m);
    return Math.hypot(px - x, py - y) < NEAR_PX;
  };
  for (const k of EACH) {
    const cross = crossing(lines, k);
    if (cross && near(cross.bearing_deg, cross.slant_m)) return ["mark", k];
  }
  for (const k of EACH) {
    if (lines.vrm[k] !== null && near(at.bearing_deg, lines.vrm[k])) return ["vrm", k];
    const away_deg = lines.ebl[k] === null ? 180 : Math.abs(((at.bearing_deg - lines.ebl[k] + 540) % 360) - 180);
    if (away_deg < 90 && near(lines.ebl[k], at.slant_m)) return ["ebl", k];
  }
  return null;
}

/**
 * Moves a line or both to a reading.
 * @param {Lines} lines
 * @param {Line} line
 * @param {{bearing_deg: number, slant_m: number}} at
 * @returns {Lines}
 */
export function movedLines({ ebl, vrm }, [kind, k], { bearing_deg, slant_m }) {
  /** @type {Lines} */
  const moved = { ebl: [...ebl], vrm: [...vrm] };
  if (kind !== "vrm") moved.ebl[k] = turned(bearing_deg);
  if (kind !== "ebl") moved.vrm[k] = slant_m;
  return moved;
}

/** From one crossing to the other on the plane: distance and true bearing. @param {Point} from @param {Point} to */
export function between(from, to) {
  const [e, n] = [to[0] - from[0], to[1] - from[1]];
  return { distance_m: Math.hypot(e, n), bearing_deg: turned(Math.atan2(e, n) / DEGREE) };
}
