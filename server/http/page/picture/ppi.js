// One plan position picture: the bins through the index table and the palette, and two drawings above it.

import { AGES, LEVELS, NOT_YET, OUTSIDE, packed, paletteOf, stateTiles, unknownTile } from "./palettes.js";
import { BinTable, onPicture, onPlane } from "./table.js";
import { DEGREE, turned } from "./placement.js";
import { Heading } from "./heading.js";
import { drawAxes, drawGrid } from "./grid.js";
import { drawMarks } from "./marks.js";
import { LABEL_TILES } from "../labels.js";

const MOST_PIXELS = 1440; // a side; above, the browser scales
const MARGIN_PX = 34; // for the bearings around the picture
const MARGIN_ABOVE_PX = 28; // their words are wider than high
const FRAME_MS = 1000 / 30;
const EARLY_MS = 4; // a browser's tick may come so much before its time
const MOST_ZOOM = 200;
const NOT_YET_PIXEL = packed(NOT_YET);
const TILES = stateTiles().map((tile, state) => (state === 1 ? null : tile)); // the overlay
const UNKNOWN_TILES = [null, null, null, unknownTile(), null]; // without it

/** @typedef {import("../look.js").Look} Look @typedef {import("./placement.js").Point} Point */

/** In the page's pixels. @typedef {{left: number, right: number, top: number, bottom: number}} Box */

