// The tab Display: what is shown and how; kept in the URL's fragment.

import { NOT_YET, PALETTES, STATE_WORDS, colourOf, packed, stateTiles } from "./palettes.js";
import { UPS } from "./heading.js";
import { LABEL_PLANES, labelLegend } from "./labels.js";
import { TRAIL_MINUTES } from "./trails.js";
import { UNIT_M } from "./grid.js";
import { hasReceiver } from "./levels.js";
import { turned } from "./placement.js";

const $ = (id) => document.getElementById(id);

/** @type {Record<string, any>} what the fragment may say, and what holds without it */
export const DEFAULTS = {
  palette: "green", low: -80, span: 50, auto: true, low2: -80, span2: 50, auto2: true, r2: true, glow: -1, up: "auto", slant: false, unit: "km",
  rings: true, overlay: false, label: "", bscope: false, profile: false, size: 1, expert: false, panes: 1, a: "", b: "", tab: "view", rate: 30,
  targets: false, trails: 0, relative: false,
};

export function readFragment() {
  const found = { ...DEFAULTS };
  for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
    const was = DEFAULTS[key];
    if (typeof was === "boolean") found[key] = text === "1";
    else if (typeof was === "number" && Number.isFinite(Number(text))) found[key] = Number(text);
    else if (typeof was === "string") found[key] = text;
  }
  if (!PALETTES.includes(found.palette)) found.palette = DEFAULTS.palette;
  if (!["km", "NM"].includes(found.unit)) found.unit = DEFAULTS.unit;
  if (!LABEL_PLANES.includes(found.label)) found.label = DEFAULTS.label;
  if (!UPS.includes(found.up)) found.up = DEFAULTS.up;
  if (!TRAIL_MINUTES.includes(found.trails)) found.trails = DEFAULTS.trails;
  found.size = Math.min(2, Math.max(0.7, found.size));
  found.rate = Math.max(0.1, found.rate);
  return found;
}

/** @param {Record<string, any>} settings only what differs from DEFAULTS is written */
export function writeFragment(settings) {
  const words = new URLSearchParams();
  for (const [key, value] of Object.entries(settings))
    if (value !== undefined && value !== DEFAULTS[key] && key in DEFAULTS) words.set(key, typeof value === "boolean" ? (value ? "1" : "0") : String(value));
  const text = words.toString();
  if (text !== location.hash.slice(1)) history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
}

export class Display {
  /** @param {import("./main.js").App} app */
  constructor(app) {
    this.app = app;
    const { look } = app;
    for (const name of PALETTES) {
      const button = document.createElement("button");
      button.setAttribute("role", "radio");
      button.title = `Palette ${name} (C: the next one)`;
      button.dataset.palette = name;
      const swatch = document.createElement("canvas");
      [swatch.width, swatch.height] = [34, 10];
      const c = swatch.getContext("2d");
      for (let k = 0; k < 34; ++k) {
        const [r, g, b] = colourOf(name, Math.round((255 * k) / 33));
        c.fillStyle = `rgb(${r} ${g} ${b})`;
        c.fillRect(k, 0, 1, 10);
      }
      button.setAttribute("aria-label", name);
      button.append(swatch);
      button.onclick = () => this.set({ palette: name });
      $("palette").append(button);
    }
    $("low").oninput = () => app.level(Number($("low").value), app.active.levels.span_dB);
    $("span").oninput = () => app.level(app.active.levels.low_dB, Number($("span").value));
    $("glow").oninput = () => this.set({ afterglow_s: Number($("glow").value), autoGlow: false });
    $("auto").onclick = () => app.active.levelOnce();
    $("usual").onclick = () => this.usual();
    $("compensated").onclick = () => this.set({ compensated: !look.compensated });
    for (const up of UPS) $(`up-${up}`).onclick = () => this.set({ up });
    $("size").onchange = () => this.set({ size: Number($("size").value) });
    $("expert").onchange = () => {
      app.kept.expert = $("expert").checked;
      app.fillSources();
      app.keep();
    };
    $("profile").onclick = () => this.set({ profile: !look.profile });
    $("bscope").onclick = () => this.set({ bscope: !look.bscope });
    $("trails").append(...TRAIL_MINUTES.map((minutes) => new Option(minutes ? `${minutes} min` : "off", String(minutes))));
    $("trails").onchange = () => this.set({ trails: Number($("trails").value) });
    $("trails-true").onclick = () => this.set({ relative: false });
    $("trails-relative").onclick = () => this.set({ relative: true });
    $("by-ground").onclick = () => this.set({ slant: false });
    $("by-slant").onclick = () => this.set({ slant: true });
    $("rings").onclick = () => this.set({ rings: !look.rings });
    $("unit-km").onclick = () => this.set({ unit: "km" });
    $("unit-nm").onclick = () => this.set({ unit: "NM" });
    $("overlay").onclick = () => this.set({ overlay: !look.overlay });
    $("label").onchange = () => this.set({ label: $("label").value });
    $("hold").onclick = () => this.set({ hold: !look.hold });
    $("zoom-out").onclick = () => app.zoom(1 / 1.5);
    $("zoom-in").onclick = () => app.zoom(1.5);
    $("zoom-fit").onclick = () => app.zoom(0);
    $("png").onclick = () => app.save();
    for (const k of [0, 1]) {
      for (const kind of ["ebl", "vrm"]) {
        $(`${kind}-${k + 1}`).onclick = () => app.toggleLine([kind, k]);
        $(`${kind}-${k + 1}-at`).onchange = ({ target }) => this.#line(kind, k, target.value);
      }
    }
    const tiles = stateTiles();
    for (const [state, word] of STATE_WORDS.entries()) if (state !== 1) this.#legend(word, ["not sampled", "", "shadow", "unknown", "too near"][state], tiles[state]);
    this.#legend("the beam has not come by yet", "not yet", new Uint32Array(64).fill(packed(NOT_YET)));
    this.show();
  }

