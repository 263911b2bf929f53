// Targets of the world for clients that may know them: the list of all, which of them is chosen, the claim, and what is set by hand.
// Where truth is not given (Welcome.truth) nothing of this exists in the page.

import { Events } from "./events.js";
import { Refused, refusalText } from "./stream.js";
import { TargetPanel } from "./target_panel.js";
import { Truth } from "./truth.js";
import { number } from "./messages.js";
import { pointsAhead, routeOf } from "./target_route.js";
import { recordsOf } from "./picture/profile.js";

const POLL_MS = 2000;
const SOON_MS = 500; // between lists, where an unknown target comes
const MANY = 100; // targets, whose marks take their time:
const MANY_MS = 200; // they are drawn less often
/** @type {import("../wire.js").ClaimKind[]} */
const CLAIM = ["TARGETS_CLAIM"];
const TAKEN = 102; // number of an Error
const NOT_CLAIMED = 103;

/** @typedef {import("../wire.js").Target & {read_ms: number}} Known a target and when the page read it */
/** @typedef {import("./picture/pane.js").Pane} Pane */
/**
 * Where a new target is to be: a bearing and range of a picture.
 * @typedef {{pane: Pane, ppi: import("./picture/ppi.js").Ppi, bearing_deg: number, range_m: number}} Fresh
 */

/** They are shown, or no longer. @extends {Events<{wanted: undefined}>} */
export class Targets extends Events {
  /** @param {import("./target_panel.js").Parts} parts @param {boolean} isWanted */
  constructor(parts, isWanted) {
    super();
    this.parts = parts;
    this.link = parts.link;
    this.pictures = parts.pictures;
    this.isWanted = isWanted;
    this.mayClaim = false;
    this.isAsking = false;
    /** @type {TargetPanel|null} null: this page may not know where targets are */
    this.panel = null;
    this.forget();
    this.link.on("Error", ({ body }) => this.#heard(body));
    this.pictures.on("added", (pane) => this.#equip(pane));
    this.pictures.on("targets", ({ pane, block }) => this.#take(pane, block));
    setInterval(() => this.poll(), POLL_MS);
  }

  /** Nothing of them is known: there is no connection. */
  forget() {
    /** By their ids. @type {Map<string, Known>} */
    this.list = new Map();
    /** @type {import("../wire.js").TargetType[]} */
    this.types = [];
    this.controller = "";
    this.holds = false;
    this.refusal = "";
    this.chosen = "";
    /** Where one is dragged to. @type {{ppi: import("./picture/ppi.js").Ppi, at: [number, number]}|null} */
    this.dragged = null;
    /** @type {Fresh|null} */
    this.fresh = null;
    this.version = "";
    this.isRefused = false; // the list: a recording has none
    this.read_ms = -Infinity;
    this.#equipAll();
    this.show();
  }

  get isOn() {
    return Boolean(this.panel && this.isWanted && this.link.isLive);
  }

  /** Behind a Welcome. @param {import("../wire.js").Welcome} welcome */
  begin(welcome) {
    this.forget();
    this.mayClaim = welcome.role !== "viewer";
    if (!welcome.truth) {
      this.panel?.remove();
      this.panel = null;
    } else {
      this.panel ??= new TargetPanel(this, this.parts);
    }
    this.#equipAll();
    this.poll();
    this.show();
  }

  /** The switch. */
  async toggle() {
    this.isWanted = !this.isWanted;
    if (!this.isWanted && this.holds) await this.toggleClaim();
    if (!this.isWanted) this.choose("");
    this.fresh = null;
    this.#equipAll();
    this.emit("wanted");
    await this.poll();
    this.show();
  }

  #equipAll() {
    for (const pane of this.pictures.panes) this.#equip(pane);
  }
  /** @param {Pane} pane */
  #equip({ ppi }) {
    ppi.truth = this.isOn ? ppi.truth ?? new Truth() : null;
    ppi.targets = this;
    ppi.needs.marks = true;
  }

  /** Of a picture's frames. @param {Pane} pane @param {import("./messages.js").MessageOf["TargetBlock"]} block */
  #take(pane, { body, plane }) {
    const { ppi, bins } = pane;
    if (!ppi.truth) return;
    const now_ms = performance.now();
    ppi.truth.take(body, plane, Boolean(bins.scan) && !pane.isRendered, now_ms);
    if (now_ms - ppi.marked_ms > (ppi.truth.records.size > MANY ? MANY_MS : 0)) {
      ppi.needs.marks = true;
      ppi.marked_ms = now_ms;
    }
    const isUnknown = [...ppi.truth.records.keys()].some((id) => !this.list.has(id));
    if (isUnknown && performance.now() - this.read_ms > SOON_MS) this.poll();
  }

