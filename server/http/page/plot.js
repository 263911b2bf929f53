// What the A-scope and the profile share: a canvas as fine as the screen, and axes of a value over slant range.

import { UNIT_M, stepOf } from "./picture/grid.js";

const FONT = '11px "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace';
export const INK = "#a9c4be";
export const LEFT = 42; // of the values' numbers
export const BOTTOM = 16; // of the ranges'

/**
 * Makes a canvas as fine as the screen, and empties it.
 * @param {HTMLCanvasElement} canvas
 * @param {import("./picture/ppi.js").Look} look
 * @returns {[number, number]|null} width and height; null: there is no room to draw
 */
export function emptied(canvas, look) {
  const [width, height] = [canvas.clientWidth / look.px, canvas.clientHeight / look.px];
  if (width < 40 || height < 20) return null;
  const density = Math.min(devicePixelRatio || 1, 2) * look.px;
  const [w, h] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const c = canvas.getContext("2d");
  c.setTransform(density, 0, 0, density, 0, 0);
  c.clearRect(0, 0, width, height);
  c.font = FONT;
  return [width, height];
}

/**
 * Lines and numbers at every step of a value and of slant range.
 * @param {CanvasRenderingContext2D} c
 * @param {import("./picture/placement.js").Placement} placement
 * @param {import("./picture/ppi.js").Look} look
 * @param {{width: number, height: number, x: (slant_m: number) => number, y: (value: number) => number}} plot
 * @param {{least: number, most: number, step: number, unit: string}} values
 */
export function drawAxes(c, placement, look, { width, height, x, y }, { least, most, step, unit }) {
  c.strokeStyle = "rgba(132, 196, 180, 0.18)";
  c.fillStyle = INK;
  c.lineWidth = 1;
  c.beginPath();
  c.textAlign = "right";
  c.textBaseline = "middle";
  for (let value = Math.ceil(least / step) * step; value <= most; value += step) {
    c.moveTo(LEFT, y(value));
    c.lineTo(width - 6, y(value));
    c.fillText(String(value), LEFT - 5, Math.max(7, y(value)));
  }
  c.textAlign = "center";
  c.textBaseline = "alphabetic";
  const unit_m = UNIT_M[look.unit];
  const each = stepOf((placement.rMax_m - placement.r0_m) / unit_m, Math.max(2, Math.floor(width / 90)));
  for (let n = Math.ceil(placement.r0_m / unit_m / each); n * each * unit_m <= placement.rMax_m; ++n) {
    const at = x(n * each * unit_m);
    c.moveTo(at, 2);
    c.lineTo(at, height - BOTTOM);
    if (at < width - 20) c.fillText(String(+(n * each).toFixed(3)), at, height - 4);
  }
  c.stroke();
  c.textAlign = "left";
  c.fillText(look.unit, 4, height - 4);
  c.fillText(unit, LEFT + 4, 13);
}
