// The lists of materials and coatings, whose numbers a scene takes.

import { by, element } from "./dom.js";

const ADHESION = "material.work_of_adhesion";

const numberOf = ({ numbers }, key) => numbers.find((of) => of.key === key);

/** Keys and values of a material. */
function setting({ numbers }) {
  const own = numbers.filter(({ key }) => key !== "surface_energy");
  return own.map(({ key, value }) => [`material.${key}`, value]);
}

/** Twice the surface energy: of two like surfaces, or of two with one coating. */
function adhesion(material) {
  const [, value, unit] = numberOf(material, "surface_energy").value.match(/^(\S+) (.*)$/);
  return [ADHESION, `${2 * Number(value)} ${unit}`];
}

/** A list: the materials that have a number, and what choosing one sets. */
class List {
  constructor(select, materials, needed, none, set) {
    this.select = select;
    this.materials = materials.filter((of) => numberOf(of, needed));
    this.set = set;
    const options = this.materials.map(({ name }, place) =>
      element("option", { value: String(place) }, name),
    );
    select.replaceChildren(element("option", { value: "" }, none), ...options);
  }

  listen(edit) {
    this.select.addEventListener("change", ({ target }) => {
      if (target.value) edit(this.set(this.materials[target.value]));
    });
  }

  /** Selects the material whose numbers a scene has, the one that was chosen first, and returns it. */
  choose(values) {
    const fits = (of) => this.set(of).every(([key, value]) => values[key]?.text === value);
    const chosen = this.materials[this.select.value];
    const material = chosen && fits(chosen) ? chosen : this.materials.find(fits);
    this.select.value = material ? String(this.materials.indexOf(material)) : "";
    return material;
  }
}

export class Materials {
  /** `edit` sets pairs of key and value. */
  constructor(materials, edit) {
    const own = [by("material-of"), materials, "youngs_modulus", "own numbers", setting];
    const coated = [by("coating-of"), materials, "surface_energy", "own number", (of) => [adhesion(of)]];
    this.materials = new List(...own);
    this.coatings = new List(...coated);
    for (const list of [this.materials, this.coatings]) list.listen(edit);
  }

  /** Shows what a scene has, and where its numbers are from. */
  show(values) {
    const material = this.materials.choose(values),
      coating = this.coatings.choose(values);
    const modulus = material && numberOf(material, "youngs_modulus");
    by("material-note").textContent = modulus?.note ?? "";
    by("material-source").hidden = !modulus;
    by("material-source").querySelector("small").textContent = modulus?.source ?? "";
    const energy = coating && numberOf(coating, "surface_energy");
    by("coating-note").textContent = energy ? `2 × ${energy.value}: ${energy.note}` : "";
  }
}
