// Where a bin lies: PROTOCOL.md, "Where a bin lies", both ways, and the plane of the picture around the antenna.
//
// World frame: x east, y up, z north of the scene's origin on the WGS84 ellipsoid, metres, refraction in y. The plane
// is azimuthal equidistant about the antenna, in metres east and north of it.

const A_M = 6378137; // WGS84
const F = 1 / 298.257223563;
const E2 = F * (2 - F);
const B_M = A_M * (1 - F);
export const DEGREE = Math.PI / 180;
const STEPS = 5; // leave less than a micrometre

const { sin, cos, tan, sqrt, atan2, atan, hypot } = Math;

/** @param {number} angle_deg to 0..360 */
export const turned = (angle_deg) => ((angle_deg % 360) + 360) % 360;

/** @typedef {[number, number]} Point east and north on a plane in metres, or right and down on a picture in pixels */

/** The frame of one scene origin. */
export class World {
  /** @param {number} latitude_deg @param {number} longitude_deg @param {number} radius_factor */
  constructor(latitude_deg, longitude_deg, radius_factor) {
    const phi = latitude_deg * DEGREE;
    this.longitude_deg = longitude_deg;
    this.sin = sin(phi);
    this.cos = cos(phi);
    this.n = A_M / sqrt(1 - E2 * this.sin ** 2);
    this.bend = 1 - 1 / radius_factor;
    const w = 1 / (1 - E2);
    this.uu = this.cos ** 2 + w * this.sin ** 2;
    this.un = (w - 1) * this.sin * this.cos;
    this.nn = this.sin ** 2 + w * this.cos ** 2;
  }

  /** The ellipsoid's own y, before refraction. @param {number} x @param {number} z */
  ellipsoid_y_m(x, z) {
    const h = this.n + this.un * z;
    const c = x * x + this.nn * z * z;
    return -c / (h + sqrt(Math.max(0, h * h - this.uu * c)));
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} z
   * @returns {[number, number, number]} latitude and longitude in degrees, height above the ellipsoid
   */
  geodetic(x, y, z) {
    const along = this.n + y + this.bend * this.ellipsoid_y_m(x, z);
    const first = along * this.cos - z * this.sin;
    const third = (along - this.n * E2) * this.sin + z * this.cos;
    const p = hypot(first, x);
    // Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23 (1976), one step.
    const theta = atan2(third * A_M, p * B_M);
    const latitude = atan2(third + (E2 / (1 - E2)) * B_M * sin(theta) ** 3, p - E2 * A_M * cos(theta) ** 3);
    const sine = sin(latitude);
    const height = p * cos(latitude) + third * sine - A_M * sqrt(1 - E2 * sine * sine);
    const longitude = this.longitude_deg + atan2(x, first) / DEGREE;
    return [latitude / DEGREE, turned(longitude + 180) - 180, height];
  }

  /**
   * @param {number} latitude_deg
   * @param {number} longitude_deg
   * @param {number} height_m
   * @returns {[number, number, number]} x, y, z of a geodetic position
   */
  world(latitude_deg, longitude_deg, height_m) {
    const phi = latitude_deg * DEGREE;
    const lambda = (longitude_deg - this.longitude_deg) * DEGREE;
    const n = A_M / sqrt(1 - E2 * sin(phi) ** 2);
    const p = (n + height_m) * cos(phi);
    const x = p * sin(lambda);
    const d1 = p * cos(lambda) - this.n * this.cos;
    const d3 = (n * (1 - E2) + height_m) * sin(phi) - this.n * (1 - E2) * this.sin;
    const z = d3 * this.cos - d1 * this.sin;
    return [x, d1 * this.cos + d3 * this.sin - this.bend * this.ellipsoid_y_m(x, z), z];
  }
}

/**
 * The geodesic from a point: T. Vincenty, "Direct and inverse solutions of geodesics on the ellipsoid", Survey Review 23
 * (1975), within 0.1 mm.
 * @param {number} latitude_deg
 * @param {number} longitude_deg
 * @param {number} east_m
 * @param {number} north_m
 * @returns {[number, number]} latitude and longitude in degrees
 */
