// The page: a scene as text, fields that change it, and what the program computes of it.

import { Computation } from "./computation.js";
import { Core, ProgramError } from "./core.js";
import { element, Field, FIELDS } from "./fields.js";
import { ForceCurve, Histogram, Probability } from "./figures.js";
import { packed, unpacked } from "./link.js";
import { percent, si } from "./quantity.js";

const by = (id) => document.getElementById(id);

// Milliseconds without another change after which a scene is computed, a typed text read, and the address changed.
const CALM = 60, TYPED = 250, LINKED = 300;
// Workers, at most: each has the laws in its own memory.
const MOST_WORKERS = 8;
const RESTORING = "device.restoring_force";

// What tests and consoles look at: the scene, the one in the address, all that was computed, and when.
const lab = { toml: "", linked: null, isComplete: false, pullOffs: [], results: null, integral: null, about: null, problems: [], times: {} };
globalThis.lab = lab;

let core, computation, known, computed = null, calm, typed, linking;
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
    refused(error, set.map(([key]) => key));
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
    showMaterial();
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
  const problems = error instanceof ProgramError && error.problems.length > 0 ? error.problems : [{ line: null, key: keys[0] ?? null, text: error.message }];
  showProblems(problems);
  stop();
}

function showProblems(problems) {
  lab.problems = problems;
  // Messages begin with their key, where they have none beside them.
  const isOf = (key, of) => of.key === key || (of.key === null && of.text.startsWith(`\`${key} `));
  for (const [key, field] of fields) field.refuse(problems.find((of) => isOf(key, of))?.text);
  by("problems").replaceChildren(...problems.map(({ line, text }) => element("li", {}, line ? `line ${line}: ${text}` : text)));
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
    computation.above(unquoted(force.text));
    return;
  }
  stop();
  computed = force?.given ? rest : null;
  Object.assign(lab, { pullOffs: [], results: null, integral: null, about: null, begun: performance.now(), restoringForce: force?.given ? force.value : null });
  by("failure").hidden = true;
  by("results").classList.remove("stale");
  by("bar").removeAttribute("value");
  by("count").textContent = "preparing";
  const count = Math.max(1, Math.min(navigator.hardwareConcurrency || 2, MOST_WORKERS));
  computation = new Computation(core.module, { toml: lab.toml, files: {} }, count, {
    prepared: showPrepared, integral: showIntegral, computed: showPiece, results: showResults, failed: showFailure,
  });
}

const unquoted = (text) => text.replace(/^"(.*)"$/, "$1");

function showPrepared(about) {
  lab.about = about;
  by("preloads").hidden = about.preloads.length < 2;
  by("preload-of").replaceChildren(...about.preloads.map((load, place) => element("option", { value: String(place) }, si(load, "N"))));
  if (about.preloads.length > 0) by("preload-of").value = String(about.preloads.length - 1);
}

function showIntegral(integral) {
  lab.integral = integral;
  const { separations } = lab.about;
  figures.force.show(integral.paths.map(({ way, force }) => ({ way, separation: separations, integral: force })));
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
  const values = lab.pullOffs.filter(Boolean).map(({ whole, after }) => (place === null ? whole : after[place]));
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
  const done = lab.pullOffs.filter(Boolean).length, of = lab.about.replicas;
  by("bar").value = done / of;
  by("count").textContent = `${done} of ${of} pads${done === of && !lab.isComplete ? ", model range" : ""}`;
}

/** The results after the preload that is chosen, or of the whole curve with the mean that the program quotes. */
function shownOf(results) {
  if (results.after_preload.length > 0) return results.after_preload[Number(by("preload-of").value)];
  const { quoted, is_controlled: is, interval, controlled_interval: controlled } = results.pull_off;
  return { ...results.whole, mean: quoted, interval: is ? controlled : interval };
}

