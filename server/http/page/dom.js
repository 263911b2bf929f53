// Elements of the document by id, and new ones.

/** @param {string} id */
export const $ = (id) => document.getElementById(id);
/** @param {string} id */
export const inputOf = (id) => /** @type {HTMLInputElement} */ ($(id));
/** @param {string} id */
export const buttonOf = (id) => /** @type {HTMLButtonElement} */ ($(id));
/** @param {string} id */
export const selectOf = (id) => /** @type {HTMLSelectElement} */ ($(id));
/** @param {string} id */
export const dialogOf = (id) => /** @type {HTMLDialogElement} */ ($(id));

/**
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Partial<HTMLElementTagNameMap[Tag]>} properties
 * @param {(Node|string)[]} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** Leaves an element alone that says so already. @param {Element} element @param {string} text */
export function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
