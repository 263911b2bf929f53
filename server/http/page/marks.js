// What moves above a picture: scan line, centre bearing, cursor, markers.

import { DEGREE, turned } from "./placement.js";

const MARKER_COLOURS = ["#ffd166", "#7cc7ff"];
const FONT = '11px "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace';

/** @param {import("./ppi.js").Ppi} ppi */
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
    stroke(c, "rgba(214, 255, 226, 0.75)", [ppi.toScreen(...ppi.placed(bearing, placement.r0_m)),
      ppi.toScreen(...ppi.placed(bearing, placement.rMax_m))]);
  }
  centreLine(ppi, c, antenna);
  look.markers.forEach((marker, k) => {
    if (marker) drawMarker(ppi, c, antenna, marker, k);
  });
  if (look.markers[0] && look.markers[1]) {
    c.setLineDash([2, 4]);
    stroke(c, "#c9c9c9", look.markers.map(({ east_m, north_m }) => ppi.toScreen(east_m, north_m)));
    c.setLineDash([]);
  }
  if (look.cursor) drawCursor(ppi, c, look.cursor);
}

function stroke(c, colour, points) {
  c.strokeStyle = colour;
  c.lineWidth = 1;
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  c.stroke();
}

/** Of the sector, with a handle for a controller. */
function centreLine(ppi, c, antenna) {
  const { placement } = ppi.bins;
  const bearing = ppi.draggedBearing_deg ?? placement.bearing_deg;
  const far = ppi.toScreen(...ppi.placed(bearing, placement.rMax_m));
  const near = ppi.toScreen(...ppi.placed(bearing, placement.r0_m + 0.93 * (placement.rMax_m - placement.r0_m)));
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

function drawMarker(ppi, c, antenna, { east_m, north_m }, k) {
  const [x, y] = ppi.toScreen(east_m, north_m);
  const radius = Math.hypot(x - antenna[0], y - antenna[1]);
  c.strokeStyle = c.fillStyle = MARKER_COLOURS[k];
  c.lineWidth = 1;
  c.setLineDash([5, 4]);
  const along = Math.atan2(y - antenna[1], x - antenna[0]);
  const long = ppi.width + ppi.height;
  c.beginPath();
  c.moveTo(...antenna);
  c.lineTo(antenna[0] + long * Math.cos(along), antenna[1] + long * Math.sin(along));
  c.stroke();
  c.beginPath();
  c.arc(...antenna, radius, 0, 2 * Math.PI);
  c.stroke();
  c.setLineDash([]);
  c.beginPath();
  c.arc(x, y, 6, 0, 2 * Math.PI);
  c.stroke();
  c.fillText(String(k + 1), x + 9, y - 9);
}

function drawCursor(ppi, c, { east_m, north_m }) {
  const [x, y] = ppi.toScreen(east_m, north_m).map((v) => Math.round(v) + 0.5);
  const parts = [[-16, 0, -5, 0], [5, 0, 16, 0], [0, -16, 0, -5], [0, 5, 0, 16]];
  for (const [colour, width] of [["rgba(0, 0, 0, 0.6)", 3], ["#ffffff", 1]]) {
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.beginPath();
    for (const [x0, y0, x1, y1] of parts) {
      c.moveTo(x + x0, y + y0);
      c.lineTo(x + x1, y + y1);
    }
    c.stroke();
  }
}

/** True bearing, in whole and tenths of degrees, of a line on the plane. */
export function lineOf(from, to) {
  const [e, n] = [to.east_m - from.east_m, to.north_m - from.north_m];
  return { distance_m: Math.hypot(e, n), bearing_deg: turned(Math.atan2(e, n) / DEGREE) };
}