function showResults(results) {
  lab.results = results;
  const { curves } = results;
  figures.force.show(curves);
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

function showAnswer(results, of) {
  by("answer").classList.remove("stale");
  const { stuck } = of;
  const range = (values, shown) => {
    const known = Object.values(values ?? {}).filter((value) => typeof value === "number");
    return known.length > 1 ? `; model range ${shown(Math.min(...known))} to ${shown(Math.max(...known))}` : "";
  };
  const newtons = (value) => si(value, "N");
  const pullOff = of.count > 0
    ? `Mean pull-off ${newtons(of.mean)} (95 % interval ${newtons(of.interval[0])} to ${newtons(of.interval[1])}${range(of.range, (value) => si(value, "N", 3))}).`
    : "No pad reaches the preload.";
  if (stuck && stuck.p !== null) {
    by("value").textContent = `${percent(stuck.p)} of the pads stay adhered`;
    by("more").textContent = `95 % interval ${percent(stuck.low)} to ${percent(stuck.high)}${range(stuck.range, percent)}. ${pullOff}`;
  } else {
    by("value").textContent = of.count > 0 ? `Pull-off ${newtons(of.mean)}` : "No pull-off";
    by("more").textContent = pullOff;
  }
  const warnings = results.warnings.length;
  by("verdicts").textContent = [
    `independence: ${results.independence.verdict}`, `cross-check: ${results.cross_check.verdict}`,
    warnings === 0 ? "no warning" : warnings === 1 ? "1 warning, stated below" : `${warnings} warnings, stated below`,
  ].join(" · ");
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

// Fields beside those of single keys.

let materials = [];

function numbersOf({ numbers }) {
  return numbers.filter(({ key }) => key !== "surface_energy").map(({ key, value }) => [`material.${key}`, value]);
}

/** Twice the surface energy: of two like surfaces, or of two with one coating. */
function adhesionOf({ numbers }) {
  const energy = numbers.find(({ key }) => key === "surface_energy");
  const [, value, unit] = energy.value.match(/^(\S+) (.*)$/);
  return `${2 * Number(value)} ${unit}`;
}

function listMaterials() {
  const { materials: all } = core.ask("materials");
  materials = all;
  const listed = (select, kept, none) => {
    const options = all.map((of, place) => [of, place]).filter(([of]) => kept(of)).map(([{ name }, place]) => element("option", { value: String(place) }, name));
    select.replaceChildren(element("option", { value: "" }, none), ...options);
  };
  listed(by("material-of"), ({ numbers }) => numbers.some(({ key }) => key === "youngs_modulus"), "own numbers");
  listed(by("coating-of"), ({ numbers }) => numbers.some(({ key }) => key === "surface_energy"), "own number");
  by("material-of").addEventListener("change", ({ target }) => target.value && edit(numbersOf(materials[target.value])));
  by("coating-of").addEventListener("change", ({ target }) => target.value && edit([["material.work_of_adhesion", adhesionOf(materials[target.value])]]));
}

/** Selects the material whose numbers the scene has, and says where they are from. */
function showMaterial() {
  const has = ([key, value]) => unquoted(known.values[key]?.text ?? "") === value;
  const chosen = (select, is, said) => {
    const options = [...select.options].filter(({ value }) => value !== "" && is(materials[value]));
    const kept = options.find(({ value }) => value === select.value) ?? options[0];
    select.value = kept?.value ?? "";
    return kept && said(materials[kept.value]);
  };
  const modulus = chosen(by("material-of"), (of) => numbersOf(of).every(has), ({ numbers }) => numbers.find(({ key }) => key === "youngs_modulus"));
  by("material-note").textContent = modulus?.note ?? "";
  by("material-source").hidden = !modulus;
  by("material-source").querySelector("small").textContent = modulus?.source ?? "";
  by("coating-note").textContent = chosen(by("coating-of"), (of) => has(["material.work_of_adhesion", adhesionOf(of)]), ({ numbers }) =>
    numbers.filter(({ key }) => key === "surface_energy").map(({ value, note }) => `2 × ${value}: ${note}`).join()) ?? "";
}

function showHumidity() {
  const given = Object.entries(known.values).some(([key, { given: is }]) => is && key.startsWith("capillary."));
  by("humid").checked = given;
  fields.get("capillary.relative_humidity").root.hidden = !given;
}

function humidify({ target }) {
  const own = Object.keys(known.values).filter((key) => key.startsWith("capillary.") && known.values[key].given);
  if (target.checked) edit([["capillary.relative_humidity", "0.45"], ["capillary.contact_angles", '["30 deg", "30 deg"]']]);
  else edit([], ["capillary", ...own]);
}

// A map of heights.

let map = null;

async function takeMap(file) {
  if (!file) return;
  map = { name: file.name, text: await file.text() };
  readMap();
}

function readMap() {
  if (!map) return;
  const given = (id) => by(id).value.trim() || null;
  by("map-problem").hidden = true;
  by("map-found").textContent = "";
  try {
    const found = core.ask("map", { ...map, pixel: given("map-pixel"), height_unit: given("map-unit"), smooth: given("map-smooth") });
    lab.map = found;
    by("map-found").textContent = [`${map.name}: ${found.summits} summits on ${found.columns} × ${found.rows} pixels, ${si(found.extent[0], "m")} × ${si(found.extent[1], "m")}.`, ...found.warnings].join(" ");
    edit(found.set);
  } catch (error) {
    by("map-problem").hidden = false;
    by("map-problem").textContent = `${map.name}: ${error.message}`;
  }
}

function listenForMaps() {
  by("map-file").addEventListener("change", ({ target }) => takeMap(target.files[0]));
  for (const id of ["map-pixel", "map-unit", "map-smooth"]) by(id).addEventListener("change", readMap);
  // The whole page takes a file, so that none is opened in place of the page.
  addEventListener("dragover", (event) => {
    event.preventDefault();
    by("own-map").open = true;
    by("drop").classList.add("over");
  });
  addEventListener("dragleave", (event) => event.relatedTarget ?? by("drop").classList.remove("over"));
  addEventListener("drop", (event) => {
    event.preventDefault();
    by("drop").classList.remove("over");
    takeMap(event.dataTransfer.files[0]);
  });
}

// Copies of the scene.

async function copy(text, words) {
  try {
    await navigator.clipboard.writeText(text);
    by("done").textContent = words;
  } catch {
    by("toml").select();
    by("done").textContent = "The browser does not allow it: the scene is selected, copy it by the keyboard.";
  }
}

function download() {
  const address = URL.createObjectURL(new Blob([lab.toml], { type: "text/plain" }));
  element("a", { href: address, download: "pad.toml" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function listen() {
  by("fields").addEventListener("submit", (event) => event.preventDefault());
  by("humid").addEventListener("change", humidify);
  by("toml").addEventListener("input", ({ target }) => {
    clearTimeout(typed);
    typed = setTimeout(() => take(target.value, { isTyped: true }), TYPED);
  });
  by("preload-of").addEventListener("change", () => (lab.results ? showResults(lab.results) : showPullOffs()));
  by("copy").addEventListener("click", () => copy(lab.toml, "The scene is copied."));
  by("copy-link").addEventListener("click", async () => copy(new URL(await packed(lab.toml), location.href).href, "The link is copied."));
  by("download").addEventListener("click", download);
  by("reset").addEventListener("click", () => take(first()));
  addEventListener("hashchange", begin);
  listenForMaps();
}

/** The pad of the README, on its suspension. */
function first() {
  return core.ask("edit", { toml: core.ask("template", "pad").toml, set: [[RESTORING, "100 nN"]], unset: [] }).toml;
}

/** Begins with the scene of the address, or else with the pad. */
async function begin() {
  let scene = null;
  try {
    scene = await unpacked(location.hash);
  } catch (error) {
    by("problems").replaceChildren(element("li", {}, `the link has no scene that can be read: ${error.message}`));
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
  listMaterials();
  listen();
  timed("fields");
  await begin();
}

main();
