// Where targets are in a radar's frames, as the server's TargetBlocks say (proto/target_record.h), and how they go.

import { number } from "./messages.js";
import { DEGREE, direct, inverse, turned } from "./picture/placement.js";

const HIDDEN_BY = ["", "ground", "a building", "the horizon", "perhaps unknown ground"];
const OVER_MS = 4000; // that the way of a target is looked at over
const LEAST_MS = 900;
const LEADER_S = 60;

/**
 * @typedef {object} TargetRecord
 * @property {string} id
 * @property {number} latitude_deg of its foot
 * @property {number} longitude_deg
 * @property {number} height_m above the datum
 * @property {number} bearing_deg true
 * @property {number} range_m slant
 * @property {number} snr_dB
 * @property {boolean} isPower snr_dB is the echo's power in dBW
 * @property {number} share seen, 0 to 1
 * @property {number} azimuth_bin that holds it; -1: none
 * @property {number} range_bin likewise
 * @property {string} hiddenBy in words
 */

/** @param {import("../wire.js").TargetBlock} body @param {Uint8Array} plane @returns {TargetRecord[]} */
export function targetRecords(body, plane) {
  const view = new DataView(plane.buffer, plane.byteOffset, plane.byteLength);
  const bytes = number(body.record_bytes);
  return Array.from({ length: number(body.records) }, (_, k) => {
    const at = k * bytes;
    const double = (/** @type {number} */ offset) => view.getFloat64(at + offset, true);
    const float = (/** @type {number} */ offset) => view.getFloat32(at + offset, true);
    return {
      id: String(view.getBigUint64(at, true)),
      latitude_deg: double(8), longitude_deg: double(16), height_m: double(24), bearing_deg: double(32), range_m: double(40),
      snr_dB: float(56), share: float(64), azimuth_bin: view.getInt32(at + 68, true), range_bin: view.getInt32(at + 72, true),
      hiddenBy: HIDDEN_BY[view.getUint8(at + 76)] ?? "", isPower: view.getUint8(at + 77) !== 0,
    };
  });
}

/** Metres a second over the ground, north and east. @typedef {{north: number, east: number}} Velocity */

/** What one picture's frames tell. */
export class Truth {
  constructor() {
    /** @type {Map<string, TargetRecord>} */
    this.records = new Map();
    /** Places of late. @type {Map<string, {latitude_deg: number, longitude_deg: number, at_ms: number}[]>} */
    this.ways = new Map();
  }

  clear() {
    this.records.clear();
    this.ways.clear();
  }

  /**
   * @param {import("../wire.js").TargetBlock} body
   * @param {Uint8Array} plane
   * @param {boolean} isDwell of an antenna that scans
   * @param {number} now_ms
   */
  take(body, plane, isDwell, now_ms) {
    const found = targetRecords(body, plane);
    if (isDwell) {
      const first = number(body.azimuths?.first_azimuth);
      const end = first + number(body.azimuths?.n_azimuth);
      for (const [id, { azimuth_bin }] of this.records) if (azimuth_bin >= first && azimuth_bin < end) this.records.delete(id);
    } else {
      this.records.clear();
    }
    for (const record of found) {
      this.records.set(record.id, record);
      this.#note(record, now_ms);
    }
    if (!isDwell) for (const id of this.ways.keys()) if (!this.records.has(id)) this.ways.delete(id);
  }

  /** @param {TargetRecord} record @param {number} at_ms */
  #note({ id, latitude_deg, longitude_deg }, at_ms) {
    const way = this.ways.get(id) ?? [];
    way.push({ latitude_deg, longitude_deg, at_ms });
    while (way.length > 2 && way[1].at_ms < at_ms - OVER_MS) way.shift();
    this.ways.set(id, way);
  }

  /** Those that the world no longer has. @param {(id: string) => boolean} isThere */
  keepOnly(isThere) {
    for (const id of this.records.keys()) if (!isThere(id)) this.forget(id);
  }
  /** @param {string} id */
  forget(id) {
    this.records.delete(id);
    this.ways.delete(id);
  }
  /** It was put elsewhere: its way begins anew. @param {string} id */
  moved(id) {
    this.ways.delete(id);
  }

  /** From successive records; null: not known yet. @param {string} id @returns {Velocity|null} */
  velocityOf(id) {
    const way = this.ways.get(id);
    const [first, last] = [way?.[0], way?.at(-1)];
    const took_ms = way ? last.at_ms - first.at_ms : 0;
    if (took_ms < LEAST_MS) return null;
    const [east, north] = inverse(first.latitude_deg, first.longitude_deg, last.latitude_deg, last.longitude_deg);
    return { north: (1000 * north) / took_ms, east: (1000 * east) / took_ms };
  }
}

/**
 * What an antenna measures of a place and height above the datum.
 * @param {import("./picture/placement.js").Placement} placement
 * @param {number} latitude_deg
 * @param {number} longitude_deg
 * @param {number} height_m
 */
export function measured(placement, latitude_deg, longitude_deg, height_m) {
  const [x, y, z] = placement.world.world(latitude_deg, longitude_deg, height_m);
  const [dx, dy, dz] = [x - placement.x_m, y - placement.y_m, z - placement.z_m];
  return { bearing_deg: turned((Math.atan2(dx, dz) - placement.north_rad) / DEGREE), range_m: Math.hypot(dx, dy, dz) };
}

/**
 * Where it will be in a minute.
 * @param {import("./picture/placement.js").Placement} placement
 * @param {TargetRecord} record
 * @param {Velocity} velocity
 */
export function soon(placement, { latitude_deg, longitude_deg, height_m }, { north, east }) {
  return measured(placement, ...direct(latitude_deg, longitude_deg, east * LEADER_S, north * LEADER_S), height_m);
}
