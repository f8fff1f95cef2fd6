// A worker: one instance of the program's core, which prepares a scene and does one job after the other.

import { Core, piece, ProgramError } from "./core.js";

let core;

const JOBS = {
  prepare({ module, scene }) {
    core = new Core(module);
    return core.ask("prepare", scene);
  },
  compute: ({ replicas }) => piece(core.call("compute", JSON.stringify(replicas))),
  integral: () => core.ask("integral"),
  merge: ({ bytes }) => core.ask("merge", bytes),
  results: ({ above }) => core.ask("results", above === null ? {} : { above }),
};

onmessage = ({ data }) => {
  try {
    const reply = JOBS[data.job](data);
    const moved = reply instanceof Uint8Array ? [reply.buffer] : [];
    postMessage({ job: data.job, reply }, moved);
  } catch (error) {
    const problems = error instanceof ProgramError ? error.problems : [];
    postMessage({ job: data.job, error: { text: error.message, problems } });
  }
};
