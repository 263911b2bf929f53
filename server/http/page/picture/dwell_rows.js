// The rows of a scanning beam's dwell, each with the moment in which the beam stood there.

import { number } from "../messages.js";

/**
 * @typedef {object} Times of a block of azimuths, in ms
 * @property {number} pose_ms since its pose was received
 * @property {number} beam_ms since the beam stood there
 * @property {number} at_ms when it came, by performance.now()
 * @property {number} utc_ms of what is seen
 */

/**
 * A row that waits for its moment: values or states.
 * @typedef {object} HeldRow
 * @property {number} row
 * @property {number} beam_ms when the beam stood there, by performance.now(); -Infinity: the dwell was missed
 * @property {Uint8Array} [states]
 * @property {number} [bin] in the pass; a sector that has turned shows it in another row
 * @property {Uint8Array} [values]
 * @property {number} [row_ms] that the beam takes for it
 * @property {Times} [times]
 */

/**
 * @param {import("../../wire.js").ScanPass} scan
 * @param {import("./placement.js").Placement} placement
 * @param {import("../../wire.js").WedgeBlock} body
 * @param {Uint8Array} plane VIDEO or STATE, [azimuth, range]
 * @param {Times} times
 * @returns {HeldRow[]} in the beam's order
 */
export function dwellRows(scan, { width_deg, ranges, azimuths, isRound, bearing_deg }, body, plane, times) {
  const first = number(body.first_azimuth);
  const rows = number(body.n_azimuth);
  const turn = Math.round((number(body.pose?.bearing_deg, bearing_deg) - bearing_deg) / width_deg);
  const dwell = number(scan.dwell_bins, rows);
  const dwellFirst = Math.floor(first / dwell) * dwell;
  const middle = dwellFirst + Math.min(dwell, azimuths - dwellFirst) / 2;
  const row_ms = (1000 * width_deg) / number(scan.rate_deg_s, 1) * (scan.clockwise ? 1 : -1);
  /** @type {HeldRow[]} */
  const found = [];
  for (let k = 0; k < rows; ++k) {
    const row = scan.clockwise ? k : rows - 1 - k;
    let to = first + row + turn;
    if (isRound) to = ((to % azimuths) + azimuths) % azimuths;
    if (to < 0 || to >= azimuths) continue;
    const beam_ms = times.at_ms - times.beam_ms + (first + row + 0.5 - middle) * row_ms;
    const values = plane.subarray(row * ranges, (row + 1) * ranges);
    found.push(body.plane === "STATE" ? { row: to, beam_ms, states: values } : { row: to, beam_ms, bin: first + row, values, row_ms, times });
  }
  return found;
}
