// The tabs Radar and Settings: who controls the radar, its switches and its parameters.

import { $, make } from "./dom.js";
import { Events } from "./events.js";
import { Field, fieldOf } from "./form.js";
import { ModeSwitch } from "./mode.js";
import { refusalText } from "./stream.js";
import { number } from "./messages.js";
import { scaled } from "./scales.js";

const isSame = (/** @type {number} */ a_m, /** @type {number} */ b_m) => Math.abs(a_m - b_m) < 20;

/** @typedef {import("./form.js").Parameter} Parameter */

/**
 * A switch that says why where it cannot be pressed.
 * @param {string} id
 * @param {string} text
 * @param {string} title
 * @param {() => void} onclick
 */
function switchOf(id, text, title, onclick) {
  const button = make("button", { id, textContent: text, title, onclick });
  button.dataset.title = title;
  return button;
}

/** Another range scale was set: its unit. @extends {Events<{scaled: import("./picture/grid.js").Unit}>} */
export class RadarControls extends Events {
  /**
   * @param {object} parts
   * @param {import("./stream.js").Link} parts.link
   * @param {import("./control.js").Control} parts.control
   * @param {import("./pictures.js").Pictures} parts.pictures
   * @param {import("./debrief.js").Debrief} parts.debrief
   * @param {import("./scales.js").RangeScales} parts.scales
   * @param {import("./tabs.js").Tabs} parts.tabs
   */
  constructor({ link, control, pictures, debrief, scales, tabs }) {
    super();
    this.link = link;
    this.control = control;
    this.pictures = pictures;
    this.debrief = debrief;
    this.rangeScales = scales;
    this.tabs = tabs;
    /** What a form may set. @type {Parameter[]} */
    this.table = [];
    /** @type {Field[]} */
    this.fields = [];
    /** Of the range scales. @type {HTMLButtonElement[]} */
    this.scales = [];
    this.#build();
    control.on("refusal", (text) => {
      this.general.textContent = text;
      if (text) tabs.show("radar");
    });
    control.on("taken", (text) => (this.general.textContent = text));
  }

