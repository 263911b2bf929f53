// What stands still above a picture: rings, bearings, edges of the sector, the antenna, the scale of levels.

import { colourOf } from "./palettes.js";
import { onPlane } from "./table.js";
import { DEGREE, turned } from "./placement.js";

export const UNIT_M = { km: 1000, NM: 1852 };
const LINE = "rgba(206, 240, 230, 0.62)";
const SHADE = "rgba(7, 11, 14, 0.45)";
const EDGE = "rgba(132, 196, 180, 0.55)";
const TEXT = "#b4cec8";
const HALO = "rgba(7, 11, 14, 0.8)";
const FONT = '11px "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace';
const RING_STEP_DEG = 20; // between places of a ring that are worked out: it is a circle to a millionth
const FEWEST_RINGS = 4;
const MOST_RINGS = 6;
const RING_STEPS = [1, 2, 5, 2.5, 4, 3, 1.5, 8, 6]; // times a power of ten, the roundest first

/** Where this drawing has words, for what is written later. @type {import("./ppi.js").Box[]} */
let written = [];

function keepFree(left, right, top, bottom) {
  written.push({ left, right, top, bottom });
}

/** Words that can be read on any picture. */
function write(c, text, x, y) {
  const width = c.measureText(text).width;
  const left = x - { left: 0, center: 0.5, right: 1 }[c.textAlign] * width;
  keepFree(left, left + width, y - 7, y + 7);
  c.strokeStyle = HALO;
  c.lineWidth = 3;
  c.strokeText(text, x, y);
  c.lineWidth = 1;
  c.fillStyle = TEXT;
  c.fillText(text, x, y);
}

/** The step 1, 2 or 5 times a power of ten that gives at most so many. */
export function stepOf(span, most) {
  const power = 10 ** Math.floor(Math.log10(span / most));
  return power * [1, 2, 5, 10].find((k) => span / (power * k) <= most);
}

/** The roundest step that gives four to six rings from one range to another, with the first and last multiple of it. */
export function ringSteps(near, far) {
  const power = 10 ** Math.floor(Math.log10((far - near) / (MOST_RINGS + 1)));
  const rings = RING_STEPS.flatMap((k) => [k * power, 10 * k * power]).map((step) => (
    { step, first: Math.max(1, Math.ceil(near / step - 1e-9)), last: Math.floor(far / step + 1e-9) }));
  const count = ({ first, last }) => last - first + 1;
  return rings.find((one) => count(one) >= FEWEST_RINGS && count(one) <= MOST_RINGS) ?? rings[0];
}

function begin(ppi) {
  const { grid: c } = ppi;
  c.setTransform(ppi.density, 0, 0, ppi.density, 0, 0);
  c.clearRect(0, 0, ppi.width, ppi.height);
  c.font = FONT;
  c.lineWidth = 1;
  c.textBaseline = "middle";
  c.textAlign = "left";
  written = ppi.words = [];
  return c;
}

/** Of a B-scope. @param {import("./ppi.js").Ppi} ppi */
export function drawAxes(ppi) {
  const { look, bins: { placement }, box: { left, right, top, bottom } } = ppi;
  const c = begin(ppi);
  c.strokeStyle = EDGE;
  c.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);
  const unit_m = UNIT_M[look.unit];
  const { step, first, last } = ringSteps(placement.r0_m / unit_m, placement.rMax_m / unit_m);
  ppi.ringStep = { step, first, last, unit: look.unit };
  for (let n = first; n <= last; ++n) {
    const [, y] = ppi.screenOf(placement.start_deg, n * step * unit_m);
    if (look.rings) stroked(c, [[left, y], [right, y]]);
    write(c, `${+(n * step).toPrecision(6)}${n === last ? ` ${look.unit}` : ""}`, right + 4, y);
  }
  const words = [1, 2, 5, 10, 30].find((k) => ((right - left) / placement.sector_deg) * k >= 44) ?? 30;
  c.textAlign = "center";
  for (let n = Math.ceil(placement.start_deg / words - 1e-9); n * words <= placement.start_deg + placement.sector_deg + 1e-9; ++n) {
    const x = left + ((n * words - placement.start_deg) / placement.sector_deg) * (right - left);
    if (look.rings) stroked(c, [[x, top], [x, bottom]]);
    write(c, String(Math.round(turned(n * words))).padStart(3, "0"), x, bottom + 12);
  }
  c.textAlign = "left";
  legend(ppi, c);
}

function stroked(c, points) {
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  for (const [colour, width] of [[SHADE, 3], [LINE, 1]]) {
    [c.strokeStyle, c.lineWidth] = [colour, width];
    c.stroke();
  }
}

