// What a viewer has chosen, in the URL's fragment.

import { PALETTES } from "./picture/palettes.js";
import { UPS } from "./picture/heading.js";
import { LABEL_PLANES } from "./labels.js";
import { TRAIL_MINUTES } from "./picture/trails.js";

/** What the fragment may say, and what holds without it. */
export const DEFAULTS = {
  palette: "green", low: -80, span: 50, auto: true, low2: -80, span2: 50, auto2: true, r2: true, glow: -1,
  up: /** @type {import("./picture/heading.js").Wish} */ ("auto"), slant: false, unit: /** @type {import("./picture/grid.js").Unit} */ ("km"),
  rings: true, overlay: false, label: /** @type {import("./labels.js").Label} */ (""), bscope: false, profile: false, size: 1,
  expert: false, panes: 1, a: "", b: "", tab: "view", rate: 30, targets: false, trails: 0, relative: false,
};

/** @typedef {typeof DEFAULTS} Kept */

/** @returns {Kept} */
export function readFragment() {
  /** @type {Record<string, string|number|boolean>} */
  const said = {};
  for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
    const usual = key in DEFAULTS ? DEFAULTS[/** @type {keyof Kept} */ (key)] : null;
    if (typeof usual === "boolean") said[key] = text === "1";
    else if (typeof usual === "number" && Number.isFinite(Number(text))) said[key] = Number(text);
    else if (typeof usual === "string") said[key] = text;
  }
  /** @type {Kept} */
  const found = { ...DEFAULTS, ...said };
  if (!PALETTES.includes(found.palette)) found.palette = DEFAULTS.palette;
  if (!["km", "NM"].includes(found.unit)) found.unit = DEFAULTS.unit;
  if (!LABEL_PLANES.includes(found.label)) found.label = DEFAULTS.label;
  if (found.up !== "auto" && !UPS.includes(found.up)) found.up = DEFAULTS.up;
  if (!TRAIL_MINUTES.includes(found.trails)) found.trails = DEFAULTS.trails;
  found.size = Math.min(2, Math.max(0.7, found.size));
  found.rate = Math.max(0.1, found.rate);
  return found;
}

/** @param {Partial<Kept>} settings only what differs from DEFAULTS is written */
export function writeFragment(settings) {
  const words = new URLSearchParams();
  for (const [key, value] of Object.entries(settings))
    if (value !== undefined && key in DEFAULTS && value !== DEFAULTS[/** @type {keyof Kept} */ (key)])
      words.set(key, typeof value === "boolean" ? (value ? "1" : "0") : String(value));
  const text = words.toString();
  if (text !== location.hash.slice(1)) history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
}
