// Numbers beside the picture: cursor, markers, rates and latencies.

import { labelWord } from "./labels.js";
import { STATE_WORDS } from "./palettes.js";
import { UNIT_M } from "./grid.js";
import { turned } from "./placement.js";
import { between, crossing } from "./lines.js";
import { number } from "./messages.js";

const FRAME_SECONDS = 3; // that a rate is counted over
const SCAN_SECONDS = 12; // of passes
const MINUTE_MS = 60000;
const KEPT = 4096; // latencies, for the greatest of late and for benches

export const distanceText = (metres, unit) => `${(metres / UNIT_M[unit]).toFixed(2)} ${unit}`;
export const bearingText = (degrees) => `${(turned(Math.round(degrees * 10) / 10) % 360).toFixed(1).padStart(5, "0")}°`;

/** Degrees and minutes to a tenth, as navigators read them: 43°27.9′N. */
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
    const list = document.getElementById("readout");
    this.values = {};
    for (const [key, name] of ROWS) {
      const term = document.createElement("dt");
      const value = document.createElement("dd");
      term.textContent = name;
      value.dataset.of = key;
      list.append(term, value);
      this.values[key] = value;
    }
  }

  /** @param {import("./main.js").App} app */
  show({ panes: [pane], look, link }) {
    const was = pane.info?.transmit_off || !link.isLive ? "was " : "";
    const at = look.cursor && pane.ppi.read(look.cursor);
    const put = (key, text) => {
      if (this.values[key].textContent !== text) this.values[key].textContent = text;
    };
    put("range", at ? distanceText(at.slant_m, look.unit) : "–");
    put("ground", at ? distanceText(at.ground_m, look.unit) : "–");
    const ahead_deg = pane.heading.heading_deg;
    const relative = at && ahead_deg !== null ? `  ${bearingText(at.bearing_deg - ahead_deg)} R` : "";
    put("bearing", at ? `${bearingText(at.bearing_deg)} T${relative}` : "–");
    put("latitude", at ? minutesText(at.latitude_deg, "N", "S") : "–");
    put("longitude", at ? minutesText(turned(at.longitude_deg + 180) - 180, "E", "W") : "–");
    put("level", !at || at.bin < 0 ? "–" : was + (at.value_dB === null ? "no echo" : `${at.value_dB.toFixed(1)} dB`));
    put("state", !at ? "–" : at.bin < 0 ? "outside" : at.state < 0 ? "–" : look.label ? labelWord(look.label, at.state, pane.bins.descriptor) || "–" : STATE_WORDS[at.state] ?? STATE_WORDS[3]);
    const { lines } = look;
    for (const k of [0, 1]) {
      const parts = [lines.ebl[k] !== null && bearingText(lines.ebl[k]), lines.vrm[k] !== null && distanceText(lines.vrm[k], look.unit)];
      put(`m${k + 1}`, parts.filter(Boolean).join(" ") || "–");
    }
    const ends = pane.bins.placement ? [0, 1].map((k) => crossing(lines, k)) : [];
    const line = ends[0] && ends[1] && between(...ends.map(({ bearing_deg, slant_m }) => pane.ppi.placed(bearing_deg, slant_m)));
    put("m12", line ? `${bearingText(line.bearing_deg)} ${distanceText(line.distance_m, look.unit)}` : "–");
  }
}

/** Counts what came and what was drawn; the first pane's. */
export class Meter {
  constructor() {
    this.received = 0;
    this.drawn = 0;
    /** In ms: from the beam, of each azimuth, where it scans; else from the pose, of each picture. */
    this.latencies = [];
    this.drawTimes = [];
    this.steps_deg = []; // by which the beam moved from picture to picture
    this.past = [{ at_ms: performance.now(), received: 0, drawn: 0 }];
    this.rates = { received: 0, drawn: 0 };
    this.drawn_ms = 0;
    this.losses = [{ at_ms: -Infinity, skipped: 0, missed: 0 }]; // counts so far, as they rose
  }

  /** @param {import("./pane.js").Pane} pane whose new bins were drawn */
  drew(pane, latencies_ms, step_deg) {
    if (pane !== pane.app.panes[0]) return;
    this.drawn_ms = performance.now();
    this.#keep(this.latencies, ...latencies_ms);
    this.#keep(this.drawTimes, pane.ppi.times.draw_ms);
    this.#keep(this.steps_deg, step_deg);
  }
  #keep(list, ...values) {
    list.push(...values);
    if (list.length >= 2 * KEPT) list.splice(0, KEPT);
  }
  frameDrawn(pane) {
    if (pane === pane.app.panes[0]) ++this.drawn;
  }
  frameReceived(pane) {
    if (pane === pane.app.panes[0]) ++this.received;
  }

  #count(now, over) {
    if (now - this.past.at(-1).at_ms < 1000) return;
    while (this.past.length > over) this.past.shift();
    const [then] = this.past;
    for (const key of ["received", "drawn"]) this.rates[key] = (1000 * (this[key] - then[key])) / (now - then.at_ms);
    this.past.push({ at_ms: now, received: this.received, drawn: this.drawn });
  }

  /** Frames that were skipped and dwells that were missed in the last minute. */
  #lately({ skipped, missed }, now) {
    const { losses } = this;
    const newest = losses.at(-1);
    if (newest.skipped !== skipped || newest.missed !== missed) losses.push({ at_ms: now, skipped, missed });
    while (losses.length > 1 && losses[1].at_ms < now - MINUTE_MS) losses.shift();
    return { skipped: skipped - losses[0].skipped, missed: missed - losses[0].missed };
  }

  /** Several times a second, whatever the connection does. */
  show({ panes: [pane], link, look, debrief }) {
    const now = performance.now();
    const { bins } = pane;
    this.#count(now, bins.scan ? SCAN_SECONDS : FRAME_SECONDS);
    let text = "";
    if (bins.newest) {
      const age_s = (now - this.drawn_ms) / 1000;
      const one = (value) => value.toFixed(value < 0.95 ? 2 : value < 9.95 ? 1 : 0);
      const latency = pane.beam_ms ?? pane.latency_ms;
      const isFresh = link.isLive && !look.hold && !pane.info?.transmit_off;
      const pass_s = bins.scan ? bins.placement.sector_deg / number(bins.scan.rate_deg_s, 36) : 0;
      if (link.isLive) text += pass_s ? `scan ${pass_s.toFixed(1)} s · ` : `in ${one(this.rates.received)} drawn ${one(this.rates.drawn)}/s · `;
      if (isFresh && latency !== null && latency < 10000) text += `${bins.scan ? "beam" : "pose"} ${Math.round(latency)} ms · `;
      text += debrief?.state?.paused ? "recorded" : `age ${age_s.toFixed(1)} s`;
      const lately = this.#lately(bins, now);
      if (lately.skipped) text += ` · skipped ${lately.skipped}`;
      if (lately.missed) text += ` · missed ${lately.missed}`;
    }
    const element = document.getElementById("meters");
    if (element.textContent !== text) element.textContent = text;
  }
}
