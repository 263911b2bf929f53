// The tab Targets: switch, claim, what is known of the chosen target, the form of a new one, the list of all.

import { $, buttonOf, inputOf, make } from "./dom.js";
import { UNIT_M } from "./picture/grid.js";
import { bearingText, distanceText } from "./readout.js";
import { number } from "./messages.js";
import { turned, DEGREE } from "./picture/placement.js";
import { pointsOf } from "./target_route.js";

export const KNOT_MPS = 1852 / 3600;
const MOST_LISTED = 200;
/** @type {Record<import("../wire.js").HeightReference, string>} */
const OVER = { DATUM: "above datum", GROUND: "above ground", ELLIPSOID: "above ellipsoid" };
/** @type {Record<string, string>} */
const SEEN_WORDS = { out: "beside what the radar looks at", no: "hidden", part: "seen in part", all: "seen" };
const KEY = ["Delete", "take the chosen target away"];

const TAB = `<button role="tab" id="tab-targets" aria-controls="targets" aria-selected="false" tabindex="-1">Targets</button>`;
const MARKUP = `
<div class="row"><span class="name">Targets</span><button id="targets-on" aria-pressed="false"
 title="Marks of all targets, as the server knows them: filled, half or hollow as they are seen; lines to where they will be in a minute">show</button>
 <span class="choice push"><button id="targets-set" aria-pressed="false" title="Only one client at a time sets targets">Set targets</button></span></div>
<p class="refusal" id="targets-refusal" role="alert"></p>
<p class="hint" id="targets-hint"></p>
<form id="target-form" class="fields" hidden autocomplete="off">
 <label class="field"><span class="name">name</span><input name="name" maxlength="64" title="As marks and lists call it"><span class="unit"></span></label>
 <label class="field"><span class="name">type</span><select name="type" title="A type of the scene: its cross section, fluctuation and size"></select><span class="unit"></span></label>
 <label class="field"><span class="name">RCS</span><input name="rcs_dbsm" inputmode="decimal" title="Without one: that of its type"><span class="unit">dBsm</span></label>
 <label class="field"><span class="name">speed</span><input name="speed" inputmode="decimal" value="20" title="Over the ground"><span class="unit">kt</span></label>
 <label class="field"><span class="name">course</span><input name="course" inputmode="decimal" value="0" title="Clockwise from true north"><span class="unit">deg</span></label>
 <label class="field"><span class="name">height</span><input name="height_m" inputmode="decimal" value="0" title="Of its foot, above ground"><span class="unit">m AGL</span></label>
 <span class="choice"><button class="call" title="A target where the picture was clicked (Enter)">Add</button><button type="button" id="target-cancel" title="No new target (Esc)">Cancel</button></span>
</form>
<div id="target-chosen" hidden>
 <dl class="mono facts"></dl>
 <div class="row" id="target-route"><span class="name">Route</span>
  <label title="From the last point back to the first place, and so on"><input type="checkbox" id="route-loops" title="From the last point back to the first place, and so on"> loops</label>
  <input id="route-speed" class="mono" inputmode="decimal" aria-label="Speed on the route, kt" title="Speed on the way to points that you append; of a route that is there, on all of it"><span class="unit">kt</span>
  <button id="route-end" title="It stops where it is">end</button></div>
 <button id="target-remove" title="The chosen target goes (Delete)">Delete target</button>
</div>
<div id="target-list" role="listbox" aria-label="Targets"></div>`;

/**
 * @typedef {object} Parts what targets and their tab use of the page
 * @property {import("./stream.js").Link} link
 * @property {import("./pictures.js").Pictures} pictures
 * @property {import("./look.js").Look} look
 * @property {import("./debrief.js").Debrief} debrief
 * @property {import("./tabs.js").Tabs} tabs
 */

/**
 * @typedef {object} FormFields
 * @property {HTMLInputElement} name
 * @property {HTMLSelectElement} type
 * @property {HTMLInputElement} rcs_dbsm
 * @property {HTMLInputElement} speed
 * @property {HTMLInputElement} course
 * @property {HTMLInputElement} height_m
 */

/** Keys are the page's again. */
function blur() {
  if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
}

/** A number as it was typed. @param {string} text @param {string} name */
function typed(text, name) {
  const value = Number(text);
  if (text.trim() === "" || !Number.isFinite(value)) throw new Error(`${name}: found ${text.trim() || "no number"}; allowed: a number`);
  return value;
}

const knots = (/** @type {number} */ mps) => +(mps / KNOT_MPS).toPrecision(3);

