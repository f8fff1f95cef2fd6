// The fields: keys of a scene with their units and sliders.

import { written } from "./quantity.js";

const LENGTHS = [["nm", 1e-9], ["um", 1e-6], ["mm", 1e-3]];
const FORCES = [["nN", 1e-9], ["uN", 1e-6], ["mN", 1e-3], ["N", 1]];
const PRESSURES = [["kPa", 1e3], ["MPa", 1e6], ["GPa", 1e9]];
const NONE = [["", 1]];

// Key, label, symbol, units, and the ends of the slider in SI; `even` sliders have equal steps, others equal factors.
export const FIELDS = [
  { of: "material", key: "material.youngs_modulus", label: "Young’s modulus", symbol: "E", units: PRESSURES, ends: [1e5, 1e12], about: "of both surfaces; a list of two for two materials" },
  { of: "material", key: "material.poisson_ratio", label: "Poisson ratio", symbol: "ν", units: NONE, ends: [0, 0.5], even: 0.01 },
  { of: "material", key: "material.hardness", label: "Hardness", symbol: "H", units: PRESSURES, ends: [1e7, 1e11], about: "of the softer surface" },
  { of: "adhesion", key: "material.work_of_adhesion", label: "Work of adhesion", symbol: "Δγ", units: [["mJ/m^2", 1e-3], ["J/m^2", 1]], ends: [1e-3, 1], about: "dry or coated surfaces: 5 to 100 mJ/m²" },
  { of: "surface", key: "surface.asperity_radius", label: "Summit radius", symbol: "R", units: LENGTHS, ends: [1e-8, 1e-4], about: "of two like surfaces R/√2 of one" },
  { of: "surface", key: "surface.asperity_density", label: "Summit density", symbol: "η", units: [["/mm^2", 1e6], ["/um^2", 1e12]], ends: [1e10, 1e15] },
  { of: "surface", key: "surface.surface_height_std", label: "Roughness, rms", symbol: "σ", units: [["pm", 1e-12], ...LENGTHS], ends: [1e-10, 1e-6], about: "of both surfaces together" },
  { of: "surface", key: "surface.nominal_area", label: "Area of a pad", symbol: "A", units: [["um^2", 1e-12], ["mm^2", 1e-6]], ends: [1e-12, 1e-8] },
  { of: "load", key: "instability.preload", label: "Preload", symbol: "", units: FORCES, ends: [1e-7, 1e-1], about: "the force that pressed the surfaces together" },
  { of: "load", key: "device.restoring_force", label: "Restoring force", symbol: "", units: FORCES, ends: [1e-9, 1e-3], about: "of the suspension, which separates them" },
  { of: "humidity", key: "capillary.relative_humidity", label: "Relative humidity", symbol: "", units: NONE, ends: [0.01, 0.99], even: 0.01 },
  { of: "ensemble", key: "ensemble.replicas", label: "Replicas", symbol: "", units: NONE, ends: [10, 10000], about: "pads that are drawn" },
  { of: "ensemble", key: "ensemble.seed", label: "Seed", symbol: "", units: NONE },
];

/** An element with properties, attributes (`aria-…`, `for`) and children. */
export function element(name, given = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(given)) {
    if (key in made && !key.includes("-")) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** A field: its label, text, slider and message. */
export class Field {
  // Steps of a slider by factors: so many to a decade.
  static #DECADE = 50;

  /** `changed(key, text)` is called with what the user gives. */
  constructor(about, changed) {
    Object.assign(this, about);
    const id = about.key.replace(".", "-");
    this.text = element("input", { id, type: "text", autocomplete: "off", spellcheck: false, "aria-describedby": `${id}-about ${id}-problem` });
    this.text.addEventListener("change", () => changed(this.key, this.text.value.trim()));
    this.problem = element("p", { id: `${id}-problem`, className: "problem", hidden: true });
    const name = element("label", { htmlFor: id }, about.label);
    if (about.symbol) name.append(" ", element("i", {}, about.symbol));
    const note = element("small", { id: `${id}-about` }, about.about ?? "");
    this.root = element("div", { className: "field" }, name, this.text);
    if (about.ends) this.root.append(this.#range(changed));
    if (about.about) this.root.append(note);
    this.root.append(this.problem);
  }

  #range(changed) {
    const [low, high] = this.ends.map((end) => this.#place(end));
    this.slider = element("input", { type: "range", min: low, max: high, step: this.even ?? 1, "aria-label": `${this.label}, slider` });
    this.slider.addEventListener("input", () => {
      const place = Number(this.slider.value);
      const value = this.even ? place : 10 ** (place / Field.#DECADE);
      this.#tell(value);
      const isWhole = this.key === "ensemble.replicas";
      this.text.value = written(isWhole ? Math.round(value) : value, this.units);
      changed(this.key, this.text.value);
    });
    return this.slider;
  }

  /** Where a value is on the slider. */
  #place(value) {
    return this.even ? value : Math.round(Field.#DECADE * Math.log10(value));
  }

  #tell(value) {
    this.slider.setAttribute("aria-valuetext", this.even ? String(value) : written(value, this.units));
  }

  /** Shows what a scene has: `known` is the entry of the core's `describe`, if there is one. */
  show(known) {
    const isGiven = known?.given ?? false;
    const text = known?.text ?? "";
    this.text.placeholder = isGiven ? "" : text || "none";
    if (document.activeElement !== this.text || !this.text.value.trim() || isGiven) this.text.value = isGiven ? plain(text) : "";
    if (!this.slider) return;
    const isSingle = typeof known?.value === "number";
    if (isSingle && known.value > 0 && document.activeElement !== this.slider) this.slider.value = this.#place(known.value);
    if (isSingle) this.#tell(known.value);
    else this.slider.setAttribute("aria-valuetext", plain(text) || "none");
    this.slider.classList.toggle("idle", !isSingle);
  }

  /** Shows what is wrong with its value, or that nothing is. */
  refuse(problem) {
    this.problem.hidden = !problem;
    this.problem.textContent = problem ?? "";
    if (problem) this.text.setAttribute("aria-invalid", "true");
    else this.text.removeAttribute("aria-invalid");
  }
}

/** A value without the quotation marks of TOML. */
const plain = (text) => text.replace(/^"(.*)"$/, "$1");

