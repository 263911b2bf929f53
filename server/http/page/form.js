// Fields of a radar's parameters: names, limits and help come from /parameters.json, a refusal stands beside its field.

import { make } from "./dom.js";

/** @typedef {{at_least?: number, at_most?: number, above?: number, below?: number, one_of?: string[]}} Limits */
/** @typedef {import("../wire.js").RadarSettings & import("../wire.js").Pose} Message whose fields a form shows */

/**
 * @typedef {object} Parameter of /parameters.json
 * @property {string} key
 * @property {string|null} message_field "RadarSettings.r_max_m"
 * @property {number|string|boolean|number[]} default
 * @property {"number"|"integer"|"boolean"|"choice"|"list of numbers"|"text"} type
 * @property {string} unit
 * @property {Limits} limits
 * @property {string} allowed
 * @property {string} text
 * @property {Record<string, string>} [enumerators] of a choice: what the stream calls each word
 * @property {string} [knob] its name among what an operator turns
 * @property {string[]} [modes] words of radar.mode that it matters to; none: all
 * @property {boolean} [of_programs] nothing for a form
 * @property {boolean} [aim] where the antenna looks
 * @property {boolean} [not_ideal] other than by default, bins are more than an ideal map's echoes
 */

const LIST = "list of numbers";
const TURN_MS = 250; // after the wheel's last step
/** Behind the point, by unit. @type {Record<string, number>} */
const DIGITS = { deg: 2, dB: 1, m: 1 };

/** The field of its message. @param {Parameter} parameter */
export const fieldOf = ({ message_field }) => /** @type {keyof Message} */ (message_field.split(".")[1]);

/** "scan.dwell_bins" in words: "dwell bins". @param {Parameter} parameter */
const nameOf = ({ key, unit }) => {
  const tail = key.slice(key.indexOf(".") + 1);
  const suffix = `_${unit.replace("deg/s", "deg_s").replace("mm/h", "mm_h").toLowerCase()}`;
  return (unit && tail.endsWith(suffix) ? tail.slice(0, -suffix.length) : tail).replaceAll("_", " ");
};

/** What is wrong with a number as it was typed; nothing: it may be sent. @param {Parameter} parameter @param {string} text */
function fault({ type, limits, allowed, unit }, text) {
  const value = text.trim() === "" ? NaN : Number(text);
  const isWrong = !Number.isFinite(value) || (type === "integer" && !Number.isInteger(value)) ||
    value < limits.at_least || value > limits.at_most || value <= limits.above || value >= limits.below;
  return isWrong ? `found ${text.trim() ? `${text} ${unit}`.trim() : "no number"}; allowed: ${allowed}` : "";
}

/** @typedef {Message[keyof Message]} Value of a field */

/** Those of a list: its message has one field. @param {Value} value @returns {import("./messages.js").Numeric[]} */
const numbersIn = (value) => Object.values(value ?? {})[0] ?? [];

/** The word of a choice's value; "" for one that this page does not know. @param {Parameter} parameter @param {Value} value */
const wordOf = ({ enumerators }, value) => Object.keys(enumerators).find((word) => enumerators[word] === value) ?? "";

/** @param {Parameter} parameter @param {Value} value of its field; one that is absent is the default */
export function isDefault(parameter, value) {
  const { type, default: usual } = parameter;
  if (value === undefined) return true;
  if (type === LIST) return String(numbersIn(value)) === String(usual);
  return type === "choice" ? wordOf(parameter, value) === usual : Number(value) === Number(usual);
}

export class Field {
  /**
   * @param {Parameter} parameter
   * @param {(parameter: Parameter, value: unknown) => Promise<void>} send
   * @param {string} [called] its name, where that of the key says too little
   */
  constructor(parameter, send, called) {
    this.parameter = parameter;
    this.send = send;
    this.field = fieldOf(parameter);
    this.isPose = parameter.message_field.startsWith("Pose.");
    this.input = this.#inputOf();
    this.value = make("output", { className: "mono" });
    this.refusal = make("span", { className: "refusal" });
    this.refusal.setAttribute("role", "alert");
    this.element = make("label", { className: "field", title: `${parameter.text} Allowed: ${parameter.allowed}. (${parameter.key})` },
      make("span", { className: "name" }, called ?? nameOf(parameter)), this.input, this.value, make("span", { className: "unit" }, parameter.unit), this.refusal);
    /** @type {Value} */
    this.current = undefined;
    this.turned = false; // and not sent yet
    this.turning = 0;
    this.input.onchange = () => this.#changed();
    this.input.addEventListener("wheel", (event) => !this.input.hidden && event instanceof WheelEvent && this.#turn(event), { passive: false });
  }

  get #isOn() {
    return this.input instanceof HTMLInputElement && this.input.checked;
  }

