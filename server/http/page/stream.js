// The connection: it opens, greets, asks, measures the server's clock, notices silence, and comes back by itself.

import { Events } from "./events.js";
import { SUBPROTOCOL, decode, encode, utcNow_ms } from "./messages.js";

const BEAT_MS = 700; // between heartbeats
const SILENCE_MS = 1400; // without an answer the picture is no longer live
const GIVE_UP_MS = 6000; // then the connection is opened anew
const ANSWER_LIMIT_MS = 60000; // of a request: a queue of pictures may take its time
const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 10000;
const TOKEN_KEY = "obliq.token"; // of sessionStorage: it ends with the tab

/** What the server refused, with its number and the faulty fields. */
export class Refused extends Error {
  /** @param {import("../wire.js").Error} body */
  constructor(body) {
    super(body.text ?? "refused");
    this.number = body.number ?? 0;
    this.fields = body.fields ?? [];
  }
}

/**
 * In words: first what is wrong with the field of a key, without its name, where there is one.
 * @param {Error} error
 * @param {string} [key]
 */
export function refusalText(error, key) {
  const fields = error instanceof Refused ? error.fields : [];
  const wordsOf = (/** @type {import("../wire.js").FieldFault} */ { found, allowed }) => `found ${found}; allowed: ${allowed}`;
  const own = fields.filter(({ field }) => field === key).map(wordsOf);
  const others = fields.filter(({ field }) => field !== key).map((fault) => `${fault.field}: ${wordsOf(fault)}`);
  return [...own, ...others].join("; ") || error.message;
}

/**
 * @typedef {object} LinkState
 * @property {"connecting"|"loading"|"live"|"silent"|"lost"|"token"|"refused"} kind
 * @property {string} text the server's words, where it has some
 * @property {number} retry_ms when the next attempt is due, by performance.now(); 0: none
 */

/** @typedef {import("./messages.js").Messages} Messages @typedef {import("./messages.js").MessageOf} MessageOf */
/** @typedef {import("../wire.js").GroundAnswer & {plane: Uint8Array}} GroundRecords an answer with its plane */

/**
 * What answers a request: of those that are not here an Ack.
 * @typedef {{Hello: import("../wire.js").Welcome, GetRadar: import("../wire.js").RadarInfo, GetStatus: import("../wire.js").Status,
 *   QueryGround: GroundRecords, GetTargets: import("../wire.js").TargetList, GetEvents: import("../wire.js").ExerciseEvents}} Answers
 */
/** @template {keyof Messages} Type @typedef {Type extends keyof Answers ? Answers[Type] : import("../wire.js").Ack} AnswerTo */
/** Of range, as the server offers them. @typedef {{scales: number[], unit: import("./picture/grid.js").Unit}} Scales */
/**
 * By type each message that answers no request.
 * @typedef {MessageOf & {state: LinkState, welcome: import("../wire.js").Welcome, scales: Scales}} Said
 */

