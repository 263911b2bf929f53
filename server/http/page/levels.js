// Black level and span of a picture. Each picture has its own: by the radar's receiver, by what is shown, or as they were set.

import { number } from "./messages.js";

const LOOK_MS = 1000; // between looks at what is shown
const SETTLED_DB = 2; // a smaller change of the best levels leaves them
const RECEIVER_SPAN_DB = 60; // as displays of logarithmic receivers have it

/** Whether something of the receiver is on: then levels stay where they are, so that its knobs are seen. */
export function hasReceiver(descriptor) {
  const s = descriptor?.settings ?? {};
  return number(descriptor?.noise_power_w) > 0 || ["receiver_gain_db", "stc_range_m", "adc_bits", "ftc_us"].some((field) => number(s[field]) !== 0);
}

/** Black at the noise before gain and sensitivity time control; null: the radar has no noise. */
export function receiverLevels(descriptor) {
  const noise_W = number(descriptor?.noise_power_w);
  if (!(noise_W > 0)) return null;
  const s = descriptor.settings;
  const isScaleAtNoise = s.video_floor_auto || s.range_normalisation; // then the scale begins there
  const low_dB = isScaleAtNoise ? number(descriptor.video_floor_db) : Math.floor(10 * Math.log10(noise_W));
  return { low_dB, span_dB: Math.min(RECEIVER_SPAN_DB, number(s.video_span_db, 100)) };
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

  /** Whether no value of the video would be seen: a picture of too few echoes for levels of its own, that makes up for the range no more. */
  #misses(bins) {
    return !bins.mayCompensate && bins.floor_dB + 254 * bins.step_dB < this.low_dB;
  }

  set(low_dB, span_dB) {
    Object.assign(this, { low_dB, span_dB, auto: false });
  }

  /**
   * The levels that a picture is to have now; null: they stay.
   * @param {import("./bins.js").Bins} bins
   * @param {import("./table.js").BinTable} table
   */
  wanted(bins, table, now_ms) {
    if (!this.auto || (this.isSettled && now_ms - this.looked_ms < LOOK_MS)) return null;
    this.looked_ms = now_ms;
    const own = receiverLevels(bins.descriptor);
    if (!own && this.isSettled && hasReceiver(bins.descriptor)) return null;
    const best = own ?? bins.bestScale(table);
    if (!best) return this.#misses(bins) ? { low_dB: bins.floor_dB, span_dB: 254 * bins.step_dB } : null;
    const off = Math.max(Math.abs(best.low_dB - this.low_dB), Math.abs(best.span_dB - this.span_dB));
    if (this.isSettled && off < (own ? 0.5 : SETTLED_DB)) return null;
    this.isSettled = true;
    return off > 0 ? best : null;
  }
}
