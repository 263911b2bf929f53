// Numbers beside the picture: cursor, markers, rates and latencies.

import { $, make, put } from "./dom.js";
import { labelWord } from "./labels.js";
import { STATE_WORDS } from "./picture/palettes.js";
import { UNIT_M } from "./picture/grid.js";
import { turned } from "./picture/placement.js";
import { between, crossing } from "./picture/lines.js";
import { number } from "./messages.js";

const FRAME_SECONDS = 3; // that a rate is counted over
const SCAN_SECONDS = 12; // of passes
const MINUTE_MS = 60000;
const KEPT = 4096; // latencies, for the greatest of late and for benches

/** @param {number} metres @param {import("./picture/grid.js").Unit} unit */
export const distanceText = (metres, unit) => `${(metres / UNIT_M[unit]).toFixed(2)} ${unit}`;
export const bearingText = (/** @type {number} */ degrees) => `${(turned(Math.round(degrees * 10) / 10) % 360).toFixed(1).padStart(5, "0")}°`;

/**
 * Degrees and minutes to a tenth, as navigators read them: 43°27.9′N.
 * @param {number} degrees
 * @param {string} positive
 * @param {string} negative
 */
export function minutesText(degrees, positive, negative) {
  const tenths = Math.round(Math.abs(degrees) * 600);
  const minutes = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
  return `${String(Math.floor(tenths / 600)).padStart(positive === "E" ? 3 : 2, "0")}°${minutes}′${degrees < 0 ? negative : positive}`;
}

/** @type {[string, string][]} */
const ROWS = [["range", "Range"], ["ground", "Ground"], ["bearing", "Bearing"], ["latitude", "Lat"], ["longitude", "Lon"],
  ["level", "Level"], ["state", "State"], ["m1", "EBL VRM 1"], ["m2", "EBL VRM 2"], ["m12", "1 to 2"]];

export class Readout {
  constructor() {
    /** @type {Record<string, HTMLElement>} */
    this.values = {};
    for (const [key, name] of ROWS) {
      this.values[key] = make("dd");
      this.values[key].dataset.of = key;
      $("readout").append(make("dt", {}, name), this.values[key]);
    }
  }

  /** @param {import("./picture/pane.js").Pane} pane @param {import("./look.js").Look} look @param {boolean} isLive */
  show(pane, look, isLive) {
    const was = pane.info?.transmit_off || !isLive ? "was " : "";
    const at = look.cursor && pane.ppi.read(look.cursor);
    const say = (/** @type {string} */ key, /** @type {string} */ text) => put(this.values[key], text);
    say("range", at ? distanceText(at.slant_m, look.unit) : "–");
    say("ground", at ? distanceText(at.ground_m, look.unit) : "–");
    const ahead_deg = pane.heading.heading_deg;
    const relative = at && ahead_deg !== null ? `  ${bearingText(at.bearing_deg - ahead_deg)} R` : "";
    say("bearing", at ? `${bearingText(at.bearing_deg)} T${relative}` : "–");
    say("latitude", at ? minutesText(at.latitude_deg, "N", "S") : "–");
    say("longitude", at ? minutesText(turned(at.longitude_deg + 180) - 180, "E", "W") : "–");
    say("level", !at || at.bin < 0 ? "–" : was + (at.value_dB === null ? "no echo" : `${at.value_dB.toFixed(1)} dB`));
    const state = !at || at.state < 0 ? "" : look.label ? labelWord(look.label, at.state, pane.bins.descriptor) : STATE_WORDS[at.state] ?? STATE_WORDS[3];
    say("state", at && at.bin < 0 ? "outside" : state || "–");
    const { lines } = look;
    for (const k of /** @type {const} */ ([0, 1])) {
      const parts = [lines.ebl[k] !== null && bearingText(lines.ebl[k]), lines.vrm[k] !== null && distanceText(lines.vrm[k], look.unit)];
      say(`m${k + 1}`, parts.filter(Boolean).join(" ") || "–");
    }
    const ends = pane.bins.placement ? /** @type {const} */ ([0, 1]).map((k) => crossing(lines, k)) : [];
    const line = ends[0] && ends[1] && between(pane.ppi.placed(ends[0].bearing_deg, ends[0].slant_m), pane.ppi.placed(ends[1].bearing_deg, ends[1].slant_m));
    say("m12", line ? `${bearingText(line.bearing_deg)} ${distanceText(line.distance_m, look.unit)}` : "–");
  }
}