/** @extends {Events<Said>} */
export class Link extends Events {
  constructor() {
    super();
    /** @type {LinkState} */
    this.state = { kind: "connecting", text: "", retry_ms: 0 };
    /** @type {import("../wire.js").Welcome|null} */
    this.welcome = null;
    this.offset_ms = 0; // server's clock minus this one's
    this.roundTrip_ms = Infinity;
    this.received = 0; // bytes
    /** @type {WebSocket|null} */
    this.socket = null;
    /**
     * Requests by their ids.
     * @type {Map<string, {resolve: (answer: any) => void, reject: (error: Error) => void, limit: number}>}
     */
    this.waiting = new Map();
    this.nextRequest = 1;
    this.sequence = 0;
    this.pause_ms = FIRST_PAUSE_MS;
    this.greeted_ms = 0;
    this.heard_ms = 0;
    this.shown_ms = 0;
    /** The heartbeat that is not answered yet. @type {{id: string, sent_ms: number}|null} */
    this.beat = null;
    this.beaten_ms = 0;
    this.retry = 0;
    setInterval(() => this.#watch(), 150);
  }

  get isLive() {
    return this.state.kind === "live";
  }

  set token(token) {
    if (token) sessionStorage.setItem(TOKEN_KEY, token);
    else sessionStorage.removeItem(TOKEN_KEY);
  }
  get token() {
    return sessionStorage.getItem(TOKEN_KEY) ?? "";
  }

  /** Opens the connection now, whatever pause was due. */
  async open() {
    clearTimeout(this.retry);
    this.#drop();
    if (this.state.kind !== "lost" && this.state.kind !== "loading") this.#say("connecting");
    const readiness = await this.#readiness();
    if (readiness !== "ready") {
      if (readiness === "") this.#later("lost", "");
      else this.#later("loading", readiness, FIRST_PAUSE_MS);
      return;
    }
    const socket = new WebSocket(new URL("stream", location.href).href.replace(/^http/, "ws"), SUBPROTOCOL);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => this.#greet(socket);
    socket.onmessage = (event) => this.socket === socket && this.#receive(event.data);
    socket.onclose = () => this.socket === socket && this.#ended();
  }

  /**
   * @template {keyof Messages} Type
   * @param {Type} type
   * @param {Messages[Type]} [body]
   * @returns {Promise<AnswerTo<Type>>} the answer's body; of a GroundAnswer also its plane
   */
  ask(type, body = /** @type {Messages[Type]} */ ({})) {
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) {
        reject(new Error("not connected"));
        return;
      }
      const id = String(this.nextRequest++);
      const limit = setTimeout(() => {
        this.waiting.delete(id);
        reject(new Error("no answer"));
      }, ANSWER_LIMIT_MS);
      this.waiting.set(id, { resolve, reject, limit });
      this.#send(type, { request_id: id, ...body });
    });
  }

  /**
   * A request whose answer is a frame: its number, which the frame's messages repeat.
   * @param {import("../wire.js").RenderOnce} body
   */
  render(body) {
    const id = String(this.nextRequest++);
    this.#send("RenderOnce", { request_id: id, ...body });
    return id;
  }

  /** @template {keyof Messages} Type @param {Type} type @param {Messages[Type]} body */
  #send(type, body) {
    this.socket.send(encode(type, body, ++this.sequence));
  }

  /** "ready", the stage of loading, or nothing where nothing answers. With it come the range scales. */
  async #readiness() {
    try {
      const answer = await fetch("page.json", { cache: "no-store", signal: AbortSignal.timeout(3000) });
      const { state, range_scales, range_unit } = await answer.json();
      this.emit("scales", { scales: range_scales, unit: range_unit });
      return /^(loading|stopping)/.test(state) ? state : "ready";
    } catch {
      return "";
    }
  }

  /** @param {WebSocket} socket */
  async #greet(socket) {
    this.heard_ms = performance.now();
    try {
      const token = this.token;
      const welcome = await this.ask("Hello", { major: 1, minor: 1, client_name: "page", ...(token && { token }) });
      if (this.socket !== socket) return;
      this.welcome = welcome;
      this.greeted_ms = performance.now();
      this.#say("live");
      this.emit("welcome", welcome);
    } catch (error) {
      if (this.socket === socket && error instanceof Refused) this.#refuse(error);
    }
  }

  /** Errors that end the connection; the others answer a request or are news. @param {Refused} error */
  #refuse(error) {
    const wasLive = this.welcome !== null;
    this.#drop(error.message);
    if (error.number === 11) {
      const had = this.token !== "";
      this.token = "";
      this.#say("token", had ? error.message : "");
    } else if (error.number === 2 || (error.number === 5 && !wasLive)) {
      this.#say("refused", error.message);
    } else {
      this.#later("lost", error.message);
    }
  }

  /** @param {ArrayBuffer|string} data */
  #receive(data) {
    const now = performance.now();
    this.heard_ms = now;
    if (this.state.kind === "silent") this.#say("live");
    if (typeof data === "string") return;
    this.received += data.byteLength;
    const message = decode(data);
    const { type, body } = message;
    if (type === "Heartbeat") {
      this.#clock(message, now);
      if (body.answer_wanted) this.#send("Heartbeat", body.request_id ? { request_id: body.request_id } : {});
      return;
    }
    const isFrame = type === "FrameBegin" || type === "FrameAbort";
    const id = !isFrame && "request_id" in body ? body.request_id : "";
    const waiting = id ? this.waiting.get(id) : undefined;
    if (waiting) {
      this.waiting.delete(id);
      clearTimeout(waiting.limit);
      if (type === "Error") waiting.reject(new Refused(body));
      else waiting.resolve(type === "GroundAnswer" ? { ...body, plane: message.plane } : body);
    } else if (type === "Error" && (body.number ?? 0) < 100) {
      this.#refuse(new Refused(body));
    } else {
      this.#pass(type, message);
    }
  }

  /** @template {keyof MessageOf} Type @param {Type} type @param {import("./messages.js").Message} message of that type */
  #pass(type, message) {
    this.emit(type, /** @type {Said[Type]} */ (message));
  }

  /**
   * The server's time belongs to the middle of the round trip; the shortest trip of late tells best.
   * @param {MessageOf["Heartbeat"]} message
   * @param {number} now
   */
  #clock({ body, utc_ms }, now) {
    if (!this.beat || body.request_id !== this.beat.id) return;
    const trip = now - this.beat.sent_ms;
    const here_ms = utcNow_ms() - trip / 2;
    this.roundTrip_ms *= 1.02; // an old measurement counts less and less
    if (trip <= this.roundTrip_ms) {
      this.roundTrip_ms = trip;
      this.offset_ms = utc_ms - here_ms;
    }
    this.beat = null;
  }

  #watch() {
    if (this.socket?.readyState !== WebSocket.OPEN || !this.welcome) return;
    const now = performance.now();
    if (now - this.greeted_ms > GIVE_UP_MS) this.pause_ms = FIRST_PAUSE_MS; // a connection that lasts
    if (!this.beat || now - this.beat.sent_ms > 4 * BEAT_MS) {
      if (!this.beat && now - this.beaten_ms < BEAT_MS) return;
      this.beaten_ms = now;
      this.beat = { id: String(this.nextRequest++), sent_ms: now };
      this.#send("Heartbeat", { request_id: this.beat.id, answer_wanted: true });
    }
    const silent_ms = now - Math.max(this.heard_ms, this.shown_ms);
    if (document.hidden) this.shown_ms = now; // a hidden page's clock runs in jumps
    else if (silent_ms > GIVE_UP_MS) this.#ended();
    else if (silent_ms > SILENCE_MS && this.isLive) this.#say("silent");
  }

  #ended() {
    this.#drop();
    this.#later("lost", "");
  }

  /** @param {LinkState["kind"]} kind @param {string} text @param {number} [pause_ms] */
  #later(kind, text, pause_ms) {
    const pause = pause_ms ?? this.pause_ms;
    if (pause_ms === undefined) this.pause_ms = Math.min(2 * this.pause_ms, LONGEST_PAUSE_MS);
    this.#say(kind, text, performance.now() + pause);
    this.retry = setTimeout(() => this.open(), pause);
  }

  /** @param {string} [why] in the server's words */
  #drop(why = "the connection was lost") {
    const socket = this.socket;
    this.socket = null;
    this.welcome = null;
    this.beat = null;
    this.roundTrip_ms = Infinity;
    socket?.close();
    for (const { reject, limit } of this.waiting.values()) {
      clearTimeout(limit);
      reject(new Error(why));
    }
    this.waiting.clear();
  }

  /** @param {LinkState["kind"]} kind */
  #say(kind, text = "", retry_ms = 0) {
    this.state = { kind, text, retry_ms };
    this.emit("state", this.state);
  }
}
