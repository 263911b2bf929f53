// What the page asks the server for all the time: frames of the radars that are shown, and how these stand.

import { Events } from "./events.js";
import { Refused } from "./stream.js";
import { number } from "./messages.js";
import { LEAST_COVERAGE } from "./words.js";

const POLL_MS = 1000;
const NO_SUCH_RADAR = 101; // number of an Error

/**
 * How all stand was asked for, answered or not; one of the radars is not there.
 * @extends {Events<{polled: undefined, unknown: undefined}>}
 */
export class Watch extends Events {
  /**
   * @param {object} parts
   * @param {import("./stream.js").Link} parts.link
   * @param {import("./pictures.js").Pictures} parts.pictures
   * @param {import("./look.js").Look} parts.look
   * @param {import("./debrief.js").Debrief} parts.debrief
   * @param {number} rate_hz of frames
   * @param {() => boolean} wantsTruth where targets are, too
   */
  constructor({ link, pictures, look, debrief }, rate_hz, wantsTruth) {
    super();
    this.link = link;
    this.pictures = pictures;
    this.look = look;
    this.debrief = debrief;
    this.rate_hz = rate_hz;
    this.wantsTruth = wantsTruth;
    /** @type {import("../wire.js").Status|null} */
    this.status = null;
    this.forget();
    document.addEventListener("visibilitychange", () => this.subscribe());
    setInterval(() => this.poll(), POLL_MS);
  }

  /** Of another connection nothing is subscribed. */
  forget() {
    /** Radars. @type {Set<string>} */
    this.subscribed = new Set();
    /** Those of them with states. @type {Set<string>} */
    this.withStates = new Set();
  }

  /** Asks for what the panes show; for nothing while the page is hidden. */
  async subscribe() {
    const { link, pictures: { panes } } = this;
    if (!link.isLive) return;
    const wanted = document.hidden ? new Set() : new Set(panes.map(({ radar }) => radar).filter(Boolean));
    const asks = [];
    for (const radar of this.subscribed) if (!wanted.has(radar)) asks.push(link.ask("Unsubscribe", { radar }));
    const rate_hz = Math.min(this.rate_hz, number(link.welcome.limits?.max_rate_hz, this.rate_hz));
    const truth = this.wantsTruth();
    this.withStates = new Set([...wanted].filter((radar) => this.#secondPlane(radar)));
    for (const radar of wanted)
      asks.push(link.ask("Subscribe", { radar, rate_hz, planes: this.planesOf(radar), video_bits: 8, ...(truth && { truth }) }).catch((error) => {
        this.pictures.say(radar, error.message);
        throw error;
      }));
    this.subscribed = wanted;
    for (const pane of panes) if (pane.radar && !this.withStates.has(pane.radar)) pane.bins.forgetStates();
    await Promise.allSettled(asks);
  }

  /** @param {string} radar */
  planesOf(radar) {
    const second = this.#secondPlane(radar);
    return /** @type {import("../wire.js").PlaneKind[]} */ (second ? ["VIDEO", second] : ["VIDEO"]);
  }

  /** What comes beside the video: a label, or states; nothing: neither. @param {string} radar */
  #secondPlane(radar) {
    return this.look.label || (this.#wantsStates(radar) ? "STATE" : "");
  }

  /** For the overlay; and where a live radar looks at ground that no file has, which is hatched. @param {string} radar */
  #wantsStates(radar) {
    if (this.look.overlay) return true;
    const coverage = this.status?.radars?.find((one) => one.radar === radar)?.coverage;
    return !this.debrief.isOn && number(coverage, 1) < LEAST_COVERAGE;
  }

  async poll() {
    const { link, pictures: { panes } } = this;
    if (!link.isLive || document.hidden) return;
    try {
      this.status = await link.ask("GetStatus");
      for (const pane of panes) {
        if (!pane.radar) continue;
        const { radar } = pane;
        const info = await link.ask("GetRadar", { radar });
        if (pane.radar !== radar) continue;
        pane.info = info;
        pane.status = (this.status.radars ?? []).find((r) => r.radar === radar) ?? null;
      }
      if ([...this.subscribed].some((radar) => this.#wantsStates(radar) !== this.withStates.has(radar))) this.subscribe();
    } catch (error) {
      if (error instanceof Refused && error.number === NO_SUCH_RADAR) this.emit("unknown");
    }
    this.emit("polled");
  }
}