/** Counts what came and what was drawn of the first picture. */
export class Meter {
  constructor() {
    this.received = 0;
    this.drawn = 0;
    /** In ms: from the beam, of each azimuth, where it scans; else from the pose, of each picture. */
    this.latencies = /** @type {number[]} */ ([]);
    this.drawTimes = /** @type {number[]} */ ([]);
    /** By which the beam moved from picture to picture. */
    this.steps_deg = /** @type {number[]} */ ([]);
    this.past = [{ at_ms: performance.now(), received: 0, drawn: 0 }];
    this.rates = { received: 0, drawn: 0 };
    this.drawn_ms = 0;
    this.losses = [{ at_ms: -Infinity, skipped: 0, missed: 0 }]; // counts so far, as they rose
  }

  /** New bins were drawn. @param {{latencies_ms: number[], step_deg: number, draw_ms: number}} drawn */
  drew({ latencies_ms, step_deg, draw_ms }) {
    this.drawn_ms = performance.now();
    this.#keep(this.latencies, ...latencies_ms);
    this.#keep(this.drawTimes, draw_ms);
    this.#keep(this.steps_deg, step_deg);
  }
  /** @param {number[]} list @param {number[]} values */
  #keep(list, ...values) {
    list.push(...values);
    if (list.length >= 2 * KEPT) list.splice(0, KEPT);
  }
  frameDrawn() {
    ++this.drawn;
  }
  frameReceived() {
    ++this.received;
  }

  /** @param {number} now @param {number} over seconds that a rate is counted over */
  #count(now, over) {
    if (now - this.past.at(-1).at_ms < 1000) return;
    while (this.past.length > over) this.past.shift();
    const [then] = this.past;
    for (const key of /** @type {const} */ (["received", "drawn"])) this.rates[key] = (1000 * (this[key] - then[key])) / (now - then.at_ms);
    this.past.push({ at_ms: now, received: this.received, drawn: this.drawn });
  }

  /**
   * Frames that were skipped and dwells that were missed in the last minute.
   * @param {{skipped: number, missed: number}} counts
   * @param {number} now
   */
  #lately({ skipped, missed }, now) {
    const { losses } = this;
    const newest = losses.at(-1);
    if (newest.skipped !== skipped || newest.missed !== missed) losses.push({ at_ms: now, skipped, missed });
    while (losses.length > 1 && losses[1].at_ms < now - MINUTE_MS) losses.shift();
    return { skipped: skipped - losses[0].skipped, missed: missed - losses[0].missed };
  }

  /**
   * Several times a second, whatever the connection does.
   * @param {import("./picture/pane.js").Pane} pane
   * @param {object} facts
   * @param {boolean} facts.isLive
   * @param {boolean} facts.isHeld
   * @param {boolean} facts.isPaused a recording stands still
   */
  show(pane, { isLive, isHeld, isPaused }) {
    const now = performance.now();
    const { bins } = pane;
    this.#count(now, bins.scan ? SCAN_SECONDS : FRAME_SECONDS);
    let text = "";
    if (bins.newest) {
      const age_s = (now - this.drawn_ms) / 1000;
      const one = (/** @type {number} */ value) => value.toFixed(value < 0.95 ? 2 : value < 9.95 ? 1 : 0);
      const latency = pane.beam_ms ?? pane.latency_ms;
      const isFresh = isLive && !isHeld && !pane.info?.transmit_off;
      const pass_s = bins.scan ? bins.placement.sector_deg / number(bins.scan.rate_deg_s, 36) : 0;
      if (isLive) text += pass_s ? `scan ${pass_s.toFixed(1)} s · ` : `in ${one(this.rates.received)} drawn ${one(this.rates.drawn)}/s · `;
      if (isFresh && latency !== null && latency < 10000) text += `${bins.scan ? "beam" : "pose"} ${Math.round(latency)} ms · `;
      text += isPaused ? "recorded" : `age ${age_s.toFixed(1)} s`;
      const lately = this.#lately(bins, now);
      if (lately.skipped) text += ` · skipped ${lately.skipped}`;
      if (lately.missed) text += ` · missed ${lately.missed}`;
    }
    put($("meters"), text);
  }
}
