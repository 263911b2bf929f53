// The pictures beside each other: which there are, which frames are whose, and what a change of the look means to each.

import { $ } from "./dom.js";
import { Events } from "./events.js";
import { Pane } from "./picture/pane.js";
import { Refused } from "./stream.js";
import { applySize, sizeFor } from "./size.js";
import { number } from "./messages.js";

const FRAME_TYPES = /** @type {const} */ (["FrameBegin", "WedgeBlock", "TargetBlock", "FrameEnd", "FrameAbort"]);
const CONTROL_TAKEN = 102; // number of an Error

/**
 * What they say: one has come; another is active, or its levels have changed; how many there are has changed; one shows another source; levels
 * were set by hand; targets of one have come; of the first one: a frame was received, azimuths and frames were drawn.
 * @typedef {{added: Pane, active: undefined, count: undefined, chosen: Pane, set: undefined, targets: {pane: Pane,
 *   block: import("./messages.js").MessageOf["TargetBlock"]}, received: undefined, drew: {latencies_ms: number[], step_deg: number, draw_ms: number},
 *   frame: undefined}} Said
 */

/** @extends {Events<Said>} */
export class Pictures extends Events {
  /**
   * @param {object} parts
   * @param {import("./look.js").Look} parts.look
   * @param {import("./stream.js").Link} parts.link
   * @param {import("./debrief.js").Debrief} parts.debrief
   * @param {import("./fragment.js").Kept} kept
   */
  constructor(parts, kept) {
    super();
    this.parts = parts;
    this.look = parts.look;
    this.kept = kept;
    /** @type {Pane[]} */
    this.panes = [];
    this.activeNumber = 0;
    /** Radar or request of each stream of frames. @type {Map<number, {radar?: string, request?: string}>} */
    this.streams = new Map();
    for (const type of FRAME_TYPES) parts.link.on(type, (message) => this.take(message));
    parts.link.on("Error", ({ body }) => this.#refused(body));
    parts.debrief.on("sought", () => {
      for (const pane of this.panes) pane.bins.clear(); // what is shown belongs to the place before
    });
    this.look.on("change", (change) => this.#apply(change));
    addEventListener("resize", () => this.resize());
    this.look.px = sizeFor(this.look.size);
    applySize(this.look.px);
  }

  get first() {
    return this.panes[0];
  }
  /** The picture whose levels the tab Display has. */
  get active() {
    return this.panes[this.activeNumber] ?? this.first;
  }

  /** @param {string} source */
  add(source) {
    const { kept } = this;
    const levels = this.panes.length ? { low: kept.low2, span: kept.span2, auto: kept.auto2 } : kept;
    const pane = new Pane($("panes"), this.parts, source, levels);
    pane.element.addEventListener("pointerdown", () => this.activate(pane), true);
    pane.on("picked", (picked) => this.choose(pane, picked));
    pane.on("levels", () => {
      this.#autoGlow(pane);
      this.emit("active");
    });
    pane.on("set", () => this.emit("set"));
    pane.on("targets", (block) => this.emit("targets", { pane, block }));
    pane.on("drew", (drawn) => pane === this.first && this.emit("drew", { ...drawn, draw_ms: pane.ppi.times.draw_ms }));
    pane.on("frame", () => pane === this.first && this.emit("frame"));
    this.panes.push(pane);
    $("panes").dataset.count = String(this.panes.length);
    this.emit("added", pane);
  }

  /** @param {Pane} pane */
  activate(pane) {
    this.activeNumber = this.panes.indexOf(pane);
    for (const one of this.panes) one.element.classList.toggle("active", one === pane && this.panes.length > 1);
    this.emit("active");
  }

  /** @param {number} count @param {string} other what a second one shows; nothing: there is none */
  setCount(count, other) {
    if (count > this.panes.length && !other) return;
    while (this.panes.length > count) this.panes.pop().remove();
    if (this.panes.length < count) this.add(other);
    $("panes").dataset.count = String(this.panes.length);
    this.activate(this.active);
    this.emit("count");
  }

  /** @param {Pane} pane @param {string} source */
  choose(pane, source) {
    pane.source = source;
    pane.info = pane.status = null;
    pane.clear();
    if (pane === this.first) this.kept.a = pane.radar;
    else this.kept.b = source;
    this.emit("chosen", pane);
  }

  /** The connection is gone. */
  forget() {
    this.streams.clear();
    for (const pane of this.panes) pane.forget();
  }

  // ---- What comes

  /** @param {import("./messages.js").Message} message of a frame */
  take(message) {
    const { type, body, stream } = message;
    if (type === "FrameBegin")
      this.streams.set(stream, number(body.request_id) ? { request: body.request_id } : { radar: body.frame.radar });
    const of = this.streams.get(stream);
    const isOver = type === "FrameEnd" || type === "FrameAbort";
    const id = of?.request ?? (type === "FrameAbort" ? body.request_id : undefined);
    for (const pane of this.panes) {
      const isOwn = id ? pane.pending === id : pane.radar && pane.radar === of?.radar;
      if (!isOwn || this.look.hold) continue;
      if (type === "FrameBegin") {
        pane.setScale();
        this.#autoGlow(pane);
      }
      pane.take(message);
      if (type === "FrameEnd" && pane === this.first) this.emit("received");
      if (id && isOver) pane.pending = "";
    }
    if (of?.request && isOver) this.streams.delete(stream);
  }

  /** @param {import("../wire.js").Error} body */
  #refused(body) {
    const asked = this.panes.find(({ pending }) => pending && pending === body.request_id);
    if (asked) asked.refused(new Refused(body));
    else if (body.number !== CONTROL_TAKEN) this.say(body.radar, body.text);
  }

  /** On the pictures of a radar; of all, where none is named. @param {string|undefined} radar @param {string} text */
  say(radar, text) {
    for (const pane of this.panes) if (!radar || pane.radar === radar) pane.says = text;
  }

  // ---- How they are shown

  /** @param {Partial<import("./look.js").LookValues>} change */
  #apply(change) {
    const has = (/** @type {string[]} */ ...keys) => keys.some((key) => key in change);
    if (has("size")) this.resize();
    for (const pane of this.panes) {
      if (has("label")) pane.bins.forgetStates();
      if (has("palette", "afterglow_s")) pane.ppi.restyle();
      if (has("compensated")) {
        pane.levels.unsettle();
        pane.rescale();
        if (pane.bins.descriptor) pane.level(performance.now());
      }
      if (has("overlay", "label")) pane.ppi.needs.all = true;
      if (has("up", "slant", "bscope")) pane.ppi.refresh();
      pane.ppi.needs.grid = pane.ppi.needs.marks = true;
    }
  }