export class TargetPanel {
  /** @param {import("./targets.js").Targets} targets @param {Parts} parts */
  constructor(targets, { link, pictures, look, debrief, tabs }) {
    this.targets = targets;
    this.link = link;
    this.pictures = pictures;
    this.look = look;
    this.debrief = debrief;
    this.tabs = tabs;
    this.factsText = this.routeKey = this.listText = ""; // as they are shown
    document.querySelector("nav").insertAdjacentHTML("beforeend", TAB);
    this.section = make("section", { id: "targets", hidden: true });
    this.section.setAttribute("role", "tabpanel");
    this.section.setAttribute("aria-labelledby", "tab-targets");
    this.section.innerHTML = MARKUP;
    document.querySelector("aside").append(this.section);
    this.form = /** @type {HTMLFormElement} */ ($("target-form"));
    this.entries = /** @type {HTMLFormControlsCollection & FormFields} */ (this.form.elements);
    $("targets-on").onclick = () => targets.toggle();
    $("targets-set").onclick = () => targets.toggleClaim();
    $("target-cancel").onclick = () => this.#cancel();
    $("target-remove").onclick = () => targets.remove();
    $("route-loops").onchange = () => targets.changeRoute({ loops: this.routeLoops });
    $("route-speed").onchange = () => this.#try(() => targets.changeRoute({ speed_m_s: this.routeSpeed_m_s }));
    $("route-end").onclick = () => targets.endRoute();
    this.entries.type.onchange = () => this.#type();
    this.form.onsubmit = (event) => {
      event.preventDefault();
      this.#try(() => targets.add(this.#read()));
    };
    this.form.onkeydown = ({ key }) => key === "Escape" && this.#cancel();
    this.keyRow = /** @type {HTMLTableElement} */ ($("key-table")).insertRow();
    for (const text of KEY) this.keyRow.insertCell().textContent = text;
    tabs.added("targets");
  }

  remove() {
    for (const element of [$("tab-targets"), this.section, this.keyRow]) element.remove();
    this.tabs.show(this.tabs.current);
  }

  open() {
    this.tabs.show("targets");
  }

