// A figure drawn by uPlot, with what is read of it by those who do not see it.

import { element } from "./dom.js";
import { number } from "./quantity.js";
import uPlot from "./vendor/uplot/uPlot.esm.js";

const HEIGHT = 250;
const FONT = '12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

/** A colour of the style sheet, with an opacity. */
function color(name, opacity = 1) {
  const value = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const alpha = Math.round(255 * opacity);
  return opacity === 1 ? value : value + alpha.toString(16).padStart(2, "0");
}

export const ink = (name, opacity) => () => color(name, opacity);

/** A figure: plot, readout under the pointer, text for those who do not see it, numbers as a table. */
export class Figure {
  constructor(root, options) {
    this.root = root;
    this.plot = root.querySelector(".plot");
    this.legend = element("p", { className: "legend", "aria-hidden": "true" });
    this.plot.after(this.legend);
    this.readout = root.querySelector(".readout");
    this.table = root.querySelector("table");
    this.details = root.querySelector("details");
    this.details.addEventListener("toggle", () => this.#tabulate());
    this.options = options;
    this.marks = [];
    this.rows = null;
    new ResizeObserver(() => this.drawn?.setSize(this.#size())).observe(this.plot);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.drawn?.redraw());
  }

  static #listed(kind, name, label) {
    return element("span", {}, element("i", { className: `swatch ${kind} ${name}` }), label);
  }

  #size() {
    return { width: Math.max(this.plot.clientWidth, 200), height: HEIGHT };
  }

  /** Shows columns of data; `units` are of the axes, `marks` vertical lines, `text` states what is seen. */
  show({ data, units, range, marks = [], isListed = true, text, header, rows }) {
    Object.assign(this, { units, range, marks });
    this.readout.textContent = "";
    if (this.drawn) this.drawn.setData(data);
    else this.#begin(data);
    this.plot.setAttribute("aria-label", text);
    this.legend.replaceChildren(
      ...this.options.series.flatMap(({ label, name, kind }, place) =>
        isListed && label && data[place + 1].some((of) => of !== null)
          ? [Figure.#listed(kind, name, label)]
          : [],
      ),
    );
    for (const { label } of marks) if (label) this.legend.append(Figure.#listed("dotted", "ink", label));
    Object.assign(this, { header, rows });
    this.#tabulate();
  }

  /** Shows nothing, and why. */
  clear(reason = "") {
    this.drawn?.destroy();
    this.drawn = null;
    this.rows = null;
    this.readout.textContent = reason;
    this.legend.replaceChildren();
    this.plot.setAttribute("aria-label", reason || "nothing computed yet");
  }

  #begin(data) {
    this.drawn?.destroy();
    const axis = (at, label) => ({
      stroke: ink("ink"),
      font: FONT,
      labelFont: FONT,
      labelSize: 18,
      labelGap: 2,
      size: at === "x" ? 34 : 52,
      grid: { stroke: ink("rule"), width: 1 },
      ticks: { stroke: ink("rule"), width: 1, size: 5 },
      label: () => label(this.units),
      values: (_, splits) => splits.map((of) => (of === null ? "" : number(of, 6))),
    });
    this.drawn = new uPlot(
      {
        ...this.#size(),
        scales: {
          x: { time: false, range: () => this.range.x },
          y: { range: () => this.range.y },
        },
        axes: [axis("x", this.options.x), axis("y", this.options.y)],
        series: [{}, ...this.options.series],
        bands: this.options.bands ?? [],
        legend: { show: false },
        cursor: { drag: { x: false, y: false }, points: { size: 6 }, y: false },
        hooks: { draw: [(plot) => this.#mark(plot)], setCursor: [(plot) => this.#read(plot)] },
      },
      data,
      this.plot,
    );
  }

  #mark(plot) {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.font = FONT.replace("12px", `${Math.round(12 * devicePixelRatio)}px`);
    for (const { at, words, dash = [], name = "ink" } of this.marks) {
      const x = Math.round(plot.valToPos(at, "x", true));
      if (!(x >= bbox.left && x <= bbox.left + bbox.width)) continue;
      ctx.strokeStyle = ctx.fillStyle = color(name);
      ctx.lineWidth = 1.5 * devicePixelRatio;
      ctx.setLineDash(dash.map((of) => of * devicePixelRatio));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      if (!words) continue;
      const isLeft = x > bbox.left + 0.6 * bbox.width;
      ctx.textAlign = isLeft ? "right" : "left";
      ctx.textBaseline = "top";
      ctx.setLineDash([]);
      ctx.strokeStyle = color("paper");
      ctx.lineWidth = 4 * devicePixelRatio;
      ctx.strokeText(words, x + (isLeft ? -6 : 6) * devicePixelRatio, bbox.top + 4 * devicePixelRatio);
      ctx.fillText(words, x + (isLeft ? -6 : 6) * devicePixelRatio, bbox.top + 4 * devicePixelRatio);
    }
    ctx.restore();
  }

  #read(plot) {
    const { idx } = plot.cursor;
    this.readout.textContent =
      idx === null || idx === undefined || !this.options.read
        ? ""
        : this.options.read(plot.data, idx, this.units);
  }

  #tabulate() {
    if (!this.details.open || !this.rows) return;
    const row = (name, cells) =>
      element("tr", {}, ...cells.map((cell) => element(name, name === "th" ? { scope: "col" } : {}, cell)));
    this.table.tHead.replaceChildren(row("th", this.header));
    this.table.tBodies[0].replaceChildren(...this.rows.map((cells) => row("td", cells)));
  }
}

/** A line of a colour, dashed or not; without a label the legend leaves it out. */
export const line = (name, label, isDashed = false) => ({
  label,
  name,
  kind: isDashed ? "dashed" : "line",
  stroke: ink(name),
  points: { show: false },
  width: isDashed ? 1.3 : 1.8,
  dash: isDashed ? [6, 4] : undefined,
});

/** An end of a band, which has no line of its own. */
export const edge = () => ({ width: 0, stroke: () => "#0000", points: { show: false } });
