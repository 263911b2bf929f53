// The tab Display: what is shown and how; kept in the URL's fragment.

import { PALETTES, STATE_COLOURS, STATE_WORDS, colourOf } from "./palettes.js";

const $ = (id) => document.getElementById(id);

/** @type {Record<string, any>} what the fragment may say, and what holds without it */
export const DEFAULTS = {
  palette: "green", low: -80, span: 50, auto: true, r2: true, glow: -1, up: "north", slant: false, unit: "km",
  rings: true, overlay: false, panes: 1, a: "", b: "", tab: "view", rate: 30,
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
  if (!["north", "bearing"].includes(found.up)) found.up = DEFAULTS.up;
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
    $("low").oninput = () => this.levels(Number($("low").value), look.span_dB);
    $("span").oninput = () => this.levels(look.low_dB, Number($("span").value));
    $("glow").oninput = () => this.set({ afterglow_s: Number($("glow").value), autoGlow: false });
    $("auto").onclick = () => this.set({ auto: !look.auto });
    $("compensated").onclick = () => this.set({ compensated: !look.compensated });
    $("up-north").onclick = () => this.set({ up: "north" });
    $("up-bearing").onclick = () => this.set({ up: "bearing" });
    $("by-ground").onclick = () => this.set({ slant: false });
    $("by-slant").onclick = () => this.set({ slant: true });
    $("rings").onclick = () => this.set({ rings: !look.rings });
    $("unit-km").onclick = () => this.set({ unit: "km" });
    $("unit-nm").onclick = () => this.set({ unit: "NM" });
    $("overlay").onclick = () => this.set({ overlay: !look.overlay });
    $("hold").onclick = () => this.set({ hold: !look.hold });
    $("zoom-out").onclick = () => app.zoom(1 / 1.5);
    $("zoom-in").onclick = () => app.zoom(1.5);
    $("zoom-fit").onclick = () => app.zoom(0);
    $("png").onclick = () => app.save();
    for (const k of [0, 1]) $(`marker-${k + 1}`).onclick = () => app.toggleMarker(k);
    for (const [state, word] of STATE_WORDS.entries()) {
      if (state === 1) continue;
      const item = document.createElement("i");
      item.title = word;
      item.textContent = ["not sampled", "", "shadow", "unknown", "too near"][state];
      const swatch = document.createElement("canvas");
      [swatch.width, swatch.height] = [8, 8];
      const c = swatch.getContext("2d");
      c.fillStyle = `rgb(${STATE_COLOURS[state].join(" ")})`;
      c.fillRect(0, 0, 8, 8);
      item.prepend(swatch);
      $("overlay-legend").append(item);
    }
    this.show();
  }

  levels(low_dB, span_dB) {
    this.set({ auto: false }, false);
    this.app.level(low_dB, span_dB);
    this.show();
    this.app.keep();
  }

  /** @param {Partial<import("./main.js").AppLook>} change */
  set(change, keep = true) {
    this.app.change(change);
    this.show();
    if (keep) this.app.keep();
  }

  next(key, values) {
    const { look } = this.app;
    this.set({ [key]: values[(values.indexOf(look[key]) + 1) % values.length] });
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
    put("low", look.low_dB, `${look.low_dB.toFixed(0)} dB`);
    put("span", look.span_dB, `${look.span_dB.toFixed(0)} dB`);
    put("glow", look.afterglow_s, look.afterglow_s ? `${look.afterglow_s.toFixed(1)} s` : "off");
    press("auto", look.auto);
    const may = panes.some((pane) => pane.bins.mayCompensate);
    $("compensated").disabled = !may;
    press("compensated", may && look.compensated);
    check("up-north", look.up === "north");
    check("up-bearing", look.up === "bearing");
    check("by-ground", !look.slant);
    check("by-slant", look.slant);
    press("rings", look.rings);
    check("unit-km", look.unit === "km");
    check("unit-nm", look.unit === "NM");
    press("overlay", look.overlay);
    $("overlay-legend").hidden = !look.overlay;
    press("hold", look.hold);
    for (const k of [0, 1]) press(`marker-${k + 1}`, look.markers[k] || look.armed === k);
    press("two", panes.length > 1);
  }

  /** The slider's ends follow the video's scale. */
  limits(low_dB, high_dB) {
    const low = $("low");
    if (Number(low.min) === low_dB && Number(low.max) === high_dB) return;
    low.min = String(low_dB);
    low.max = String(high_dB);
    low.value = String(this.app.look.low_dB);
  }
}