export class Ppi {
  /**
   * @param {HTMLElement} element
   * @param {import("./bins.js").Bins} bins
   * @param {Look} look
   */
  constructor(element, bins, look) {
    this.element = element;
    this.bins = bins;
    this.look = look;
    this.canvases = ["picture", "grid", "marks"].map((name) => {
      const canvas = document.createElement("canvas");
      canvas.className = name;
      element.append(canvas);
      return canvas;
    });
    const [picture, grid, marks] = this.canvases;
    this.picture = picture.getContext("2d", { alpha: false, willReadFrequently: true });
    this.grid = grid.getContext("2d");
    this.marks = marks.getContext("2d");
    this.table = new BinTable();
    this.ages = new Uint8Array(0);
    this.width = this.height = 0; // the page's own pixels, of look.px CSS pixels
    this.heading = new Heading();
    this.view = { width: 1, height: 1, pixel_m: 1, right_m: 0, ahead_m: 0, up_deg: 0, slant: false };
    this.image = null;
    this.due_ms = 0; // the next picture, not before
    this.draws = 0;
    this.times = { draw_ms: 0, table_ms: 0 };
    this.handle = false; // whether the centre bearing can be dragged
    /** Where. @type {Point|null} */
    this.handleAt = null;
    /** @type {number|undefined} */
    this.draggedBearing_deg = undefined;
    /** @type {{step: number, first: number, last: number, unit: import("./grid.js").Unit}|null} */
    this.ringStep = null;
    /** Of the grid. @type {Box[]} */
    this.words = [];
    /** Where targets are; null: not shown. @type {import("../truth.js").Truth|null} */
    this.truth = null;
    /** What is known of them. @type {import("./target_marks.js").TargetsShown|null} */
    this.targets = null;
    this.marked_ms = 0; // when new places of targets were last drawn
    this.needs = { table: true, grid: true, marks: true, all: true };
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
    this.restyle();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width < 8 || height < 8) return;
    const density = Math.min(devicePixelRatio || 1, 2);
    const part = Math.min(density, MOST_PIXELS / width, MOST_PIXELS / height);
    const { px } = this.look;
    const [picture, grid, marks] = this.canvases;
    const w = Math.floor(width * part);
    const h = Math.floor(height * part);
    if (w !== picture.width || h !== picture.height || !this.image) {
      [picture.width, picture.height] = [w, h];
      this.image = this.picture.createImageData(w, h);
      this.out = new Uint32Array(this.image.data.buffer);
    }
    for (const canvas of [grid, marks])
      [canvas.width, canvas.height] = [Math.round(width * density), Math.round(height * density)];
    this.width = width / px;
    this.height = height / px;
    this.density = density * px; // of the canvases above the picture
    this.refresh();
  }

  /** Where things lie has changed. */
  refresh() {
    Object.assign(this.needs, { table: true, grid: true, marks: true });
  }

  /** Colours have changed. */
  restyle() {
    this.palette = paletteOf(this.look.palette);
    Object.assign(this.needs, { grid: true, all: true, marks: true });
  }

  /** @returns {import("./table.js").View} the whole sector, or the window that was chosen */
  #viewNow() {
    const { placement } = this.bins;
    const [picture] = this.canvases;
    const { up_deg } = this.heading.up(this.look.up, placement);
    this.isSlant = this.look.slant || !placement.hasGround;
    const base = { width: picture.width, height: picture.height, up_deg, slant: this.isSlant };
    const fit = this.#fit(up_deg);
    const chosen = this.look.window;
    if (!chosen) return { ...base, ...fit };
    return { ...base, pixel_m: fit.pixel_m / chosen.zoom, right_m: chosen.right_m, ahead_m: chosen.ahead_m };
  }

  /** The view that holds all of the sector. @param {number} up_deg */
  #fit(up_deg) {
    const { placement } = this.bins;
    const u = up_deg * DEGREE;
    let [left, right, back, ahead] = [0, 0, 0, 0];
    const include = (/** @type {number} */ bearing_deg, /** @type {number} */ slant_m, isFirst = false) => {
      const [e, n] = this.placed(bearing_deg, slant_m);
      const x = e * Math.cos(u) - n * Math.sin(u);
      const y = e * Math.sin(u) + n * Math.cos(u);
      if (isFirst) [left, right, back, ahead] = [x, x, y, y];
      [left, right] = [Math.min(left, x), Math.max(right, x)];
      [back, ahead] = [Math.min(back, y), Math.max(ahead, y)];
    };
    const sector_deg = placement.azimuths * placement.width_deg;
    // An expanded view far out leaves the antenna off the picture.
    const isFar = !placement.isRound && placement.r0_m > 0.5 * placement.rMax_m;
    if (isFar) include(placement.start_deg, placement.r0_m, true);
    const steps = Math.max(4, Math.ceil(sector_deg / 5));
    for (let k = 0; k <= steps; ++k) {
      include(placement.start_deg + (k / steps) * sector_deg, placement.rMax_m);
      if (isFar) include(placement.start_deg + (k / steps) * sector_deg, placement.r0_m);
    }
    const [picture] = this.canvases;
    const perCss = picture.width / this.width;
    const margin = 2 * Math.min(MARGIN_PX, this.width / 11) * perCss;
    const above = 2 * MARGIN_ABOVE_PX * perCss;
    const pixel_m = Math.max((right - left) / (picture.width - margin), (ahead - back) / (picture.height - above), 1e-3);
    return { pixel_m, right_m: (left + right) / 2, ahead_m: (back + ahead) / 2 };
  }

  /** On the plane of this picture. @param {number} bearing_deg @param {number} slant_m @returns {Point} */
  placed(bearing_deg, slant_m) {
    if (!this.isSlant) return this.bins.placement.place(bearing_deg, slant_m);
    return [slant_m * Math.sin(bearing_deg * DEGREE), slant_m * Math.cos(bearing_deg * DEGREE)];
  }

  /** Edges of a B-scope, in the page's pixels. */
  get box() {
    const side = Math.min(140, this.width / 8); // room for words and legend
    return { left: side, right: this.width - side, top: 44, bottom: this.height - 34 };
  }

  /** The page's pixels of a bearing and slant range. @param {number} bearing_deg @param {number} slant_m @returns {Point} */
  screenOf(bearing_deg, slant_m) {
    if (!this.look.bscope) return this.toScreen(...this.placed(bearing_deg, slant_m));
    const { placement } = this.bins;
    const { left, right, top, bottom } = this.box;
    let turn = turned(bearing_deg - placement.start_deg);
    if (turn > 180 + placement.sector_deg / 2) turn -= 360;
    return [left + (turn / placement.sector_deg) * (right - left),
      bottom - ((slant_m - placement.r0_m) / (placement.rMax_m - placement.r0_m)) * (bottom - top)];
  }

  /** The page's pixels of a place on the plane. @param {number} east_m @param {number} north_m @returns {Point} */
  toScreen(east_m, north_m) {
    if (this.look.bscope) {
      const { bearing_deg, slant_m } = this.#seenFrom(east_m, north_m);
      return this.screenOf(bearing_deg, slant_m);
    }
    const [x, y] = onPicture(this.view, east_m, north_m);
    const k = this.width / this.view.width;
    return [x * k, y * k];
  }

  /** A place on the plane under the page's pixels. @param {number} x @param {number} y @returns {import("../look.js").Place} */
  fromScreen(x, y) {
    if (this.look.bscope) {
      const { placement } = this.bins;
      const { left, right, top, bottom } = this.box;
      const bearing_deg = placement.start_deg + ((x - left) / (right - left)) * placement.sector_deg;
      const slant_m = placement.r0_m + ((bottom - y) / (bottom - top)) * (placement.rMax_m - placement.r0_m);
      const [east_m, north_m] = this.placed(bearing_deg, Math.max(1, slant_m));
      return { east_m, north_m };
    }
    const k = this.view.width / this.width;
    const [east_m, north_m] = onPlane(this.view, x * k, y * k);
    return { east_m, north_m };
  }

  /** Slant and ground range, bearing, place, bin and value of a place on the plane. @param {import("../look.js").Place} place */
  read({ east_m, north_m }) {
    const { bins } = this;
    const { placement } = bins;
    if (!placement) return null;
    const seen = this.#seenFrom(east_m, north_m);
    const { row, column } = placement.bin(seen.bearing_deg, seen.slant_m);
    const bin = row < 0 ? -1 : row * placement.ranges + column;
    const isKnown = bin >= 0 && bins.seen_ms[row] > -Infinity;
    return { ...seen, row, column, bin, value_dB: isKnown ? bins.value_dB(bin) : null, isKnown,
      state: isKnown && bins.hasState[row] ? bins.state[bin] : -1 };
  }

  /** What the antenna measures of a place on this picture's plane. @param {number} east_m @param {number} north_m */
  #seenFrom(east_m, north_m) {
    const { placement } = this.bins;
    if (!this.isSlant) return placement.seen(east_m, north_m);
    const slant_m = Math.hypot(east_m, north_m);
    const bearing_deg = Math.atan2(east_m, north_m) / DEGREE;
    return { slant_m, bearing_deg, ...placement.located(bearing_deg, slant_m) };
  }

  /** Zooms about the page's pixels. Begins where the last zoom or pan ended, drawn or not. @param {number} factor */
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    if (!this.bins.placement || this.look.bscope) return;
    const view = this.#viewNow();
    const fit = this.#fit(view.up_deg);
    const zoom = Math.min(MOST_ZOOM, (fit.pixel_m / view.pixel_m) * factor);
    if (zoom < 0.3) return;
    const k = view.width / this.width;
    const dx = (x * k - view.width / 2) * view.pixel_m * (1 - 1 / factor);
    const dy = (y * k - view.height / 2) * view.pixel_m * (1 - 1 / factor);
    this.look.window = { zoom, right_m: view.right_m + dx, ahead_m: view.ahead_m - dy };
  }

  /** @param {number} dx the page's pixels @param {number} dy */
  pan(dx, dy) {
    if (!this.bins.placement || this.look.bscope) return;
    const view = this.#viewNow();
    const k = (view.width / this.width) * view.pixel_m;
    const zoom = this.#fit(view.up_deg).pixel_m / view.pixel_m;
    this.look.window = { zoom, right_m: view.right_m - dx * k, ahead_m: view.ahead_m + dy * k };
  }

  /** At most 30 pictures a second; more where the beam would otherwise move by more than its width between two. */
  #pause_ms() {
    const s = this.bins.descriptor?.settings;
    if (!this.bins.scan || !s) return FRAME_MS;
    const width_deg = s.beam_pattern && s.beam_pattern !== "OFF_BEAM" ? Number(s.beam_width_deg) : 3;
    return (Number(this.bins.scan.rate_deg_s) * FRAME_MS) / 1000 > width_deg ? 0 : FRAME_MS;
  }

  /**
   * @param {number} now_ms
   * @param {number|null} held_ms since then the picture is held; null: it is not
   * @returns {boolean} whether bins were drawn
   */
  draw(now_ms, held_ms) {
    if (!this.bins.placement || !this.image) return false;
    if (now_ms < this.due_ms - EARLY_MS) return false;
    if (held_ms === null) this.bins.advance(now_ms);
    const began = performance.now();
    if (this.needs.table) this.#rebuild(began);
    const rows = this.#drawRows(this.bins.ageClock_ms(held_ms ?? now_ms));
    if (rows) {
      this.due_ms = Math.max(this.due_ms + this.#pause_ms(), now_ms); // a late picture does not put off the next
      ++this.draws;
      this.times.draw_ms = performance.now() - began;
    }
    if (this.needs.grid) (this.look.bscope ? drawAxes : drawGrid)(this);
    if (this.needs.marks || (rows && this.bins.scan)) drawMarks(this);
    this.needs.grid = this.needs.marks = false;
    return rows > 0;
  }

  /** @param {number} began by performance.now() */
  #rebuild(began) {
    this.view = this.#viewNow();
    if (this.look.bscope) {
      const k = this.view.width / this.width;
      const { left, right, top, bottom } = this.box;
      this.table.buildB(this.bins.placement, this.view, { left: left * k, right: right * k, top: top * k, bottom: bottom * k });
    } else {
      this.table.build(this.bins.placement, this.view);
    }
    this.out.fill(packed(OUTSIDE));
    this.ages = new Uint8Array(this.bins.placement.azimuths);
    this.needs.table = false;
    this.needs.all = this.needs.grid = this.needs.marks = true;
    this.times.table_ms = performance.now() - began;
  }

  /** @param {number} clock_ms that ages count from @returns {number} rows that were drawn */
  #drawRows(clock_ms) {
    const { bins, table, out, palette, ages } = this;
    const { rowStart } = table;
    const perMs = bins.scan && this.look.afterglow_s > 0 ? (AGES - 1) / (1000 * this.look.afterglow_s) : 0;
    const tiles = bins.hasStates ? (this.look.label ? LABEL_TILES : this.look.overlay ? TILES : UNKNOWN_TILES) : null;
    let [top, bottom, rows] = [Infinity, -1, 0];
    for (let row = 0; row < bins.placement.azimuths; ++row) {
      const since = (clock_ms - bins.seen_ms[row]) * perMs;
      const age = perMs === 0 ? 0 : since > 0 ? Math.min(AGES - 1, Math.floor(since)) : 0;
      if (!this.needs.all && !bins.changed[row] && age === ages[row]) continue;
      ages[row] = age;
      bins.changed[row] = 0;
      ++rows;
      const begin = rowStart[row];
      const end = rowStart[row + 1];
      if (begin === end) continue;
      if (tiles && bins.hasState[row]) drawStates(out, this.view.width, table, begin, end, bins, palette, age * LEVELS, tiles);
      else if (tiles === TILES) for (let k = begin; k < end; ++k) out[table.pixels[k]] = NOT_YET_PIXEL;
      else drawPlain(out, table, begin, end, bins.shown, palette, age * LEVELS);
      top = Math.min(top, table.pixels[begin]); // pixels of a row come from above to below
      bottom = Math.max(bottom, table.pixels[end - 1]);
    }
    if (this.needs.all) this.picture.putImageData(this.image, 0, 0);
    else if (bottom >= 0) {
      const first = Math.floor(top / this.view.width);
      this.picture.putImageData(this.image, 0, 0, 0, first, this.view.width, Math.floor(bottom / this.view.width) + 1 - first);
    }
    this.needs.all = false;
    return rows;
  }
}

