// The switch of a radar's mode: map, moving target indicator, map sharpened by Doppler, image of synthetic aperture.

import { number } from "./messages.js";
import { refusalText } from "./form.js";

const C_MPS = 299792458;
const STANDS_MPS = 1; // what is slower does not fly
const KEY = "radar.mode";
const FOR_PROGRAMS = "pulses"; // no display for pulses: programs receive them

/** As pictures say it: "MTI"; of a map nothing. @param {Record<string, any>} settings */
export function modeWord(settings) {
  const word = String(settings?.mode ?? "MAP_MODE").replace(/_MODE$/, "");
  return word === "MAP" ? "" : word;
}

const digits = (value) => String(+value.toPrecision(3));

/** Radial speeds that a canceller takes for ground are multiples of this one: half a wavelength a pulse. */
export const blind_mps = (s) => (C_MPS / (1e9 * number(s.frequency_ghz, 10)) / 2) * number(s.prf_hz, 1000);

/** What each mode does and needs. @type {Record<string, (s: Record<string, any>) => string>} */
const SENTENCES = {
  map: () => "The mean echo of all that the beam sees.",
  mti: (s) => `Cancels what stands still; blind at radial speeds of ${digits(blind_mps(s))} m/s (λ PRF/2) and its multiples; ` +
    "a flying radar needs clutter lock.",
  dbs: (s) => `Sharpens the beam by the Doppler of ${number(s.doppler_pulses, 16)} pulses; needs a beam, and a velocity across it.`,
  sar: (s) => `Makes an image of ${digits(number(s.resolution_m, 3))} m across range; needs whole frames, a sector of at most 10°, ` +
    "and a velocity across the sector's middle.",
  pulses: (s) => `Gives programs ${number(s.doppler_pulses, 16)} pulses a dwell; this picture is the map.`,
};

/** What a mode lacks at this moment; nothing: it works. */
function lack(word, s, { speed_mps }) {
  const flies = speed_mps > STANDS_MPS;
  if (word === "mti" && flies && !s.clutter_lock) return `It flies at ${speed_mps.toFixed(0)} m/s without clutter lock: the ground moves, too.`;
  if (word === "dbs" && !flies) return "It stands: this is the map of the real beam.";
  return "";
}

function make(tag, className, parent) {
  const element = document.createElement(tag);
  element.className = className;
  parent.append(element);
  return element;
}

export class ModeSwitch {
  /**
   * @param {import("./main.js").App} app
   * @param {HTMLElement} panel
   */
  constructor(app, panel) {
    this.app = app;
    this.box = make("div", "mode-switch", panel);
    this.box.hidden = true;
    const row = make("div", "row", this.box);
    make("span", "name", row).textContent = "Mode";
    this.choice = make("span", "choice", row);
    this.choice.setAttribute("role", "radiogroup");
    this.choice.setAttribute("aria-label", "Mode of the radar");
    this.word = make("output", "holder", row); // for clients that may not set it
    this.says = make("p", "hint", this.box);
    this.lacks = make("p", "hint lack", this.box);
    this.refusal = make("p", "refusal", this.box);
    this.refusal.setAttribute("role", "alert");
    this.fields = make("div", "fields", this.box);
    /** @type {HTMLButtonElement[]} */
    this.buttons = [];
  }

  /**
   * @param {import("./form.js").Parameter[]} knobs
   * @param {(parameter: import("./form.js").Parameter) => import("./form.js").Field} fieldOf
   * @returns {import("./form.js").Parameter[]} those that have nothing to do with modes
   */
  use(knobs, fieldOf) {
    this.parameter = knobs.find(({ key }) => key === KEY);
    if (!this.parameter) return knobs;
    this.choice.replaceChildren(...this.parameter.limits.one_of.filter((word) => word !== FOR_PROGRAMS).map((word) => {
      const button = document.createElement("button");
      button.setAttribute("role", "radio");
      button.id = `mode-${word}`;
      button.value = word;
      button.textContent = word === "map" ? word : word.toUpperCase();
      button.onclick = () => this.#choose(word);
      return button;
    }));
    this.buttons = [...this.choice.children];
    this.own = knobs.filter(({ modes }) => modes).map(fieldOf);
    this.fields.replaceChildren(...this.own.map(({ element }) => element));
    return knobs.filter((knob) => knob !== this.parameter && !knob.modes);
  }

  async #choose(word) {
    this.refusal.textContent = "";
    try {
      await this.app.set(this.parameter.message_field, this.parameter.enumerators[word]);
    } catch (error) {
      this.refusal.textContent = refusalText(error, this.parameter);
      this.refusedOf = this.#settingsNow();
    }
  }

  #settingsNow() {
    const { radar, info } = this.app.panes[0];
    return `${radar} ${info?.settings_version}`;
  }

  /**
   * @param {any} info RadarInfo; nothing: not known
   * @param {boolean} mine whether this page may set it now
   * @param {string} why not
   * @param {boolean} never nor ever
   */
  show(info, mine, why, never) {
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
    const put = (element, text) => {
      if (element.textContent !== text) element.textContent = text;
    };
    this.says.dataset.mode = now;
    put(this.says, SENTENCES[now]?.(s) ?? this.parameter.text);
    put(this.lacks, lack(now, s, this.app.panes[0].heading));
    if (this.refusal.textContent && this.refusedOf !== this.#settingsNow()) this.refusal.textContent = ""; // what was refused may now be allowed
    for (const { element, parameter } of this.own) element.hidden = !parameter.modes.includes(now);
  }
}