export function direct(latitude_deg, longitude_deg, east_m, north_m) {
  const s = hypot(east_m, north_m);
  const alpha = atan2(east_m, north_m);
  const u1 = atan((1 - F) * tan(latitude_deg * DEGREE));
  const sinU = sin(u1);
  const cosU = cos(u1);
  const sigma1 = atan2(sinU / cosU, cos(alpha));
  const sinAlpha = cosU * sin(alpha);
  const cos2 = 1 - sinAlpha ** 2;
  const u2 = (cos2 * (A_M ** 2 - B_M ** 2)) / B_M ** 2;
  const aa = 1 + (u2 / 16384) * (4096 + u2 * (-768 + u2 * (320 - 175 * u2)));
  const bb = (u2 / 1024) * (256 + u2 * (-128 + u2 * (74 - 47 * u2)));
  const first = s / (B_M * aa);
  let sigma = first;
  let middle = 0;
  for (let step = 0; step < 4; ++step) { // each gains three digits
    middle = cos(2 * sigma1 + sigma);
    sigma = first + bb * sin(sigma) * (middle + (bb / 4) * (cos(sigma) * (2 * middle ** 2 - 1) -
      (bb / 6) * middle * (4 * sin(sigma) ** 2 - 3) * (4 * middle ** 2 - 3)));
  }
  middle = cos(2 * sigma1 + sigma);
  const sinS = sin(sigma);
  const cosS = cos(sigma);
  const latitude = atan2(sinU * cosS + cosU * sinS * cos(alpha),
    (1 - F) * hypot(sinAlpha, sinU * sinS - cosU * cosS * cos(alpha)));
  const c = (F / 16) * cos2 * (4 + F * (4 - 3 * cos2));
  const lambda = atan2(sinS * sin(alpha), cosU * cosS - sinU * sinS * cos(alpha)) -
    (1 - c) * F * sinAlpha * (sigma + c * sinS * (middle + c * cosS * (2 * middle ** 2 - 1)));
  return [latitude / DEGREE, longitude_deg + lambda / DEGREE];
}

/**
 * East and north of a point within some 1,000 km: direct() turned round on the tangent plane of the first point, where nothing
 * happens at a pole. A step leaves (s / R)^2 / 2 of the error: under a micrometre.
 * @param {number} latitude_deg
 * @param {number} longitude_deg
 * @param {number} toLatitude_deg
 * @param {number} toLongitude_deg
 * @returns {Point}
 */
export function inverse(latitude_deg, longitude_deg, toLatitude_deg, toLongitude_deg) {
  const tangent = new World(latitude_deg, longitude_deg, 1);
  const [x, , z] = tangent.world(toLatitude_deg, toLongitude_deg, 0);
  let [east, north] = [x, z];
  for (let step = 0; step < STEPS; ++step) {
    const [dx, , dz] = tangent.world(...direct(latitude_deg, longitude_deg, east, north), 0);
    east += x - dx;
    north += z - dz;
  }
  return [east, north];
}

/**
 * A frame's bins on the plane. Bearings in degrees, clockwise from true north at the antenna.
 */
