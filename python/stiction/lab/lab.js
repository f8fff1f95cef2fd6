// The page: a scene as text, fields that change it, and what the program computes of it.

import { showAnswer } from "./answer.js";
import { Computation } from "./computation.js";
import { Core, ProgramError } from "./core.js";
import { by, element } from "./dom.js";
import { Field, FIELDS } from "./fields.js";
import { ForceCurve, Histogram, Probability } from "./figures.js";
import { packed, unpacked } from "./link.js";
import { listenForMaps } from "./maps.js";
import { Materials } from "./materials.js";
import { si } from "./quantity.js";

// Milliseconds without another change until a scene is computed, a typed text read, and the address changed.
const [CALM, TYPED, LINKED] = [60, 250, 300];
// Workers, at most: each has the laws in its own memory.
const MOST_WORKERS = 8;
const RESTORING = "device.restoring_force";

// What tests and consoles look at: the scene, the one in the address, all that was computed, and when.
const lab = {
  toml: "",
  linked: null,
  isComplete: false,
  pullOffs: [],
  results: null,
  integral: null,
  about: null,
  problems: [],
  times: {},
};
globalThis.lab = lab;

// The core of this page, its lists, the computation at hand, its scene without the restoring force, what is
// known of the scene at hand, timers.
let core, materials, computation, computed, known, calm, typed, linking;
const fields = new Map();
const figures = {
  histogram: new Histogram(by("histogram")),
  force: new ForceCurve(by("force")),
  probability: new Probability(by("probability")),
};

/** Notes when something is seen for the first time, in seconds since the page was asked for. */
function timed(name) {
  requestAnimationFrame(() => (lab.times[name] ??= performance.now() / 1000));
}

// The scene.

/** Changes keys of the scene: pairs of key and value, and keys to leave out. */
function edit(set, unset = []) {
  try {
    take(core.ask("edit", { toml: lab.toml, set, unset }).toml);
  } catch (error) {
    refused(
      error,
      set.map(([key]) => key),
    );
  }
}

/** Takes a text as the scene, shows it, and computes it. */
function take(toml, { isTyped = false } = {}) {
  lab.toml = toml;
  lab.isComplete = false;
  clearTimeout(calm);
  clearTimeout(linking);
  linking = setTimeout(link, LINKED);
  if (!isTyped) by("toml").value = toml;
  try {
    known = core.ask("describe", { toml, files: {} });
  } catch (error) {
    refused(error);
    return;
  }
  document.title = known.title ? `${known.title} – Will my pad stick?` : "Will my pad stick?";
  // Of a text that is no TOML nothing is known: fields stay as they are.
  if (Object.values(known.values).some(({ given }) => given) || known.errors.length === 0) {
    for (const [key, field] of fields) field.show(known.values[key]);
    showHumidity();
    materials.show(known.values);
  }
  showProblems(known.errors);
  if (known.errors.length === 0) calm = setTimeout(compute, CALM);
  else stop();
}

/** Puts the scene into the address. */
async function link() {
  const { toml } = lab;
  const hash = await packed(toml);
  if (toml !== lab.toml) return;
  history.replaceState(null, "", hash);
  lab.linked = toml;
}

/** Shows what the program refuses: at the fields of its keys, else below the scene. */
function refused(error, keys = []) {
  const problems =
    error instanceof ProgramError && error.problems.length > 0
      ? error.problems
      : [{ line: null, key: keys[0] ?? null, text: error.message }];
  showProblems(problems);
  stop();
}

function showProblems(problems) {
  lab.problems = problems;
  // A problem without a key may have it at the beginning of its message.
  const isOf = (key, of) => of.key === key || (of.key === null && of.text.startsWith(`\`${key} `));
  for (const [key, field] of fields) field.refuse(problems.find((of) => isOf(key, of))?.text);
  by("problems").replaceChildren(
    ...problems.map(({ line, text }) => element("li", {}, line ? `line ${line}: ${text}` : text)),
  );
  if (problems.length > 0) by("toml").setAttribute("aria-invalid", "true");
  else by("toml").removeAttribute("aria-invalid");
}