  /** What is typed wrong is said, and not sent. @param {() => Promise<unknown>|void} what */
  async #try(what) {
    try {
      await what();
    } catch (error) {
      this.targets.refusal = error.message;
      this.show();
    }
  }

  // ---- The form of a new target

  ask() {
    this.show();
    this.entries.name.focus({ preventScroll: true });
    this.entries.name.select();
  }

  /** It may be clicked again at once. */
  added() {
    this.entries.name.value = "";
    blur();
  }

  #cancel() {
    this.targets.cancel();
    blur();
  }

  /** @returns {import("../wire.js").Target} */
  #read() {
    const { name, type, rcs_dbsm, speed, course, height_m } = this.entries;
    const speed_m_s = typed(speed.value, "speed") * KNOT_MPS;
    const course_rad = typed(course.value, "course") * DEGREE;
    return {
      name: name.value.trim(), ...(type.value && { type: type.value }), ...(rcs_dbsm.value.trim() && { rcs_dbsm: typed(rcs_dbsm.value, "RCS") }),
      velocity_north_m_s: speed_m_s * Math.cos(course_rad), velocity_east_m_s: speed_m_s * Math.sin(course_rad),
      height_m: typed(height_m.value, "height"),
    };
  }

  #type() {
    const { type, rcs_dbsm } = this.entries;
    const found = this.targets.types.find(({ name }) => name === type.value);
    rcs_dbsm.placeholder = found ? String(+number(found.rcs_dbsm).toFixed(1)) : "";
  }

  #types() {
    const { type } = this.entries;
    const names = ["", ...this.targets.types.map(({ name }) => name)];
    if ([...type.options].map(({ value }) => value).join("\n") === names.join("\n")) return;
    type.replaceChildren(...names.map((name) => new Option(name || "none", name)));
    this.#type();
  }

  // ---- The route of the chosen one

  get routeLoops() {
    return inputOf("route-loops").checked;
  }
  get routeSpeed_m_s() {
    return typed(inputOf("route-speed").value, "speed on the route") * KNOT_MPS;
  }

  // ---- What is shown

  show() {
    const { targets } = this;
    const { holds, controller, isOn, mayClaim, fresh } = targets;
    const isAdmin = this.link.welcome?.role === "admin";
    const why = !mayClaim ? "You may look; to set targets takes a token of a controller"
      : this.debrief.isOn ? "A recording is as it was: nothing of it can be set"
      : controller && !holds && !isAdmin ? `${controller} sets targets; only an admin may take over` : !isOn ? "Show targets first" : "";
    $("targets-on").setAttribute("aria-pressed", String(Boolean(isOn)));
    const set = buttonOf("targets-set");
    set.textContent = holds ? "Done" : controller ? "Take over" : "Set targets";
    set.disabled = Boolean(why) && !holds;
    set.title = holds ? "Let others set targets" : why || "Only one client at a time sets targets";
    set.setAttribute("aria-pressed", String(holds));
    $("targets-refusal").textContent = targets.refusal;
    $("targets-hint").textContent = !isOn ? "" : holds
      ? "Click the picture: a new target. Drag a mark: it moves. Shift and click: the next point of the chosen one's route. Delete: it goes."
      : controller ? `Set by ${controller}.` : "";
    this.form.hidden = !(holds && fresh);
    this.#types();
    this.#chosen();
    this.#list();
  }

  #chosen() {
    const { targets } = this;
    const target = targets.isOn ? targets.list.get(targets.chosen) : null;
    $("target-chosen").hidden = !target;
    if (!target) return;
    const facts = this.#facts(target);
    const text = JSON.stringify(facts);
    if (this.factsText !== text) {
      this.factsText = text;
      this.section.querySelector(".facts").replaceChildren(...facts.flatMap(([name, value]) => {
        return [make("dt", {}, name), make("dd", {}, value)];
      }));
    }
    $("target-route").hidden = $("target-remove").hidden = !targets.holds;
    buttonOf("route-end").disabled = !target.route;
    const key = `${targets.chosen} ${JSON.stringify(target.route)}`;
    if (this.routeKey === key) return;
    this.routeKey = key;
    inputOf("route-loops").checked = Boolean(target.route?.loops);
    const last = pointsOf(target).at(-1);
    const speed = Math.hypot(number(target.velocity_north_m_s), number(target.velocity_east_m_s));
    inputOf("route-speed").value = String(knots(last ? last.speed_m_s : speed || 20 * KNOT_MPS));
  }

  /** @param {import("./targets.js").Known} target */
  #facts(target) {
    const { targets, look } = this;
    const { ppi } = this.pictures.first;
    const record = ppi.truth?.records.get(target.id);
    const velocity = ppi.truth && targets.velocityOf(target.id, ppi.truth);
    const speed = velocity && Math.hypot(velocity.north, velocity.east);
    const reference = OVER[target.height_reference ?? "DATUM"];
    const facts = [["Name", targets.nameOf(target.id)]];
    if (target.type) facts.push(["Type", target.type]);
    if (record) facts.push(["At", `${bearingText(record.bearing_deg)} T  ${distanceText(record.range_m, look.unit)}`]);
    facts.push(["Height", `${number(target.height_m).toFixed(0)} m ${reference}`]);
    if (speed !== null && speed !== undefined)
      facts.push(["Goes", speed < 0.05 ? "stands" : `${bearingText(turned(Math.atan2(velocity.east, velocity.north) / DEGREE))} T  ${(speed / KNOT_MPS).toFixed(0)} kt`]);
    if (target.route) facts.push(["Route", `${targets.pointsAhead(target.id).length} points ahead${target.route.loops ? ", loops" : ""}`]);
    facts.push(["RCS", `${number(target.rcs_dbsm).toFixed(1)} dBsm`]);
    if (record) {
      const echo = record.snr_dB <= -199 ? "none" : `${record.snr_dB.toFixed(1)} ${record.isPower ? "dBW" : "dB over noise"}`;
      facts.push(["Echo", echo], ["Seen", record.share >= 0.999 ? "all of it" : `${(100 * record.share).toFixed(0)} %${record.hiddenBy ? `, ${record.hiddenBy}` : ""}`]);
    } else facts.push(["Seen", "not by this radar"]);
    return facts;
  }

  #list() {
    const { targets, look } = this;
    const { ppi } = this.pictures.first;
    const all = targets.isOn ? [...targets.list.values()] : [];
    const rows = all.slice(0, MOST_LISTED).map((target) => {
      const record = ppi.truth?.records.get(target.id);
      return { id: target.id, name: targets.nameOf(target.id), share: record && record.azimuth_bin >= 0 && record.range_bin >= 0 ? record.share : -1,
        at: record ? `${String(Math.round(turned(record.bearing_deg)) % 360).padStart(3, "0")}° ${(record.range_m / UNIT_M[look.unit]).toFixed(1)} ${look.unit}` : "–" };
    });
    const list = $("target-list");
    const text = [...rows.map(({ id }) => id), all.length].join();
    if (this.listText !== text) {
      this.listText = text;
      list.replaceChildren(...rows.map(({ id }) => this.#item(id)));
      if (all.length > rows.length) list.append(make("p", { className: "hint" }, `and ${all.length - rows.length} more`));
    }
    for (const [k, { id, name, share, at }] of rows.entries()) {
      const item = /** @type {HTMLElement} */ (list.children[k]);
      item.setAttribute("aria-selected", String(id === targets.chosen));
      item.dataset.seen = share < 0 ? "out" : share === 0 ? "no" : share < 0.999 ? "part" : "all";
      item.title = SEEN_WORDS[item.dataset.seen];
      for (const [n, words] of [name, at].entries()) if (item.children[n].textContent !== words) item.children[n].textContent = words;
    }
  }

  /** @param {string} id */
  #item(id) {
    const item = make("button", { onclick: () => this.targets.choose(id) }, make("span"), make("span"));
    item.setAttribute("role", "option");
    item.dataset.id = id;
    return item;
  }
}
