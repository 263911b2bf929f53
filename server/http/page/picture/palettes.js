// Colours of levels: 32 ages of 256 levels, packed as a canvas wants them.

export const LEVELS = 256;
export const AGES = 32;
export const PALETTES = ["green", "grey", "viridis", "amber"];

// matplotlib's viridis (S. van der Walt and N. Smith, CC0), 256 colours.
const VIRIDIS =
  "44015444025645045745055946075a46085c460a5d460b5e470d60470e6147106347116447136548146748166848176948186a481a6c" +
  "481b6d481c6e481d6f481f70482071482173482374482475482576482677482878482979472a7a472c7a472d7b472e7c472f7d46307e" +
  "46327e46337f463480453581453781453882443983443a83443b84433d84433e85423f85424086424186414287414487404588404688" +
  "3f47883f48893e49893e4a893e4c8a3d4d8a3d4e8a3c4f8a3c508b3b518b3b528b3a538b3a548c39558c39568c38588c38598c375a8c" +
  "375b8d365c8d365d8d355e8d355f8d34608d34618d33628d33638d32648e32658e31668e31678e31688e30698e306a8e2f6b8e2f6c8e" +
  "2e6d8e2e6e8e2e6f8e2d708e2d718e2c718e2c728e2c738e2b748e2b758e2a768e2a778e2a788e29798e297a8e297b8e287c8e287d8e" +
  "277e8e277f8e27808e26818e26828e26828e25838e25848e25858e24868e24878e23888e23898e238a8d228b8d228c8d228d8d218e8d" +
  "218f8d21908d21918c20928c20928c20938c1f948c1f958b1f968b1f978b1f988b1f998a1f9a8a1e9b8a1e9c891e9d891f9e891f9f88" +
  "1fa0881fa1881fa1871fa28720a38620a48621a58521a68522a78522a88423a98324aa8325ab8225ac8226ad8127ad8128ae8029af7f" +
  "2ab07f2cb17e2db27d2eb37c2fb47c31b57b32b67a34b67935b77937b87838b9773aba763bbb753dbc743fbc7340bd7242be7144bf70" +
  "46c06f48c16e4ac16d4cc26c4ec36b50c46a52c56954c56856c66758c7655ac8645cc8635ec96260ca6063cb5f65cb5e67cc5c69cd5b" +
  "6ccd5a6ece5870cf5773d05675d05477d1537ad1517cd2507fd34e81d34d84d44b86d54989d5488bd6468ed64590d74393d74195d840" +
  "98d83e9bd93c9dd93ba0da39a2da37a5db36a8db34aadc32addc30b0dd2fb2dd2db5de2bb8de29bade28bddf26c0df25c2df23c5e021" +
  "c8e020cae11fcde11dd0e11cd2e21bd5e21ad8e219dae319dde318dfe318e2e418e5e419e7e419eae51aece51befe51cf1e51df4e61e" +
  "f6e620f8e621fbe723fde725";


/** @typedef {[number, number, number]} Colour red, green, blue, 0 to 255 */

/** Between these, linearly. @type {Record<string, [number, Colour][]>} */
const RAMPS = {
  green: [[0, [2, 8, 5]], [0.3, [6, 62, 30]], [0.62, [24, 158, 74]], [0.88, [120, 240, 140]], [1, [226, 255, 220]]],
  grey: [[0, [0, 0, 0]], [1, [255, 255, 255]]],
  amber: [[0, [8, 4, 0]], [0.35, [92, 46, 2]], [0.7, [226, 132, 12]], [0.92, [255, 196, 92]], [1, [255, 240, 206]]],
};

/** What is not an echo; the overlay's colours by a bin's state. */
export const OUTSIDE = /** @type {Colour} */ ([7, 11, 14]);
export const STATE_COLOURS = /** @type {Colour[]} */ ([
  [176, 40, 128], // not sampled
  [0, 0, 0], // sampled: its level
  [26, 52, 104], // shadow
  [112, 18, 44], // no known ground
  [48, 66, 74], // all ground is farther away
]);
export const STATE_WORDS = ["not sampled", "sampled", "shadow", "no known ground", "nearer than any ground"];

/** Of azimuths whose states have not come yet, where states are shown. */
export const NOT_YET = /** @type {Colour} */ ([58, 66, 70]);
/** Lines of ground that no file has, where the overlay is off. */
export const UNKNOWN_LINES = /** @type {Colour} */ ([92, 104, 110]);

/** A pixel of a tile: whether it is part of a hatch. @typedef {(x: number, y: number) => boolean} Hatch */

/** What beside its hue tells a state from another: dots, level lines, lines that rise, upright lines. @type {Hatch[]} */
const HATCHES = [(x, y) => (x & 3) < 2 && (y & 3) < 2, () => false, (x, y) => (y & 3) < 2, (x, y) => ((x + y) & 7) < 3, (x) => (x & 3) < 2];

/** A tile of 8 x 8 pixels: whether each is part of the state's hatch. @param {number} state */
const tileOf = (state) => Array.from({ length: 64 }, (_, k) => HATCHES[state](k & 7, k >> 3));

/** Between the lines of a hatch. @param {Colour} colour @returns {Colour} */
const dimmed = ([r, g, b]) => [Math.round(0.42 * r), Math.round(0.42 * g), Math.round(0.42 * b)];

/** [state][pixel of the tile] a packed colour: the state's hue, darker between the lines of its hatch. */
export const stateTiles = () => STATE_COLOURS.map((colour, state) =>
  Uint32Array.from(tileOf(state), (line) => packed(line ? colour : dimmed(colour))));

/** [pixel of the tile] lines over what else a picture shows; 0 between them. */
export const unknownTile = () => Uint32Array.from(tileOf(3), (line) => (line ? packed(UNKNOWN_LINES) : 0));

/** A packed pixel of an ImageData, on a little-endian machine (all that browsers run on). @param {Colour} colour */
export const packed = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

/** @param {Colour} from @param {Colour} to @param {number} part of the way @returns {Colour} */
function mixed([r, g, b], [toR, toG, toB], part) {
  const mix = (/** @type {number} */ a, /** @type {number} */ z) => Math.round(a + part * (z - a));
  return [mix(r, toR), mix(g, toG), mix(b, toB)];
}

/** @param {string} name @param {number} level 0 to 255 @returns {Colour} */
export function colourOf(name, level) {
  if (name === "viridis") {
    const at = 6 * Math.round(level);
    const part = (/** @type {number} */ k) => parseInt(VIRIDIS.substring(at + k, at + k + 2), 16);
    return [part(0), part(2), part(4)];
  }
  const ramp = RAMPS[name] ?? RAMPS.green;
  const t = level / (LEVELS - 1);
  const k = Math.max(1, ramp.findIndex(([end]) => t <= end));
  const [[t0, low], [t1, high]] = [ramp[k - 1], ramp[k]];
  const part = (t - t0) / (t1 - t0);
  return mixed(low, high, part);
}

/**
 * [age][level]: an echo fades to a tenth of its light, faster at first, as phosphor does.
 * @param {string} name
 */
export function paletteOf(name) {
  const colours = Array.from({ length: LEVELS }, (_, level) => colourOf(name, level));
  const ground = colours[0];
  const table = new Uint32Array(AGES * LEVELS);
  for (let age = 0; age < AGES; ++age) {
    const light = Math.pow(0.1, age / (AGES - 1));
    for (let level = 0; level < LEVELS; ++level) {
      table[age * LEVELS + level] = packed(mixed(ground, colours[level], light));
    }
  }
  return table;
}