/**
 * @param {Uint32Array} out pixels
 * @param {BinTable} table
 * @param {number} begin of its pixels
 * @param {number} end
 * @param {Uint8ClampedArray} shown levels
 * @param {Uint32Array} palette
 * @param {number} age where its colours begin
 */
function drawPlain(out, { pixels, bins }, begin, end, shown, palette, age) {
  for (let k = begin; k < end; ++k) out[pixels[k]] = palette[age + shown[bins[k]]];
}

/**
 * By state, as `tiles` have it; where they have nothing (null, or 0 in a tile) the level.
 * @param {Uint32Array} out pixels
 * @param {number} width of the picture
 * @param {BinTable} table
 * @param {number} begin of its pixels
 * @param {number} end
 * @param {import("./bins.js").Bins} bins
 * @param {Uint32Array} palette
 * @param {number} age where its colours begin
 * @param {(Uint32Array|null)[]} tiles
 */
function drawStates(out, width, { pixels, bins }, begin, end, { shown, state }, palette, age, tiles) {
  for (let k = begin; k < end; ++k) {
    const bin = bins[k];
    const tile = tiles[state[bin]] ?? (state[bin] > 4 ? tiles[3] : null);
    const pixel = pixels[k];
    const colour = tile ? tile[((Math.floor(pixel / width) & 7) << 3) | (pixel % width & 7)] : 0;
    out[pixel] = colour || palette[age + shown[bin]];
  }
}
