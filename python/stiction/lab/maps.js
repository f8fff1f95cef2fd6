// A map of heights of the user: chosen or dropped, its summits give keys of the scene.

import { by } from "./dom.js";
import { si } from "./quantity.js";

/** Listens for maps. `found` is called with what the core finds in one. */
export function listenForMaps(core, found) {
  let map = null;

  function read() {
    if (!map) return;
    const given = (id) => by(id).value.trim() || null;
    const options = {
      pixel: given("map-pixel"),
      height_unit: given("map-unit"),
      smooth: given("map-smooth"),
    };
    by("map-problem").hidden = true;
    by("map-found").textContent = "";
    try {
      const of = core.ask("map", { ...map, ...options });
      const [width, height] = of.extent.map((side) => si(side, "m"));
      const size = `${of.columns} × ${of.rows} pixels, ${width} × ${height}`;
      const words = `${map.name}: ${of.summits} summits on ${size}.`;
      by("map-found").textContent = [words, ...of.warnings].join(" ");
      found(of);
    } catch (error) {
      by("map-problem").hidden = false;
      by("map-problem").textContent = `${map.name}: ${error.message}`;
    }
  }

  async function take(file) {
    if (!file) return;
    by("own-map").open = true;
    map = { name: file.name, text: await file.text() };
    read();
  }

  by("map-file").addEventListener("change", ({ target }) => take(target.files[0]));
  for (const id of ["map-pixel", "map-unit", "map-smooth"]) by(id).addEventListener("change", read);
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
    take(event.dataTransfer.files[0]);
  });
}
