// Keys: what each does, in the list that `?` shows.

import { $, make } from "./dom.js";

/** @type {[string, string][]} what `?` shows */
const KEYS = [
  ["← →", "turn the antenna by 1°, with Ctrl by 10°; without control: move the cursor"],
  ["Shift + arrows", "move the cursor"],
  ["+ − 0", "zoom in, out, all of the sector"],
  ["[ ]", "smaller, greater range scale"],
  ["1 2", "bearing line and range marker 1, 2 (EBL, VRM): at the cursor, or away"],
  ["A", "levels by what is shown now"],
  ["C", "next palette"],
  ["N", "north, bearing, heading or course up"],
  ["G", "to the gain: type a number; the wheel turns a field, too"],
  ["L", "places on the ground, or slant ranges"],
  ["B V", "B-scope: bearings across, ranges upwards; profile of the ground along bearing line 1"],
  ["R U", "rings; km or NM"],
  ["O", "overlay of shadow, not sampled, no ground"],
  ["F", "hold the picture"],
  ["S", "save a PNG"],
  ["P", "one picture or two"],
  ["K", "take or release control"],
  ["T Z", "standby; freeze the radar"],
  ["D", "next tab"],
  ["Esc", "cursor, bearing lines and range markers away"],
  ["space , .", "of a recording: pause; a second back, on, with Ctrl ten"],
  ["?", "this list"],
];

/** @typedef {"ArrowLeft"|"ArrowRight"|"ArrowUp"|"ArrowDown"} Arrow */
/** @type {Record<Arrow, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/**
 * @typedef {object} Doings what keys do
 * @property {(key: string, isFast: boolean) => (() => void)|null|undefined} press a letter in lower case, a sign or a key's name, and whether
 *   Ctrl is pressed; nothing: the key is the browser's
 * @property {(dx: number, dy: number, isCursor: boolean, isFast: boolean) => void} arrow steps to the right and down; isCursor: with Shift
 */

/** @param {Doings} doings */
export function listenKeys({ press, arrow }) {
  $("key-table").replaceChildren(...KEYS.map((row) => make("tr", {}, ...row.map((text) => make("td", {}, text)))));
  addEventListener("keydown", (event) => {
    const { key, ctrlKey: isFast } = event;
    const target = event.target instanceof Element ? event.target : document.body;
    if (target.closest("input, select, textarea, dialog[open]") || event.altKey || event.metaKey) return;
    if (target.closest("nav") && key.startsWith("Arrow")) return;
    if (target.closest("button") && key === " ") return;
    if (key in ARROWS) {
      arrow(...ARROWS[/** @type {Arrow} */ (key)], event.shiftKey, isFast);
    } else {
      const does = press(key.length === 1 ? key.toLowerCase() : key, isFast);
      if (!does) return;
      does();
    }
    event.preventDefault();
  });
}