  #build() {
    const panel = $("radar");
    const { control } = this;
    const row = (/** @type {string} */ name, /** @type {HTMLElement[]} */ ...children) =>
      panel.append(make("div", { className: "row" }, make("span", { className: "name" }, name), ...children));
    const choice = (/** @type {HTMLElement[]} */ ...buttons) => make("span", { className: "choice" }, ...buttons);
    this.holder = make("span", { className: "holder" });
    this.claim = switchOf("claim", "take", "Only one client at a time sets a radar (K)", () => control.toggle());
    row("Control", this.holder, this.claim);
    this.transmit = switchOf("transmit", "standby", "Standby switches the transmitter off (T)", () => control.toggleState("transmit"));
    this.freeze = switchOf("freeze", "freeze", "The radar keeps this pose and these settings (Z)", () => control.toggleState("freeze"));
    this.stop = switchOf("exercise-freeze", "freeze all", "All radars stand still for all stations: clock, antenna and noise", () => control.toggleExercise());
    this.reset = switchOf("exercise-reset", "reset", "This radar goes back to the scene file's settings, pose and switches", () => control.reset());
    row("State", choice(this.transmit, this.freeze, this.stop, this.reset));
    this.scaleUnitText = make("span", { className: "unit" }, "NM");
    this.own = switchOf("scale-own", "", "The range that this radar had at first", () => this.scale(this.own_m));
    this.scaleChoice = choice();
    row("Range", this.scaleChoice, this.scaleUnitText, this.own);
    this.mode = new ModeSwitch(panel, (messageField, value) => control.set(messageField, value));
    this.general = make("p", { className: "refusal" });
    this.general.setAttribute("role", "alert");
    this.quick = make("div", { className: "fields" });
    panel.append(this.general, this.quick);
    this.section = make("select", { title: "Section of the scene file" });
    this.section.setAttribute("aria-label", "Section of the scene file");
    this.section.onchange = () => this.#fillSection();
    this.all = make("div", { className: "fields" });
    $("setup").append(this.section, this.all);
  }

  /** The server offers other range scales. @param {import("./stream.js").Scales} offered */
  offer({ scales, unit }) {
    this.scaleUnitText.textContent = unit;
    this.scales = scales.map((scale, k) => switchOf(`scale-${scale}`, String(scale), `Range scale of ${scale} ${unit} ([ and ]: smaller, greater)`,
      () => this.scale(this.rangeScales.metres[k])));
    this.scaleChoice.replaceChildren(...this.scales);
    this.show();
  }

  /** To the field of the receiver's gain, where this page has control. */
  toGain() {
    const field = this.fields.find(({ parameter }) => parameter.key === "receiver.gain_db");
    if (!field || !this.control.isMine) return;
    this.tabs.show("radar");
    field.input.focus();
    if (field.input instanceof HTMLInputElement) field.input.select();
  }

  /**
   * The tab Radar gets what an operator turns; the tab Settings all, by section of the scene file.
   * @param {Parameter[]} table of /parameters.json
   */
  use(table) {
    this.table = table.filter(({ message_field, of_programs }) => message_field && !of_programs);
    this.control.aims = new Set(this.table.filter(({ aim }) => aim).map(fieldOf));
    this.fields = [];
    const knobs = this.table.filter(({ knob }) => knob);
    const knobOf = (/** @type {Parameter} */ parameter) => this.#field(parameter, parameter.knob);
    this.quick.replaceChildren(...this.mode.use(knobs, knobOf).map((parameter) => knobOf(parameter).element));
    const sections = [...new Set(this.table.map(({ key }) => key.split(".")[0]))];
    this.section.replaceChildren(...sections.map((name) => new Option(name, name)));
    this.#fillSection();
  }

  /** @param {Parameter} parameter @param {string} [name] */
  #field(parameter, name) {
    /** @type {Field} */
    const field = new Field(parameter, (p, value) => this.#set(field, p, value), name);
    this.fields.push(field);
    return field;
  }

  #fillSection() {
    this.fields = this.fields.filter(({ element }) => $("radar").contains(element));
    const own = this.table.filter(({ key }) => key.startsWith(`${this.section.value}.`));
    this.all.replaceChildren(...own.map((parameter) => this.#field(parameter).element));
    this.show();
  }

  /** @param {Field} field @param {Parameter} parameter @param {unknown} value */
  async #set(field, parameter, value) {
    try {
      await this.control.set(parameter.message_field, value);
      field.refuse("");
    } catch (error) {
      field.refuse(refusalText(error, parameter.key));
    }
  }

  // ---- Range scales

  /** Rings are in the unit of the scale. @param {number} range_m */
  scale(range_m) {
    const { control, link, rangeScales: { metres, unit } } = this;
    return control.attempt(async () => {
      await link.ask("SetSettings", { radar: control.radar, settings: scaled(control.info.settings, range_m) });
      this.emit("scaled", metres.includes(range_m) ? unit : "km");
    });
  }

  /** @param {number} by 1: the next greater one, -1: the next smaller */
  nextScale(by) {
    const now_m = number(this.control.info?.settings?.r_max_m);
    const { own_m, rangeScales: { metres } } = this;
    const scales = [...metres, ...(own_m ? [own_m] : [])].sort((a, b) => a - b);
    const found = by > 0 ? scales.find((s) => s > now_m + 20) : scales.findLast((s) => s < now_m - 20);
    if (found) this.scale(found);
  }

  /** The range that this page saw first of a radar, where no scale has it; it stays in the tab. */
  get own_m() {
    const { info, radar } = this.control;
    const now_m = number(info?.settings?.r_max_m);
    const key = `obliq.range ${this.link.welcome?.scene_name} ${radar}`;
    if (now_m && !sessionStorage.getItem(key)) sessionStorage.setItem(key, String(now_m));
    const own_m = Number(sessionStorage.getItem(key));
    return this.rangeScales.metres.some((scale_m) => isSame(own_m, scale_m)) ? 0 : own_m;
  }

  // ---- What is shown

  show() {
    const { control, link, debrief } = this;
    const { info, isMine: mine } = control;
    const role = link.welcome?.role ?? "";
    const holder = info?.settings_controller ?? "";
    this.holder.textContent = !info ? "" : debrief.isOn ? "a recording" : mine ? "this page" : holder || "nobody";
    this.holder.title = this.holder.textContent + (control.isFlown ? `; flown by ${info.controller}` : "");
    const why = debrief.isOn ? "A recording is as it was: nothing of its radars can be set"
      : role === "viewer" ? "You may watch; to set a radar takes a token of a controller"
      : holder && !mine && role !== "admin" ? `${holder} has control; only an admin may take over` : "";
    this.claim.textContent = mine ? "release" : holder ? "take over" : "take control";
    this.claim.disabled = !link.isLive || !control.radar || Boolean(why);
    this.claim.title = why || this.claim.dataset.title;
    this.claim.classList.toggle("call", !this.claim.disabled && !mine);
    for (const button of [this.transmit, this.freeze, ...this.scales, this.own]) {
      button.disabled = !mine;
      button.title = mine ? button.dataset.title : why || "Take control first (K)";
    }
    const leads = link.isLive && Boolean(info) && !debrief.isOn && (role === "admin" || (mine && control.holds("POSE_CLAIM")));
    for (const button of [this.stop, this.reset]) {
      button.disabled = !leads;
      button.title = leads ? button.dataset.title : why || "For an admin, or who holds pose and settings";
    }
    this.stop.textContent = info?.exercise_frozen ? "go on" : "freeze all";
    this.stop.setAttribute("aria-pressed", String(Boolean(info?.exercise_frozen)));
    this.transmit.textContent = info?.transmit_off ? "transmit" : "standby";
    this.transmit.setAttribute("aria-pressed", String(Boolean(info?.transmit_off)));
    this.freeze.setAttribute("aria-pressed", String(Boolean(info?.frozen)));
    this.#showScales();
    if (info) for (const field of this.fields) field.show(info, mine);
    const { first, panes } = this.pictures;
    this.mode.show(control.radar, info, first.heading, mine, why || "Take control first (K)", role === "viewer" || debrief.isOn);
    for (const { ppi } of panes) {
      const had = ppi.handle;
      ppi.handle = mine && ppi === first.ppi;
      if (had !== ppi.handle) ppi.needs.marks = true;
    }
  }

  #showScales() {
    const { own_m } = this;
    this.own.hidden = !own_m;
    this.own.textContent = `${+(own_m / 1000).toFixed(1)} km`;
    const now_m = number(this.control.info?.settings?.r_max_m);
    /** @param {HTMLButtonElement} button @param {number} range_m */
    const press = (button, range_m) => button.setAttribute("aria-pressed", String(isSame(now_m, range_m)));
    press(this.own, own_m);
    for (const [k, button] of this.scales.entries()) press(button, this.rangeScales.metres[k]);
  }
}
