// Trails: where echoes were that stood out, behind the picture, in another hue, until they are too old.
//
// A grid of cells on the plane around the antenna has, of each cell, when its echo last stood out from what is usual there, and how
// strong it was. Relative trails stay with the antenna; true ones stay on the earth: the grid's middle is then a place, and the antenna
// moves over it. Everything is in the video's own steps, so that levels of the display change nothing.

import { BinTable, onPlane } from "./table.js";
import { DEGREE, direct, inverse } from "./placement.js";
import { packed } from "./palettes.js";

export const TRAIL_MINUTES = [0, 0.25, 0.5, 1, 2, 3, 6];
const CELLS = 1024; // a side
const REACH = 1.25; // of the grid, times the greatest range: the antenna may move so far before it follows
const OUT_DB = 9; // an echo that stands out is at least so much above what is usual in its cell,
const OUT_SPREADS = 3.5; // and so many times what that varies by
const GONE_DB = 6; // below what stood out: it is no longer there
const RISE = 0.04; // of the difference, a look: what is usual follows slowly upwards,
const FALL = 0.3; // and fast downwards
const SPREAD_PART = 0.2;
const FIRST_SPREAD_DB = 8; // until it is known
const STEP_MS = 200; // between looks at what is shown
const FAINTEST = 0.3;
const NEVER = -1e9;
const MINUTE_MS = 60000;

/** By palette, another hue than its own. @type {Record<string, import("./palettes.js").Colour>} */
const HUES = { green: [96, 132, 255], grey: [88, 140, 255], amber: [80, 160, 255], viridis: [255, 110, 150] };

/** @typedef {import("./placement.js").Point} Point here also latitude and longitude */

export class Trails {
  /**
   * @param {import("./bins.js").Bins} bins
   * @param {import("./ppi.js").Ppi} ppi
   * @param {import("../look.js").Look} look
   * @param {import("../debrief.js").Debrief} debrief
   */
  constructor(bins, ppi, look, debrief) {
    this.bins = bins;
    this.ppi = ppi;
    this.look = look;
    this.debrief = debrief;
    /** While there are trails. @type {HTMLCanvasElement|null} */
    this.canvas = null;
    this.settings = ""; // that the video was made with
    this.kind = ""; // of the trails
    /** What the grid shows of the plane. @type {import("./table.js").View|null} */
    this.view = null;
    /** The grid's middle, and its cells. @type {{at: Point, cell_m: number}|null} */
    this.origin = null;
    this.clear();
  }

  get length_ms() {
    return this.look.trails * MINUTE_MS;
  }

  /** Nothing was seen yet. */
  clear() {
    /** [cell] seconds when its echo last stood out. @type {Float32Array|null} */
    this.stamps = null;
    /** [azimuth] when it was last looked at. @type {Float64Array|null} */
    this.rows = null;
    /** Of the grid's cells. @type {string} */
    this.key = "";
    /** The view of the picture that they are drawn for. @type {import("./table.js").View|null} */
    this.drawn = null;
    this.stepped_ms = -Infinity;
  }

