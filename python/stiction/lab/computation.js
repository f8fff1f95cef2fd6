// One scene computed by several workers: pieces of replicas on all of them, merged by the first one.

import { head, ProgramError } from "./core.js";

// Replicas of a piece, and of the first pieces: the first picture does not wait for a whole one.
const PIECE = 8, FIRST = 2;
// Milliseconds between results of what is merged so far.
const APART = 1000;

/** Cuts replicas of a part into pieces. */
function pieces(part, first, end, size) {
  const found = [];
  for (let at = first; at < end; at += size) found.push({ part, first: at, count: Math.min(size, end - at) });
  return found;
}

export class Computation {
  #workers;
  #queue = [];
  #size = PIECE;
  // Pieces that wait for the first worker, and what it has merged of each part.
  #computed = [];
  #merged = [];
  #parts = null;
  #asked = false;
  // Whether results are due for something new, at which restoring force, and when there were some.
  #isNew = false;
  #above = null;
  #last = -Infinity;

  /**
   * Begins. `listener` has `prepared(about)`, `integral(curves)`, `computed(head)`, `results(results)` and `failed(error)`.
   * `scene` is what `prepare` of the core takes.
   */
  constructor(module, scene, count, listener) {
    this.listener = listener;
    this.#workers = Array.from({ length: count }, () => {
      const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
      const own = { worker, isPrepared: false, isBusy: true };
      worker.onmessage = ({ data }) => this.#heard(own, data);
      worker.onerror = (event) => this.#failed(new Error(event.message || "a worker has ended"));
      worker.postMessage({ job: "prepare", module, scene });
      return own;
    });
  }

  /** Ends at once, whatever the workers are at. */
  cancel() {
    for (const { worker } of this.#workers) worker.terminate();
    this.#workers = [];
  }

  /** Asks for the results at another restoring force, a text with its unit: no replica is computed anew. */
  above(force) {
    this.#above = force;
    this.#isNew = true;
    this.#last = -Infinity;
    this.#go();
  }

  /** Whether all replicas of all parts are merged. */
  get isComplete() {
    return this.#parts !== null && this.#parts.every(({ part }) => this.#merged[part]?.complete);
  }

  #heard(own, { job, reply, error }) {
    if (!this.#workers.includes(own)) return;
    if (error) {
      this.#failed(new ProgramError(error));
      return;
    }
    own.isBusy = false;
    const done = {
      prepare: () => this.#prepared(own, reply),
      integral: () => this.#integrated(reply),
      compute: () => this.#computed.push(reply) && this.listener.computed(head(reply)),
      merge: () => this.#mergedOf(reply),
      results: () => this.listener.results(reply),
    };
    done[job]();
    this.#go();
  }

  #prepared(own, about) {
    own.isPrepared = true;
    if (this.about) return;
    this.about = about;
    const { most_replicas: most, group = PIECE } = about;
    this.#size = group === 1 ? PIECE : group;
    const early = group === 1 ? Math.min(FIRST * this.#workers.length, most) : 0;
    this.#queue = [...pieces(0, 0, early, FIRST), ...pieces(0, early, most, this.#size)];
    this.listener.prepared(about);
  }

  #integrated(integral) {
    this.#parts = integral.parts;
    for (const { part, replicas } of integral.parts.slice(1)) this.#queue.push(...pieces(part, 0, replicas, this.#size));
    this.listener.integral(integral);
  }

  #mergedOf(merged) {
    this.#merged[merged.part] = merged;
    if (merged.complete) this.#queue = this.#queue.filter(({ part }) => part !== merged.part);
    this.#isNew = true;
  }

  /** Gives work to every worker that has none. */
  #go() {
    this.#workers.forEach((own, place) => {
      if (!own.isPrepared || own.isBusy) return;
      const job = (place === 0 && this.#collecting()) || this.#computing();
      if (!job) return;
      own.isBusy = true;
      own.worker.postMessage(job, job.bytes ? [job.bytes.buffer] : []);
    });
  }

  /** What the first worker does before it computes. */
  #collecting() {
    if (!this.#asked) {
      this.#asked = true;
      return { job: "integral" };
    }
    if (this.#computed.length > 0) return { job: "merge", bytes: this.#computed.shift() };
    const isEnough = (this.#merged[0]?.merged ?? 0) >= Math.min(PIECE, this.about.most_replicas);
    const isDue = this.isComplete || performance.now() - this.#last >= APART;
    if (!this.#isNew || !isEnough || !isDue) return null;
    this.#isNew = false;
    this.#last = performance.now();
    return { job: "results", above: this.#above };
  }

  #computing() {
    const replicas = this.#queue.shift();
    return replicas && { job: "compute", replicas };
  }

  #failed(error) {
    this.cancel();
    this.listener.failed(error);
  }
}