  #inputOf() {
    const { type, limits, key } = this.parameter;
    if (type === "choice") {
      const select = make("select", { name: key }, ...limits.one_of.map((word) => new Option(word, word)));
      select.dataset.key = key;
      return select;
    }
    const input = make("input", { name: key });
    input.dataset.key = key;
    if (type === "boolean") {
      input.type = "checkbox";
    } else if (type === LIST) {
      input.type = "text";
      input.autocomplete = "off";
    } else {
      input.type = "number";
      input.step = type === "integer" ? "1" : "any";
      input.autocomplete = "off";
      if (limits.at_least !== undefined) input.min = String(limits.at_least);
      if (limits.at_most !== undefined) input.max = String(limits.at_most);
    }
    return input;
  }

  /** @param {import("../wire.js").RadarInfo} info @param {boolean} mayChange */
  show(info, mayChange) {
    const from = /** @type {Message} */ ((this.isPose ? info.pose : info.settings) ?? {});
    this.current = from[this.field];
    this.input.hidden = !mayChange;
    this.value.hidden = mayChange;
    const text = this.#text(this.current);
    this.value.textContent = text;
    this.value.title = this.current === undefined ? "" : String(this.current);
    if (this.turned || (document.activeElement === this.input && this.input.type !== "checkbox")) return;
    if (this.input instanceof HTMLInputElement && this.input.type === "checkbox") this.input.checked = Boolean(this.current);
    else if (this.input.value !== text && !this.refusal.textContent) this.input.value = text;
  }

  /** @param {Value} value */
  #text(value) {
    const { type } = this.parameter;
    if (type === "boolean") return value ? "on" : "off";
    if (type === "choice") return wordOf(this.parameter, value);
    if (type === LIST) return numbersIn(value).join(", ");
    if (value === undefined) return "0";
    return type === "integer" ? String(value) : this.#rounded(Number(value));
  }

  /** As an operator reads it; the title of the value has all digits. @param {number} value */
  #rounded(value) {
    const { unit, key } = this.parameter;
    if (/latitude|longitude/.test(key)) return String(Number(value.toFixed(5)));
    const digits = DIGITS[unit];
    return String(digits === undefined || (value !== 0 && Math.abs(value) < 0.1 ** digits) ? Number(value.toPrecision(6)) : Number(value.toFixed(digits)));
  }

  /**
   * The wheel turns a field that may be changed, by its own steps; what is turned is sent when it stands still.
   * @param {WheelEvent} event
   */
  #turn(event) {
    const { type, limits, unit } = this.parameter;
    if (type !== "number" && type !== "integer") return;
    event.preventDefault();
    const step = type === "integer" || ["dB", "mm/h", "us"].includes(unit) ? 1 : unit === "m" ? 100 : unit.startsWith("deg") ? 0.5 : 0.1;
    const now = Number(this.input.value) - Math.sign(event.deltaY) * step;
    const least = limits.at_least ?? limits.above ?? -Infinity;
    this.input.value = this.#rounded(Math.min(limits.at_most ?? limits.below ?? Infinity, Math.max(least, now)));
    this.turned = true;
    clearTimeout(this.turning);
    this.turning = setTimeout(() => {
      this.turned = false;
      this.#changed();
    }, TURN_MS);
  }

  async #changed() {
    const { type, enumerators } = this.parameter;
    const text = this.input.value;
    if (type === "boolean") return this.send(this.parameter, this.#isOn);
    if (type === "choice") return text && this.send(this.parameter, enumerators[text]);
    const words = type === LIST ? text.split(/[\s,;]+/).filter(Boolean) : [text];
    this.refuse(words.map((word) => fault(this.parameter, word)).find(Boolean) ?? "");
    if (this.refusal.textContent) return;
    if (type === LIST) return this.send(this.parameter, { tilt_deg: words.map(Number) });
    // 64 bits go as text, which is exact.
    await this.send(this.parameter, type === "integer" && /^-?\d+$/.test(text) ? text : Number(text));
  }

  /** @param {string} text nothing: it was accepted */
  refuse(text) {
    this.refusal.textContent = text;
    this.element.classList.toggle("refused", text !== "");
  }
}