/** @param {import("./ppi.js").Ppi} ppi */
export function drawGrid(ppi) {
  const { bins, look } = ppi;
  const { placement } = bins;
  const c = begin(ppi);
  const { sector_deg } = placement;
  if (look.rings) rings(ppi, c, sector_deg);
  if (!placement.isRound) {
    c.strokeStyle = EDGE;
    for (const bearing of [placement.start_deg, placement.start_deg + sector_deg])
      line(ppi, c, bearing, placement.r0_m, placement.rMax_m);
  }
  bearings(ppi, c, sector_deg);
  antenna(ppi, c);
  legend(ppi, c);
}

function line(ppi, c, bearing_deg, from_m, to_m) {
  c.beginPath();
  c.moveTo(...ppi.toScreen(...ppi.placed(bearing_deg, from_m)));
  c.lineTo(...ppi.toScreen(...ppi.placed(bearing_deg, to_m)));
  c.stroke();
}

/** Distance on the plane of a slant range, by bearing: exact every RING_STEP_DEG, between them linear. */
function ringOf(ppi, slant_m, sector_deg) {
  const { start_deg } = ppi.bins.placement;
  const n = Math.max(1, Math.ceil(sector_deg / RING_STEP_DEG));
  const exact = Array.from({ length: n + 1 }, (_, k) => {
    const [e, north] = ppi.placed(start_deg + (k / n) * sector_deg, slant_m);
    return { distance: Math.hypot(e, north), turn: Math.atan2(e, north) - (start_deg + (k / n) * sector_deg) * DEGREE };
  });
  return (part) => {
    const k = Math.min(n - 1, Math.floor(part * n));
    const v = part * n - k;
    const distance = exact[k].distance * (1 - v) + exact[k + 1].distance * v;
    const bearing = (start_deg + part * sector_deg) * DEGREE + exact[k].turn;
    return [distance * Math.sin(bearing), distance * Math.cos(bearing)];
  };
}

/** Of the ranges that the picture shows. */
function ringRange(ppi) {
  const { placement } = ppi.bins;
  const unit_m = UNIT_M[ppi.look.unit];
  const { view } = ppi;
  const corners = [[0, 0], [view.width, 0], [0, view.height], [view.width, view.height]];
  const distances = corners.map(([x, y]) => Math.hypot(...onPlane(view, x, y)));
  const far = Math.min(placement.rMax_m, 1.05 * Math.max(...distances) + (ppi.isSlant ? 0 : placement.y_m));
  const [ax, ay] = ppi.toScreen(0, 0);
  const holdsAntenna = ax > 0 && ay > 0 && ax < ppi.width && ay < ppi.height;
  const near = Math.max(placement.r0_m, holdsAntenna ? 0 : 0.8 * nearest(ppi));
  return { unit_m, ...ringSteps(near / unit_m, far / unit_m) };
}

/** The picture's nearest place to an antenna that is off it. */
function nearest(ppi) {
  const { view } = ppi;
  let least = Infinity;
  for (let k = 0; k <= 8; ++k)
    for (const [x, y] of [[k / 8, 0], [k / 8, 1], [0, k / 8], [1, k / 8]])
      least = Math.min(least, Math.hypot(...onPlane(view, x * view.width, y * view.height)));
  return least;
}

function rings(ppi, c, sector_deg) {
  const { placement } = ppi.bins;
  const { step, unit_m, first, last } = ringRange(ppi);
  ppi.ringStep = { step, first, last, unit: ppi.look.unit };
  const drawn = [];
  const places = []; // of labels
  for (let n = last; n >= first; --n)
    drawn.push([n * step * unit_m, true, `${+(n * step).toPrecision(6)}${n === last ? ` ${ppi.look.unit}` : ""}`]);
  drawn.push([placement.rMax_m, false, ""]);
  if (placement.r0_m > 0) drawn.push([placement.r0_m, false, ""]);
  for (const [slant_m, isRing, text] of drawn) {
    const ring = ringOf(ppi, slant_m, sector_deg);
    const steps = Math.max(24, Math.ceil(sector_deg));
    c.beginPath();
    for (let k = 0; k <= steps; ++k) c.lineTo(...ppi.toScreen(...ring(k / steps)));
    for (const [colour, width] of [[SHADE, 3], [isRing ? LINE : EDGE, 1]]) { // also on bright ground
      [c.strokeStyle, c.lineWidth] = [colour, width];
      c.stroke();
    }
    if (text) ringLabel(ppi, c, ring, text, places);
  }
}

function ringLabel(ppi, c, ring, text, places) {
  const { isRound } = ppi.bins.placement;
  const part = isRound ? turned(ppi.view.up_deg + 95 - ppi.bins.placement.start_deg) / 360 : 1;
  let [x, y] = ppi.toScreen(...ring(part));
  const [x0, y0] = ppi.toScreen(...ring(Math.max(0, part - 0.004)));
  const length = Math.hypot(x - x0, y - y0) || 1;
  if (!isRound) { // beyond the edge of the sector
    x += (12 * (x - x0)) / length;
    y += (12 * (y - y0)) / length;
  }
  const width = c.measureText(text).width;
  const rightwards = x >= x0;
  x = isRound ? x - width - 2 : rightwards ? x - 3 : x - width + 3;
  if (places.some((p) => x < p.end + 4 && p.x < x + width + 4 && Math.abs(p.y - y) < 12)) return; // no room beside its neighbour
  places.push({ x, y, end: x + width });
  write(c, text, x, y);
}

