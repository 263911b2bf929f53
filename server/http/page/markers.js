// What a viewer puts on the pictures: cursor, bearing lines and range markers.

import { Events } from "./events.js";
import { crossing, movedLines, noLines } from "./picture/lines.js";

/**
 * @typedef {import("./picture/lines.js").Line} Line
 * @typedef {import("./picture/lines.js").Lines} Lines
 * @typedef {import("./look.js").Place} Place
 * @typedef {import("./picture/pane.js").Pane} Pane
 */

/** Lines have moved, or one waits for its place. @extends {Events<{lines: undefined}>} */
export class Markers extends Events {
  /** @param {import("./look.js").Look} look @param {import("./pictures.js").Pictures} pictures */
  constructor(look, pictures) {
    super();
    this.look = look;
    this.pictures = pictures;
  }

  /** @param {Place|null} place */
  setCursor(place) {
    this.look.cursor = place;
    this.pictures.mark();
  }

  /** @param {number} dx the page's pixels on the first picture @param {number} dy */
  moveCursor(dx, dy) {
    const { ppi, bins } = this.pictures.first;
    if (!bins.placement) return;
    const { cursor } = this.look;
    const [x, y] = cursor ? ppi.toScreen(cursor.east_m, cursor.north_m) : [ppi.width / 2, ppi.height / 2];
    this.setCursor(ppi.fromScreen(x + dx, y + dy));
  }

  /** @param {import("./picture/lines.js").Lines} lines */
  setLines(lines) {
    this.look.lines = lines;
    this.look.armed = null;
    this.pictures.mark();
    this.emit("lines");
  }

  /** @param {Line} line @param {Pane} pane @param {number} x the page's pixels @param {number} y */
  placeLine(line, pane, x, y) {
    const at = pane.ppi.read(pane.ppi.fromScreen(x, y));
    if (at) this.setLines(movedLines(this.look.lines, line, at));
  }

  /** Takes it away; or places it at the cursor, or by the next click. @param {Line} line */
  toggleLine(line) {
    const { look } = this;
    const [kind, k] = line;
    const { ebl, vrm } = look.lines;
    const isThere = kind === "mark" ? crossing(look.lines, k) : look.lines[kind][k] !== null;
    const without = (/** @type {Lines["ebl"]} */ [first, second]) => /** @type {Lines["ebl"]} */ (k === 0 ? [null, second] : [first, null]);
    if (isThere) this.setLines({ ebl: kind === "vrm" ? ebl : without(ebl), vrm: kind === "ebl" ? vrm : without(vrm) });
    else if (look.cursor && !/^(ebl|vrm)-/.test(document.activeElement?.id ?? "")) this.setLines(movedLines(look.lines, line, this.pictures.first.ppi.read(look.cursor)));
    else look.armed = String(look.armed) === String(line) ? null : line;
    this.emit("lines");
  }

  /** All of them go. */
  clear() {
    this.look.cursor = null;
    this.setLines(noLines());
  }
}
