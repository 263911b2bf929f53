// One picture with its source: a live radar, or the first one's view rendered at another range scale or through another frustum.

import { Annunciators } from "./annunciators.js";
import { Bins } from "./bins.js";
import { put } from "../dom.js";
import { Events } from "../events.js";
import { asStates } from "../labels.js";
import { Levels, bestScale } from "./levels.js";
import { Ppi } from "./ppi.js";
import { Profile } from "./profile.js";
import { Scope } from "./scope.js";
import { Trails } from "./trails.js";
import { refusalText } from "../stream.js";
import { changesOf } from "../sources.js";
import { number, utcNow_ms } from "../messages.js";

const TARGETS_MS = 2000; // between frames of a picture that is rendered with moving targets

const MARKUP = `<div class="ppi" tabindex="0" role="application" aria-label="Radar picture"></div>
<div class="corner source"><select class="pick" title="What this picture shows: a radar, or the first one at another range scale"
 aria-label="Radar of this picture"></select><span class="about"></span></div>
<div class="banner" hidden></div>
<canvas class="scope" aria-label="Level over range at the cursor's bearing"></canvas>`;

/** @typedef {import("../messages.js").MessageOf} MessageOf */

/**
 * What a picture says: another source was picked; its levels, or what they may make up for, are others; they were set by hand; targets came;
 * azimuths were drawn, with their latencies and the angle that the beam moved by; a whole frame was drawn.
 * @typedef {{picked: string, levels: undefined, set: undefined, targets: MessageOf["TargetBlock"],
 *   drew: {latencies_ms: number[], step_deg: number}, frame: undefined}} Said
 */

/** @extends {Events<Said>} */
export class Pane extends Events {
  /**
   * @param {HTMLElement} parent
   * @param {object} parts
   * @param {import("../look.js").Look} parts.look
   * @param {import("../stream.js").Link} parts.link
   * @param {import("../debrief.js").Debrief} parts.debrief
   * @param {string} source "radar NAME", "scale NM" or "frustum KIND"
   * @param {{low: number, span: number, auto: boolean}} levels
   */
  constructor(parent, { look, link, debrief }, source, levels) {
    super();
    this.look = look;
    this.link = link;
    this.debrief = debrief;
    this.element = document.createElement("section");
    this.element.className = "pane";
    this.element.innerHTML = MARKUP;
    parent.append(this.element);
    this.bins = new Bins();
    this.ppi = new Ppi(this.element.querySelector(".ppi"), this.bins, look);
    this.scope = new Scope(this.element.querySelector(".scope"));
    this.profile = new Profile(this.scope.canvas, look, link);
    this.trails = new Trails(this.bins, this.ppi, look, debrief);
    this.annunciators = new Annunciators(this.ppi.element);
    this.banner = /** @type {HTMLElement} */ (this.element.querySelector(".banner"));
    this.about = this.element.querySelector(".about");
    this.pick = /** @type {HTMLSelectElement} */ (this.element.querySelector(".pick"));
    this.pick.onchange = () => this.emit("picked", this.pick.value);
    this.source = source;
    this.levels = new Levels(levels);
    /** @type {import("../../wire.js").RadarInfo|null} */
    this.info = null;
    /** @type {import("../../wire.js").RadarStatus|null} */
    this.status = null;
    /** What is wrong with it in the server's words. @type {string|null} */
    this.says = null;
    this.drawnFrames = 0;
    /** Of what was shown last: since its pose came, or since the beam saw it. @type {number|null} */
    this.latency_ms = null;
    /** @type {number|null} */
    this.beam_ms = null;
    this.mayCompensate = false;
    /** @type {import("./bins.js").Times|null} */
    this.shownTimes = null;
    /** @type {number|null} */
    this.held_ms = null;
    this.clear();
  }

  get heading() {
    return this.ppi.heading;
  }
  get radar() {
    return this.source.startsWith("radar ") ? this.source.slice(6) : "";
  }
  /** Not a live radar: each of its frames is asked for. */
  get isRendered() {
    return !this.radar;
  }
  /** In a sentence: "through the oblique frustum", "at range 12 NM". */
  get called() {
    return this.frustum ? `through the ${this.frustum} frustum` : `at range ${this.source.slice(6)}`;
  }
  get frustum() {
    return this.source.startsWith("frustum ") ? this.source.slice(8) : "";
  }

