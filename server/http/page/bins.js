// The bins of one radar as they arrive: values as sent, the levels that are shown, when each azimuth was seen.

import { Placement } from "./placement.js";
import { fieldOf, isDefault } from "./form.js";
import { number } from "./messages.js";

const MOST_HELD_MS = 74; // a scanning beam's azimuths wait at most this long for their turn
const MS = 1e-6; // of a nanosecond

/**
 * How the bytes of plane VIDEO become levels 1 to 255. Level 0: no echo at all.
 * @typedef {object} Scale
 * @property {number} low_dB black
 * @property {number} span_dB to the brightest
 * @property {boolean} compensated for range
 */

export class Bins {
  /** @type {import("./form.js").Parameter[]|null} those that are not_ideal; null: not known yet */
  static notIdeal = null;

  constructor() {
    /** @type {any} the newest FrameDescriptor */
    this.descriptor = null;
    /** @type {Placement|null} */
    this.placement = null;
    /** @type {any} ScanPass; null: whole frames */
    this.scan = null;
    this.video = new Uint8Array(0); // [azimuth, range], as sent
    this.state = new Uint8Array(0);
    this.hasState = new Uint8Array(0); // [azimuth] whether its states have come
    this.shown = new Uint8ClampedArray(0); // levels
    this.seen_ms = new Float64Array(0); // [azimuth] when it was seen, by ageClock_ms(); -Infinity: never
    this.changed = new Uint8Array(0); // [azimuth]
    /** @type {Scale} */
    this.scale = { low_dB: -80, span_dB: 50, compensated: false };
    this.frames = 0; // whole ones
    this.skipped = 0;
    this.missed = 0; // dwells
    this.summary = null;
    /** Rows of a scanning beam that wait for their moment, in its order. */
    this.held = [];
    this.delay_ms = 40;
    this.hasStates = false;
    this.newest = null; // times of the newest row that was shown
    this.passed = []; // since the last look: how long ago the beam stood in each row that was shown, ms
    this.scanRow = -1;
    this.last = null; // of a scanning beam: the row shown before, and its bin
    this.gap = {};
    this.isRecorded = false;
    this.swept_ms = 0; // of a recording: for how long the beam has swept so far
  }

  /** What ages are counted by: of a recording the beam's own way, which pauses, speeds and seeks leave as it is. */
  ageClock_ms(now_ms) {
    return this.isRecorded ? this.swept_ms : now_ms;
  }

  get floor_dB() {
    return number(this.descriptor?.video_floor_db);
  }
  get step_dB() {
    return number(this.descriptor?.settings.video_span_db, 100) / 254;
  }
  /** An ideal map, as in ground_map.png: no receiver has added to its echoes or changed their law in range. */
  get isIdeal() {
    const s = this.descriptor?.settings;
    return Boolean(s && Bins.notIdeal?.every((parameter) => isDefault(parameter, s[fieldOf(parameter)])));
  }
  get mayCompensate() {
    return this.isIdeal && !this.descriptor.settings.range_normalisation;
  }

  /** Value in dB re the descriptor's power_unit, as sent; null: no echo. */
  value_dB(bin) {
    const value = this.video[bin];
    return value === 0 ? null : this.floor_dB + (value - 1) * this.step_dB;
  }

  /** Added to a level for display, in dB: r^2 of amplitudes, as in ground_map.png. */
  compensation_dB(column) {
    if (!this.scale.compensated || !this.mayCompensate) return 0;
    return 40 * Math.log10(this.placement.r0_m + (column + 0.5) * this.placement.spacing_m);
  }