  /** News that the claim was taken. @param {import("../wire.js").Error} error */
  #heard(error) {
    if (!this.panel || !/^targets:|setting targets/.test(error.text ?? "")) return;
    this.holds = false;
    this.fresh = this.dragged = null;
    this.refusal = error.text;
    this.show();
  }

  async poll() {
    if (!this.isOn || this.isRefused || document.hidden || this.isAsking) return;
    this.isAsking = true;
    this.read_ms = performance.now();
    try {
      /** @type {Map<string, Known>} */
      const list = new Map();
      /** @type {import("../wire.js").TargetList|null} */
      let first = null;
      for (let after = "0", more = true; more; ) {
        const page = await this.link.ask("GetTargets", { after });
        first ??= page;
        for (const target of page.targets ?? []) list.set(target.id, { ...target, read_ms: performance.now() });
        more = Boolean(page.more && page.targets?.length);
        after = page.targets?.at(-1)?.id ?? after;
      }
      this.#keep(list, first);
    } catch (error) {
      if (error instanceof Refused) [this.refusal, this.isRefused] = [refusalText(error), true];
    }
    this.isAsking = false;
    this.show();
  }

  /** @param {Map<string, Known>} list @param {import("../wire.js").TargetList} first page of it */
  #keep(list, { types, controller, version }) {
    const isOther = this.version !== (version ?? "");
    [this.list, this.version, this.types, this.controller] = [list, version ?? "", types ?? [], controller ?? ""];
    if (!this.controller) this.holds = false;
    if (this.chosen && !list.has(this.chosen)) this.choose("");
    for (const { ppi } of this.pictures.panes) {
      if (isOther) ppi.truth?.keepOnly((id) => list.has(id));
      ppi.needs.marks = true;
    }
  }

  // ---- What is known of one

  /** @param {string} id */
  nameOf(id) {
    return this.list.get(id)?.name || `#${id}`;
  }

  /** Seconds since it was at the place that the list has; null: its clock is not that of the poses. @param {Known} target */
  ageOf(target) {
    const { newestPose } = this.pictures.first;
    if (target.sim_time_ns === undefined) return number(target.age_s) + (performance.now() - target.read_ms) / 1000;
    if (newestPose?.sim_time_ns === undefined) return null;
    return Math.max(0, (number(newestPose.sim_time_ns) - number(target.sim_time_ns)) * 1e-9);
  }

  /** As it was set; or by its way, where it follows a route or nothing was said. @param {string} id @param {Truth} truth */
  velocityOf(id, truth) {
    const target = this.list.get(id);
    const north = number(target?.velocity_north_m_s);
    const east = number(target?.velocity_east_m_s);
    if ((!north && !east) || target.route) return truth.velocityOf(id);
    const age_s = this.ageOf(target) ?? 0;
    return { north: north + age_s * number(target.acceleration_north_m_s2), east: east + age_s * number(target.acceleration_east_m_s2) };
  }

  /** @param {string} id */
  pointsAhead(id) {
    const target = this.list.get(id);
    const here = this.pictures.panes.map(({ ppi }) => ppi.truth?.records.get(id)).find(Boolean);
    return target?.route ? pointsAhead(target, this.ageOf(target), here) : [];
  }

  /** @param {string} id */
  loops(id) {
    return Boolean(this.list.get(id)?.route?.loops);
  }

  /** @param {string} id nothing: none */
  choose(id) {
    this.chosen = id;
    this.pictures.mark();
    this.show();
  }

  // ---- What is set by hand

  /**
   * Does what may be refused; the refusal stands in the panel.
   * @param {() => Promise<unknown>} what
   * @returns {Promise<boolean>} whether it was done
   */
  async attempt(what) {
    this.refusal = "";
    try {
      await what();
    } catch (error) {
      this.refusal = refusalText(error);
      if (error instanceof Refused && (error.number === TAKEN || error.number === NOT_CLAIMED)) this.holds = false;
    }
    const isDone = !this.refusal;
    this.isAsking = false;
    await this.poll();
    this.show();
    return isDone;
  }

  toggleClaim() {
    const { link } = this;
    this.fresh = null;
    return this.attempt(async () => {
      if (this.holds) await link.ask("ReleaseControl", { radar: "", kinds: CLAIM });
      else await link.ask("ClaimControl", { radar: "", kinds: CLAIM, ...(this.controller && { force: true }) });
      this.holds = !this.holds;
    });
  }

  /** @param {import("../wire.js").SetTargets} request */
  set(request) {
    return this.attempt(() => this.link.ask("SetTargets", request));
  }

  /**
   * The place on the ground, or so high over it, that an antenna measures at a bearing and range.
   * @param {Pane} pane
   * @param {{bearing_deg: number, slant_m: number}} at
   * @param {number} over_m the ground, or the datum
   * @param {boolean} isOverGround
   */
  async #place(pane, { bearing_deg, slant_m: range_m }, over_m, isOverGround) {
    const { placement } = pane.bins;
    if (!isOverGround) return placement.located(bearing_deg, range_m, over_m);
    let at = placement.located(bearing_deg, range_m, placement.reference_m + over_m);
    for (let step = 0; step < 3; ++step) {
      const answer = await this.link.ask("QueryGround", { latitude_deg: [at.latitude_deg], longitude_deg: [at.longitude_deg] }).catch(() => /** @type {null} */ (null));
      const ground = answer && recordsOf(answer, answer.plane)[0];
      if (!ground?.known) break;
      at = placement.located(bearing_deg, range_m, ground.height_m + over_m);
    }
    return at;
  }

  /**
   * A click on the picture.
   * @param {Pane} pane
   * @param {number} x
   * @param {number} y
   * @param {{id: string|null, isRoutePoint: boolean}} what the target under it
   * @returns {boolean} whether it was about targets
   */
  click(pane, x, y, { id, isRoutePoint }) {
    if (!this.isOn) return false;
    if (isRoutePoint && this.holds && this.chosen) {
      this.#append(pane, x, y);
      return true;
    }
    if (id !== null) {
      this.choose(id);
      this.panel.open();
      return true;
    }
    const at = this.holds && pane.ppi.read(pane.ppi.fromScreen(x, y));
    if (!at) return false;
    this.fresh = { pane, ppi: pane.ppi, bearing_deg: at.bearing_deg, range_m: at.slant_m };
    this.choose("");
    this.panel.open();
    this.panel.ask();
    return true;
  }

  cancel() {
    this.fresh = this.dragged = null;
    this.choose("");
  }

  /** The target of the form, where the picture was clicked. @param {import("../wire.js").Target} target without id and place */
  async add({ height_m, ...target }) {
    const { fresh } = this;
    if (!fresh) return;
    const done = await this.attempt(async () => {
      const { latitude_deg, longitude_deg } = await this.#place(fresh.pane, { ...fresh, slant_m: fresh.range_m }, number(height_m), true);
      this.isAsking = false;
      await this.poll();
      const id = String([...this.list.keys()].reduce((most, one) => (BigInt(one) > most ? BigInt(one) : most), 0n) + 1n);
      await this.link.ask("SetTargets", { targets: [{ ...target, id, latitude_deg, longitude_deg, height_m, height_reference: "GROUND" }] });
      this.fresh = null;
      this.choose(id);
    });
    if (done) this.panel.added();
  }

  /** @param {Pane} pane @param {string} id @param {number} x @param {number} y */
  drag(pane, id, x, y) {
    if (this.chosen !== id) this.choose(id);
    this.dragged = { ppi: pane.ppi, at: [x, y] };
    pane.ppi.needs.marks = true;
  }

  /**
   * Its mark was let go. A route goes on from there.
   * @param {Pane} pane
   * @param {string} id
   * @param {number} x
   * @param {number} y
   */
  async drop(pane, id, x, y) {
    const at = pane.ppi.read(pane.ppi.fromScreen(x, y));
    const target = this.list.get(id);
    if (at && target) {
      const points = this.pointsAhead(id);
      await this.attempt(async () => {
        const isOverGround = target.height_reference === "GROUND";
        const record = pane.ppi.truth?.records.get(id);
        const over_m = isOverGround ? number(target.height_m) : record?.height_m ?? number(target.height_m);
        const { latitude_deg, longitude_deg } = await this.#place(pane, at, over_m, isOverGround);
        await this.link.ask("SetTargets", { targets: [{ id, latitude_deg, longitude_deg, ...this.#motion(target, points) }] });
        for (const { ppi } of this.pictures.panes) ppi.truth?.moved(id);
      });
    }
    this.dragged = null;
    pane.ppi.needs.marks = true;
  }

  /**
   * What would be lost of its motion if a place alone were set.
   * @param {Known} target
   * @param {import("./target_route.js").RoutePoint[]} points
   */
  #motion(target, points) {
    return target.route ? { route: routeOf(points, Boolean(target.route.loops)) } : {};
  }

  /** @param {Pane} pane @param {number} x @param {number} y */
  async #append(pane, x, y) {
    const id = this.chosen;
    const target = this.list.get(id);
    const at = pane.ppi.read(pane.ppi.fromScreen(x, y));
    if (!at || !target) return;
    const height_m = number(target.height_m);
    await this.attempt(async () => {
      const { latitude_deg, longitude_deg } = await this.#place(pane, at, height_m, target.height_reference === "GROUND");
      const point = { latitude_deg, longitude_deg, height_m, speed_m_s: this.panel.routeSpeed_m_s };
      await this.link.ask("SetTargets", { targets: [{ id, route: routeOf([...this.pointsAhead(id), point], this.panel.routeLoops) }] });
    });
  }

  /** Speed on all of the chosen one's way, or whether it loops. @param {{speed_m_s?: number, loops?: boolean}} change */
  changeRoute({ speed_m_s, loops }) {
    const target = this.list.get(this.chosen);
    if (!target?.route) return this.show();
    const points = this.pointsAhead(this.chosen).map((point) => ({ ...point, ...(speed_m_s !== undefined && { speed_m_s }) }));
    return this.set({ targets: [{ id: this.chosen, route: routeOf(points, loops ?? Boolean(target.route.loops)) }] });
  }
  endRoute() {
    return this.set({ targets: [{ id: this.chosen, route: routeOf([], false) }] });
  }

  async remove() {
    const id = this.chosen;
    if (!this.holds || !id) return;
    if (!(await this.set({ gone: [id] }))) return;
    for (const { ppi } of this.pictures.panes) ppi.truth?.forget(id);
    this.choose("");
  }

  show() {
    this.panel?.show();
  }
}
