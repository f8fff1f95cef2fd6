// The fields: keys of a scene with their units and sliders.

import { element } from "./dom.js";
import { written } from "./quantity.js";

const LENGTHS = [
  ["nm", 1e-9],
  ["um", 1e-6],
  ["mm", 1e-3],
];
const SMALL = [["pm", 1e-12], ...LENGTHS];
const FORCES = [
  ["nN", 1e-9],
  ["uN", 1e-6],
  ["mN", 1e-3],
  ["N", 1],
];
const PRESSURES = [
  ["kPa", 1e3],
  ["MPa", 1e6],
  ["GPa", 1e9],
];
const NONE = [["", 1]];

const DENSITIES = [
  ["/mm^2", 1e6],
  ["/um^2", 1e12],
];
const AREAS = [
  ["um^2", 1e-12],
  ["mm^2", 1e-6],
];
const ENERGIES = [
  ["mJ/m^2", 1e-3],
  ["J/m^2", 1],
];

/** Where a field stands, its key, label and symbol, units, ends of the slider in SI, and a note. */
const field = (of, key, [label, symbol = ""], units, ends, about = "") => ({
  of,
  key,
  label,
  symbol,
  units,
  ends,
  about,
});
/** A field whose slider has equal steps; others have equal factors. */
const evenly = (even, of) => ({ ...of, even });
/** A field that is seen where a scene has its key. */
const optional = (of) => ({ ...of, isOptional: true });

export const FIELDS = [
  field(
    "material",
    "material.youngs_modulus",
    ["Young’s modulus", "E"],
    PRESSURES,
    [1e5, 1e12],
    "of both surfaces; a list of two for two materials",
  ),
  evenly(0.01, field("material", "material.poisson_ratio", ["Poisson ratio", "ν"], NONE, [0, 0.5])),
  field("material", "material.hardness", ["Hardness", "H"], PRESSURES, [1e7, 1e11], "of the softer surface"),
  field(
    "adhesion",
    "material.work_of_adhesion",
    ["Work of adhesion", "Δγ"],
    ENERGIES,
    [1e-3, 1],
    "dry or coated surfaces: 5 to 100 mJ/m²",
  ),
  field(
    "surface",
    "surface.asperity_radius",
    ["Summit radius", "R"],
    LENGTHS,
    [1e-8, 1e-4],
    "of two like surfaces R/√2 of one",
  ),
  field("surface", "surface.asperity_density", ["Summit density", "η"], DENSITIES, [1e10, 1e15]),
  field(
    "surface",
    "surface.surface_height_std",
    ["Roughness, rms", "σ"],
    SMALL,
    [1e-10, 1e-6],
    "of both surfaces together",
  ),
  optional(
    field(
      "surface",
      "surface.asperity_height_std",
      ["Summit heights, std", "σₛ"],
      SMALL,
      [1e-10, 1e-6],
      "by default from σ",
    ),
  ),
  field("surface", "surface.nominal_area", ["Area of a pad", "A"], AREAS, [1e-12, 1e-8]),
  field(
    "load",
    "instability.preload",
    ["Preload"],
    FORCES,
    [1e-7, 1e-1],
    "the force that pressed the surfaces together",
  ),
  field(
    "load",
    "device.restoring_force",
    ["Restoring force"],
    FORCES,
    [1e-9, 1e-3],
    "of the suspension, which separates them",
  ),
  optional(
    evenly(0.01, field("humidity", "capillary.relative_humidity", ["Relative humidity"], NONE, [0.01, 0.99])),
  ),
  optional(
    field(
      "humidity",
      "capillary.contact_angles",
      ["Contact angles"],
      NONE,
      null,
      "of water on each surface, receding",
    ),
  ),
  field("ensemble", "ensemble.replicas", ["Replicas"], NONE, [10, 10000], "pads that are drawn"),
  field("ensemble", "ensemble.seed", ["Seed"], NONE, null),
];

/** A field: its label, text, slider and message. */
export class Field {
  // Steps of a slider on a logarithmic scale, per decade.
  static #DECADE = 50;

  /** `changed(key, text)` is called with what the user gives. */
  constructor(about, changed) {
    Object.assign(this, about);
    const id = about.key.replace(".", "-");
    this.text = element("input", {
      id,
      type: "text",
      autocomplete: "off",
      spellcheck: false,
      "aria-describedby": `${id}-about ${id}-problem`,
    });
    this.text.addEventListener("change", () => changed(this.key, this.text.value.trim()));
    this.problem = element("p", { id: `${id}-problem`, className: "problem", hidden: true });
    const name = element("label", { htmlFor: id }, about.label);
    if (about.symbol) name.append(" ", element("i", {}, about.symbol));
    this.root = element("div", { className: "field" }, name, this.text);
    if (about.ends) this.root.append(this.#range(changed));
    this.root.append(element("small", { id: `${id}-about` }, about.about), this.problem);
  }

  #range(changed) {
    const [low, high] = this.ends.map((end) => this.#place(end));
    this.slider = element("input", {
      type: "range",
      min: low,
      max: high,
      step: this.even ?? 1,
      "aria-label": `${this.label}, slider`,
    });
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
    if (this.isOptional) this.root.hidden = !isGiven;
    this.text.placeholder = isGiven ? "" : text || "none";
    this.text.value = isGiven ? text : "";
    if (!this.slider) return;
    const isSingle = typeof known?.value === "number";
    const isMoved = document.activeElement === this.slider;
    if (isSingle && known.value > 0 && !isMoved) this.slider.value = this.#place(known.value);
    if (isSingle) this.#tell(known.value);
    else this.slider.setAttribute("aria-valuetext", text || "none");
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