  /** @param {Uint32Array} tile 8 x 8 pixels */
  #legend(title, text, tile, to = "overlay-legend") {
    const item = document.createElement("i");
    item.title = title;
    item.textContent = text;
    const swatch = document.createElement("canvas");
    [swatch.width, swatch.height] = [16, 8];
    const c = swatch.getContext("2d");
    const image = new ImageData(new Uint8ClampedArray(tile.buffer.slice(0)), 8, 8);
    for (const x of [0, 8]) c.putImageData(image, x, 0);
    item.prepend(swatch);
    $(to).append(item);
  }

  /** What the colours of a label mean, once its frame has come. */
  #labelLegend() {
    const { label } = this.app.look;
    const legend = labelLegend(label, this.app.panes[0]?.bins.descriptor);
    const key = `${label} ${legend.map(([word]) => word)}`;
    if (this.legendKey === key) return;
    this.legendKey = key;
    $("label-legend").replaceChildren();
    $("label-legend").hidden = !legend.length;
    for (const [word, tile] of legend) this.#legend(word, word, tile, "label-legend");
  }

  /** Levels by the receiver again, or by what is shown. */
  usual() {
    const { active } = this.app;
    active.levels.auto = true;
    active.levels.unsettle();
    if (active.bins.descriptor) active.level(performance.now());
    this.show();
    this.app.keep();
  }

  /** @param {Partial<import("./main.js").AppLook>} change */
  set(change, keep = true) {
    this.app.change(change);
    this.show();
    if (keep) this.app.keep();
  }

  /** A bearing line or range marker by number: degrees, or the unit of ranges; nothing takes it away. */
  #line(kind, k, text) {
    const value = text.trim() === "" ? null : Number(text);
    const isWrong = value !== null && (!Number.isFinite(value) || (kind === "vrm" && value <= 0));
    if (isWrong) return this.show();
    const { lines, unit } = this.app.look;
    const list = lines[kind].map((was, n) => (n !== k ? was : value === null ? null : kind === "ebl" ? turned(value) : value * UNIT_M[unit]));
    this.app.setLines({ ...lines, [kind]: list });
  }

  next(key, values) {
    const { look } = this.app;
    if (key === "up" && look.up === "auto") return this.set({ up: values[(values.indexOf(this.#upNow()) + 1) % values.length] });
    this.set({ [key]: values[(values.indexOf(look[key]) + 1) % values.length] });
  }

  /** What is up on the first picture. */
  #upNow() {
    const [{ bins, heading }] = this.app.panes;
    return bins.placement ? heading.up(this.app.look.up, bins.placement).up : this.app.look.up;
  }

  show() {
    const { look, panes } = this.app;
    const press = (id, on) => $(id).setAttribute("aria-pressed", String(Boolean(on)));
    const check = (id, on) => $(id).setAttribute("aria-checked", String(Boolean(on)));
    for (const button of $("palette").children) button.setAttribute("aria-checked", String(button.dataset.palette === look.palette));
    const put = (id, value, text) => {
      if (Number($(id).value) !== value && document.activeElement !== $(id)) $(id).value = String(value);
      $(`${id}-text`).textContent = text;
    };
    const { bins, levels } = this.app.active;
    this.#limits(bins, levels);
    put("low", levels.low_dB, `${levels.low_dB.toFixed(0)} dB`);
    put("span", levels.span_dB, `${levels.span_dB.toFixed(0)} dB`);
    put("glow", look.afterglow_s, look.afterglow_s ? `${look.afterglow_s.toFixed(1)} s` : "off");
    press("usual", levels.auto);
    $("usual").textContent = hasReceiver(bins.descriptor) ? "receiver" : "follow";
    const may = panes.some((pane) => pane.bins.mayCompensate);
    $("compensated").disabled = !may;
    press("compensated", may && look.compensated);
    const now = this.#upNow();
    for (const up of UPS) check(`up-${up}`, now === up);
    press("bscope", look.bscope);
    press("profile", look.profile);
    $("expert").checked = this.app.kept.expert;
    $("size").value = String(look.size);
    $("trails").value = String(look.trails);
    check("trails-true", !look.relative);
    check("trails-relative", look.relative);
    check("by-ground", !look.slant);
    check("by-slant", look.slant);
    press("rings", look.rings);
    check("unit-km", look.unit === "km");
    check("unit-nm", look.unit === "NM");
    press("overlay", look.overlay);
    $("overlay-legend").hidden = !look.overlay || Boolean(look.label);
    $("label").value = look.label;
    this.#labelLegend();
    press("hold", look.hold);
    for (const k of [0, 1])
      for (const [kind, scale, digits] of [["ebl", 1, 1], ["vrm", UNIT_M[look.unit], 2]]) {
        const value = look.lines[kind][k];
        press(`${kind}-${k + 1}`, value !== null || String(look.armed) === `${kind},${k}`);
        const field = $(`${kind}-${k + 1}-at`);
        const text = value === null ? "" : (value / scale).toFixed(digits);
        if (document.activeElement !== field) field.value = text;
      }
    press("two", panes.length > 1);
  }

  /** The slider's ends follow the video's scale. */
  #limits(bins, { low_dB }) {
    if (!bins.placement) return;
    const least = Math.floor(bins.floor_dB + bins.compensation_dB(0));
    const most = Math.ceil(bins.floor_dB + 254 * bins.step_dB + bins.compensation_dB(bins.placement.ranges - 1));
    const low = $("low");
    if (Number(low.min) === least && Number(low.max) === most) return;
    low.min = String(least);
    low.max = String(most);
    low.value = String(low_dB);
  }
}