// The computation.

function stop() {
  computation?.cancel();
  computation = null;
  lab.isComplete = false;
  computed = null;
  // What is seen is of the scene before.
  for (const part of ["answer", "results"]) by(part).classList.add("stale");
  if (lab.problems.length > 0) by("count").textContent = "the scene has an error";
}

/** Begins to compute the scene at hand; only another restoring force needs no new replicas. */
function compute() {
  const force = known.values[RESTORING];
  const rest = core.ask("edit", { toml: lab.toml, set: [], unset: [RESTORING] }).toml;
  if (computation && computed === rest && force?.given) {
    lab.isComplete = false;
    lab.restoringForce = force.value;
    showPullOffs();
    computation.above(force.text);
    return;
  }
  stop();
  computed = force?.given ? rest : null;
  Object.assign(lab, {
    pullOffs: [],
    results: null,
    integral: null,
    about: null,
    begun: performance.now(),
    restoringForce: force?.given ? force.value : null,
  });
  by("failure").hidden = true;
  by("results").classList.remove("stale");
  by("bar").removeAttribute("value");
  by("count").textContent = "preparing";
  const count = Math.max(1, Math.min(navigator.hardwareConcurrency || 2, MOST_WORKERS));
  computation = new Computation(core.module, { toml: lab.toml, files: {} }, count, {
    prepared: showPrepared,
    integral: showIntegral,
    computed: showPiece,
    results: showResults,
    failed: showFailure,
  });
}

function showPrepared(about) {
  lab.about = about;
  by("preloads").hidden = about.preloads.length < 2;
  by("preload-of").replaceChildren(
    ...about.preloads.map((load, place) => element("option", { value: String(place) }, si(load, "N"))),
  );
  if (about.preloads.length > 0) by("preload-of").value = String(about.preloads.length - 1);
}

function showIntegral(integral) {
  lab.integral = integral;
  const { separations } = lab.about;
  figures.force.show(
    integral.paths.map(({ way, force }) => ({ way, separation: separations, integral: force })),
  );
  timed("first curve");
}

function showPiece(piece) {
  if (piece.contact !== null) {
    showCount();
    return;
  }
  piece.pull_off.forEach((whole, place) => {
    lab.pullOffs[piece.first + place] = { whole, after: piece.after_preload?.[place] ?? [] };
  });
  showCount();
  showPullOffs();
  timed("first picture");
  if (lab.pullOffs.filter(Boolean).length === lab.about.replicas) timed("replicas");
}

/** The pull-offs so far that the figures are of: after the preload that is chosen, where there are any. */
function shownPullOffs() {
  const place = lab.about?.preloads.length ? Number(by("preload-of").value) : null;
  const values = lab.pullOffs
    .filter(Boolean)
    .map(({ whole, after }) => (place === null ? whole : after[place]));
  return values.filter((value) => typeof value === "number");
}

let isDrawing = false;
function showPullOffs() {
  if (isDrawing) return;
  isDrawing = true;
  requestAnimationFrame(() => {
    isDrawing = false;
    figures.histogram.show(shownPullOffs(), lab.restoringForce, lab.results && shownOf(lab.results).mean);
  });
}

function showCount() {
  const { replicas: of } = lab.about;
  const done = lab.pullOffs.filter(Boolean).length;
  by("bar").value = done / of;
  by("count").textContent = `${done} of ${of} pads${done === of && !lab.isComplete ? ", model range" : ""}`;
}

/** The results after the preload that is chosen, or of the whole curve with the mean that is quoted. */
function shownOf(results) {
  if (results.after_preload.length > 0) return results.after_preload[Number(by("preload-of").value)];
  const { quoted, is_controlled: is, interval, controlled_interval: controlled } = results.pull_off;
  return { ...results.whole, mean: quoted, interval: is ? controlled : interval };
}

