// Where own ship or aircraft heads and where it goes, and what is up on a picture.

import { number } from "../messages.js";
import { DEGREE, inverse, turned } from "./placement.js";

/** @type {Up[]} */
export const UPS = ["north", "bearing", "heading", "course"];
export const UP_WORDS = { north: "N UP", bearing: "BRG UP", heading: "HDG UP", course: "CRS UP" };
const LEAST_M = 5; // way that gives a course
const OVER_MS = 3000; // that it is looked at over

/** @typedef {import("./placement.js").Placement} Placement */
/** @typedef {"north"|"bearing"|"heading"|"course"} Up what is up */
/** @typedef {Up|"auto"} Wish auto: a sector's bearing, all round north */

/** Heading, course and speed of one radar, from its poses: their velocity, or the way of the last seconds. */
export class Heading {
  constructor() {
    this.forget();
  }

  forget() {
    /** True; null: the poses have none. @type {number|null} */
    this.heading_deg = null;
    /** Null: it stands. @type {number|null} */
    this.course_deg = null;
    this.speed_mps = 0;
    /** Places of late, and when they were. @type {{place: [number, number], at_ms: number}[]} */
    this.trail = [];
    this.moved_ms = -Infinity; // when the newest pose was another than the one before
    /** Of the newest pose. @type {string} */
    this.key = "";
  }

  /** @param {import("../../wire.js").Pose} pose of a frame or a dwell @param {number} now_ms */
  take(pose, now_ms) {
    if (pose.heading_deg !== undefined) this.heading_deg = turned(number(pose.heading_deg));
    /** @type {[number, number]} */
    const place = [number(pose.latitude_deg), number(pose.longitude_deg)];
    const key = [...place, pose.height_m, pose.bearing_deg, pose.tilt_deg].join();
    if (this.key && key !== this.key) this.moved_ms = now_ms;
    this.key = key;
    const { trail } = this;
    trail.push({ place, at_ms: now_ms });
    while (trail.length > 2 && trail[1].at_ms < now_ms - OVER_MS) trail.shift();
    if (pose.velocity_north_m_s !== undefined) { // by the poses' own clock
      const [east, north] = [number(pose.velocity_east_m_s), number(pose.velocity_north_m_s)];
      this.#goes(east, north, Math.hypot(east, north) < (1000 * LEAST_M) / OVER_MS);
      return;
    }
    const took_ms = now_ms - trail[0].at_ms;
    if (took_ms < OVER_MS / 2) return;
    const [east_m, north_m] = inverse(...trail[0].place, ...place);
    this.#goes((1000 * east_m) / took_ms, (1000 * north_m) / took_ms, Math.hypot(east_m, north_m) < LEAST_M);
  }

  /** Metres a second over the ground. @param {number} east @param {number} north @param {boolean} stands */
  #goes(east, north, stands) {
    this.course_deg = stands ? null : turned(Math.atan2(east, north) / DEGREE);
    this.speed_mps = stands ? 0 : Math.hypot(east, north);
  }

  /** Whether poses that differ still come. @param {number} now_ms */
  isMoving(now_ms) {
    return now_ms - this.moved_ms < 3000;
  }

  /**
   * The line that a display draws ahead: the heading, or where poses have none the radar's own bearing.
   * @param {Placement} placement
   */
  ahead_deg(placement) {
    return this.heading_deg ?? placement.bearing_deg;
  }

  /**
   * @param {Wish} wish
   * @param {Placement} placement
   * @returns {{up: Up, up_deg: number}}
   */
  up(wish, placement) {
    const up = wish === "auto" ? (placement.isRound ? "north" : "bearing") : wish;
    const by = { north: 0, bearing: placement.bearing_deg, heading: this.ahead_deg(placement), course: this.course_deg ?? this.ahead_deg(placement) };
    return { up, up_deg: by[up] };
  }
}
