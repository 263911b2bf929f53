// The switch of a radar's mode: map, moving target indicator, map sharpened by Doppler, image of synthetic aperture.

import { make, put } from "./dom.js";
import { number } from "./messages.js";
import { refusalText } from "./stream.js";

const C_MPS = 299792458;
const STANDS_MPS = 1; // what is slower does not fly
const KEY = "radar.mode";
const FOR_PROGRAMS = "pulses"; // no display for pulses: programs receive them

/** @typedef {import("../wire.js").RadarSettings} RadarSettings */

/** As pictures say it: "MTI"; of a map nothing. @param {RadarSettings|undefined} settings */
export function modeWord(settings) {
  const word = String(settings?.mode ?? "MAP_MODE").replace(/_MODE$/, "");
  return word === "MAP" ? "" : word;
}

const digits = (/** @type {number} */ value) => String(+value.toPrecision(3));

/**
 * Radial speeds that a canceller takes for ground are multiples of this one: half a wavelength a pulse.
 * @param {RadarSettings} s
 */
export const blind_mps = (s) => (C_MPS / (1e9 * number(s.frequency_ghz, 10)) / 2) * number(s.prf_hz, 1000);

/** What each mode does and needs. @type {Record<string, (s: RadarSettings) => string>} */
const SENTENCES = {
  map: () => "The mean echo of all that the beam sees.",
  mti: (s) => `Cancels what stands still; blind at radial speeds of ${digits(blind_mps(s))} m/s (λ PRF/2) and its multiples; ` +
    "a flying radar needs clutter lock.",
  dbs: (s) => `Sharpens the beam by the Doppler of ${number(s.doppler_pulses, 16)} pulses; needs a beam, and a velocity across it.`,
  sar: (s) => `Makes an image of ${digits(number(s.resolution_m, 3))} m across range; needs whole frames, a sector of at most 10°, ` +
    "and a velocity across the sector's middle.",
  pulses: (s) => `Gives programs ${number(s.doppler_pulses, 16)} pulses a dwell; this picture is the map.`,
};

/**
 * What a mode lacks at this moment; nothing: it works.
 * @param {string} word
 * @param {RadarSettings} s
 * @param {{speed_mps: number}} heading
 */
function lack(word, s, { speed_mps }) {
  const flies = speed_mps > STANDS_MPS;
  if (word === "mti" && flies && !s.clutter_lock) return `It flies at ${speed_mps.toFixed(0)} m/s without clutter lock: the ground moves, too.`;
  if (word === "dbs" && !flies) return "It stands: this is the map of the real beam.";
  return "";
}

export class ModeSwitch {
  /**
   * @param {HTMLElement} panel
   * @param {(messageField: string, value: string) => Promise<void>} set may be refused
   */
  constructor(panel, set) {
    this.set = set;
    this.choice = make("span", { className: "choice" });
    this.choice.setAttribute("role", "radiogroup");
    this.choice.setAttribute("aria-label", "Mode of the radar");
    this.word = make("output", { className: "holder" }); // for clients that may not set it
    this.says = make("p", { className: "hint" });
    this.lacks = make("p", { className: "hint lack" });
    this.refusal = make("p", { className: "refusal" });
    this.refusal.setAttribute("role", "alert");
    this.fields = make("div", { className: "fields" });
    const row = make("div", { className: "row" }, make("span", { className: "name" }, "Mode"), this.choice, this.word);
    this.box = make("div", { className: "mode-switch", hidden: true }, row, this.says, this.lacks, this.refusal, this.fields);
    panel.append(this.box);
    /** @type {HTMLButtonElement[]} */
    this.buttons = [];
    /** @type {import("./form.js").Parameter|undefined} */
    this.parameter = undefined;
    /** Fields of single modes. @type {import("./form.js").Field[]} */
    this.own = [];
    this.setNow = ""; // the radar and its settings as they are shown
    this.refusedOf = ""; // those that a mode was refused for
  }

  /**
   * @param {import("./form.js").Parameter[]} knobs
   * @param {(parameter: import("./form.js").Parameter) => import("./form.js").Field} fieldOf
   * @returns {import("./form.js").Parameter[]} those that have nothing to do with modes
   */
  use(knobs, fieldOf) {
    this.parameter = knobs.find(({ key }) => key === KEY);
    if (!this.parameter) return knobs;
    this.buttons = this.parameter.limits.one_of.filter((word) => word !== FOR_PROGRAMS).map((word) => {
      const button = make("button", { id: `mode-${word}`, value: word, textContent: word === "map" ? word : word.toUpperCase(),
        onclick: () => this.#choose(word) });
      button.setAttribute("role", "radio");
      return button;
    });
    this.choice.replaceChildren(...this.buttons);
    this.own = knobs.filter(({ modes }) => modes).map(fieldOf);
    this.fields.replaceChildren(...this.own.map(({ element }) => element));
    return knobs.filter((knob) => knob !== this.parameter && !knob.modes);
  }

  /** @param {string} word */
  async #choose(word) {
    this.refusal.textContent = "";
    try {
      await this.set(this.parameter.message_field, this.parameter.enumerators[word]);
    } catch (error) {
      this.refusal.textContent = refusalText(error, this.parameter.key);
      this.refusedOf = this.setNow;
    }
  }

  /**
   * @param {string} radar
   * @param {import("../wire.js").RadarInfo|null} info null: not known
   * @param {{speed_mps: number}} heading
   * @param {boolean} mine whether this page may set it now
   * @param {string} why not
   * @param {boolean} never nor ever
   */
  show(radar, info, heading, mine, why, never) {
    this.setNow = `${radar} ${info?.settings_version}`;
    this.box.hidden = !info || !this.parameter;
    if (this.box.hidden) return;
    const s = info.settings ?? {};
    const now = (modeWord(s) || "map").toLowerCase();
    this.choice.hidden = never;
    this.word.hidden = !never;
    this.word.textContent = modeWord(s) || "map";
    for (const button of this.buttons) {
      button.setAttribute("aria-checked", String(button.value === now));
      button.disabled = !mine;
      button.title = mine ? SENTENCES[button.value]?.(s) ?? this.parameter.text : why;
    }
    this.says.dataset.mode = now;
    put(this.says, SENTENCES[now]?.(s) ?? this.parameter.text);
    put(this.lacks, lack(now, s, heading));
    if (this.refusal.textContent && this.refusedOf !== this.setNow) this.refusal.textContent = ""; // what was refused may now be allowed
    for (const { element, parameter } of this.own) element.hidden = !parameter.modes.includes(now);
  }
}