  clear() {
    this.levels.unsettle();
    this.heading.forget();
    /** @type {import("../../wire.js").Pose|null} */
    this.newestPose = null;
    this.ppi.truth?.clear();
    this.trails.clear();
    this.awaits = true; // its first picture
    /** What RenderOnce was last asked for. @type {string} */
    this.rendered = "";
    /** Its request, while unanswered. @type {string} */
    this.pending = "";
  }

  /** Nothing is known of its radar: there is no connection. */
  forget() {
    this.info = this.status = null;
    this.clear();
    this.bins.abort();
  }

  /** @param {import("../messages.js").Message} message of this pane's frames */
  take({ type, body, plane, utc_ms }) {
    const { bins, ppi } = this;
    if (type === "FrameBegin") {
      bins.isRecorded = this.debrief.isOn;
      if (bins.begin(body)) ppi.refresh();
      this.says = null;
      this.awaits = false;
      this.#pose(body.frame.pose);
      this.describe();
    } else if (type === "WedgeBlock") {
      if (body.pose) this.#pose(body.pose);
      this.#block(body, plane, utc_ms);
    } else if (type === "TargetBlock") {
      this.emit("targets", /** @type {MessageOf["TargetBlock"]} */ ({ type, body, plane, utc_ms }));
    } else if (type === "FrameEnd") {
      if (bins.end(body)) ppi.refresh();
      this.#law();
      this.level(performance.now());
    } else if (type === "FrameAbort") {
      bins.abort();
    }
  }

