// A target's route as the page changes it: what of it is still ahead, worked out as the server does from its place, speeds and age.

import { number } from "./messages.js";
import { inverse } from "./placement.js";

/**
 * @typedef {object} RoutePoint
 * @property {number} latitude_deg
 * @property {number} longitude_deg
 * @property {number} height_m over the target's reference
 * @property {number} speed_m_s on the way to it
 */

/** @param {any} target of a TargetList @returns {RoutePoint[]} all of its points */
export function pointsOf({ route, height_m }) {
  const speeds = route?.speed_m_s ?? [];
  return (route?.latitude_deg ?? []).map((latitude_deg, k) => ({
    latitude_deg: number(latitude_deg), longitude_deg: number(route.longitude_deg?.[k]),
    height_m: number(route.height_m?.[k], number(height_m)), speed_m_s: number(speeds[k] ?? speeds[0]),
  }));
}

const length = (from, to) => Math.hypot(...inverse(from.latitude_deg, from.longitude_deg, to.latitude_deg, to.longitude_deg));

/**
 * The points that it has not reached, in their order; of a loop all, the next one first.
 * @param {any} target of a TargetList
 * @param {number} age_s since it was at its place
 * @returns {RoutePoint[]}
 */
export function pointsAhead(target, age_s) {
  const points = pointsOf(target);
  if (!points.length) return points;
  const start = { latitude_deg: number(target.latitude_deg), longitude_deg: number(target.longitude_deg) };
  const loops = Boolean(target.route.loops);
  const ways = points.map((point, k) => ({ to: point, s: length(points[k - 1] ?? start, point) / Math.max(1e-3, point.speed_m_s) }));
  if (loops) ways.push({ to: null, s: length(points.at(-1), start) / Math.max(1e-3, points.at(-1).speed_m_s) });
  const round_s = ways.reduce((sum, { s }) => sum + s, 0);
  let left_s = loops && round_s > 0 ? age_s % round_s : age_s;
  let next = 0;
  while (next < ways.length && left_s >= ways[next].s) left_s -= ways[next++].s;
  if (!loops) return points.slice(next);
  const first = next % points.length;
  return [...points.slice(first), ...points.slice(0, first)];
}

/** @param {RoutePoint[]} points @param {boolean} loops */
export function routeOf(points, loops) {
  const list = (key) => points.map((point) => point[key]);
  return { latitude_deg: list("latitude_deg"), longitude_deg: list("longitude_deg"), height_m: list("height_m"), speed_m_s: list("speed_m_s"), loops };
}
