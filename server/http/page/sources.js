// What a picture may show: a radar, the first radar at another range scale, or, for experts, its view through another frustum.

import { buttonOf, inputOf } from "./dom.js";
import { Events } from "./events.js";
import { number } from "./messages.js";
import { UNIT_M } from "./picture/grid.js";
import { scaled } from "./scales.js";

/** @type {Record<string, import("../wire.js").FrustumKind>} */
const FRUSTA = { sweep: "SWEEP", oblique: "OBLIQUE", symmetric: "SYMMETRIC" };
const HALF_TURN_DEG = 180; // a symmetric frustum sees less

/** "scale 12 NM": its metres; 0: it is none. @param {string} source */
export function scaleOf(source) {
  const [kind, value, unit] = source.split(" ");
  return kind === "scale" && (unit === "km" || unit === "NM") ? Number(value) * UNIT_M[unit] : 0;
}

/**
 * What a RenderOnce changes of the first radar's settings.
 * @param {string} source
 * @param {import("../wire.js").RadarSettings} settings
 * @returns {import("../wire.js").RadarSettings}
 */
export function changesOf(source, settings) {
  const scale_m = scaleOf(source);
  return scale_m ? scaled(settings, scale_m) : { frustum: FRUSTA[source.slice("frustum ".length)] };
}

/** Fills the choice above each picture; the switch for other frusta was set. @extends {Events<{expert: undefined}>} */
export class Sources extends Events {
  /**
   * @param {object} parts
   * @param {import("./stream.js").Link} parts.link
   * @param {import("./pictures.js").Pictures} parts.pictures
   * @param {import("./debrief.js").Debrief} parts.debrief
   * @param {import("./scales.js").RangeScales} parts.scales
   * @param {import("./fragment.js").Kept} parts.kept
   */
  constructor({ link, pictures, debrief, scales, kept }) {
    super();
    this.link = link;
    this.pictures = pictures;
    this.debrief = debrief;
    this.scales = scales;
    this.kept = kept;
    /** @type {boolean|null} */
    this.filledWide = null;
    const expert = inputOf("expert");
    expert.checked = kept.expert;
    expert.onchange = () => {
      kept.expert = expert.checked;
      this.fill();
      this.emit("expert");
    };
  }

  /** Whether the first radar sees too much for a symmetric frustum. */
  get #isWide() {
    return number(this.pictures.first.info?.settings?.sector_deg) >= HALF_TURN_DEG;
  }

  /** Range scales as sources: "scale 12 NM". */
  get #scales() {
    const { metres, unit } = this.scales;
    return metres.map((scale_m) => `scale ${+(scale_m / UNIT_M[unit]).toPrecision(6)} ${unit}`);
  }

  /** What the second picture shows unasked; nothing: there is no other. */
  get other() {
    const radars = this.link.welcome?.radars ?? [];
    const { first } = this.pictures;
    const { b } = this.kept;
    const rendersNothing = this.debrief.isOn;
    const [kind, name] = b.split(/ (.*)/);
    if (kind === "radar" && radars.includes(name)) return b;
    if (!rendersNothing && ((kind === "scale" && scaleOf(b)) || (kind === "frustum" && name in FRUSTA))) return b;
    const other = radars.find((radar) => radar !== first.radar);
    if (other) return `radar ${other}`;
    if (rendersNothing) return "";
    const now_m = number(first.info?.settings?.r_max_m);
    const scales = this.#scales;
    return scales.findLast((scale) => scaleOf(scale) < 0.9 * now_m) ?? scales.find((scale) => scaleOf(scale) > 1.1 * now_m) ?? "";
  }

  /** Where the first radar's sector has become wide enough for other frusta, or too wide. */
  refresh() {
    if (this.filledWide !== this.#isWide) this.fill();
    this.filledWide = this.#isWide;
  }

  fill() {
    const radars = this.link.welcome?.radars;
    if (!this.link.welcome) return;
    const { panes } = this.pictures;
    for (const pane of panes) {
      const isFirst = pane === panes[0];
      const options = (radars ?? []).map((radar) => new Option(radar, `radar ${radar}`));
      // A recording renders nothing. One that was chosen stays, and what the server says of it.
      if (!isFirst && !this.debrief.isOn) {
        const scales = this.#scales;
        if (scaleOf(pane.source) && !scales.includes(pane.source)) scales.push(pane.source);
        options.push(...scales.map((scale) => new Option(`range ${scale.slice(6)}`, scale)));
        const kinds = Object.keys(FRUSTA).filter((kind) => kind === pane.frustum || (this.kept.expert && (kind !== "symmetric" || !this.#isWide)));
        options.push(...kinds.map((kind) => new Option(`${kind}, same view`, `frustum ${kind}`)));
      }
      pane.pick.replaceChildren(...options);
      if (!options.some(({ value }) => value === pane.source)) pane.source = isFirst ? `radar ${radars?.[0] ?? ""}` : this.other;
      pane.pick.value = pane.source;
    }
    if (panes[1]?.source === "") this.pictures.setCount(1, "");
    const two = buttonOf("two");
    two.disabled = panes.length === 1 && !this.other;
    two.title = two.disabled ? "This recording has one radar, and renders nothing else" : "One picture or two (P)";
  }
}
