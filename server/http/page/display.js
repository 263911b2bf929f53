// The tab Display: what is shown and how.

import { NOT_YET, PALETTES, STATE_WORDS, colourOf, packed, stateTiles } from "./picture/palettes.js";
import { $, buttonOf, inputOf, make, selectOf } from "./dom.js";
import { Events } from "./events.js";
import { UPS } from "./picture/heading.js";
import { labelLegend } from "./labels.js";
import { TRAIL_MINUTES } from "./picture/trails.js";
import { UNIT_M } from "./picture/grid.js";
import { hasReceiver } from "./picture/levels.js";
import { turned } from "./picture/placement.js";

const STATE_LEGENDS = ["not sampled", "", "shadow", "unknown", "too near"];
/** @template Value @param {Value[]} values @param {Value} value */
const after = (values, value) => values[(values.indexOf(value) + 1) % values.length];
/** @type {["ebl"|"vrm", 0|1][]} */
const LINES = [["ebl", 0], ["vrm", 0], ["ebl", 1], ["vrm", 1]];
const SWATCH = { width: 34, height: 10 };

/** @typedef {import("./look.js").LookValues} LookValues */

/** Something was chosen by hand. @extends {Events<{set: undefined}>} */
export class Display extends Events {
  /**
   * @param {import("./look.js").Look} look
   * @param {import("./pictures.js").Pictures} pictures
   * @param {import("./markers.js").Markers} markers
   */
  constructor(look, pictures, markers) {
    super();
    this.look = look;
    this.pictures = pictures;
    this.markers = markers;
    this.legendKey = "";
    for (const name of PALETTES) $("palette").append(this.#paletteButton(name));
    const low = inputOf("low");
    const span = inputOf("span");
    low.oninput = () => pictures.active.setLevels(Number(low.value), pictures.active.levels.span_dB);
    span.oninput = () => pictures.active.setLevels(pictures.active.levels.low_dB, Number(span.value));
    const glow = inputOf("glow");
    glow.oninput = () => this.set({ afterglow_s: Number(glow.value), autoGlow: false });
    $("auto").onclick = () => pictures.active.levelOnce();
    $("usual").onclick = () => this.usual();
    $("compensated").onclick = () => this.set({ compensated: !look.compensated });
    for (const up of UPS) $(`up-${up}`).onclick = () => this.set({ up });
    const [size, trails, label] = [selectOf("size"), selectOf("trails"), selectOf("label")];
    size.onchange = () => this.set({ size: Number(size.value) });
    $("profile").onclick = () => this.set({ profile: !look.profile });
    $("bscope").onclick = () => this.set({ bscope: !look.bscope });
    trails.append(...TRAIL_MINUTES.map((minutes) => new Option(minutes ? `${minutes} min` : "off", String(minutes))));
    trails.onchange = () => this.set({ trails: Number(trails.value) });
    $("trails-true").onclick = () => this.set({ relative: false });
    $("trails-relative").onclick = () => this.set({ relative: true });
    $("by-ground").onclick = () => this.set({ slant: false });
    $("by-slant").onclick = () => this.set({ slant: true });
    $("rings").onclick = () => this.set({ rings: !look.rings });
    $("unit-km").onclick = () => this.set({ unit: "km" });
    $("unit-nm").onclick = () => this.set({ unit: "NM" });
    $("overlay").onclick = () => this.set({ overlay: !look.overlay });
    label.onchange = () => this.set({ label: /** @type {import("./labels.js").Label} */ (label.value) });
    $("hold").onclick = () => this.set({ hold: !look.hold });
    $("zoom-out").onclick = () => pictures.zoom(1 / 1.5);
    $("zoom-in").onclick = () => pictures.zoom(1.5);
    $("zoom-fit").onclick = () => pictures.zoom(0);
    for (const [kind, k] of LINES) {
      $(`${kind}-${k + 1}`).onclick = () => markers.toggleLine([kind, k]);
      const at = inputOf(`${kind}-${k + 1}-at`);
      at.onchange = () => this.#line(kind, k, at.value);
    }
    const tiles = stateTiles();
    for (const [state, word] of STATE_WORDS.entries()) if (state !== 1) this.#legend(word, STATE_LEGENDS[state], tiles[state]);
    this.#legend("the beam has not come by yet", "not yet", new Uint32Array(64).fill(packed(NOT_YET)));
    this.show();
  }

  /** @param {string} name */
  #paletteButton(name) {
    const { width, height } = SWATCH;
    const swatch = make("canvas", SWATCH);
    const c = swatch.getContext("2d");
    for (let k = 0; k < width; ++k) {
      const [r, g, b] = colourOf(name, Math.round((255 * k) / (width - 1)));
      c.fillStyle = `rgb(${r} ${g} ${b})`;
      c.fillRect(k, 0, 1, height);
    }
    const button = make("button", { title: `Palette ${name} (C: the next one)`, onclick: () => this.set({ palette: name }) }, swatch);
    button.setAttribute("role", "radio");
    button.dataset.palette = name;
    button.setAttribute("aria-label", name);
    return button;
  }