  /** @param {import("../../wire.js").WedgeBlock} body @param {Uint8Array} plane @param {number} utc_ms */
  #block(body, plane, utc_ms) {
    const { bins, debrief, look: { label } } = this;
    const now_ms = performance.now();
    // At utc_ms the server's monotonic clock stood at send_ns.
    const past_ms = utcNow_ms() + this.link.offset_ms - utc_ms;
    const sent_ns = number(body.send_ns);
    const clock = {
      now_ms, utc_ms: debrief.isOn ? debrief.utcAt_ms(debrief.position_s) : utc_ms,
      age_ms: (/** @type {string|undefined} */ clock_ns) => (clock_ns === undefined ? 0 : past_ms + (sent_ns - number(clock_ns)) * 1e-6),
    };
    if (label && body.plane === label) bins.block(...asStates(body, label, plane, bins.descriptor), clock);
    else bins.block(body, plane, clock);
  }

  /** The legend says whether the picture makes up for the range. */
  #law() {
    const { bins, ppi } = this;
    if (this.mayCompensate === bins.mayCompensate) return;
    this.mayCompensate = bins.mayCompensate;
    ppi.needs.grid = true;
    this.emit("levels");
  }

  /** Of what comes; a picture that another up turns is laid out anew. @param {import("../../wire.js").Pose|undefined} pose */
  #pose(pose) {
    if (!pose) return;
    this.newestPose = pose;
    const { heading, ppi, look } = this;
    heading.take(pose, performance.now());
    if (!this.bins.placement || (look.up !== "heading" && look.up !== "course")) return;
    const { up_deg } = heading.up(look.up, this.bins.placement);
    if (Math.abs(((up_deg - ppi.view.up_deg + 540) % 360) - 180) > 0.5) ppi.refresh();
  }

  describe() {
    const { placement, descriptor } = this.bins;
    const s = descriptor.settings;
    const rows = this.element.clientWidth > 700 ? `${placement.azimuths} × ${placement.ranges} bins` : "";
    this.about.textContent = [`${number(s.frequency_ghz).toFixed(2)} GHz`, rows].filter(Boolean).join(" · ");
  }

  // ---- Levels

  /** The bins' levels are to be those of this picture. */
  setScale() {
    const { low_dB, span_dB } = this.levels;
    this.bins.scale = { low_dB, span_dB, compensated: this.look.compensated };
  }

  /** Its levels have changed. */
  rescale() {
    this.setScale();
    this.bins.rescale();
    this.ppi.needs.grid = true;
    this.emit("levels");
  }

  /** Black level and span by the receiver or by what is shown, where nobody has set them. @param {number} now_ms */
  level(now_ms) {
    const wanted = this.levels.wanted(this.bins, this.ppi.table, now_ms);
    if (!wanted) return;
    Object.assign(this.levels, wanted);
    this.rescale();
  }

  /** By the receiver or by what is shown from now on, found anew. */
  levelAnew() {
    this.levels.unsettle();
    if (this.bins.descriptor) this.level(performance.now());
  }

  /** Sets them by what is shown now; they do not follow it. */
  levelOnce() {
    const best = this.bins.descriptor && bestScale(this.bins, this.ppi.table);
    if (best) this.setLevels(best.low_dB, best.span_dB);
  }

  /** By hand. @param {number} low_dB @param {number} span_dB */
  setLevels(low_dB, span_dB) {
    this.levels.set(low_dB, span_dB);
    this.rescale();
    this.emit("set");
  }

  // ---- Drawing

  /** @param {number} now_ms */
  draw(now_ms) {
    const { bins, ppi } = this;
    const { cursor, hold } = this.look;
    const isHeld = !this.link.isLive || hold;
    if (isHeld && !ppi.needs.grid && !ppi.needs.marks && !ppi.needs.table) return this.trails.draw(now_ms, true);
    if (!isHeld) this.held_ms = now_ms;
    const hadMarks = ppi.needs.marks;
    const isNew = ppi.draw(now_ms, isHeld ? this.held_ms ?? now_ms : null);
    this.trails.draw(now_ms, isHeld);
    if (isNew || (hadMarks && !ppi.needs.marks)) {
      if (this.profile.isWanted(this.radar)) this.profile.draw(this.radar, bins.placement, this.newestPose);
      else this.scope.draw(bins, this.look, cursor && ppi.read(cursor));
    }
    if (!isNew || isHeld) return;
    if (!this.levels.isSettled) this.level(now_ms);
    const { newest } = bins;
    const passed = bins.passed.splice(0);
    if (newest && newest !== this.shownTimes) {
      this.shownTimes = newest;
      const done_ms = performance.now();
      this.latency_ms = this.heading.isMoving(done_ms) ? newest.pose_ms + done_ms - newest.at_ms : null; // else it is the pose's age
      this.beam_ms = bins.scan && passed.length ? passed[0] + done_ms - now_ms : null;
      const latencies_ms = bins.scan ? passed.map((ms) => ms + done_ms - now_ms) : [newest.pose_ms + done_ms - newest.at_ms];
      this.emit("drew", { latencies_ms, step_deg: bins.scan ? passed.length * bins.placement.width_deg : 0 });
    }
    if (bins.frames !== this.drawnFrames) {
      this.drawnFrames = bins.frames;
      this.emit("frame");
    }
  }

  /**
   * Asks for this pane's own frame where the first pane shows something new.
   * @param {Pane} first
   * @param {import("../../wire.js").PlaneKind[]} planes
   * @param {boolean} truth where targets are, too
   */
  renderAgain(first, planes, truth) {
    const { link, look } = this;
    const d = first.bins.descriptor;
    if (!this.isRendered || this.pending || !d || !link.isLive || look.hold) return;
    const moment = d.targets ? Math.floor(performance.now() / TARGETS_MS) : 0; // they move, where nothing else does
    const wanted = JSON.stringify([this.source, d.settings, d.pose, planes, truth, moment]);
    if (wanted === this.rendered) return;
    this.rendered = wanted;
    const settings = { ...d.settings, ...changesOf(this.source, d.settings) };
    if (settings.planes_per_bin && settings.frustum === "SWEEP") delete settings.pixel_columns;
    this.pending = link.render({ radar: first.radar, settings, pose: d.pose, video_bits: 8, planes, ...(d.targets && { live_targets: true, truth }) });
  }

  /** The server renders no such frame. @param {import("../stream.js").Refused} error */
  refused(error) {
    this.pending = "";
    this.says = `No picture ${this.called}: ${refusalText(error)}.`;
  }

  /** Words on the picture itself: a sentence, nothing for none, and its corners. @param {string} sentence */
  tell(sentence) {
    put(this.banner, sentence);
    this.banner.hidden = !sentence;
    this.annunciators.show(this);
    this.element.classList.toggle("standby", Boolean(this.info?.transmit_off));
  }

  remove() {
    this.element.remove();
  }
}
