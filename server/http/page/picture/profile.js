// The ground along bearing line 1, from QueryGround: how high it is, and what of it the antenna sees.

import { stepOf } from "./grid.js";
import { BOTTOM, INK, LEFT, drawAxes, emptied } from "../plot.js";
import { bearingText } from "../readout.js";
import { number } from "../messages.js";

const POINTS = 256;
const PAUSE_MS = 500; // between questions
const SEEN = [1, 2]; // of a record's sight: visible, visible over unknown ground

/** @typedef {{slant_m: number, known: boolean, height_m: number, surface_m: number, seen: boolean}} Point */

/**
 * Records of a GroundAnswer: PROTOCOL.md, "Ground queries".
 * @param {import("../../wire.js").GroundAnswer} answer
 * @param {Uint8Array} plane
 * @returns {Omit<Point, "slant_m">[]}
 */
export function recordsOf({ points, record_bytes }, plane) {
  const view = new DataView(plane.buffer, plane.byteOffset, plane.byteLength);
  return Array.from({ length: number(points) }, (_, k) => {
    const at = k * number(record_bytes);
    return { known: view.getUint8(at + 60) === 0, height_m: view.getFloat64(at + 16, true), surface_m: view.getFloat64(at + 24, true),
      seen: SEEN.includes(view.getUint8(at + 61)) };
  });
}

export class Profile {
  /**
   * @param {HTMLCanvasElement} canvas the A-scope's
   * @param {import("../look.js").Look} look
   * @param {import("../stream.js").Link} link
   */
  constructor(canvas, look, link) {
    this.canvas = canvas;
    this.look = look;
    this.link = link;
    this.pending = false;
    this.context = canvas.getContext("2d");
    /** @type {Point[]} */
    this.points = [];
    this.antenna_m = NaN; // above the datum
    this.bearing_deg = 0;
    this.says = "";
    this.key = "";
    this.asked_ms = -Infinity;
  }

  /** @param {string} radar nothing: the picture has none of its own */
  isWanted(radar) {
    return this.look.profile && this.look.lines.ebl[0] !== null && Boolean(radar);
  }

  /**
   * Asks where something has changed.
   * @param {string} radar
   * @param {import("./placement.js").Placement} placement
   * @param {import("../../wire.js").Pose|null} newestPose
   */
  async #ask(radar, placement, newestPose) {
    const { link, look } = this;
    const now = performance.now();
    const bearing_deg = look.lines.ebl[0];
    const key = [radar, bearing_deg, placement.r0_m, placement.rMax_m, newestPose?.latitude_deg, newestPose?.longitude_deg, newestPose?.height_m].join();
    if (key === this.key || this.pending || now - this.asked_ms < PAUSE_MS || !link.isLive) return;
    [this.key, this.asked_ms, this.pending] = [key, now, true];
    const slants = Array.from({ length: POINTS }, (_, k) => placement.r0_m + ((k + 0.5) / POINTS) * (placement.rMax_m - placement.r0_m));
    const places = slants.map((slant_m) => placement.located(bearing_deg, slant_m));
    try {
      const answer = await link.ask("QueryGround", { radar, latitude_deg: places.map((p) => p.latitude_deg), longitude_deg: places.map((p) => p.longitude_deg) });
      this.points = recordsOf(answer, answer.plane).map((point, k) => ({ slant_m: slants[k], ...point }));
      this.antenna_m = answer.antenna && (answer.antenna.height_reference ?? "DATUM") === "DATUM" ? number(answer.antenna.height_m) : NaN;
      this.bearing_deg = bearing_deg;
      this.says = "";
    } catch (error) {
      [this.points, this.says] = [[], error.message];
    }
    this.pending = false;
  }

  /**
   * @param {string} radar
   * @param {import("./placement.js").Placement} placement
   * @param {import("../../wire.js").Pose|null} newestPose
   */
  draw(radar, placement, newestPose) {
    this.#ask(radar, placement, newestPose);
    const { canvas, context: c, look } = this;
    const room = emptied(canvas, look);
    if (!room) return;
    const [width, height] = room;
    c.fillStyle = INK;
    c.textAlign = "right";
    c.fillText(this.says || `profile ${bearingText(this.bearing_deg)} T`, width - 8, 13);
    c.textAlign = "left";
    const known = this.points.filter((point) => point.known);
    if (known.length === 0) return;
    const least = Math.min(...known.map((point) => point.height_m));
    const most = Math.max(...known.map((point) => point.surface_m), Number.isNaN(this.antenna_m) ? -Infinity : this.antenna_m);
    const span = Math.max(10, most - least);
    const floor = height - BOTTOM - 1;
    const x = (/** @type {number} */ slant_m) => LEFT + ((slant_m - placement.r0_m) / (placement.rMax_m - placement.r0_m)) * (width - LEFT - 6);
    const y = (/** @type {number} */ m) => 6 + (1 - (m - least) / (1.04 * span)) * (floor - 8);
    const step = stepOf(span, Math.max(2, Math.floor(height / 30)));
    drawAxes(c, placement, look, { width, height, x, y }, { least, most: least + span, step, unit: "m" });
    const each = (width - LEFT - 6) / POINTS;
    for (const point of this.points) {
      if (!point.known) continue;
      const left = x(point.slant_m) - each / 2;
      c.fillStyle = point.seen ? "#2c7d4f" : "#1d2f4f";
      c.fillRect(left, y(point.height_m), each + 0.5, floor - y(point.height_m));
      c.fillStyle = point.seen ? "#8ee6b2" : "#5d78a8";
      c.fillRect(left, y(point.surface_m) - 1, each + 0.5, 2);
    }
    if (!Number.isNaN(this.antenna_m)) {
      c.strokeStyle = "#ffa94d";
      c.setLineDash([3, 4]);
      c.beginPath();
      c.moveTo(LEFT, y(this.antenna_m));
      c.lineTo(width - 6, y(this.antenna_m));
      c.stroke();
      c.setLineDash([]);
    }
  }
}
