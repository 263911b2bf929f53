// The page: it joins connection, pictures, controls and words.

import { Bins } from "./bins.js";
import { Bookmarks } from "./bookmarks.js";
import { Debrief } from "./debrief.js";
import { Display, readFragment, writeFragment } from "./controls.js";
import { KEYS, listenKeys, listenPointer } from "./input.js";
import { Link, Refused } from "./stream.js";
import { Meter, Readout } from "./readout.js";
import { Pane } from "./pane.js";
import { Targets } from "./targets.js";
import { RadarControls } from "./radar.js";
import { number } from "./messages.js";
import { savePicture } from "./export.js";
import { crossing, movedLines, noLines } from "./lines.js";
import { applySize, sizeFor } from "./size.js";
import { fillSources, isWide, otherSource } from "./sources.js";
import { LEAST_COVERAGE, sentences } from "./words.js";
import { turned } from "./placement.js";

const POLL_MS = 1000;
const WORDS_MS = 250;
const TURN_MS = 2000;
const NEWS_MS = 12000;

const $ = (id) => document.getElementById(id);

/** @typedef {import("./ppi.js").Look & {compensated: boolean, autoGlow: boolean, hold: boolean, size: number, armed: [string, number]|null}} AppLook */

export class App {
  constructor() {
    const kept = readFragment();
    /** @type {AppLook} */
    this.look = {
      palette: kept.palette, compensated: kept.r2,
      afterglow_s: Math.max(0, kept.glow), autoGlow: kept.glow < 0, up: kept.up, slant: kept.slant, unit: kept.unit,
      rings: kept.rings, overlay: kept.overlay, label: kept.label, bscope: kept.bscope, profile: kept.profile, trails: kept.trails, relative: kept.relative, hold: false, window: null, cursor: null, lines: noLines(), armed: null,
      size: kept.size, px: sizeFor(kept.size),
    };
    applySize(this.look.px);
    addEventListener("resize", () => this.resize());
    this.kept = kept;
    this.tab = kept.tab;
    /** @type {Pane[]} */
    this.panes = [];
    this.status = null;
    this.said = [];
    this.streams = new Map(); // stream id to radar or request
    this.link = new Link({
      message: (message) => this.take(message),
      state: (state) => this.linked(state),
      welcome: (welcome) => this.welcomed(welcome),
      scales: (scales, unit) => this.controls.offer(scales, unit),
    });
    this.targets = this.look.targets = new Targets(this);
    this.meter = new Meter();
    this.readout = new Readout();
    this.addPane(`radar ${kept.a}`);
    this.display = new Display(this);
    this.controls = new RadarControls(this);
    this.debrief = new Debrief(this);
    this.bookmarks = new Bookmarks(this);
    listenKeys(this);
    this.#buttons();
    document.addEventListener("visibilitychange", () => this.subscribe());
    setInterval(() => this.poll(), POLL_MS);
    setInterval(() => this.tell(), WORDS_MS);
    requestAnimationFrame((now) => this.frame(now));
    this.link.open();
    this.loadParameters();
  }

