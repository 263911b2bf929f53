// Black level and span of a picture. Each picture has its own: by the radar's receiver, by what is shown, or as they were set.

import { number } from "../messages.js";

const LOOK_MS = 1000; // between looks at what is shown
const SETTLED_DB = 2; // a smaller change of the best levels leaves them
const RECEIVER_SPAN_DB = 60; // as displays of logarithmic receivers have it

/**
 * @typedef {import("./bins.js").Bins} Bins
 * @typedef {import("./table.js").BinTable} BinTable
 * @typedef {import("../../wire.js").FrameDescriptor} FrameDescriptor
 */

/**
 * Whether something of the receiver is on: then levels stay where they are, so that its knobs are seen.
 * @param {FrameDescriptor|null} descriptor
 */
export function hasReceiver(descriptor) {
  const s = descriptor?.settings ?? {};
  return number(descriptor?.noise_power_w) > 0 || /** @type {const} */ (["receiver_gain_db", "stc_range_m", "adc_bits", "ftc_us"]).some((field) => number(s[field]) !== 0);
}

/**
 * Black at the noise before gain and sensitivity time control; null: the radar has no noise.
 * @param {FrameDescriptor|null} descriptor
 */
export function receiverLevels(descriptor) {
  const noise_W = number(descriptor?.noise_power_w);
  if (!(noise_W > 0)) return null;
  const s = descriptor.settings;
  const isScaleAtNoise = s.video_floor_auto || s.range_normalisation; // then the scale begins there
  const low_dB = isScaleAtNoise ? number(descriptor.video_floor_db) : Math.floor(10 * Math.log10(noise_W));
  return { low_dB, span_dB: Math.min(RECEIVER_SPAN_DB, number(s.video_span_db, 100)) };
}

/**
 * Low and high end in dB of what a picture shows, 5th to 99.7th percentile, at least 10 dB, as in ground_map.png.
 * @param {Bins} bins
 * @param {BinTable} table
 * @returns {{low_dB: number, span_dB: number}|null} null: too few echoes
 */
export function bestScale(bins, table) {
  const counts = new Float64Array(1024);
  const every = 7;
  const low = bins.floor_dB + (bins.mayCompensate && bins.scale.compensated ? 40 * Math.log10(Math.max(1, bins.placement.r0_m)) : 0);
  let total = 0;
  for (let k = 0; k < table.size; k += every) {
    const bin = table.bins[k];
    const value = bins.value_dB(bin);
    if (value === null) continue;
    const level = value + bins.compensation_dB(bin % bins.placement.ranges);
    ++counts[Math.max(0, Math.min(1023, Math.round((level - low) * 4)))];
    ++total;
  }
  if (total < 50) return null;
  const at = (/** @type {number} */ part) => {
    let sum = 0;
    const k = counts.findIndex((count) => (sum += count) >= part * total);
    return low + k / 4;
  };
  const black = Math.floor(at(0.05));
  return { low_dB: black, span_dB: Math.max(10, Math.ceil(at(0.997)) - black) };
}

export class Levels {
  /** @param {{low: number, span: number, auto: boolean}} kept auto: not set by hand */
  constructor({ low, span, auto }) {
    this.low_dB = low;
    this.span_dB = span;
    this.auto = auto;
    this.isSettled = false;
    this.looked_ms = 0;
  }

  /** They are to be found anew. */
  unsettle() {
    this.isSettled = false;
  }

  /**
   * Whether no value of the video would be seen: a picture of too few echoes for levels of its own, that makes up for the range no
   * more.
   * @param {Bins} bins
   */
  #misses(bins) {
    return !bins.mayCompensate && bins.floor_dB + 254 * bins.step_dB < this.low_dB;
  }

  /** @param {number} low_dB @param {number} span_dB */
  set(low_dB, span_dB) {
    Object.assign(this, { low_dB, span_dB, auto: false });
  }

  /**
   * The levels that a picture is to have now; null: they stay.
   * @param {Bins} bins
   * @param {BinTable} table
   * @param {number} now_ms
   */
  wanted(bins, table, now_ms) {
    if (!this.auto || (this.isSettled && now_ms - this.looked_ms < LOOK_MS)) return null;
    this.looked_ms = now_ms;
    const own = receiverLevels(bins.descriptor);
    if (!own && this.isSettled && hasReceiver(bins.descriptor)) return null;
    const best = own ?? bestScale(bins, table);
    if (!best) return this.#misses(bins) ? { low_dB: bins.floor_dB, span_dB: 254 * bins.step_dB } : null;
    const off = Math.max(Math.abs(best.low_dB - this.low_dB), Math.abs(best.span_dB - this.span_dB));
    if (this.isSettled && off < (own ? 0.5 : SETTLED_DB)) return null;
    this.isSettled = true;
    return off > 0 ? best : null;
  }
}