export class Placement {
  /** @param {import("../../wire.js").FrameDescriptor} d */
  constructor(d) {
    const get = (/** @type {import("../messages.js").Numeric|undefined} */ value) => Number(value ?? 0);
    this.start_deg = get(d.azimuth_start_deg);
    this.width_deg = get(d.azimuth_width_deg);
    this.r0_m = get(d.range_start_m);
    this.spacing_m = get(d.range_spacing_m);
    this.azimuths = get(d.settings.azimuth_bins);
    this.ranges = get(d.settings.range_bins);
    this.reference_m = get(d.map_reference_height_m);
    this.north_rad = get(d.north_rad);
    this.x_m = get(d.antenna_x_m);
    this.y_m = get(d.antenna_y_m);
    this.z_m = get(d.antenna_z_m);
    this.latitude_deg = get(d.pose?.latitude_deg);
    this.longitude_deg = get(d.pose?.longitude_deg);
    this.bearing_deg = get(d.pose?.bearing_deg);
    this.world = new World(get(d.origin_latitude_deg), get(d.origin_longitude_deg),
      d.radius_factor === undefined ? 1 : Number(d.radius_factor));
    this.isRound = this.azimuths * this.width_deg > 359.999;
    /** Whatever the places of the bins relative to the antenna follow from. */
    this.key = [this.start_deg, this.width_deg, this.r0_m, this.spacing_m, this.azimuths, this.ranges, this.reference_m,
      this.north_rad, this.x_m, this.y_m, this.z_m, this.latitude_deg, this.longitude_deg, d.origin_latitude_deg,
      d.origin_longitude_deg, d.radius_factor].join();
    const [lat, lon] = this.world.geodetic(this.x_m, this.y_m, this.z_m);
    /** The antenna by the frame itself. */
    this.antenna_deg = [lat, lon];
  }

  get sector_deg() {
    return this.azimuths * this.width_deg;
  }

  get rMax_m() {
    return this.r0_m + this.ranges * this.spacing_m;
  }

  /**
   * What the antenna measures of a place on the plane: slant range, true bearing.
   * @param {number} east_m
   * @param {number} north_m
   */
  seen(east_m, north_m) {
    const [lat, lon] = direct(this.latitude_deg, this.longitude_deg, east_m, north_m);
    const [x, y, z] = this.world.world(lat, lon, this.reference_m);
    const dx = x - this.x_m;
    const dz = z - this.z_m;
    return {
      slant_m: hypot(dx, y - this.y_m, dz),
      ground_m: hypot(dx, dz),
      bearing_deg: (atan2(dx, dz) - this.north_rad) / DEGREE,
      latitude_deg: lat,
      longitude_deg: lon,
    };
  }

  /**
   * Where a bearing and slant range meet a height, that of the reference; ground_m is 0 where they do not.
   * @param {number} bearing_deg
   * @param {number} slant_m
   */
  located(bearing_deg, slant_m, height_m = this.reference_m) {
    const alpha = bearing_deg * DEGREE + this.north_rad;
    let y = height_m;
    let d, x, z;
    let lat, lon, height;
    for (let step = 0; step <= STEPS; ++step) {
      d = sqrt(Math.max(0, slant_m ** 2 - (this.y_m - y) ** 2));
      x = this.x_m + d * sin(alpha);
      z = this.z_m + d * cos(alpha);
      [lat, lon, height] = this.world.geodetic(x, y, z);
      y += height_m - height;
    }
    return { ground_m: d, latitude_deg: lat, longitude_deg: lon };
  }

  /** On the plane. @param {number} bearing_deg @param {number} slant_m @returns {Point} */
  place(bearing_deg, slant_m) {
    const { ground_m, latitude_deg, longitude_deg } = this.located(bearing_deg, slant_m);
    if (ground_m === 0) return [0, 0];
    return inverse(this.latitude_deg, this.longitude_deg, latitude_deg, longitude_deg);
  }

  /** Whether the farthest bins meet ground: not of an antenna too high, or too far from the scene's origin. */
  get hasGround() {
    return [this.start_deg, this.bearing_deg].every((bearing_deg) => {
      const { slant_m } = this.seen(...this.place(bearing_deg, this.rMax_m));
      return Math.abs(slant_m - this.rMax_m) < 0.01 * this.rMax_m;
    });
  }

  /**
   * Azimuth bin of a bearing, range bin of a slant range; -1 where there is none.
   * @param {number} bearing_deg
   * @param {number} slant_m
   */
  bin(bearing_deg, slant_m) {
    let row = Math.floor(turned(bearing_deg - this.start_deg) / this.width_deg);
    if (this.isRound) row = Math.min(row, this.azimuths - 1);
    const column = Math.floor((slant_m - this.r0_m) / this.spacing_m);
    const inside = row < this.azimuths && column >= 0 && column < this.ranges;
    return { row: inside ? row : -1, column: inside ? column : -1 };
  }
}
