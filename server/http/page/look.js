// How pictures are shown: what all of them share, as the viewer has chosen it.

import { Events } from "./events.js";
import { noLines } from "./picture/lines.js";

/**
 * @typedef {object} LookValues
 * @property {string} palette
 * @property {boolean} compensated levels make up for the range, where the video may
 * @property {number} afterglow_s
 * @property {boolean} autoGlow until the beam comes again
 * @property {import("./picture/heading.js").Wish} up
 * @property {boolean} bscope azimuths across, ranges upwards, instead of places
 * @property {boolean} profile below the first picture, the ground along bearing line 1
 * @property {number} size of letters and lines: 1 as the screen has room for
 * @property {boolean} slant
 * @property {import("./picture/grid.js").Unit} unit
 * @property {boolean} overlay
 * @property {import("./labels.js").Label} label the plane whose labels are shown; empty: none
 * @property {boolean} rings
 * @property {number} trails minutes; 0: none
 * @property {boolean} relative trails move with the antenna; else they stay on the earth
 * @property {boolean} hold the picture is kept
 * @property {{right_m: number, ahead_m: number, zoom: number}|null} window null: all of the sector
 */

/** @typedef {{east_m: number, north_m: number}} Place on the plane around the antenna */

/** @extends {Events<{change: Partial<LookValues>}>} */
export class Look extends Events {
  /** @param {import("./fragment.js").Kept} kept */
  constructor(kept) {
    super();
    this.palette = kept.palette;
    this.compensated = kept.r2;
    this.afterglow_s = Math.max(0, kept.glow);
    this.autoGlow = kept.glow < 0;
    this.up = kept.up;
    this.bscope = kept.bscope;
    this.profile = kept.profile;
    this.size = kept.size;
    this.slant = kept.slant;
    this.unit = kept.unit;
    this.overlay = kept.overlay;
    this.label = kept.label;
    this.rings = kept.rings;
    this.trails = kept.trails;
    this.relative = kept.relative;
    this.hold = false;
    /** @type {LookValues["window"]} */
    this.window = null;
    /** @type {Place|null} */
    this.cursor = null;
    this.lines = noLines();
    /** Placed by the next click. @type {import("./picture/lines.js").Line|null} */
    this.armed = null;
    this.px = 1; // CSS pixels of one of the page's own
  }

  /** @param {Partial<LookValues>} change */
  change(change) {
    Object.assign(this, change);
    if (["up", "slant", "bscope"].some((key) => key in change)) this.window = null;
    this.emit("change", change);
  }

  /** As the fragment keeps it. @returns {Partial<import("./fragment.js").Kept>} */
  get kept() {
    return {
      palette: this.palette, r2: this.compensated, glow: this.autoGlow ? -1 : this.afterglow_s, up: this.up, slant: this.slant, unit: this.unit,
      rings: this.rings, overlay: this.overlay, label: this.label, bscope: this.bscope, profile: this.profile, size: this.size,
      trails: this.trails, relative: this.relative,
    };
  }
}
