// Labels over the picture: what a bin's ground is, in a colour instead of its level (PROTOCOL.md, "Labels"). They come in place of
// states, as codes: 1 shows the level, those from FIRST on have colours.

import { packed } from "./picture/palettes.js";
import { number } from "./messages.js";

const LEVEL = 1;
const FIRST = 16;
const NO_MATERIAL = 255;
const BANDS = 8; // of heights

/** @typedef {import("../wire.js").FrameDescriptor} FrameDescriptor */
/**
 * @typedef {Extract<import("../wire.js").PlaneKind, "MATERIAL"|"BUILDING"|"HEIGHT"|"RETURNS">} LabelPlane
 * @typedef {LabelPlane|""} Label nothing: none
 */

/** @type {import("./picture/palettes.js").Colour[]} */
const COLOURS = [[214, 96, 77], [67, 147, 195], [253, 219, 120], [118, 186, 105], [160, 110, 190], [240, 160, 70], [120, 200, 200], [200, 200, 200]];

const heightsOf = (/** @type {FrameDescriptor} */ { ground }) => ({ low_m: number(ground?.lowest_m), high_m: number(ground?.highest_m) });
const floatsOf = (/** @type {Uint8Array} */ plane) => new Float32Array(plane.slice().buffer);

/**
 * By plane: the code of each value, and what the codes mean.
 * @type {Record<LabelPlane, {codes: (plane: Uint8Array, descriptor: FrameDescriptor) => Uint8Array, words: (descriptor: FrameDescriptor) => string[]}>}
 */
const LABELS = {
  MATERIAL: {
    codes: (plane) => plane.map((value) => (value === NO_MATERIAL ? LEVEL : FIRST + (value % COLOURS.length))),
    words: ({ materials }) => (materials ?? []).slice(0, COLOURS.length).map(({ name }) => name),
  },
  BUILDING: {
    codes: (plane) => Uint8Array.from(floatsOf(plane), (share) => (share >= 0.5 ? FIRST : share >= 0.1 ? FIRST + 1 : LEVEL)),
    words: () => ["buildings give half and more", "a tenth and more"],
  },
  HEIGHT: {
    codes: (plane, descriptor) => {
      const { low_m, high_m } = heightsOf(descriptor);
      const perM = BANDS / Math.max(1, high_m - low_m);
      const band = (/** @type {number} */ height_m) => Math.min(BANDS - 1, Math.max(0, Math.floor((height_m - low_m) * perM)));
      return Uint8Array.from(floatsOf(plane), (height_m) => (Number.isNaN(height_m) ? LEVEL : FIRST + band(height_m)));
    },
    words: (descriptor) => {
      const { low_m, high_m } = heightsOf(descriptor);
      return COLOURS.map((_, band) => `from ${Math.round(low_m + ((high_m - low_m) * band) / BANDS)} m`);
    },
  },
  RETURNS: {
    codes: (plane) => plane.map((returns) => (returns < 2 ? LEVEL : FIRST + Math.min(returns, 4) - 2)),
    words: () => ["two stretches", "three", "four and more"],
  },
};

/** The first: none. @type {Label[]} */
export const LABEL_PLANES = ["", ...(/** @type {LabelPlane[]} */ (Object.keys(LABELS)))];

/** [code] a tile of 8 x 8 pixels; null: the level. */
export const LABEL_TILES = [...Array(FIRST).fill(null), ...COLOURS.map((colour) => new Uint32Array(64).fill(packed(colour)))];

/**
 * A block of a label as one of states.
 * @param {import("../wire.js").WedgeBlock} body
 * @param {LabelPlane} label
 * @param {Uint8Array} plane
 * @param {FrameDescriptor} descriptor
 * @returns {[import("../wire.js").WedgeBlock, Uint8Array]}
 */
export function asStates(body, label, plane, descriptor) {
  return [{ ...body, plane: "STATE" }, LABELS[label].codes(plane, descriptor)];
}

/**
 * What a code means; nothing: it is no label's.
 * @param {Label} label
 * @param {number} code
 * @param {FrameDescriptor|null} descriptor
 */
export function labelWord(label, code, descriptor) {
  return code < FIRST || !label ? "" : LABELS[label].words(descriptor)[code - FIRST] ?? "";
}

/**
 * Word and tile of each code that has a colour.
 * @param {Label} label
 * @param {FrameDescriptor|null} descriptor
 * @returns {[string, Uint32Array][]}
 */
export function labelLegend(label, descriptor) {
  if (!label || !descriptor) return [];
  return LABELS[label].words(descriptor).map((word, k) => [word, LABEL_TILES[FIRST + k]]);
}
