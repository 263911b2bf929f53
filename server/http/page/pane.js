// One picture with its source: a live radar, or the first one's view rendered at another range scale or through another frustum.

import { Annunciators } from "./annunciators.js";
import { Bins } from "./bins.js";
import { asStates } from "./labels.js";
import { Levels } from "./levels.js";
import { Ppi } from "./ppi.js";
import { Profile } from "./profile.js";
import { Scope } from "./scope.js";
import { Trails } from "./trails.js";
import { refusalText } from "./form.js";
import { changesOf } from "./sources.js";
import { number, utcNow_ms } from "./messages.js";

const TARGETS_MS = 2000; // between frames of a picture that is rendered with moving targets

const MARKUP = `<div class="ppi" tabindex="0" role="application" aria-label="Radar picture"></div>
<div class="corner source"><select class="pick" title="What this picture shows: a radar, or the first one at another range scale"
 aria-label="Radar of this picture"></select><span class="about"></span></div>
<div class="banner" hidden></div>
<canvas class="scope" aria-label="Level over range at the cursor's bearing"></canvas>`;

export class Pane {
  /**
   * @param {HTMLElement} parent
   * @param {import("./main.js").App} app
   * @param {string} source "radar NAME", "scale NM" or "frustum KIND"
   * @param {{low: number, span: number, auto: boolean}} levels
   */
  constructor(parent, app, source, levels) {
    this.app = app;
    this.element = document.createElement("section");
    this.element.className = "pane";
    this.element.innerHTML = MARKUP;
    parent.append(this.element);
    this.bins = new Bins();
    this.ppi = new Ppi(this.element.querySelector(".ppi"), this.bins, app.look);
    this.scope = new Scope(this.element.querySelector(".scope"));
    this.profile = new Profile(this.scope.canvas);
    this.trails = new Trails(this);
    this.annunciators = new Annunciators(this.ppi.element);
    this.banner = this.element.querySelector(".banner");
    this.about = this.element.querySelector(".about");
    this.pick = this.element.querySelector(".pick");
    this.pick.onchange = () => app.choose(this, this.pick.value);
    this.source = source;
    this.levels = new Levels(levels);
    this.info = null; // RadarInfo
    this.status = null; // RadarStatus
    this.rendered = ""; // what RenderOnce was last asked for
    this.pending = ""; // its request, while unanswered
    this.drawnFrames = 0;
    this.latency_ms = null;
    this.clear();
  }

  get heading() {
    return this.ppi?.heading;
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
    this.heading?.forget();
    this.newestPose = null;
    this.ppi?.truth?.clear();
    this.trails?.clear();
    this.awaits = true; // its first picture
    this.pending = this.rendered = "";
  }

  /** @param {import("./messages.js").Message} message of this pane's frames */
  take({ type, body, plane, utc_ms }) {
    const { bins, ppi } = this;
    if (type === "FrameBegin") {
      this.app.setScale(this);
      bins.isRecorded = Boolean(this.app.debrief.state);
      if (bins.begin(body)) ppi.refresh();
      this.says = null;
      this.awaits = false;
      this.#pose(body.frame.pose);
      this.describe();
    } else if (type === "WedgeBlock") {
      const now_ms = performance.now();
      if (body.pose) this.#pose(body.pose);
      // At utc_ms the server's monotonic clock stood at send_ns.
      const past_ms = utcNow_ms() + this.app.link.offset_ms - utc_ms;
      const sent_ns = number(body.send_ns);
      const age_ms = (clock_ns) => (clock_ns === undefined ? 0 : past_ms + (sent_ns - number(clock_ns)) * 1e-6);
      const { debrief, look } = this.app;
      [body, plane] = look.label && body.plane === look.label ? asStates(body, plane, bins.descriptor) : [body, plane];
      bins.block(body, plane, { now_ms, age_ms, utc_ms: debrief.state ? debrief.utcAt_ms(debrief.position_s) : utc_ms });
    } else if (type === "TargetBlock") {
      this.app.targets.take(this, { body, plane });
    } else if (type === "FrameEnd") {
      if (bins.end(body)) ppi.refresh();
      this.#law();
      this.level(performance.now());
    } else if (type === "FrameAbort") {
      bins.abort();
    }
  }