  /**
   * @param {any} body of FrameBegin
   * @returns {boolean} whether bins now lie elsewhere
   */
  begin(body) {
    const d = body.frame;
    const placement = new Placement(d);
    this.skipped += number(body.frames_skipped);
    this.next = null;
    const scan = body.scan ?? null;
    const sameShape = this.placement && placement.azimuths === this.placement.azimuths &&
      placement.ranges === this.placement.ranges && placement.r0_m === this.placement.r0_m &&
      placement.spacing_m === this.placement.spacing_m && placement.width_deg === this.placement.width_deg;
    if (sameShape && !scan && placement.key !== this.placement.key) {
      // Shown when it is whole: half of it would lie where the antenna no longer is.
      const size = placement.azimuths * placement.ranges;
      this.next = { d, placement, video: this.spareVideo(size), state: this.spareState(size), hasState: this.hasState.slice(), count: 0 };
      return false;
    }
    const moved = this.placement?.key !== placement.key;
    if (sameShape && scan) this.#turn(placement);
    const levels = this.#levelsOf();
    this.#take(d, placement, sameShape);
    this.scan = scan;
    if (levels !== this.#levelsOf()) this.rescale();
    return moved;
  }

  spareVideo(size) {
    if (this.spare?.length !== size) this.spare = new Uint8Array(size);
    return this.spare;
  }
  spareState(size) {
    if (this.spareStates?.length !== size) this.spareStates = new Uint8Array(size);
    return this.spareStates;
  }

  /** What a level follows from beside its value. */
  #levelsOf() {
    return [this.floor_dB, this.step_dB, this.mayCompensate].join();
  }

