// Events between the parts of the page: a part says what has happened and does not know who listens.

/** @template Said what is said, by the event's name */
export class Events {
  constructor() {
    /** @type {Map<keyof Said, ((what: any) => void)[]>} */
    this.listeners = new Map();
  }

  /**
   * @template {keyof Said} Name
   * @param {Name} name
   * @param {(what: Said[Name]) => void} listener called in the order of these calls
   */
  on(name, listener) {
    this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener]);
  }

  /**
   * @template {keyof Said} Name
   * @param {Name} name
   * @param {Said[Name]} [what]
   */
  emit(name, what) {
    for (const listener of this.listeners.get(name) ?? []) listener(what);
  }
}
