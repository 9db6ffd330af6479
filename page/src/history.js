/** Samples of the last seconds, one column per curve, in the form that uPlot draws: [times, curve, curve, …]. */
export class History {
  #span;
  #readers;
  columns;

  /** @param {number} span s kept  @param {Array<function(object): number|null>} readers one per curve */
  constructor(span, readers) {
    this.#span = span;
    this.#readers = readers;
    this.clear();
  }

  clear() {
    this.columns = [[], ...this.#readers.map(() => [])];
  }

  /** Adds what the readers find in a message with a `time`. Time that runs back takes away what came after. */
  add(message) {
    const times = this.columns[0];
    let keep = times.length;
    while (keep > 0 && times[keep - 1] >= message.time) --keep;
    let drop = 0;
    while (drop < keep && times[drop] < message.time - this.#span) ++drop;
    if (keep < times.length) for (const column of this.columns) column.length = keep;
    if (drop > 0) for (const column of this.columns) column.splice(0, drop);
    times.push(message.time);
    this.#readers.forEach((read, i) => this.columns[i + 1].push(read(message) ?? null));
  }

  /** Has any curve a value? */
  get empty() {
    return this.columns.slice(1).every((column) => column.every((value) => value === null));
  }
}
