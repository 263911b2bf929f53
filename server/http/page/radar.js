// The tabs Radar and Settings: who controls the radar, its switches and its parameters.

import { Field, refusalText } from "./form.js";
import { ModeSwitch } from "./mode.js";
import { Refused } from "./stream.js";
import { UNIT_M } from "./grid.js";
import { number } from "./messages.js";
import { turned } from "./placement.js";

const $ = (id) => document.getElementById(id);
const isSame = (a_m, b_m) => Math.abs(a_m - b_m) < 20;
const tabs = () => [...document.querySelectorAll("nav [role=tab]")].map(({ id }) => id.slice("tab-".length));
const MOST_EXTENT = 256; // limits of pulse.extent_bins
const C_MPS = 299792458;

/**
 * Settings of another range scale: what would be refused beside it comes along. A range bin that is shorter than the pulse needs more of them
 * to hold it; near echoes begin nearer than the scale ends.
 */
export function scaled(settings, range_m) {
  const change = { r_max_m: range_m };
  if (number(settings.r_min_m) > 0.8 * range_m) change.r_min_m = range_m / 20;
  if (settings.pulse_kind === "RECTANGULAR_PULSE") {
    const bin_m = (range_m - number(change.r_min_m ?? settings.r_min_m)) / number(settings.range_bins, 1);
    const needed = Math.ceil((C_MPS * number(settings.pulse_length_us) * 1e-6) / 2 / bin_m);
    if (needed > number(settings.pulse_extent_bins)) change.pulse_extent_bins = Math.min(MOST_EXTENT, needed);
  }
  return change;
}

function make(tag, text, title) {
  const element = document.createElement(tag);
  element.textContent = text;
  if (title) element.title = element.dataset.title = title;
  return element;
}

