// The bar of a served recording: pause, speed, any place of it. What one station sets holds for all.

import { $, buttonOf, inputOf, selectOf } from "./dom.js";
import { Events } from "./events.js";
import { number, utcNow_ms } from "./messages.js";
import { refusalText } from "./stream.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 10, 60];
const SEEK_MS = 120; // between places of a slider that is dragged
const STEPS = 2000; // of the slider, over the recording

/** 75.25 is "1:15.2", 3675 "1:01:15.0". @param {number} seconds */
function clockText(seconds) {
  const tenths = Math.max(0, Math.floor(10 * seconds + 1e-6));
  const [h, m] = [Math.floor(tenths / 36000), Math.floor(tenths / 600) % 60];
  const s = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
  return h ? `${h}:${String(m).padStart(2, "0")}:${s}` : `${m}:${s}`;
}

/**
 * The server turns out to serve a recording; it has gone to another place.
 * @extends {Events<{begun: undefined, sought: undefined}>}
 */
export class Debrief extends Events {
  /** @param {import("./stream.js").Link} link */
  constructor(link) {
    super();
    this.link = link;
    /** @type {import("../wire.js").ReplayState|null} */
    this.state = null;
    this.utc_ms = 0; // of the state
    this.sent_ms = 0; // when a place was last asked for
    /** Shown until the replay has gone there. @type {number|null} */
    this.asked_s = null;
    this.isDragged = false;
    this.unanswered = 0;
    this.refusal = "";
    const speed = selectOf("replay-speed");
    speed.replaceChildren(...SPEEDS.map((factor) => new Option(`× ${factor}`, String(factor))));
    speed.onchange = () => this.#set({ speed: Number(speed.value) });
    $("replay-pause").onclick = () => this.togglePause();
    $("replay-place").oninput = () => this.#drag(false);
    $("replay-place").onchange = () => this.#drag(true);
    link.on("ReplayState", (message) => this.#take(message));
  }

  /** Whether the server serves a recording. */
  get isOn() {
    return this.state !== null;
  }

  /** @param {import("./messages.js").MessageOf["ReplayState"]} message */
  #take({ body, utc_ms }) {
    const was = this.state;
    if (was && was.seeks !== body.seeks) this.emit("sought");
    this.state = body;
    this.utc_ms = utc_ms;
    if (!this.isDragged && !this.unanswered) this.asked_s = null;
    this.show();
    if (!was) this.emit("begun");
  }

  forget() {
    this.state = this.asked_s = null;
    this.show();
  }

  /** Seconds from the recording's beginning. */
  get position_s() {
    const { state } = this;
    const since_s = state.running ? (utcNow_ms() + this.link.offset_ms - this.utc_ms) / 1000 : 0;
    return Math.min(number(state.duration_s), number(state.position_s) + number(state.speed, 1) * Math.max(0, since_s));
  }

  /** Of a moment of the recording. @param {number} at_s */
  utcAt_ms(at_s) {
    return Number(BigInt(this.state.start_utc_ns ?? 0) / 1000000n) + 1000 * at_s;
  }

  togglePause() {
    const { state } = this;
    if (!state) return;
    if (state.ended) this.#set({ seek_s: 0, paused: false });
    else this.#set({ paused: !state.paused });
  }

  /** @param {number} by_s */
  step(by_s) {
    if (this.state) this.#set({ seek_s: Math.min(Math.max(0, this.position_s + by_s), number(this.state.duration_s)) });
  }

  /** @param {boolean} isLast */
  #drag(isLast) {
    this.isDragged = !isLast;
    this.asked_s = (Number(inputOf("replay-place").value) / STEPS) * number(this.state.duration_s);
    const now = performance.now();
    this.show();
    if (!isLast && now - this.sent_ms < SEEK_MS) return;
    this.sent_ms = now;
    this.#set({ seek_s: this.asked_s });
  }

  /** @param {import("../wire.js").SetReplay} change */
  async #set(change) {
    this.refusal = "";
    ++this.unanswered;
    try {
      await this.link.ask("SetReplay", change);
    } catch (error) {
      this.refusal = refusalText(error);
      this.asked_s = null;
    }
    --this.unanswered;
    this.show();
  }

  show() {
    const { state } = this;
    $("replay").hidden = !state;
    if (!state) return;
    const duration_s = number(state.duration_s);
    const place = inputOf("replay-place");
    const at_s = this.asked_s ?? this.position_s;
    const text = String(Math.round((STEPS * at_s) / Math.max(duration_s, 1e-3)));
    if (place.value !== text) place.value = text;
    const utc = new Date(this.utcAt_ms(at_s)).toISOString();
    $("replay-time").textContent = `${clockText(at_s)} / ${clockText(duration_s)}  ${utc.slice(11, 21)}Z`;
    $("replay-time").title = `Place in the recording, its length, and the time of the recording: ${utc}`;
    $("replay-pause").textContent = state.ended ? "again" : state.paused ? "play" : "pause";
    const speed = String(number(state.speed, 1));
    const speeds = selectOf("replay-speed");
    if (![...speeds.options].some(({ value }) => value === speed)) speeds.add(new Option(`× ${speed}`, speed));
    if (document.activeElement !== speeds) speeds.value = speed;
    const isViewer = this.link.welcome?.role === "viewer";
    for (const id of ["replay-pause", "replay-speed", "replay-place"]) buttonOf(id).disabled = isViewer;
    $("replay").title = isViewer ? "Steering the replay needs a token of the role controller" : "";
    $("replay-refusal").classList.toggle("dim", isViewer);
    $("replay-refusal").textContent = isViewer ? "viewers only watch" : this.refusal;
  }
}
