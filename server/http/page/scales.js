// Range scales: what beside the range a radar has to change for one.

import { UNIT_M } from "./picture/grid.js";
import { number } from "./messages.js";

const MOST_EXTENT = 256; // limits of pulse.extent_bins
const C_MPS = 299792458;

/**
 * Settings of another range scale: what would be refused beside it comes along. A range bin that is shorter than the pulse needs more of them
 * to hold it; near echoes begin nearer than the scale ends.
 * @param {import("../wire.js").RadarSettings} settings
 * @param {number} range_m
 */
export function scaled(settings, range_m) {
  /** @type {import("../wire.js").RadarSettings} */
  const change = { r_max_m: range_m };
  if (number(settings.r_min_m) > 0.8 * range_m) change.r_min_m = range_m / 20;
  if (settings.pulse_kind === "RECTANGULAR_PULSE") {
    const bin_m = (range_m - number(change.r_min_m ?? settings.r_min_m)) / number(settings.range_bins, 1);
    const needed = Math.ceil((C_MPS * number(settings.pulse_length_us) * 1e-6) / 2 / bin_m);
    if (needed > number(settings.pulse_extent_bins)) change.pulse_extent_bins = Math.min(MOST_EXTENT, needed);
  }
  return change;
}

/** The scales that the server offers. */
export class RangeScales {
  /** @type {number[]} */
  metres = [];
  /** @type {import("./picture/grid.js").Unit} */
  unit = "NM";

  /** @param {import("./stream.js").Scales} offered @returns {boolean} whether they are others */
  take({ scales, unit }) {
    const metres = scales.map((scale) => scale * UNIT_M[unit]);
    if (this.metres.join() === metres.join() && this.unit === unit) return false;
    [this.metres, this.unit] = [metres, unit];
    return true;
  }
}