  #buttons() {
    $("two").onclick = () => this.setPanes(this.panes.length === 1 ? 2 : 1);
    $("keys").onclick = () => this.showKeys();
    $("key-table").replaceChildren(...KEYS.map(([key, text]) => {
      const row = document.createElement("tr");
      row.insertCell().textContent = key;
      row.insertCell().textContent = text;
      return row;
    }));
    $("ask").onclose = () => {
      if ($("ask").returnValue !== "ok" || !$("token").value) return;
      this.link.token = $("token").value;
      $("token").value = "";
      this.link.open();
    };
    $("again").onclick = () => this.again();
    $("words").onclick = () => $("words").classList.toggle("all");
    $("words").onkeydown = ({ key }) => {
      if (key === "Enter") $("words").click();
    };
    addEventListener("hashchange", () => location.reload());
  }

  /** What helps a page that does not come back by itself, or not yet. */
  again() {
    const { kind } = this.link.state;
    if (kind === "token") this.askToken();
    else if (kind === "refused") location.reload();
    else this.link.open();
  }

  askToken() {
    const { text } = this.link.state;
    $("ask-text").textContent = text ? `The server does not accept this one: ${text}` : "This server wants a token.";
    $("ask").returnValue = "";
    if (!$("ask").open) $("ask").showModal();
  }

  showKeys() {
    $("help").showModal();
  }

  async loadParameters() {
    try {
      const table = await (await fetch("parameters.json")).json();
      this.controls.use(table);
      Bins.notIdeal = table.filter(({ not_ideal }) => not_ideal);
      this.change({ compensated: this.look.compensated });
      this.display.show();
    } catch {
      setTimeout(() => this.loadParameters(), 3000);
    }
  }

  /** Keeps the settings in the URL's fragment. */
  keep() {
    const { look } = this;
    const levels = Object.fromEntries(this.panes.flatMap(({ levels: { low_dB, span_dB, auto } }, k) => {
      const of = k ? k + 1 : "";
      return auto ? [] : [[`auto${of}`, false], [`low${of}`, low_dB], [`span${of}`, span_dB]];
    }));
    writeFragment({
      ...levels, palette: look.palette, r2: look.compensated, glow: look.autoGlow ? -1 : look.afterglow_s, up: look.up, slant: look.slant,
      unit: look.unit, rings: look.rings, overlay: look.overlay, label: look.label, bscope: look.bscope, profile: look.profile, size: look.size, expert: this.kept.expert, panes: this.panes.length, tab: this.tab, rate: this.kept.rate,
      a: this.kept.a, b: this.kept.b, targets: this.targets.isWanted, trails: look.trails, relative: look.relative,
    });
  }

  // ---- Panes

  addPane(source) {
    const { kept } = this;
    const levels = this.panes.length ? { low: kept.low2, span: kept.span2, auto: kept.auto2 } : kept;
    const pane = new Pane($("panes"), this, source, levels);
    pane.element.addEventListener("pointerdown", () => this.activate(pane), true);
    listenPointer(this, pane);
    this.targets.equip(pane);
    this.panes.push(pane);
    $("panes").dataset.count = String(this.panes.length);
  }

  /** The picture whose levels the tab Display has. */
  get active() {
    return this.panes[this.activeNumber] ?? this.panes[0];
  }
  activate(pane) {
    this.activeNumber = this.panes.indexOf(pane);
    for (const one of this.panes) one.element.classList.toggle("active", one === pane && this.panes.length > 1);
    this.display?.show();
  }

  setPanes(count) {
    const other = otherSource(this);
    if (count > this.panes.length && !other) return;
    while (this.panes.length > count) this.panes.pop().remove();
    if (this.panes.length < count) this.addPane(other);
    $("panes").dataset.count = String(this.panes.length);
    this.activate(this.active);
    this.fillSources();
    this.subscribe();
    this.poll();
    this.display.show();
    this.keep();
  }

  /** @param {Pane} pane */
  choose(pane, source) {
    pane.source = source;
    pane.info = pane.status = null;
    pane.clear();
    if (pane === this.panes[0]) this.kept.a = pane.radar;
    else this.kept.b = source;
    this.keep();
    this.subscribe();
    this.poll();
  }

  fillSources() {
    fillSources(this);
  }

  // ---- The connection

  linked(state) {
    document.body.classList.toggle("stale", !["live", "connecting"].includes(state.kind));
    document.body.dataset.link = state.kind;
    if (state.kind !== "live" && state.kind !== "silent") {
      this.debrief?.forget();
      this.targets.forget();
      $("role").textContent = "";
      this.streams.clear();
      for (const pane of this.panes) {
        pane.info = pane.status = null;
        pane.clear();
        pane.bins.abort();
        pane.bins.held = [];
      }
    }
    if (state.kind === "token") this.askToken();
    else if (state.kind === "live") $("ask").close();
    const again = { token: "enter a token", refused: "load again", lost: "connect now" }[state.kind];
    $("again").hidden = !again;
    if (again) $("again").textContent = again;
    this.controls?.show();
    this.tell();
  }

  async welcomed(welcome) {
    $("scene").textContent = [welcome.scene_name, welcome.server_version].filter(Boolean).join(" · ");
    $("scene").title = `Scene and version of ${welcome.server_name ?? "the server"}`;
    document.title = `obliq · ${welcome.scene_name ?? ""}`;
    $("role").textContent = welcome.role ?? "";
    $("role").title = { viewer: "You may watch", controller: "You may set a radar that nobody else controls",
      admin: "You may set any radar" }[welcome.role] ?? "";
    this.fillSources();
    this.targets.begin(welcome);
    this.subscribed = new Set();
    this.subscribe();
    this.bookmarks.begin(welcome);
    await this.poll(); // what there is to see beside it follows from the first radar
    if (this.kept.panes === 2 && this.panes.length === 1) this.setPanes(2);
  }

  /** Asks for what the panes show; for nothing while the page is hidden. */
  async subscribe() {
    const { link } = this;
    if (!link.isLive) return;
    const wanted = document.hidden ? new Set() : new Set(this.panes.map(({ radar }) => radar).filter(Boolean));
    const asks = [];
    for (const radar of this.subscribed ?? []) if (!wanted.has(radar)) asks.push(link.ask("Unsubscribe", { radar }));
    const rate_hz = Math.min(this.kept.rate, number(link.welcome.limits?.max_rate_hz, this.kept.rate));
    this.withStates = new Set([...wanted].filter((radar) => this.secondPlane(radar)));
    for (const radar of wanted) {
      const planes = ["VIDEO", this.secondPlane(radar)].filter(Boolean);
      asks.push(link.ask("Subscribe", { radar, rate_hz, planes, video_bits: 8, ...(this.targets.isOn && { truth: true }) }).catch((error) => {
        for (const pane of this.panes) if (pane.radar === radar) pane.says = error.message;
        throw error;
      }));
    }
    this.subscribed = wanted;
    for (const pane of this.panes) if (pane.radar && !this.withStates.has(pane.radar)) pane.bins.forgetStates();
    await Promise.allSettled(asks);
  }

  /** What comes beside the video: a label, or states; nothing: neither. */
  secondPlane(radar) {
    return this.look.label || (this.wantsStates(radar) ? "STATE" : "");
  }

  /** For the overlay; and where a live radar looks at ground that no file has, which is hatched. */
  wantsStates(radar) {
    if (this.look.overlay) return true;
    const coverage = this.status?.radars?.find((one) => one.radar === radar)?.coverage;
    return !this.debrief?.state && number(coverage, 1) < LEAST_COVERAGE;
  }

  /** @param {import("./messages.js").Message} message */
  take(message) {
    const { type, body, stream } = message;
    if (type === "FrameBegin")
      this.streams.set(stream, number(body.request_id) ? { request: body.request_id } : { radar: body.frame.radar });
    const of = this.streams.get(stream);
    if (type === "ReplayState") {
      const isFirst = !this.debrief.state;
      this.debrief.take(message);
      if (isFirst) this.fillSources();
      if (isFirst) this.bookmarks.show();
    }
    if (type === "ExerciseEvents") this.bookmarks.take(message);
    if (type === "Error") {
      const asked = this.panes.find(({ pending }) => pending && pending === body.request_id);
      this.targets.heard(body);
      if (asked) asked.refused(new Refused(body));
      else if (number(body.number) === 102) this.tellNews(this.controls.general.textContent = `Control was taken: ${body.text}`);
      else for (const pane of this.panes) if (!body.radar || pane.radar === body.radar) pane.says = body.text;
      this.poll();
      return;
    }
    const id = of?.request ?? (type === "FrameAbort" ? body.request_id : undefined);
    for (const pane of this.panes) {
      const isOwn = id ? pane.pending === id : pane.radar && pane.radar === of?.radar;
      if (!isOwn || this.look.hold) continue;
      pane.take(message);
      if (type === "FrameEnd") this.meter.frameReceived(pane);
      if (id && (type === "FrameEnd" || type === "FrameAbort")) pane.pending = "";
    }
    if (of?.request && (type === "FrameEnd" || type === "FrameAbort")) this.streams.delete(stream);
  }

  /** Said for some seconds, whatever the page shows. */
  tellNews(text) {
    this.news = { text, until_ms: performance.now() + NEWS_MS };
    this.tell();
  }

  async poll() {
    const { link } = this;
    if (!link.isLive || document.hidden) return;
    try {
      this.status = await link.ask("GetStatus");
      for (const pane of this.panes) {
        if (!pane.radar) continue;
        const { radar } = pane;
        const info = await link.ask("GetRadar", { radar });
        if (pane.radar !== radar) continue;
        pane.info = info;
        pane.status = (this.status.radars ?? []).find((r) => r.radar === radar) ?? null;
      }
      if ([...this.subscribed].some((radar) => this.wantsStates(radar) !== this.withStates.has(radar))) this.subscribe();
      if (this.filledFor !== isWide(this)) this.fillSources();
      this.filledFor = isWide(this);
    } catch (error) {
      if (error instanceof Refused && error.number === 101) this.fillSources();
    }
    this.controls.show();
    this.tell();
  }

  /** @param {string} messageField "RadarSettings.r_max_m" @param {any} value */
  async set(messageField, value) {
    const [message, field] = messageField.split(".");
    const radar = this.panes[0].radar;
    if (message === "Pose") await this.controls.pose({ [field]: value });
    else await this.link.ask("SetSettings", { radar, settings: { [field]: value } });
    await this.poll();
  }

  setBearing(bearing_deg) {
    const rounded = Math.round(bearing_deg * 10) / 10;
    return this.controls.attempt(() => this.controls.pose({ bearing_deg: rounded }));
  }
  turn(by_deg) {
    const { info } = this.panes[0];
    if (!info) return;
    // What was asked for last counts until the server has had time to say it.
    const now = performance.now();
    const from = now - (this.turned?.at_ms ?? -Infinity) < TURN_MS ? this.turned.to : number(info.pose?.bearing_deg);
    this.turned = { to: turned(from + by_deg), at_ms: now };
    this.setBearing(this.turned.to);
  }

  // ---- What is shown

  /** @param {Partial<AppLook>} change */
  change(change) {
    const { look } = this;
    Object.assign(look, change);
    const has = (...keys) => keys.some((key) => key in change);
    if (has("size")) this.resize();
    if (has("label")) for (const pane of this.panes) pane.bins.forgetStates();
    if (has("hold", "overlay", "label") && !look.hold) this.subscribe();
    for (const pane of this.panes) {
      if (has("palette", "afterglow_s")) pane.ppi.restyle();
      if (has("compensated")) {
        pane.levels.unsettle();
        this.rescale(pane);
        if (pane.bins.descriptor) pane.level(performance.now());
      }
      if (has("overlay", "label")) pane.ppi.needs.all = true;
      if (has("up", "slant", "bscope")) look.window = null;
      if (has("up", "slant", "bscope") || !Object.keys(change).length) pane.ppi.refresh();
      pane.ppi.needs.grid = pane.ppi.needs.marks = true;
    }
  }

  /** Black level and span of a picture, set by hand. */
  level(low_dB, span_dB, pane = this.active) {
    pane.levels.set(low_dB, span_dB);
    this.rescale(pane);
    this.keep();
  }

  /** @param {Pane} pane whose levels have changed */
  rescale(pane) {
    this.setScale(pane);
    pane.bins.rescale();
    pane.ppi.needs.grid = true;
    this.display?.show();
  }

  /** @param {Pane} pane */
  setScale({ bins, levels }) {
    const { low_dB, span_dB } = levels;
    bins.scale = { low_dB, span_dB, compensated: this.look.compensated };
    if (bins === this.panes[0]?.bins && bins.placement && this.look.autoGlow) this.#autoGlow(bins);
  }

  /** An echo fades until the beam comes again. */
  #autoGlow({ scan, placement }) {
    const pass_s = scan ? (placement.azimuths * placement.width_deg) / number(scan.rate_deg_s, 36) : 0;
    const glow = Math.min(20, Math.round(4 * pass_s) / 2);
    if (glow === this.look.afterglow_s) return;
    this.change({ afterglow_s: glow });
    this.display.show();
  }

  zoom(factor, x, y, pane = this.panes[0]) {
    if (factor === 0) this.look.window = null;
    else pane.ppi.zoom(factor, x, y);
    this.change({});
  }

  /** Letters and lines follow the window. */
  resize() {
    const px = sizeFor(this.look.size);
    if (px === this.look.px) return;
    this.look.px = px;
    applySize(px);
    for (const pane of this.panes) pane.ppi.resize();
  }

  setCursor(place) {
    this.look.cursor = place;
    for (const pane of this.panes) pane.ppi.needs.marks = true;
  }
  moveCursor(dx, dy) {
    const { ppi, bins } = this.panes[0];
    if (!bins.placement) return;
    const { cursor } = this.look;
    const [x, y] = cursor ? ppi.toScreen(cursor.east_m, cursor.north_m) : [ppi.width / 2, ppi.height / 2];
    this.setCursor(ppi.fromScreen(x + dx, y + dy));
  }
  /** Bearing lines and range markers. @param {import("./lines.js").Lines} lines */
  setLines(lines) {
    this.look.lines = lines;
    this.look.armed = null;
    this.setCursor(this.look.cursor);
    this.display.show();
  }
  /** @param {[string, number]} what "ebl", "vrm" or "mark", which is both, and its number */
  placeLine(what, pane, x, y) {
    const at = pane.ppi.read(pane.ppi.fromScreen(x, y));
    if (at) this.setLines(movedLines(this.look.lines, what, at));
  }
  /** @param {[string, number]} what is taken away; or placed at the cursor, or by the next click */
  toggleLine(what) {
    const { look } = this;
    const [kind, k] = what;
    const { ebl, vrm } = look.lines;
    const isThere = kind === "mark" ? crossing(look.lines, k) : look.lines[kind][k] !== null;
    const without = (list) => list.map((value, n) => (n === k ? null : value));
    if (isThere) this.setLines({ ebl: kind === "vrm" ? ebl : without(ebl), vrm: kind === "ebl" ? vrm : without(vrm) });
    else if (look.cursor && !/^(ebl|vrm)-/.test(document.activeElement?.id ?? "")) this.setLines(movedLines(look.lines, what, this.panes[0].ppi.read(look.cursor)));
    else look.armed = String(look.armed) === String(what) ? null : what;
    this.display.show();
  }
  clearMarks() {
    Object.assign(this.look, { cursor: null, lines: noLines(), armed: null });
    this.setCursor(null);
    this.display.show();
  }

  save() {
    savePicture(this);
  }

  tell() {
    if (this.debrief?.state) this.debrief.show();
    this.meter.show(this);
    this.targets.show();
    this.said = sentences(this);
    const words = $("words");
    const text = this.said.map((sentence) => sentence.text).join(" ");
    if (words.textContent !== text) words.textContent = text;
    words.title = text;
    words.tabIndex = words.scrollHeight > words.clientHeight + 1 || words.classList.contains("all") ? 0 : -1; // opened by a click
    words.dataset.grave = String(this.said[0]?.grave ?? 0);
    for (const pane of this.panes) {
      const own = this.said.find(({ banner, panes }) => banner && (panes?.includes(pane) ?? true));
      pane.say(own?.banner ?? "");
      pane.annunciators.show(pane);
      pane.element.classList.toggle("standby", Boolean(pane.info?.transmit_off));
    }
  }

  frame(now) {
    for (const pane of this.panes) {
      pane.draw(now);
      if (pane !== this.panes[0]) pane.renderAgain(this.panes[0]);
    }
    this.readout.show(this);
    requestAnimationFrame((next) => this.frame(next));
  }
}

globalThis.obliq = new App(); // for tests and benches