function showResults(results) {
  lab.results = results;
  figures.force.show(results.curves);
  const of = shownOf(results);
  if (of.count > 0) figures.probability.show(of.above, lab.restoringForce);
  else figures.probability.clear("no pad reaches the preload");
  showAnswer(results, of);
  showPullOffs();
  lab.isComplete = computation?.isComplete ?? false;
  if (!lab.isComplete) return;
  lab.seconds = (performance.now() - lab.begun) / 1000;
  timed("complete");
  by("bar").value = 1;
  by("count").textContent = `${results.replicas} pads in ${lab.seconds.toFixed(1)} s`;
  by("summary").textContent = results.summary;
}

function showFailure(error) {
  computation = null;
  if (error instanceof ProgramError && error.problems.length > 0) {
    refused(error);
    return;
  }
  by("failure").hidden = false;
  by("failure").textContent = error.message;
  by("count").textContent = "not computed";
}

// Humidity.

function showHumidity() {
  const given = Object.entries(known.values).some(
    ([key, { given: is }]) => is && key.startsWith("capillary."),
  );
  by("humid").checked = given;
}

function humidify({ target }) {
  const own = Object.keys(known.values).filter(
    (key) => key.startsWith("capillary.") && known.values[key].given,
  );
  if (target.checked)
    edit([
      ["capillary.relative_humidity", "0.45"],
      ["capillary.contact_angles", '["30 deg", "30 deg"]'],
    ]);
  else edit([], ["capillary", ...own]);
}

// Copies of the scene.

async function copy(text, words) {
  try {
    await navigator.clipboard.writeText(text);
    by("done").textContent = words;
  } catch {
    by("toml").select();
    by("done").textContent = "The browser refuses: the scene is selected, copy it by the keyboard.";
  }
}

function download() {
  const address = URL.createObjectURL(new Blob([lab.toml], { type: "text/plain" }));
  element("a", { href: address, download: "pad.toml" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function listen() {
  by("humid").addEventListener("change", humidify);
  by("toml").addEventListener("input", ({ target }) => {
    clearTimeout(typed);
    typed = setTimeout(() => take(target.value, { isTyped: true }), TYPED);
  });
  by("preload-of").addEventListener("change", () =>
    lab.results ? showResults(lab.results) : showPullOffs(),
  );
  by("copy").addEventListener("click", () => copy(lab.toml, "The scene is copied."));
  by("copy-link").addEventListener("click", async () =>
    copy(new URL(await packed(lab.toml), location.href).href, "The link is copied."),
  );
  by("download").addEventListener("click", download);
  by("reset").addEventListener("click", () => take(first()));
  addEventListener("hashchange", begin);
  listenForMaps(core, (found) => {
    lab.map = found;
    edit(found.set);
  });
}

/** The pad of the README, on its suspension. */
function first() {
  const { toml } = core.ask("template", "pad");
  return core.ask("edit", { toml, set: [[RESTORING, "100 nN"]], unset: [] }).toml;
}

/** Begins with the scene of the address, or else with the pad. */
async function begin() {
  let scene = null;
  try {
    scene = await unpacked(location.hash);
  } catch (error) {
    by("done").textContent = `The link has no scene that can be read: ${error.message}`;
  }
  if (scene !== lab.toml) take(scene ?? first());
}

async function main() {
  for (const about of FIELDS) {
    const field = new Field(about, (key, text) => (text ? edit([[key, text]]) : edit([], [key])));
    fields.set(about.key, field);
    by(about.of).append(field.root);
  }
  try {
    core = new Core(await Core.compiled("stiction.wasm"));
  } catch (error) {
    showFailure(new Error(`The program's core cannot be loaded: ${error.message}`));
    return;
  }
  const { version, source } = core.ask("version");
  by("version").textContent = `stiction ${version}, source ${source}`;
  materials = new Materials(core.ask("materials").materials, edit);
  listen();
  timed("fields");
  await begin();
}

main();