export class RadarControls {
  /** @param {import("./main.js").App} app */
  constructor(app) {
    this.app = app;
    /** @type {Field[]} */
    this.fields = [];
    /** Range scales, in metres. @type {number[]} */
    this.scales_m = [];
    this.scaleUnit = "NM";
    document.querySelector("nav").onclick = ({ target }) => target.id.startsWith("tab-") && this.tab(target.id.slice("tab-".length));
    document.querySelector("nav").onkeydown = (event) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!by) return;
      this.nextTab(by);
      $(`tab-${app.tab}`).focus();
    };
    this.#build();
    this.tab(app.tab);
  }

  nextTab(by = 1) {
    const all = tabs();
    this.tab(all.at((all.indexOf(this.app.tab) + by) % all.length));
  }

  tab(name) {
    const all = tabs();
    this.app.tab = all.includes(name) ? name : all[0];
    for (const tab of all) {
      const on = tab === this.app.tab;
      $(tab).hidden = !on;
      $(`tab-${tab}`).setAttribute("aria-selected", String(on));
      $(`tab-${tab}`).tabIndex = on ? 0 : -1;
    }
    this.app.keep();
  }

  #build() {
    const panel = $("radar");
    const { app } = this;
    const row = (name, ...children) => {
      const element = make("div", "");
      element.className = "row";
      const label = make("span", name);
      label.className = "name";
      element.append(label, ...children);
      panel.append(element);
      return element;
    };
    const choice = (...buttons) => {
      const element = make("span", "");
      element.className = "choice";
      element.append(...buttons);
      return element;
    };
    this.holder = make("span", "");
    this.holder.className = "holder";
    this.claim = make("button", "take", "Only one client at a time sets a radar (K)");
    this.claim.id = "claim";
    this.claim.onclick = () => this.toggleControl();
    row("Control", this.holder, this.claim);
    this.transmit = make("button", "standby", "Standby switches the transmitter off (T)");
    this.transmit.id = "transmit";
    this.transmit.onclick = () => this.toggleState("transmit");
    this.freeze = make("button", "freeze", "The radar keeps this pose and these settings (Z)");
    this.freeze.id = "freeze";
    this.freeze.onclick = () => this.toggleState("freeze");
    this.stop = make("button", "freeze all", "All radars stand still for all stations: clock, antenna and noise");
    this.stop.id = "exercise-freeze";
    this.stop.onclick = () => this.attempt(() => app.link.ask("SetExercise", { frozen: !this.info?.exercise_frozen }));
    this.reset = make("button", "reset", "This radar goes back to the scene file's settings, pose and switches");
    this.reset.id = "exercise-reset";
    this.reset.onclick = () => this.attempt(() => app.link.ask("ResetExercise", { radar: this.radar }));
    row("State", choice(this.transmit, this.freeze, this.stop, this.reset));
    this.scales = [];
    this.scaleUnitText = make("span", "NM");
    this.scaleUnitText.className = "unit";
    this.own = make("button", "", "The range that this radar had at first");
    this.own.id = "scale-own";
    this.own.onclick = () => this.scale(this.own_m);
    this.scaleChoice = choice();
    row("Range", this.scaleChoice, this.scaleUnitText, this.own);
    this.mode = new ModeSwitch(app, panel);
    this.general = make("p", "");
    this.general.className = "refusal";
    this.general.setAttribute("role", "alert");
    panel.append(this.general);
    this.quick = make("div", "");
    this.quick.className = "fields";
    panel.append(this.quick);
    this.section = make("select", "", "Section of the scene file");
    this.section.setAttribute("aria-label", "Section of the scene file");
    this.section.onchange = () => this.#fillSection();
    this.all = make("div", "");
    this.all.className = "fields";
    $("setup").append(this.section, this.all);
  }

  /** The server's range scales. @param {number[]} scales @param {"NM"|"km"} unit */
  offer(scales, unit) {
    const scales_m = scales.map((scale) => scale * UNIT_M[unit]);
    if (this.scales_m.join() === scales_m.join() && this.scaleUnit === unit) return;
    [this.scales_m, this.scaleUnit] = [scales_m, unit];
    this.scaleUnitText.textContent = unit;
    this.scales = scales.map((scale, k) => {
      const button = make("button", String(scale), `Range scale of ${scale} ${unit} ([ and ]: smaller, greater)`);
      button.id = `scale-${scale}`;
      button.onclick = () => this.scale(scales_m[k]);
      return button;
    });
    this.scaleChoice.replaceChildren(...this.scales);
    this.app.fillSources();
    this.show();
  }

  /** To the field of the receiver's gain, where this page has control. */
  toGain() {
    const field = this.fields.find(({ parameter }) => parameter.key === "receiver.gain_db");
    if (!field || !this.isMine) return;
    this.tab("radar");
    field.input.focus();
    field.input.select();
  }

  /**
   * The tab Radar gets what an operator turns; the tab Settings all, by section of the scene file.
   * @param {import("./form.js").Parameter[]} table of /parameters.json
   */
  use(table) {
    this.table = table.filter(({ message_field, of_programs }) => message_field && !of_programs);
    this.fields = [];
    const knobs = this.table.filter(({ knob }) => knob);
    const knobOf = (parameter) => this.#field(parameter, parameter.knob);
    this.quick.replaceChildren(...this.mode.use(knobs, knobOf).map((parameter) => knobOf(parameter).element));
    const sections = [...new Set(this.table.map(({ key }) => key.split(".")[0]))];
    this.section.replaceChildren(...sections.map((name) => new Option(name, name)));
    this.#fillSection();
  }

  #field(parameter, name) {
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

  get radar() {
    return this.app.panes[0].radar;
  }
  get info() {
    return this.app.panes[0].info;
  }
  get isMine() {
    return this.holds("SETTINGS_CLAIM") && this.app.link.isLive;
  }
  holds(kind) {
    return Boolean(this.info?.claimed_by_you?.includes(kind));
  }
  /** Another client flies the radar. */
  get isFlown() {
    return Boolean(this.info?.controller) && !this.holds("POSE_CLAIM");
  }

  /**
   * The settings' holder turns the antenna; the radar, or the platform that it rides on, is moved by the holder of its
   * pose: this page, when nobody does.
   * @param {Record<string, any>} pose fields that change
   */
  async pose(pose) {
    const { link } = this.app;
    const { radar } = this;
    const isAim = (field) => this.table?.some(({ aim, message_field }) => aim && message_field === `Pose.${field}`);
    const moves = !Object.keys(pose).every(isAim);
    const borrows = moves && !this.holds("POSE_CLAIM");
    const flown = (moves && this.info?.platform) || radar;
    if (!borrows && this.isFlown && "bearing_deg" in pose) // then it counts from the heading
      pose = { ...pose, bearing_deg: turned(pose.bearing_deg - number(this.info.pose?.heading_deg)) };
    if (borrows) await link.ask("ClaimControl", { radar: flown, kinds: ["POSE_CLAIM"] });
    try {
      await link.ask("SetPose", { radar: flown, pose });
    } finally {
      if (borrows) await link.ask("ReleaseControl", { radar: flown, kinds: ["POSE_CLAIM"] });
    }
  }

  async #set(field, parameter, value) {
    try {
      await this.app.set(parameter.message_field, value);
      field.refuse("");
    } catch (error) {
      field.refuse(error instanceof Refused ? refusalText(error, parameter) : error.message);
    }
  }

  /** Does what may be refused; the refusal stands below the switches. */
  async attempt(what) {
    this.general.textContent = "";
    try {
      await what();
    } catch (error) {
      this.general.textContent = error instanceof Refused ? refusalText(error) : error.message;
      this.tab("radar");
    }
    await this.app.poll();
  }

  toggleControl() {
    const { link } = this.app;
    return this.attempt(async () => {
      if (this.isMine) await link.ask("ReleaseControl", { radar: this.radar });
      else await link.ask("ClaimControl", { radar: this.radar, kinds: ["SETTINGS_CLAIM"],
        ...(this.info?.settings_controller && { force: true }) });
    });
  }

  toggleState(which) {
    const off = which === "transmit" ? { transmit: Boolean(this.info?.transmit_off) } : { freeze: !this.info?.frozen };
    return this.attempt(() => this.app.link.ask("SetState", { radar: this.radar, ...off }));
  }

  /** Rings are in the unit of the scale. */
  scale(range_m) {
    return this.attempt(async () => {
      await this.app.link.ask("SetSettings", { radar: this.radar, settings: scaled(this.info.settings, range_m) });
      this.app.display.set({ unit: this.scales_m.includes(range_m) ? this.scaleUnit : "km" });
    });
  }

  nextScale(by) {
    const now_m = number(this.info?.settings?.r_max_m);
    const scales = [...this.scales_m, ...(this.own_m ? [this.own_m] : [])].sort((a, b) => a - b);
    const found = by > 0 ? scales.find((s) => s > now_m + 20) : scales.findLast((s) => s < now_m - 20);
    return found && this.scale(found);
  }

  /** The range that this page saw first of a radar, where no scale has it; it stays in the tab. */
  get own_m() {
    const now_m = number(this.info?.settings?.r_max_m);
    const key = `obliq.range ${this.app.link.welcome?.scene_name} ${this.radar}`;
    if (now_m && !sessionStorage.getItem(key)) sessionStorage.setItem(key, String(now_m));
    const own_m = Number(sessionStorage.getItem(key));
    return this.scales_m.some((scale_m) => isSame(own_m, scale_m)) ? 0 : own_m;
  }

  show() {
    const { info, app } = this;
    const role = app.link.welcome?.role ?? "";
    const mine = this.isMine;
    const holder = info?.settings_controller ?? "";
    this.holder.textContent = !info ? "" : app.debrief?.state ? "a recording" : mine ? "this page" : holder || "nobody";
    this.holder.title = this.holder.textContent + (this.isFlown ? `; flown by ${info.controller}` : "");
    const why = app.debrief?.state ? "A recording is as it was: nothing of its radars can be set"
      : role === "viewer" ? "You may watch; to set a radar takes a token of a controller"
      : holder && !mine && role !== "admin" ? `${holder} has control; only an admin may take over` : "";
    this.claim.textContent = mine ? "release" : holder ? "take over" : "take control";
    this.claim.disabled = !app.link.isLive || !this.radar || Boolean(why);
    this.claim.title = why || "Only one client at a time sets a radar (K)";
    this.claim.classList.toggle("call", !this.claim.disabled && !mine);
    for (const button of [this.transmit, this.freeze, ...this.scales, this.own]) {
      button.disabled = !mine;
      button.title = mine ? button.dataset.title : why || "Take control first (K)";
    }
    const leads = app.link.isLive && Boolean(info) && !app.debrief?.state && (role === "admin" || (mine && this.holds("POSE_CLAIM")));
    for (const button of [this.stop, this.reset]) {
      button.disabled = !leads;
      button.title = leads ? button.dataset.title : why || "For an admin, or who holds pose and settings";
    }
    this.stop.textContent = info?.exercise_frozen ? "go on" : "freeze all";
    this.stop.setAttribute("aria-pressed", String(Boolean(info?.exercise_frozen)));
    this.transmit.textContent = info?.transmit_off ? "transmit" : "standby";
    this.transmit.setAttribute("aria-pressed", String(Boolean(info?.transmit_off)));
    this.freeze.setAttribute("aria-pressed", String(Boolean(info?.frozen)));
    const { own_m } = this;
    this.own.hidden = !own_m;
    this.own.textContent = `${+(own_m / 1000).toFixed(1)} km`;
    for (const [button, range_m] of [[this.own, own_m], ...this.scales.map((button, k) => [button, this.scales_m[k]])])
      button.setAttribute("aria-pressed", String(isSame(number(info?.settings?.r_max_m), range_m)));
    if (info) for (const field of this.fields) field.show(info, mine);
    this.mode.show(info, mine, why || "Take control first (K)", role === "viewer" || Boolean(app.debrief?.state));
    for (const pane of app.panes) {
      const had = pane.ppi.handle;
      pane.ppi.handle = mine && pane === app.panes[0];
      if (had !== pane.ppi.handle) pane.ppi.needs.marks = true;
    }
  }
}
