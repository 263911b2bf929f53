// A target's route as the page changes it: what of it is still ahead, worked out as the server does from its place, speeds and age.

import { number } from "./messages.js";
import { inverse } from "./picture/placement.js";

/**
 * @typedef {object} RoutePoint
 * @property {number} latitude_deg
 * @property {number} longitude_deg
 * @property {number} height_m over the target's reference
 * @property {number} speed_m_s on the way to it
 */

/** @typedef {{latitude_deg: number, longitude_deg: number}} LatLon */
/** @typedef {{from: LatLon, to: RoutePoint, m: number, s: number}} Way from one point to the next: metres and seconds */

/** @param {import("../wire.js").Target} target @returns {RoutePoint[]} all of its points */
export function pointsOf({ route, height_m }) {
  const speeds = route?.speed_m_s ?? [];
  return (route?.latitude_deg ?? []).map((latitude_deg, k) => ({
    latitude_deg: number(latitude_deg), longitude_deg: number(route.longitude_deg?.[k]),
    height_m: number(route.height_m?.[k], number(height_m)), speed_m_s: number(speeds[k] ?? speeds[0]),
  }));
}

/** In metres. @param {LatLon} from @param {LatLon} to */
const length = (from, to) => Math.hypot(...inverse(from.latitude_deg, from.longitude_deg, to.latitude_deg, to.longitude_deg));

/**
 * How many of the ways it has behind it, so long after it was at their beginning.
 * @param {Way[]} ways
 * @param {number} age_s
 * @param {boolean} loops
 */
function passedBy(ways, age_s, loops) {
  const round_s = ways.reduce((sum, { s }) => sum + s, 0);
  let left_s = loops && round_s > 0 ? age_s % round_s : age_s;
  let passed = 0;
  while (passed < ways.length && left_s >= ways[passed].s) left_s -= ways[passed++].s;
  return passed;
}

/** The way that it is on by where it is: that which is the least detour. @param {Way[]} ways @param {LatLon} here */
function wayAt(ways, here) {
  const detours = ways.map(({ from, to, m }) => length(from, here) + length(here, to) - m);
  return detours.indexOf(Math.min(...detours));
}

/**
 * The points that it has not reached, in their order; of a loop all, the next one first.
 * @param {import("../wire.js").Target} target
 * @param {number|null} age_s since it was at its place; null: no clock says it
 * @param {LatLon|undefined} here where it is
 * @returns {RoutePoint[]}
 */
export function pointsAhead(target, age_s, here) {
  const points = pointsOf(target);
  if (!points.length) return points;
  const start = { latitude_deg: number(target.latitude_deg), longitude_deg: number(target.longitude_deg) };
  const loops = Boolean(target.route.loops);
  /** @type {RoutePoint[]} */
  const stops = loops ? [...points, { ...start, height_m: 0, speed_m_s: points.at(-1).speed_m_s }] : points;
  const ways = stops.map((to, k) => {
    const from = stops[k - 1] ?? start;
    const m = length(from, to);
    return { from, to, m, s: m / Math.max(1e-3, to.speed_m_s) };
  });
  const passed = age_s !== null ? passedBy(ways, age_s, loops) : here ? wayAt(ways, here) : 0;
  if (!loops) return points.slice(passed);
  const first = passed % points.length;
  return [...points.slice(first), ...points.slice(0, first)];
}

/** @param {RoutePoint[]} points @param {boolean} loops */
export function routeOf(points, loops) {
  const list = (/** @type {keyof RoutePoint} */ key) => points.map((point) => point[key]);
  return { latitude_deg: list("latitude_deg"), longitude_deg: list("longitude_deg"), height_m: list("height_m"), speed_m_s: list("speed_m_s"), loops };
}
