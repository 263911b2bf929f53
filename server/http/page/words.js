// The state of everything, in sentences: one place for each, the gravest first.

import { number } from "./messages.js";

export const LEAST_COVERAGE = 0.9995; // with less there is ground that no file has

/** @typedef {import("./picture/pane.js").Pane} Pane */
/**
 * @typedef {{grave: 0|1|2, text: string, banner?: string, panes?: Pane[]}} Sentence 2: the picture is not live; without panes: of
 *   all
 */
/** Of the radar of this name. @typedef {Sentence & {name?: string}} NamedSentence */

/**
 * @typedef {object} Facts that are to be said
 * @property {import("./stream.js").LinkState} state of the connection
 * @property {Pane[]} panes
 * @property {import("../wire.js").ReplayState|null} replay
 * @property {boolean} isHeld
 * @property {string} news said for some seconds
 * @property {import("../wire.js").Status|null} status
 */

/** @param {Facts} facts @returns {Sentence[]} */
export function sentences({ state, panes, replay, isHeld, news, status }) {
  const link = linkSentence(state);
  if (link) return [link];
  const isMany = new Set(panes.map(({ radar }) => radar).filter(Boolean)).size > 1;
  const found = panes.flatMap((pane) => paneSentences(pane, isMany ? pane.radar : "", isHeld));
  if (replay) found.unshift({ grave: 0, text: `A recording${replay.ended ? "; it has ended" : replay.paused ? "; paused" : ""}.` });
  if (isHeld) found.unshift({ grave: 1, text: "The picture is held; press F or Hold to go on.", banner: "PICTURE HELD" });
  if (news) found.unshift({ grave: 1, text: news });
  if (status?.window_error) found.push({ grave: 1, text: `Ground is missing: ${status.window_error}.` });
  if (status?.window_loading) found.push({ grave: 0, text: "The server is loading the next ground." });
  return joined(found).sort((a, b) => b.grave - a.grave);
}

/**
 * One sentence for what several panes say, with the names of their radars in front.
 * @param {NamedSentence[]} found
 * @returns {Sentence[]}
 */
function joined(found) {
  /** @type {Map<string, Sentence & {names: Set<string>}>} */
  const said = new Map();
  for (const { name, ...sentence } of found) {
    const before = said.get(sentence.text);
    if (before) {
      before.names.add(name);
      before.panes?.push(...(sentence.panes ?? []));
    } else {
      said.set(sentence.text, { ...sentence, names: new Set([name]) });
    }
  }
  return [...said.values()].map(({ names, text, ...more }) => ({ ...more, text: [[...names].filter(Boolean).join(", "), text].filter(Boolean).join(": ") }));
}

/** @param {import("./stream.js").LinkState} state @returns {Sentence|null} null: all is well */
function linkSentence(state) {
  const left_s = Math.max(0, Math.ceil((state.retry_ms - performance.now()) / 1000));
  const again = state.retry_ms ? (left_s > 0 ? ` Next attempt in ${left_s} s.` : " Trying again now.") : "";
  const because = state.text ? `: ${plain(state.text)}` : "";
  switch (state.kind) {
    case "connecting":
      return { grave: 0, text: "Connecting to the server.", banner: "CONNECTING" };
    case "loading":
      return { grave: 1, text: `The server is not ready yet: ${plain(state.text)}.`, banner: loadingBanner(state.text) };
    case "silent":
      return { grave: 2, text: "The server is silent; the picture is old.", banner: "NO ANSWER" };
    case "lost":
      return { grave: 2, text: `${state.text ? "The server ended the connection" : "No connection to the server"}${because}.${again}`, banner: "NO CONNECTION" };
    case "token":
      return state.text
        ? { grave: 2, text: `The server does not accept this token: ${plain(state.text)}.`, banner: "WRONG TOKEN" }
        : { grave: 2, text: "This server wants a token.", banner: "TOKEN NEEDED" };
    case "refused":
      return { grave: 2, text: `The server refuses this page${because}. Load it again.`, banner: "REFUSED" };
    default:
      return null;
  }
}

const plain = (/** @type {string} */ text) => text.trim().replace(/\.$/, "");

/** @param {string} text */
function loadingBanner(text) {
  const percent = /(\d+) %/.exec(text);
  return text.startsWith("stopping") ? "STOPPING" : `LOADING${percent ? ` ${percent[1]} %` : ""}`;
}

/** @param {Pane} pane @param {string} name before its sentences @param {boolean} isHeld */
function paneSentences(pane, name, isHeld) {
  const { info, status, bins } = pane;
  /** @type {NamedSentence[]} */
  const found = [];
  /** @param {0|1|2} grave @param {string} text @param {string} [banner] */
  const say = (grave, text, banner) => found.push({ grave, text, name, banner, panes: [pane] });
  if (pane.says) say(1, pane.says, pane.awaits || pane.isRendered ? `NO PICTURE\n${pane.says}` : undefined);
  else if (pane.awaits && !isHeld && !info?.transmit_off && !info?.fault)
    say(0, `Waiting for the first picture ${pane.radar ? `of ${pane.radar}` : pane.called}.`, "WAITING");
  if (info?.transmit_off) say(1, "Standby: the transmitter is off.", "STANDBY");
  if (info?.exercise_frozen) say(1, "The exercise is frozen: all radars stand still.", "EXERCISE FROZEN");
  else if (info?.frozen) say(1, "The radar is frozen: it keeps an older pose and older settings.", "RADAR FROZEN");
  if (info?.fault) say(2, `The radar cannot render: ${plain(info.fault)}.`, "FAULT");
  const coverage = status?.coverage === undefined ? undefined : number(status.coverage);
  if (coverage === 0) say(1, "Off the map: no file has ground where the radar looks.", "OFF THE MAP");
  if (info?.pose_stale) say(1, "The pose is stale: no newer one has arrived in time.", "STALE POSE");
  if (info?.gimbal) say(1, `The antenna stands at its gimbal's limit: ${plain(info.gimbal)}.`, "GIMBAL LIMIT");
  if (info && number(info.rate_limit_hz)) say(0, `The operator limits this radar to ${number(info.rate_limit_hz)} frames/s.`);
  if (coverage !== undefined && coverage < LEAST_COVERAGE) {
    const percent = Math.min(99.9, 100 * coverage).toFixed(coverage > 0.99 ? 1 : 0);
    const why = status.coverage_reason ? `: ${plain(status.coverage_reason)}` : "";
    say(0, `${percent} % of the sector has ground${why}.`);
  }
  for (const warning of bins.descriptor?.warnings ?? []) say(0, `${plain(warning)}.`);
  return found;
}
