// Electronic bearing lines and variable range markers: two of each, apart, by pointer or by number.

import { DEGREE, turned } from "./placement.js";

export const ORANGE = "#ffa94d"; // as S-52 has it for a navigator's own marks
const DASHES = [[], [6, 4]]; // of the first and of the second

/** @typedef {{ebl: (number|null)[], vrm: (number|null)[]}} Lines true bearings, slant ranges in metres */

export const noLines = () => ({ ebl: [null, null], vrm: [null, null] });

/** Where bearing line and range marker k cross, as bearing and slant range; null: one of them is not there. */
export function crossing({ ebl, vrm }, k) {
  return ebl[k] === null || vrm[k] === null ? null : { bearing_deg: ebl[k], slant_m: vrm[k] };
}

/** @param {import("./ppi.js").Ppi} ppi */
export function drawLines(ppi, c) {
  const { look, bins: { placement } } = ppi;
  c.strokeStyle = c.fillStyle = ORANGE;
  c.lineWidth = 1;
  for (const k of [0, 1]) {
    c.setLineDash(DASHES[k]);
    const { ebl, vrm } = look.lines;
    if (ebl[k] !== null) path(ppi, c, [0, 1].map((part) => [ebl[k], part * 1.6 * placement.rMax_m]));
    if (vrm[k] !== null) path(ppi, c, Array.from({ length: 121 }, (_, n) => [placement.start_deg + n * (placement.sector_deg / 120), vrm[k]]), k);
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

function path(ppi, c, points) {
  c.beginPath();
  for (const [bearing_deg, slant_m] of points) c.lineTo(...ppi.screenOf(bearing_deg, slant_m));
  c.stroke();
}

const NEAR_PX = 8;

/** What lies under a place of the picture: ["mark", k] the crossing, ["ebl", k], ["vrm", k]; null: nothing. */
export function lineAt(ppi, x, y) {
  const { lines } = ppi.look;
  const at = ppi.read(ppi.fromScreen(x, y));
  if (!at) return null;
  const near = (bearing_deg, slant_m) => {
    const [px, py] = ppi.screenOf(bearing_deg, slant_m);
    return Math.hypot(px - x, py - y) < NEAR_PX;
  };
  for (const k of [0, 1]) {
    const cross = crossing(lines, k);
    if (cross && near(cross.bearing_deg, cross.slant_m)) return ["mark", k];
  }
  for (const k of [0, 1]) {
    if (lines.vrm[k] !== null && near(at.bearing_deg, lines.vrm[k])) return ["vrm", k];
    const away_deg = lines.ebl[k] === null ? 180 : Math.abs(((at.bearing_deg - lines.ebl[k] + 540) % 360) - 180);
    if (away_deg < 90 && near(lines.ebl[k], at.slant_m)) return ["ebl", k];
  }
  return null;
}

/** Moves a line or both to a reading. @param {[string, number]} what of lineAt() */
export function movedLines({ ebl, vrm }, [kind, k], { bearing_deg, slant_m }) {
  const moved = { ebl: [...ebl], vrm: [...vrm] };
  if (kind !== "vrm") moved.ebl[k] = turned(bearing_deg);
  if (kind !== "ebl") moved.vrm[k] = slant_m;
  return moved;
}

/** From one crossing to the other on the plane: distance and true bearing. */
export function between(from, to) {
  const [e, n] = [to[0] - from[0], to[1] - from[1]];
  return { distance_m: Math.hypot(e, n), bearing_deg: turned(Math.atan2(e, n) / DEGREE) };
}