  /** Of what is seen: a recording's own time. @param {number} now_ms */
  #clock_ms(now_ms) {
    return this.debrief.isOn ? 1000 * this.debrief.position_s : now_ms;
  }

  /** @param {number} now_ms @param {boolean} isHeld nothing new is shown */
  draw(now_ms, isHeld) {
    if (!this.length_ms) {
      if (this.canvas) this.#remove();
      return;
    }
    const { bins, ppi } = this;
    if (!bins.placement || !ppi.image) return;
    this.#begin();
    const isDue = !isHeld && now_ms - this.stepped_ms >= STEP_MS;
    if (isDue) {
      this.stepped_ms = now_ms;
      this.#follow();
      this.#note(this.#clock_ms(now_ms));
      this.#paint(this.#clock_ms(now_ms));
    }
    if (isDue || this.drawn !== ppi.view) this.#show();
  }

  #begin() {
    if (!this.canvas) {
      this.canvas = document.createElement("canvas");
      this.canvas.className = "trails";
      this.ppi.canvases[0].after(this.canvas);
      this.grid = new OffscreenCanvas(CELLS, CELLS);
      this.context = this.grid.getContext("2d");
      /** @type {ImageData} */
      this.image = this.context.createImageData(CELLS, CELLS);
      /** Its pixels. @type {Uint32Array} */
      this.out = new Uint32Array(this.image.data.buffer);
      this.table = new BinTable();
    }
    if (!this.stamps) {
      this.stamps = new Float32Array(CELLS * CELLS).fill(NEVER); // seconds
      this.peaks = new Uint8Array(CELLS * CELLS); // what stood out
      this.newest = new Uint8Array(CELLS * CELLS);
      this.usual = new Float32Array(CELLS * CELLS).fill(-1); // -1: not known
      this.spread = new Float32Array(CELLS * CELLS);
      this.origin = null;
      this.rows = null;
    }
  }

  #remove() {
    this.canvas.remove();
    this.canvas = this.table = this.image = this.out = null;
    this.clear();
  }

  /** The grid's cells and middle, where antenna, range or kind of trail have changed. */
  #follow() {
    const { bins: { placement }, look } = this;
    const isSlant = this.ppi.isSlant;
    const key = `${placement.key} ${isSlant} ${look.relative}`;
    if (key === this.key) return;
    this.key = key;
    const cell_m = (2 * REACH * placement.rMax_m) / CELLS;
    /** @type {Point} */
    const here = [placement.latitude_deg, placement.longitude_deg];
    let { origin } = this;
    const kind = `${isSlant} ${look.relative}`;
    if (!origin || this.kind !== kind) {
      if (origin) this.stamps.fill(NEVER);
      origin = { at: here, cell_m };
    }
    this.kind = kind;
    if (look.relative) origin = { ...origin, at: here };
    // Of the grid's middle, from the antenna.
    let [east_m, north_m] = inverse(...here, ...origin.at);
    const isFar = Math.hypot(east_m, north_m) > (REACH - 1) * placement.rMax_m;
    if (isFar || origin.cell_m !== cell_m) {
      const [right, up] = [Math.round(-east_m / origin.cell_m), Math.round(-north_m / origin.cell_m)];
      this.#regrid(origin.cell_m, cell_m, right, up);
      origin = { at: direct(...origin.at, right * origin.cell_m, up * origin.cell_m), cell_m };
      [east_m, north_m] = inverse(...here, ...origin.at);
    }
    this.origin = origin;
    this.view = { width: CELLS, height: CELLS, pixel_m: cell_m, right_m: east_m, ahead_m: north_m, up_deg: 0, slant: isSlant };
    this.table.build(placement, this.view);
    if (look.relative || !this.bins.scan) this.rows = null; // else an azimuth stays on the earth as it was seen
  }

  /**
   * Cells of another size, with the middle so many old cells to the right and up.
   * @param {number} old_m
   * @param {number} new_m
   * @param {number} right
   * @param {number} up
   */
  #regrid(old_m, new_m, right, up) {
    const [k, middle] = [new_m / old_m, CELLS / 2];
    const to = Int32Array.from({ length: CELLS }, (_, x) => Math.floor(middle + (x + 0.5 - middle) * k + right));
    /** @template {Float32Array|Uint8Array} Cells @param {Cells} was @param {number} empty @returns {Cells} */
    const moved = (was, empty) => {
      const is = /** @type {Cells} */ (was.slice().fill(empty));
      for (let y = 0; y < CELLS; ++y) {
        const fromY = Math.floor(middle + (y + 0.5 - middle) * k - up);
        if (fromY < 0 || fromY >= CELLS) continue;
        for (let x = 0; x < CELLS; ++x) if (to[x] >= 0 && to[x] < CELLS) is[y * CELLS + x] = was[fromY * CELLS + to[x]];
      }
      return is;
    };
    [this.stamps, this.peaks, this.newest] = [moved(this.stamps, NEVER), moved(this.peaks, 0), moved(this.newest, 0)];
    [this.usual, this.spread] = [moved(this.usual, -1), moved(this.spread, 0)];
  }

  /** Azimuths that have been seen since the last look. @param {number} clock_ms */
  #note(clock_ms) {
    const { bins } = this;
    const { table: { pixels, bins: binOf, rowStart }, stamps, peaks, newest, usual, spread } = this;
    const { azimuths } = bins.placement;
    const perdB = 1 / bins.step_dB;
    const [out, first] = [OUT_DB * perdB, FIRST_SPREAD_DB * perdB];
    if (this.rows?.length !== azimuths) this.rows = new Float64Array(azimuths).fill(NaN);
    const settings = `${bins.descriptor.settings_version} ${bins.floor_dB} ${bins.step_dB}`;
    if (settings !== this.settings) usual.fill(-1); // a knob was turned
    this.settings = settings;
    const stamp = clock_ms / 1000;
    for (let row = 0; row < azimuths; ++row) {
      if (bins.seen_ms[row] === this.rows[row] || bins.seen_ms[row] === -Infinity) continue;
      this.rows[row] = bins.seen_ms[row];
      for (let k = rowStart[row]; k < rowStart[row + 1]; ++k) {
        const cell = pixels[k];
        const value = bins.video[binOf[k]];
        newest[cell] = value;
        if (usual[cell] < 0) {
          usual[cell] = value;
          spread[cell] = first;
          continue;
        }
        const above = value - usual[cell];
        if (above > out && above > OUT_SPREADS * spread[cell]) {
          stamps[cell] = stamp;
          peaks[cell] = value;
        } else spread[cell] += SPREAD_PART * (Math.abs(above) - spread[cell]);
        usual[cell] += above * (above > 0 ? RISE : FALL);
      }
    }
  }

  /** The picture of the grid: what stood out and is gone, the fainter the older. @param {number} clock_ms */
  #paint(clock_ms) {
    const { stamps, peaks, newest, out } = this;
    const gone = GONE_DB / this.bins.step_dB;
    const length_s = this.length_ms / 1000;
    const now = clock_ms / 1000;
    const colour = packed(HUES[this.look.palette] ?? HUES.green) & 0xffffff;
    const shades = Uint32Array.from({ length: 256 }, (_, k) => {
      const light = FAINTEST + (1 - FAINTEST) * (1 - k / 255) ** 1.4;
      return (colour | (Math.round(235 * light) << 24)) >>> 0;
    });
    const perS = 255 / length_s;
    for (let cell = 0; cell < out.length; ++cell) {
      const age_s = now - stamps[cell];
      out[cell] = age_s <= length_s && age_s >= 0 && newest[cell] < peaks[cell] - gone ? shades[(age_s * perS) | 0] : 0;
    }
    this.context.putImageData(this.image, 0, 0);
  }

  /** Onto the picture as it is looked at. */
  #show() {
    const { ppi, look } = this;
    const { view } = ppi;
    this.drawn = view;
    const { canvas } = this;
    if (canvas.width !== view.width || canvas.height !== view.height) [canvas.width, canvas.height] = [view.width, view.height];
    const c = canvas.getContext("2d");
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    if (!this.view) return;
    c.imageSmoothingEnabled = true;
    if (look.bscope) return this.#showB(c);
    // From cells to the plane, east and north, to the picture.
    const u = view.up_deg * DEGREE;
    const k = this.view.pixel_m / view.pixel_m;
    const [sin, cos] = [Math.sin(u) * k, Math.cos(u) * k];
    const [e, n] = onPlane(this.view, 0, 0);
    const right = e * Math.cos(u) - n * Math.sin(u);
    const ahead = e * Math.sin(u) + n * Math.cos(u);
    c.setTransform(cos, -sin, sin, cos, view.width / 2 + (right - view.right_m) / view.pixel_m, view.height / 2 - (ahead - view.ahead_m) / view.pixel_m);
    c.drawImage(this.grid, 0, 0);
    c.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** Of a B-scope: the cell of each place between its axes. @param {CanvasRenderingContext2D} c */
  #showB(c) {
    const { ppi, bins: { placement } } = this;
    const k = ppi.view.width / ppi.width;
    const [left, right, top, bottom] = [ppi.box.left, ppi.box.right, ppi.box.top, ppi.box.bottom].map((side) => Math.round(side * k));
    const [width, height] = [right - left, bottom - top];
    if (width < 1 || height < 1) return;
    const image = c.createImageData(width, height);
    const pixels = new Uint32Array(image.data.buffer);
    const middle_deg = placement.start_deg + placement.sector_deg / 2;
    const { pixel_m, right_m, ahead_m } = this.view;
    const across = Array.from({ length: width }, (_, x) => (placement.start_deg + ((x + 0.5) / width) * placement.sector_deg) * DEGREE);
    const [sines, cosines] = [across.map(Math.sin), across.map(Math.cos)];
    for (let y = 0; y < height; ++y) {
      const slant_m = placement.r0_m + (1 - (y + 0.5) / height) * (placement.rMax_m - placement.r0_m);
      const distance = Math.hypot(...ppi.placed(middle_deg, slant_m));
      for (let x = 0; x < width; ++x) {
        const cellX = Math.floor(CELLS / 2 + (distance * sines[x] - right_m) / pixel_m);
        const cellY = Math.floor(CELLS / 2 - (distance * cosines[x] - ahead_m) / pixel_m);
        if (cellX >= 0 && cellY >= 0 && cellX < CELLS && cellY < CELLS) pixels[y * width + x] = this.out[cellY * CELLS + cellX];
      }
    }
    c.putImageData(image, left, top);
  }
}
