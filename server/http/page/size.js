// How large letters and lines are: as the screen has room for, times what the viewer chooses.

const WIDTH_PX = 1366; // of the screen that the page's own sizes are made for
const HEIGHT_PX = 768;
const LARGEST = 4;

/** CSS pixels of one of the page's own. @param {number} chosen 1: as the screen is */
export function sizeFor(chosen) {
  const room = Math.min(innerWidth / WIDTH_PX, innerHeight / HEIGHT_PX);
  return Math.min(LARGEST, Math.max(1, room)) * chosen;
}

/** For the style sheet, which counts in var(--px). @param {number} size CSS pixels */
export function applySize(size) {
  document.documentElement.style.setProperty("--px", `${size}px`);
}