  /** The legend says whether the picture makes up for the range. */
  #law() {
    const { bins, ppi } = this;
    if (this.mayCompensate === bins.mayCompensate) return;
    this.mayCompensate = bins.mayCompensate;
    ppi.needs.grid = true;
    this.app.display.show();
  }

  /** Of what comes; a picture that another up turns is laid out anew. */
  #pose(pose) {
    if (!pose) return;
    this.newestPose = pose;
    const { heading, ppi, app: { look } } = this;
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

  /** Black level and span by the receiver or by what is shown, where nobody has set them. */
  level(now_ms) {
    const wanted = this.levels.wanted(this.bins, this.ppi.table, now_ms);
    if (!wanted) return;
    Object.assign(this.levels, wanted);
    this.app.rescale(this);
  }

  /** Sets them by what is shown now; they do not follow it. */
  levelOnce() {
    const best = this.bins.descriptor && this.bins.bestScale(this.ppi.table);
    if (best) this.app.level(best.low_dB, best.span_dB, this);
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    const { bins, ppi } = this;
    const { cursor, hold } = this.app.look;
    const isHeld = !this.app.link.isLive || hold;
    if (isHeld && !ppi.needs.grid && !ppi.needs.marks && !ppi.needs.table) return this.trails.draw(now_ms, true);
    if (!isHeld) this.held_ms = now_ms;
    const hadMarks = ppi.needs.marks;
    const isNew = ppi.draw(now_ms, isHeld ? this.held_ms ?? now_ms : null);
    this.trails.draw(now_ms, isHeld);
    if (isNew || (hadMarks && !ppi.needs.marks)) {
      if (this.profile.isWanted(this)) this.profile.draw(this);
      else this.scope.draw(bins, this.app.look, cursor && ppi.read(cursor));
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
      const latencies = bins.scan ? passed.map((ms) => ms + done_ms - now_ms) : [newest.pose_ms + done_ms - newest.at_ms];
      this.app.meter.drew(this, latencies, bins.scan ? passed.length * bins.placement.width_deg : 0);
    }
    if (bins.frames !== this.drawnFrames) {
      this.drawnFrames = bins.frames;
      this.app.meter.frameDrawn(this);
    }
  }

  /** Asks for this pane's own frame where the first pane shows something new. */
  renderAgain(first) {
    const { link, look } = this.app;
    const d = first.bins.descriptor;
    if (!this.isRendered || this.pending || !d || !link.isLive || look.hold) return;
    const second = this.app.secondPlane(first.radar);
    const { isOn: truth } = this.app.targets;
    const moment = d.targets ? Math.floor(performance.now() / TARGETS_MS) : 0; // they move, where nothing else does
    const wanted = JSON.stringify([this.source, d.settings, d.pose, second, truth, moment]);
    if (wanted === this.rendered) return;
    this.rendered = wanted;
    const settings = { ...d.settings, ...changesOf(this.source, d.settings) };
    if (settings.planes_per_bin && settings.frustum === "SWEEP") delete settings.pixel_columns;
    this.pending = link.render({ radar: first.radar, settings, pose: d.pose, video_bits: 8, ...(d.targets && { live_targets: true, truth }),
      planes: ["VIDEO", second].filter(Boolean) });
  }

  /** The server renders no such frame. */
  refused(error) {
    this.pending = "";
    this.says = `No picture ${this.called}: ${refusalText(error)}.`;
  }

  /** A sentence on the picture itself; nothing: none. */
  say(text) {
    if (this.banner.textContent === text) return;
    this.banner.textContent = text;
    this.banner.hidden = !text;
  }

  remove() {
    this.element.remove();
  }
}
