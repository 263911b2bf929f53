// Control of the first picture's radar: who holds it, and what the holder does to it.

import { Events } from "./events.js";
import { Refused, refusalText } from "./stream.js";
import { number } from "./messages.js";
import { turned } from "./picture/placement.js";

const TURN_MS = 2000;
const TAKEN = 102; // number of an Error
const NOT_CLAIMED = 103;

/** @typedef {import("../wire.js").Pose} Pose */

/**
 * A refusal in words; nothing: what was refused before is tried anew. Another client has taken control.
 * @extends {Events<{refusal: string, taken: string}>}
 */
export class Control extends Events {
  /**
   * @param {object} parts
   * @param {import("./stream.js").Link} parts.link
   * @param {import("./pictures.js").Pictures} parts.pictures
   * @param {import("./watch.js").Watch} parts.watch
   */
  constructor({ link, pictures, watch }) {
    super();
    this.link = link;
    this.pictures = pictures;
    this.watch = watch;
    /** Fields of the pose that aim the antenna and move nothing. @type {Set<string>} */
    this.aims = new Set();
    this.turned = { to_deg: 0, at_ms: -Infinity };
    link.on("Error", ({ body }) => body.number === TAKEN && this.emit("taken", `Control was taken: ${body.text}`));
  }

  get radar() {
    return this.pictures.first.radar;
  }
  get info() {
    return this.pictures.first.info;
  }
  get isMine() {
    return this.holds("SETTINGS_CLAIM") && this.link.isLive;
  }
  /** @param {import("../wire.js").ClaimKind} kind */
  holds(kind) {
    return Boolean(this.info?.claimed_by_you?.includes(kind));
  }
  /** Another client flies the radar. */
  get isFlown() {
    return Boolean(this.info?.controller) && !this.holds("POSE_CLAIM");
  }

  /** Does what may be refused. @param {() => Promise<unknown>} what */
  async attempt(what) {
    this.emit("refusal", "");
    try {
      await what();
    } catch (error) {
      this.emit("refusal", refusalText(error));
    }
    await this.watch.poll();
  }

  /** @param {string} messageField "RadarSettings.r_max_m" @param {unknown} value */
  async set(messageField, value) {
    const [message, field] = messageField.split(".");
    const { radar } = this;
    if (message === "Pose") await this.pose({ [field]: value });
    else await this.link.ask("SetSettings", { radar, settings: { [field]: value } });
    await this.watch.poll();
  }

  /**
   * The antenna is turned by the settings' holder; the radar, or the platform that it rides on, is moved by the holder of its
   * pose: this page, when nobody does.
   * @param {Pose} pose fields that change
   */
  async pose(pose) {
    const { link, radar, info } = this;
    const moves = !Object.keys(pose).every((field) => this.aims.has(field));
    const isHeld = !moves || this.holds("POSE_CLAIM");
    const flown = (moves && info?.platform) || radar;
    if (isHeld && this.isFlown && "bearing_deg" in pose) // then it counts from the heading
      pose = { ...pose, bearing_deg: turned(number(pose.bearing_deg) - number(info.pose?.heading_deg)) };
    const set = () => link.ask("SetPose", { radar: flown, pose });
    try {
      if (isHeld) {
        await set();
        return;
      }
    } catch (error) {
      // What is known may be older than the end of a claim that was borrowed for a moment.
      if (!moves || !(error instanceof Refused && error.number === NOT_CLAIMED)) throw error;
    }
    await link.ask("ClaimControl", { radar: flown, kinds: ["POSE_CLAIM"] });
    try {
      await set();
    } finally {
      await link.ask("ReleaseControl", { radar: flown, kinds: ["POSE_CLAIM"] });
    }
  }

  /** @param {number} bearing_deg */
  setBearing(bearing_deg) {
    const rounded = Math.round(bearing_deg * 10) / 10;
    return this.attempt(() => this.pose({ bearing_deg: rounded }));
  }

  /** @param {number} by_deg */
  turn(by_deg) {
    if (!this.info) return;
    // What was asked for last counts until the server has had time to say it.
    const now = performance.now();
    const from_deg = now - this.turned.at_ms < TURN_MS ? this.turned.to_deg : number(this.info.pose?.bearing_deg);
    this.turned = { to_deg: turned(from_deg + by_deg), at_ms: now };
    this.setBearing(this.turned.to_deg);
  }

  toggle() {
    const { link, radar, info } = this;
    return this.attempt(() => (this.isMine ? link.ask("ReleaseControl", { radar })
      : link.ask("ClaimControl", { radar, kinds: ["SETTINGS_CLAIM"], ...(info?.settings_controller && { force: true }) })));
  }

  /** @param {"transmit"|"freeze"} which */
  toggleState(which) {
    const change = which === "transmit" ? { transmit: Boolean(this.info?.transmit_off) } : { freeze: !this.info?.frozen };
    return this.attempt(() => this.link.ask("SetState", { radar: this.radar, ...change }));
  }

  /** All radars stand still, or go on. */
  toggleExercise() {
    return this.attempt(() => this.link.ask("SetExercise", { frozen: !this.info?.exercise_frozen }));
  }

  reset() {
    return this.attempt(() => this.link.ask("ResetExercise", { radar: this.radar }));
  }
}
