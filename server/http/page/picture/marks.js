// What moves above a picture: scan line, heading line, centre bearing, cursor; bearing lines and range markers.

import { crossing, drawLines } from "./lines.js";
import { drawTargets } from "./target_marks.js";

const FONT = '11px "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace';

/** @typedef {import("./ppi.js").Ppi} Ppi @typedef {import("./placement.js").Point} Point */

/** @param {Ppi} ppi */
export function drawMarks(ppi) {
  const { marks: c, bins, look } = ppi;
  const { placement } = bins;
  c.setTransform(ppi.density, 0, 0, ppi.density, 0, 0);
  c.clearRect(0, 0, ppi.width, ppi.height);
  c.font = FONT;
  c.textBaseline = "middle";
  const antenna = ppi.toScreen(0, 0);
  if (bins.scan && bins.scanRow >= 0) {
    const bearing = placement.start_deg + (bins.scanRow + 0.5) * placement.width_deg;
    stroke(c, "rgba(214, 255, 226, 0.75)", [ppi.screenOf(bearing, placement.r0_m), ppi.screenOf(bearing, placement.rMax_m)]);
  }
  headingLine(ppi, c);
  centreLine(ppi, c, antenna);
  drawLines(ppi, c);
  const ends = /** @type {const} */ ([0, 1]).map((k) => crossing(look.lines, k));
  if (ends[0] && ends[1]) {
    c.setLineDash([2, 4]);
    stroke(c, "#c9c9c9", ends.map(({ bearing_deg, slant_m }) => ppi.screenOf(bearing_deg, slant_m)));
    c.setLineDash([]);
  }
  if (ppi.truth) drawTargets(ppi, c, ppi.targets);
  if (look.cursor) drawCursor(ppi, c, look.cursor);
}

/** @param {CanvasRenderingContext2D} c @param {string} colour @param {Point[]} points */
function stroke(c, colour, points) {
  c.strokeStyle = colour;
  c.lineWidth = 1;
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  c.stroke();
}

/**
 * From the antenna to the edge, solid as on ships' displays; only of a radar whose poses have a heading, or that looks all round.
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 */
function headingLine(ppi, c) {
  const { bins: { placement }, heading } = ppi;
  if (heading.heading_deg === null && !placement.isRound) return; // the sector's centre is marked at its edge
  const ahead = heading.ahead_deg(placement);
  stroke(c, "rgba(236, 250, 244, 0.85)", [ppi.look.bscope ? ppi.screenOf(ahead, placement.r0_m) : ppi.toScreen(0, 0), ppi.screenOf(ahead, placement.rMax_m)]);
}

/**
 * Of the sector, with a handle for a controller.
 * @param {Ppi} ppi
 * @param {CanvasRenderingContext2D} c
 * @param {Point} antenna its pixels
 */
function centreLine(ppi, c, antenna) {
  const { placement } = ppi.bins;
  const bearing = ppi.draggedBearing_deg ?? placement.bearing_deg;
  const far = ppi.screenOf(bearing, placement.rMax_m);
  const near = ppi.screenOf(bearing, placement.r0_m + 0.93 * (placement.rMax_m - placement.r0_m));
  stroke(c, "rgba(200, 226, 218, 0.6)", ppi.draggedBearing_deg === undefined ? [near, far] : [antenna, far]);
  ppi.handleAt = far;
  if (!ppi.handle) return;
  const turn = Math.atan2(far[1] - antenna[1], far[0] - antenna[0]);
  c.save();
  c.translate(...far);
  c.rotate(turn);
  c.fillStyle = "#e8f6f0";
  c.beginPath();
  c.moveTo(2, 0);
  c.lineTo(-9, -5);
  c.lineTo(-9, 5);
  c.fill();
  c.restore();
}

/** @param {Ppi} ppi @param {CanvasRenderingContext2D} c @param {import("../look.js").Place} place */
function drawCursor(ppi, c, { east_m, north_m }) {
  const [x, y] = ppi.toScreen(east_m, north_m).map((v) => Math.round(v) + 0.5);
  const parts = [[-16, 0, -5, 0], [5, 0, 16, 0], [0, -16, 0, -5], [0, 5, 0, 16]];
  c.beginPath();
  for (const [x0, y0, x1, y1] of parts) {
    c.moveTo(x + x0, y + y0);
    c.lineTo(x + x1, y + y1);
  }
  [c.strokeStyle, c.lineWidth] = ["rgba(0, 0, 0, 0.6)", 3];
  c.stroke();
  [c.strokeStyle, c.lineWidth] = ["#ffffff", 1];
  c.stroke();
}
