// One scene computed by several workers: pieces of replicas on all of them, merged by the first one.

import { head, ProgramError } from "./core.js";

// Replicas of a piece, and of the first pieces: the first picture does not wait for a whole one.
const PIECE = 8,
  FIRST = 2;
// Milliseconds between results of what is merged so far.
const APART = 1000;

/** Cuts the replicas of a part, the run itself or one of its plastic contacts, into pieces. */
function pieces(part, first, end, size) {
  const found = [];
  for (let at = first; at < end; at += size)
    found.push({ ...part, first: at, count: Math.min(size, end - at) });
  return found;
}

export class Computation {
  #workers;
  #queue = [];
  #size = PIECE;
  // Pieces that wait for the first worker, what it has merged, and the parts that it knows.
  #computed = [];
  #merged = { merged: 0, complete: false, contacts: [] };
  #parts = null;
  #asked = false;
  // Whether results are due for something new, at which restoring force, and when there were some.
  #isNew = false;
  #above = null;
  #last = -Infinity;

  /**
   * Begins. `listener` has `prepared(about)`, `integral(curves)`, `computed(head)`, `results(results)` and
   * `failed(error)`. `scene` is what `prepare` of the core takes.
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
    const { complete, contacts } = this.#merged;
    return (
      complete &&
      this.#parts !== null &&
      this.#parts.every(({ contact }) => contact === null || contacts.includes(contact))
    );
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
    const { replicas, group } = about;
    this.#size = group === 1 ? PIECE : group;
    const early = group === 1 ? Math.min(FIRST * this.#workers.length, replicas) : 0;
    this.#queue = [...pieces({}, 0, early, FIRST), ...pieces({}, early, replicas, this.#size)];
    this.listener.prepared(about);
  }

  #integrated(integral) {
    this.#take(integral.parts);
    this.listener.integral(integral);
  }

  #mergedOf(merged) {
    this.#merged = merged;
    this.#take(merged.parts);
    // With targets fewer replicas may do.
    if (merged.complete) this.#queue = this.#queue.filter(({ contact }) => contact);
    this.#isNew = true;
  }

  /** Queues the parts of the model range that are new; with targets they come once the run is complete. */
  #take(parts) {
    const isNew = ({ contact }) =>
      contact !== null && !this.#parts?.some((known) => known.contact === contact);
    for (const part of parts.filter(isNew)) this.#queue.push(...pieces(part, 0, part.replicas, this.#size));
    this.#parts = parts;
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
    const isDue = this.isComplete || performance.now() - this.#last >= APART;
    if (!this.#isNew || this.#merged.merged === 0 || !isDue) return null;
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