/** Bearings around the sector, or at the picture's border where that is nearer. */
function bearings(ppi, c, sector_deg) {
  const { placement } = ppi.bins;
  const [ax, ay] = ppi.toScreen(0, 0);
  const [rx, ry] = ppi.toScreen(...ppi.placed(placement.start_deg + sector_deg / 2, placement.rMax_m));
  const radius = Math.hypot(rx - ax, ry - ay);
  const perDegree = radius * DEGREE;
  const tick = [1, 2, 5, 10].find((k) => perDegree * k >= 6) ?? 10;
  const words = [1, 2, 5, 10, 30].find((k) => perDegree * k >= 44 && k % tick === 0) ?? 30;
  const first = Math.ceil(placement.start_deg / tick - 1e-9);
  const last = Math.floor((placement.start_deg + sector_deg) / tick + (placement.isRound ? -1e-6 : 1e-9));
  c.textAlign = "center";
  for (let n = first; n <= last; ++n) {
    const bearing = n * tick;
    const isWord = bearing % words === 0;
    const end = borderOf(ppi, ax, ay, ...ppi.toScreen(...ppi.placed(bearing, placement.rMax_m)));
    if (!end) continue;
    const { x, y, dx, dy } = end;
    const long = isWord ? 9 : bearing % 10 === 0 ? 6 : 4;
    c.strokeStyle = isWord ? TEXT : EDGE;
    c.beginPath();
    c.moveTo(x, y);
    c.lineTo(x + long * dx, y + long * dy);
    c.stroke();
    if (isWord) write(c, String(turned(bearing)).padStart(3, "0"), x + 22 * dx, y + 18 * dy);
  }
  c.textAlign = "left";
}

/** The end of a bearing's line on the picture, with the line's direction; null: it is not on it. */
function borderOf(ppi, ax, ay, bx, by) {
  const inset = 34;
  const length = Math.hypot(bx - ax, by - ay);
  if (length < 1) return null;
  const [dx, dy] = [(bx - ax) / length, (by - ay) / length];
  let most = length;
  for (const [p, d, low, high] of [[ax, dx, inset, ppi.width - inset], [ay, dy, inset - 6, ppi.height - inset + 6]]) {
    if (Math.abs(d) > 1e-9) most = Math.min(most, ((d > 0 ? high : low) - p) / d);
    else if (p < low || p > high) return null;
  }
  const [x, y] = [ax + most * dx, ay + most * dy];
  const inside = x > inset - 4 && x < ppi.width - inset + 4 && y > inset - 10 && y < ppi.height - inset + 10;
  return most > 0 && inside ? { x, y, dx, dy } : null;
}

function antenna(ppi, c) {
  const [x, y] = ppi.toScreen(0, 0);
  c.strokeStyle = TEXT;
  c.beginPath();
  c.arc(x, y, 4, 0, 2 * Math.PI);
  c.moveTo(x - 8, y);
  c.lineTo(x + 8, y);
  c.moveTo(x, y - 8);
  c.lineTo(x, y + 8);
  c.stroke();
}

/** A bar with the levels in dB, in the lower corner that the sector leaves free. */
function legend(ppi, c) {
  const height = Math.min(132, ppi.height / 4);
  const width = 9;
  const { placement } = ppi.bins;
  const middle_deg = placement.start_deg + (placement.azimuths * placement.width_deg) / 2 - ppi.view.up_deg;
  const isLeft = !ppi.look.bscope && !placement.isRound && Math.sin(middle_deg * DEGREE) > 0.3;
  const x = isLeft ? 34 : ppi.width - width - 8;
  const y = ppi.height - height - 20;
  for (let k = 0; k < height; ++k) {
    const [r, g, b] = colourOf(ppi.look.palette, Math.round(255 * (1 - k / (height - 1))));
    c.fillStyle = `rgb(${r} ${g} ${b})`;
    c.fillRect(x, y + k, width, 1.5);
  }
  keepFree(x - 30, x + width, y - 20, y + height + 7);
  c.strokeStyle = EDGE;
  c.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
  const { low_dB, span_dB } = ppi.bins.scale;
  const step = stepOf(span_dB, 4);
  c.textAlign = "right";
  for (let dB = Math.ceil(low_dB / step) * step; dB <= low_dB + span_dB + 1e-9; dB += step)
    write(c, String(dB), x - 4, y + height * (1 - (dB - low_dB) / span_dB));
  write(c, ppi.bins.scale.compensated && ppi.bins.mayCompensate ? "dB r²" : "dB", x + width, y - 13);
  c.textAlign = "left";
}