  #take(d, placement, sameShape) {
    this.descriptor = d;
    this.placement = placement;
    if (sameShape) return;
    const size = placement.azimuths * placement.ranges;
    this.video = new Uint8Array(size);
    this.state = new Uint8Array(size);
    this.hasState = new Uint8Array(placement.azimuths);
    this.shown = new Uint8ClampedArray(size);
    this.seen_ms = new Float64Array(placement.azimuths).fill(-Infinity);
    this.changed = new Uint8Array(placement.azimuths).fill(1);
    this.held = [];
    this.scanRow = -1;
    this.last = null;
  }

  /** A sector that has turned keeps what it knows at its bearing. */
  #turn(placement) {
    const by = Math.round((placement.start_deg - this.placement.start_deg) / placement.width_deg);
    if (by === 0) return;
    const { azimuths, ranges, isRound } = placement;
    const old = { video: this.video.slice(), state: this.state.slice(), shown: this.shown.slice(), seen: this.seen_ms.slice(),
      hasState: this.hasState.slice() };
    this.last = null;
    for (let row = 0; row < azimuths; ++row) {
      const from = isRound ? (((row + by) % azimuths) + azimuths) % azimuths : row + by;
      const known = from >= 0 && from < azimuths;
      for (const plane of ["video", "state", "shown"]) {
        const target = this[plane].subarray(row * ranges, (row + 1) * ranges);
        if (known) target.set(old[plane].subarray(from * ranges, (from + 1) * ranges));
        else target.fill(0);
      }
      this.seen_ms[row] = known ? old.seen[from] : -Infinity;
      this.hasState[row] = known ? old.hasState[from] : 0;
    }
    this.changed.fill(1);
  }

  /**
   * @param {any} body of WedgeBlock
   * @param {Uint8Array} plane
   * @param {{now_ms: number, utc_ms: number, age_ms: (clock_ns: any) => number}} clock utc_ms: of what is seen;
   *   age_ms: since a reading of the server's clock
   */
  block(body, plane, clock) {
    const { placement } = this.next ?? this;
    if (!placement || (body.plane !== "VIDEO" && body.plane !== "STATE")) return;
    const first = number(body.first_azimuth);
    const rows = number(body.n_azimuth);
    if (number(body.n_range) !== placement.ranges || number(body.first_range) !== 0) {
      this.#copyPart(this.next ?? this, body, plane);
      return;
    }
    const times = { pose_ms: clock.age_ms(body.pose_received_ns), beam_ms: clock.age_ms(body.beam_ns), at_ms: clock.now_ms,
      utc_ms: clock.utc_ms };
    if (body.plane === "STATE") this.hasStates = true;
    if (this.next) {
      this.next[body.plane === "VIDEO" ? "video" : "state"].set(plane, first * placement.ranges);
      if (body.plane === "STATE") this.next.hasState.fill(1, first, first + rows);
      this.next.times = times;
    } else if (body.plane === "STATE" && !(this.scan && body.beam_ns !== undefined)) {
      this.#showStates(first, plane, rows);
    } else if (this.scan && body.beam_ns !== undefined) {
      this.#hold(body, plane, first, rows, times);
    } else {
      this.#show(first, plane, rows, times);
    }
  }

  #copyPart(target, body, plane) {
    const ranges = target.placement.ranges;
    const values = body.plane === "VIDEO" ? target.video : target.state;
    const n = number(body.n_range);
    const first = number(body.first_azimuth);
    for (let row = 0; row < number(body.n_azimuth); ++row)
      values.set(plane.subarray(row * n, (row + 1) * n), (first + row) * ranges + number(body.first_range));
    if (target === this) this.#levels(first, number(body.n_azimuth));
  }

  /** A dwell's azimuths are shown one by one as the beam passed them, a little later. */
  #hold(body, plane, first, rows, times) {
    const { width_deg, ranges, azimuths, isRound, bearing_deg } = this.placement;
    const turn = Math.round((number(body.pose?.bearing_deg, bearing_deg) - bearing_deg) / width_deg);
    const dwell = number(this.scan.dwell_bins, rows);
    const dwellFirst = Math.floor(first / dwell) * dwell;
    const middle = dwellFirst + Math.min(dwell, azimuths - dwellFirst) / 2;
    const row_ms = (1000 * width_deg) / number(this.scan.rate_deg_s, 1) * (this.scan.clockwise ? 1 : -1);
    for (let k = 0; k < rows; ++k) {
      const row = this.scan.clockwise ? k : rows - 1 - k;
      let to = first + row + turn;
      if (isRound) to = ((to % azimuths) + azimuths) % azimuths;
      if (to < 0 || to >= azimuths) continue;
      const beam_ms = times.at_ms - times.beam_ms + (first + row + 0.5 - middle) * row_ms;
      const values = plane.subarray(row * ranges, (row + 1) * ranges);
      if (body.plane === "STATE") {
        this.held.push({ row: to, states: values, beam_ms });
        continue;
      }
      const late_ms = times.at_ms - beam_ms;
      // As late as the latest azimuth of late, so that the beam moves evenly.
      this.delay_ms = Math.min(Math.max(this.delay_ms - 0.02, late_ms), MOST_HELD_MS);
      this.held.push({ row: to, bin: first + row, values, beam_ms, row_ms, times });
    }
    if (body.plane === "STATE") this.held.sort((a, b) => a.beam_ms - b.beam_ms); // a row's states after its values
  }

  /** Shows what is due. */
  advance(now_ms) {
    let due = 0;
    while (due < this.held.length && this.held[due].beam_ms + this.delay_ms <= now_ms) {
      const { row, bin, states, values, beam_ms, row_ms, times } = this.held[due++];
      if (states) {
        this.#showStates(row, states, 1);
        for (const to of this.gap[row] ?? []) this.#showStates(to, states, 1);
        continue;
      }
      this.#show(row, values, 1, { ...times, beam_ms: now_ms - beam_ms, at_ms: now_ms });
      this.seen_ms[row] = beam_ms;
      if (beam_ms === -Infinity) { // missed
        this.last = null;
        continue;
      }
      if (this.isRecorded) this.seen_ms[row] = this.swept_ms += Math.abs(row_ms);
      this.#closeGap(row, bin);
      this.scanRow = row;
      this.passed.push(now_ms - beam_ms);
    }
    if (due) this.held.splice(0, due);
  }

  /**
   * Where the antenna itself turns with the scan, the dwells that it renders lie apart. A beam leaves no gaps: azimuths that lie between two
   * that followed each other show the nearer one.
   */
  #closeGap(row, bin) {
    const { azimuths, ranges, isRound } = this.placement;
    const { last } = this;
    this.last = { row, bin };
    this.gap = { [row]: [] }; // rows that show what the key does
    if (!last) return;
    const step = this.scan.clockwise ? 1 : -1;
    const around = (n) => (isRound ? ((n % azimuths) + azimuths) % azimuths : n);
    if (around(last.bin + step) !== bin) return; // another pass, or what lies between was not looked at
    const gap = isRound ? around(step * (row - last.row)) : step * (row - last.row);
    if (gap < 2 || gap > azimuths / 2) return; // the next, or against the scan
    for (let k = 1; k < gap; ++k) {
      const to = around(last.row + step * k);
      const from = 2 * k < gap ? last.row : row;
      this.video.copyWithin(to * ranges, from * ranges, (from + 1) * ranges);
      if (from === row) this.gap[row].push(to); // its states are still to come
      else if (this.hasState[from]) this.#showStates(to, this.state.subarray(from * ranges, (from + 1) * ranges), 1);
      this.#levels(to, 1);
      this.seen_ms[to] = this.seen_ms[from];
    }
  }

  #showStates(first, states, rows) {
    this.state.set(states, first * this.placement.ranges);
    this.hasState.fill(1, first, first + rows);
    this.changed.fill(1, first, first + rows);
  }

  #show(first, values, rows, times) {
    this.video.set(values, first * this.placement.ranges);
    this.newest = times;
    this.#levels(first, rows);
    this.seen_ms.fill(times.at_ms, first, first + rows);
  }

  #levels(first, rows) {
    const { ranges } = this.placement;
    const { low_dB, span_dB } = this.scale;
    const perdB = 254 / span_dB;
    const step = this.step_dB * perdB;
    const base = 1 + (this.floor_dB - this.step_dB - low_dB) * perdB;
    const offset = this.#offsets(base, perdB);
    const { video, shown } = this;
    for (let row = first; row < first + rows; ++row) {
      const start = row * ranges;
      for (let k = 0; k < ranges; ++k) {
        const value = video[start + k];
        const level = value * step + offset[k];
        shown[start + k] = value === 0 ? 0 : level < 1 ? 1 : level;
      }
    }
    this.changed.fill(1, first, first + rows);
  }

  #offsets(base, perdB) {
    const { ranges } = this.placement;
    const key = `${base} ${perdB} ${this.scale.compensated && this.mayCompensate} ${this.placement.r0_m} ${ranges}`;
    if (this.offsetsKey !== key) {
      this.offsetsKey = key;
      this.offset = Float64Array.from({ length: ranges }, (_, k) => base + perdB * this.compensation_dB(k));
    }
    return this.offset;
  }

  /** Levels of all bins anew. */
  rescale() {
    if (this.placement) this.#levels(0, this.placement.azimuths);
  }

  /** @param {any} body of FrameEnd @returns {boolean} whether bins now lie elsewhere */
  end(body) {
    this.summary = body.summary ?? null;
    this.render_ms = 1000 * number(body.render_s);
    ++this.frames;
    for (const span of body.missed ?? []) this.#miss(number(span.first_azimuth), number(span.n_azimuth));
    if (!this.next) return false;
    const { d, placement, video, state, hasState, times } = this.next;
    const levels = this.#levelsOf();
    [this.spare, this.spareStates] = [this.video, this.state];
    this.#take(d, placement, true);
    [this.video, this.state, this.hasState] = [video, state, hasState];
    this.scan = null;
    this.next = null;
    if (levels !== this.#levelsOf() || times) this.#levels(0, placement.azimuths);
    if (times) this.newest = times;
    this.seen_ms.fill(times?.at_ms ?? performance.now());
    return true;
  }

  /** Missed dwells stay dark. */
  #miss(first, rows) {
    this.missed += rows;
    const { ranges } = this.placement;
    const values = new Uint8Array(ranges);
    for (let row = first; row < first + rows; ++row) this.held.push({ row, values, beam_ms: -Infinity, times: this.newest });
  }

  /** Nothing that was seen holds any more. */
  clear() {
    for (const plane of [this.video, this.state, this.shown, this.hasState]) plane.fill(0);
    this.seen_ms.fill(-Infinity);
    this.changed.fill(1);
    this.held = [];
    this.last = null;
  }

  /** They come no more. */
  forgetStates() {
    if (!this.hasStates) return;
    this.hasStates = false;
    this.hasState.fill(0);
    this.changed.fill(1);
  }

  abort() {
    this.next = null;
    this.held = [];
    this.last = null;
  }

  /** Low and high end in dB of what `bins` show, 5th to 99.7th percentile, at least 10 dB, as in ground_map.png. */
  bestScale(table) {
    const counts = new Float64Array(1024);
    const every = 7;
    const low = this.floor_dB + (this.mayCompensate && this.scale.compensated ? 40 * Math.log10(Math.max(1, this.placement.r0_m)) : 0);
    let total = 0;
    for (let k = 0; k < table.size; k += every) {
      const bin = table.bins[k];
      const value = this.value_dB(bin);
      if (value === null) continue;
      const level = value + this.compensation_dB(bin % this.placement.ranges);
      ++counts[Math.max(0, Math.min(1023, Math.round((level - low) * 4)))];
      ++total;
    }
    if (total < 50) return null;
    const at = (part) => {
      let sum = 0;
      const k = counts.findIndex((count) => (sum += count) >= part * total);
      return low + k / 4;
    };
    const black = Math.floor(at(0.05));
    return { low_dB: black, span_dB: Math.max(10, Math.ceil(at(0.997)) - black) };
  }
}