  /** @param {string} title @param {string} text @param {Uint32Array} tile 8 x 8 pixels */
  #legend(title, text, tile, to = "overlay-legend") {
    const swatch = make("canvas", { width: 16, height: 8 });
    const c = swatch.getContext("2d");
    const image = new ImageData(new Uint8ClampedArray(tile.slice().buffer), 8, 8);
    for (const x of [0, 8]) c.putImageData(image, x, 0);
    $(to).append(make("i", { title }, swatch, text));
  }

  /** What the colours of a label mean, once its frame has come. */
  #labelLegend() {
    const { label } = this.look;
    const legend = labelLegend(label, this.pictures.first.bins.descriptor);
    const key = `${label} ${legend.map(([word]) => word)}`;
    if (this.legendKey === key) return;
    this.legendKey = key;
    $("label-legend").replaceChildren();
    $("label-legend").hidden = !legend.length;
    for (const [word, tile] of legend) this.#legend(word, word, tile, "label-legend");
  }

  /** Levels by the receiver again, or by what is shown. */
  usual() {
    const { active } = this.pictures;
    active.levels.auto = true;
    active.levelAnew();
    this.show();
    this.emit("set");
  }

  /** @param {Partial<LookValues>} change */
  set(change) {
    this.look.change(change);
    this.show();
    this.emit("set");
  }

  /**
   * A bearing line or range marker by number: degrees, or the unit of ranges; nothing takes it away.
   * @param {"ebl"|"vrm"} kind
   * @param {0|1} k
   * @param {string} text
   */
  #line(kind, k, text) {
    const value = text.trim() === "" ? null : Number(text);
    const isWrong = value !== null && (!Number.isFinite(value) || (kind === "vrm" && value <= 0));
    if (isWrong) return this.show();
    const { lines, unit } = this.look;
    const list = /** @type {[number|null, number|null]} */ ([...lines[kind]]);
    list[k] = value === null ? null : kind === "ebl" ? turned(value) : value * UNIT_M[unit];
    this.markers.setLines({ ...lines, [kind]: list });
  }

  nextPalette() {
    this.set({ palette: after(PALETTES, this.look.palette) });
  }
  nextUp() {
    this.set({ up: after(UPS, this.#upNow()) });
  }

  /** What is up on the first picture. */
  #upNow() {
    const { bins, heading } = this.pictures.first;
    const { up } = this.look;
    return bins.placement ? heading.up(up, bins.placement).up : up === "auto" ? null : up;
  }

  show() {
    const { look, pictures: { panes } } = this;
    const press = (/** @type {string} */ id, /** @type {boolean} */ on) => $(id).setAttribute("aria-pressed", String(on));
    const check = (/** @type {string} */ id, /** @type {boolean} */ on) => $(id).setAttribute("aria-checked", String(on));
    for (const button of $("palette").querySelectorAll("button")) button.setAttribute("aria-checked", String(button.dataset.palette === look.palette));
    const put = (/** @type {string} */ id, /** @type {number} */ value, /** @type {string} */ text) => {
      const slider = inputOf(id);
      if (Number(slider.value) !== value && document.activeElement !== slider) slider.value = String(value);
      $(`${id}-text`).textContent = text;
    };
    const { bins, levels } = this.pictures.active;
    this.#limits(bins, levels);
    put("low", levels.low_dB, `${levels.low_dB.toFixed(0)} dB`);
    put("span", levels.span_dB, `${levels.span_dB.toFixed(0)} dB`);
    put("glow", look.afterglow_s, look.afterglow_s ? `${look.afterglow_s.toFixed(1)} s` : "off");
    press("usual", levels.auto);
    $("usual").textContent = hasReceiver(bins.descriptor) ? "receiver" : "follow";
    const may = panes.some((pane) => pane.bins.mayCompensate);
    buttonOf("compensated").disabled = !may;
    press("compensated", may && look.compensated);
    const now = this.#upNow();
    for (const up of UPS) check(`up-${up}`, now === up);
    press("bscope", look.bscope);
    press("profile", look.profile);
    selectOf("size").value = String(look.size);
    selectOf("trails").value = String(look.trails);
    check("trails-true", !look.relative);
    check("trails-relative", look.relative);
    check("by-ground", !look.slant);
    check("by-slant", look.slant);
    press("rings", look.rings);
    check("unit-km", look.unit === "km");
    check("unit-nm", look.unit === "NM");
    press("overlay", look.overlay);
    $("overlay-legend").hidden = !look.overlay || Boolean(look.label);
    selectOf("label").value = look.label;
    this.#labelLegend();
    press("hold", look.hold);
    for (const [kind, k] of LINES) {
      const value = look.lines[kind][k];
      press(`${kind}-${k + 1}`, value !== null || String(look.armed) === `${kind},${k}`);
      const field = inputOf(`${kind}-${k + 1}-at`);
      const text = value === null ? "" : kind === "ebl" ? value.toFixed(1) : (value / UNIT_M[look.unit]).toFixed(2);
      if (document.activeElement !== field) field.value = text;
    }
    press("two", panes.length > 1);
  }

  /**
   * The slider's ends follow the video's scale.
   * @param {import("./picture/bins.js").Bins} bins
   * @param {import("./picture/levels.js").Levels} levels
   */
  #limits(bins, { low_dB }) {
    if (!bins.placement) return;
    const least = Math.floor(bins.floor_dB + bins.compensation_dB(0));
    const most = Math.ceil(bins.floor_dB + 254 * bins.step_dB + bins.compensation_dB(bins.placement.ranges - 1));
    const low = inputOf("low");
    if (Number(low.min) === least && Number(low.max) === most) return;
    low.min = String(least);
    low.max = String(most);
    low.value = String(low_dB);
  }
}