  /** Cursor, lines, markers and targets anew. */
  mark() {
    for (const { ppi } of this.panes) ppi.needs.marks = true;
  }

  /** An echo of a scanning antenna fades until the beam comes again; the first picture says when. @param {Pane} pane */
  #autoGlow(pane) {
    const { scan, placement } = pane.bins;
    if (pane !== this.first || !placement || !this.look.autoGlow) return;
    const pass_s = scan ? (placement.azimuths * placement.width_deg) / number(scan.rate_deg_s, 36) : 0;
    const glow = Math.min(20, Math.round(4 * pass_s) / 2);
    if (glow === this.look.afterglow_s) return;
    this.look.change({ afterglow_s: glow });
    this.emit("active");
  }

  /**
   * @param {number} factor 0: all of the sector
   * @param {number} [x] the page's pixels of what stays where it is
   * @param {number} [y]
   */
  zoom(factor, x, y, pane = this.first) {
    if (factor === 0) this.look.window = null;
    else pane.ppi.zoom(factor, x, y);
    this.layOut();
  }

  /** @param {number} dx the page's pixels @param {number} dy @param {Pane} pane */
  pan(dx, dy, pane) {
    pane.ppi.pan(dx, dy);
    this.layOut();
  }

  /** What the window shows is another part. */
  layOut() {
    for (const { ppi } of this.panes) ppi.refresh();
  }

  /** Letters and lines follow the window. */
  resize() {
    const px = sizeFor(this.look.size);
    if (px === this.look.px) return;
    this.look.px = px;
    applySize(px);
    for (const pane of this.panes) pane.ppi.resize();
  }

  /** Levels as the fragment keeps them: those that were set by hand. @returns {Partial<import("./fragment.js").Kept>} */
  get keptLevels() {
    return Object.fromEntries(this.panes.flatMap(({ levels: { low_dB, span_dB, auto } }, k) => {
      const of = k ? k + 1 : "";
      return auto ? [] : [[`auto${of}`, false], [`low${of}`, low_dB], [`span${of}`, span_dB]];
    }));
  }
}
