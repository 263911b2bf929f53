// The A-scope: level over slant range at the cursor's azimuth, or where the beam is.

import { stepOf } from "./grid.js";
import { BOTTOM, INK, LEFT, drawAxes, emptied } from "../plot.js";

const LEAST_SPAN_DB = 20;

export class Scope {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.low = Infinity;
    this.high = -Infinity;
    this.key = "";
  }

  /**
   * @param {import("./bins.js").Bins} bins
   * @param {import("./ppi.js").Look} look
   * @param {{row: number, column: number, slant_m: number}|null} at the cursor's bin
   */
  draw(bins, look, at) {
    const { canvas, context: c } = this;
    const { placement } = bins;
    const room = placement && emptied(canvas, look);
    if (!room) return;
    const [width, height] = room;
    const isCursor = at && at.row >= 0;
    const row = isCursor ? at.row : bins.scanRow >= 0 ? bins.scanRow : Math.floor(placement.azimuths / 2);
    const values = bins.video.subarray(row * placement.ranges, (row + 1) * placement.ranges);
    this.#settle(values, bins);
    const x = (/** @type {number} */ column) => LEFT + (column / placement.ranges) * (width - LEFT - 6);
    const y = (/** @type {number} */ dB) => 4 + (1 - (dB - this.low) / (this.high - this.low)) * (height - BOTTOM - 6);
    const atRange = (/** @type {number} */ slant_m) => x((slant_m - placement.r0_m) / placement.spacing_m);
    drawAxes(c, placement, look, { width, height, x: atRange, y }, { least: this.low, most: this.high, step: this.#step(height), unit: "dB as sent" });
    c.strokeStyle = "#7ee0a4";
    c.lineWidth = 1;
    c.beginPath();
    const floor = height - BOTTOM - 1;
    let isDown = false;
    const each = Math.max(1, Math.floor(placement.ranges / (2 * (width - LEFT)))); // what one half pixel holds: its greatest
    for (let k = 0; k < placement.ranges; k += each) {
      let value = 0;
      for (let j = k; j < k + each && j < placement.ranges; ++j) value = Math.max(value, values[j]);
      const to = value === 0 ? floor : y(bins.floor_dB + (value - 1) * bins.step_dB);
      if (isDown) c.lineTo(x(k + 0.5), to);
      else c.moveTo(x(k + 0.5), to);
      isDown = true;
    }
    c.stroke();
    if (isCursor) {
      c.strokeStyle = "rgba(255, 255, 255, 0.75)";
      c.beginPath();
      c.moveTo(x(at.column + 0.5), 2);
      c.lineTo(x(at.column + 0.5), floor);
      c.stroke();
    }
    const bearing = placement.start_deg + (row + 0.5) * placement.width_deg;
    c.fillStyle = INK;
    c.textAlign = "right";
    c.fillText(`A-scope ${(((bearing % 360) + 360) % 360).toFixed(1).padStart(5, "0")}°`, width - 8, 13);
    c.textAlign = "left";
  }

  /**
   * The axis holds all that was seen of this geometry, in steps of ten.
   * @param {Uint8Array} values
   * @param {import("./bins.js").Bins} bins
   */
  #settle(values, bins) {
    const key = `${bins.floor_dB} ${bins.step_dB} ${bins.placement.key.split(",").slice(0, 6)}`;
    if (key !== this.key) [this.key, this.low, this.high] = [key, Infinity, -Infinity];
    let [least, most] = [255, 0];
    for (const value of values) {
      if (value === 0) continue;
      if (value < least) least = value;
      if (value > most) most = value;
    }
    if (most > 0) {
      this.low = Math.min(this.low, 10 * Math.floor((bins.floor_dB + (least - 1) * bins.step_dB) / 10));
      this.high = Math.max(this.high, 10 * Math.ceil((bins.floor_dB + (most - 1) * bins.step_dB) / 10));
    }
    if (!(this.high > this.low)) [this.low, this.high] = [bins.floor_dB, bins.floor_dB + LEAST_SPAN_DB];
  }

  /** Between lines, so that there are two at least. @param {number} height */
  #step(height) {
    const span = this.high - this.low;
    let most = Math.max(2, Math.floor(height / 26));
    let step = stepOf(span, most);
    while (Math.floor(this.high / step) <= Math.ceil(this.low / step)) step = stepOf(span, ++most);
    return step;
  }
}
