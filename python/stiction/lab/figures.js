// The three figures: pull-offs of patches, force over separation, probability over the restoring force.

import { edge, Figure, ink, line } from "./figure.js";
import { number, percent, scale, si } from "./quantity.js";
import uPlot from "./vendor/uplot/uPlot.esm.js";

// Bars of the histogram, at most.
const BARS = 24;

/** The step 1, 2 or 5 times a power of ten that is at least this long. */
function step(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [1, 2, 5, 10].map((of) => of * power).find((of) => of >= length * (1 - 1e-9));
}

/** Pull-offs of patches: those above the restoring force stay adhered. */
export class Histogram {
  constructor(root) {
    const bars = (name, label) => ({
      label,
      name,
      kind: "bar",
      stroke: ink(name),
      fill: ink(name),
      width: 0,
      points: { show: false },
      paths: uPlot.paths.bars({ size: [0.94, Infinity] }),
    });
    this.figure = new Figure(root, {
      x: ({ x }) => `pull-off of a pad (${x})`,
      y: () => "pads",
      series: [bars("vermilion", "stays adhered"), bars("blue", "is separated")],
      read: ([x, all], at, { x: unit, width }) =>
        `${number(x[at] - width / 2)} to ${number(x[at] + width / 2)} ${unit}: ${all[at]} pads`,
    });
  }

  /** `pullOffs` in N, in the order of the replicas; the restoring force and the mean where there are any. */
  show(pullOffs, force, mean) {
    if (pullOffs.length === 0) {
      this.figure.clear("none yet");
      return;
    }
    const sorted = Float64Array.from(pullOffs).sort();
    const { factor, unit } = scale(Math.abs(sorted[sorted.length >> 1]) || 1e-9, "N");
    const low = sorted[0] / factor,
      high = sorted.at(-1) / factor;
    const width = step(
      Math.max(high - low, 1e-3 * Math.abs(high), 1e-12) / Math.min(BARS, 4 + Math.sqrt(sorted.length)),
    );
    const first = Math.floor(low / width),
      count = Math.floor(high / width) - first + 1;
    const [x, all, below] = [(place) => (first + place + 0.5) * width, () => 0, () => 0].map((of) =>
      Array.from({ length: count }, (_, place) => of(place)),
    );
    for (const value of sorted) {
      const bar = Math.min(Math.floor(value / factor / width) - first, count - 1);
      all[bar] += 1;
      if (force === null || !(value > force)) below[bar] += 1;
    }
    const marks = [];
    if (force !== null) marks.push({ at: force / factor, words: `restoring force ${si(force, "N")}` });
    if (mean) marks.push({ at: mean / factor, dash: [2, 3], label: `mean ${si(mean, "N")}` });
    const ends = [first * width, (first + count) * width];
    if (
      force !== null &&
      force / factor > ends[0] - 0.5 * (ends[1] - ends[0]) &&
      force / factor < ends[1] + 0.5 * (ends[1] - ends[0])
    ) {
      ends[0] = Math.min(ends[0], force / factor - width);
      ends[1] = Math.max(ends[1], force / factor + width);
    }
    const [least, half, most] = [0, sorted.length >> 1, sorted.length - 1].map((at) => si(sorted[at], "N"));
    this.figure.show({
      data: [x, all, below],
      units: { x: unit, width },
      range: { x: ends, y: [0, Math.max(5, ...all) * 1.15] },
      marks,
      isListed: force !== null,
      text: `Histogram of the pull-offs of ${sorted.length} pads, ${least} to ${most}, half below ${half}.`,
      header: [`from (${unit})`, `to (${unit})`, "pads"],
      rows: all.map((pads, place) => [
        number(x[place] - width / 2),
        number(x[place] + width / 2),
        String(pads),
      ]),
    });
  }

  clear(reason) {
    this.figure.clear(reason);
  }
}

/** Force over separation on every way: mean and standard deviation over patches, and the integral. */
export class ForceCurve {
  constructor(root) {
    const NAMES = [
      ["approach", "blue"],
      ["retraction", "vermilion"],
    ];
    this.figure = new Figure(root, {
      x: ({ x }) => `separation h (${x})`,
      y: ({ y }) => `external force (${y})`,
      series: NAMES.flatMap(([way, name]) => [
        line(name, `${way}, mean and standard deviation`),
        edge(),
        edge(),
        line("ink", way === "approach" ? "integral" : null, true),
      ]),
      bands: NAMES.map(([, name], place) => ({
        series: [4 * place + 2, 4 * place + 3],
        fill: ink(name, 0.2),
      })),
      read: (data, at, { x, y }) => {
        const ways = NAMES.map(([way], place) => [way, data[4 * place + 1][at] ?? data[4 * place + 4][at]]);
        const said = ways
          .filter(([, force]) => typeof force === "number")
          .map(([way, force]) => `${way} ${number(force)} ${y}`);
        return `h = ${number(data[0][at])} ${x}: ${said.join(", ")}`;
      },
    });
  }

  /** `curves` have `way`, `separation`, `integral`, and once there are replicas `mean` and `std`. */
  show(curves) {
    const ofWays = ["approach", "retraction"].map((way) => curves.find((of) => of.way === way));
    const known = ofWays.filter(Boolean);
    const { separation } = known[0];
    const x = scale(Math.max(...separation) / 2, "m");
    const finite = (of) => (of ?? []).filter((value) => typeof value === "number");
    const lowest = Math.min(0, ...known.flatMap((of) => [...finite(of.mean), ...finite(of.integral)]));
    // Far below in compression the standard deviation is that of the compression.
    const std = Math.max(
      0,
      ...known.map((of) => of.std?.[of.mean.indexOf(Math.min(...finite(of.mean)))] ?? 0),
    );
    const depth = -lowest || Math.max(...known.flatMap((of) => finite(of.mean ?? of.integral)));
    const y = scale(depth, "N");
    const order = separation.map((_, at) => at).sort((a, b) => separation[a] - separation[b]);
    const column = (of) => order.map((at) => (typeof of?.[at] === "number" ? of[at] / y.factor : null));
    // A band where its line is seen: above it is far wider than the figure is high.
    const sum = (of, sign) =>
      of?.mean?.map((mean, at) => (of.std[at] === null || !(mean < depth) ? null : mean + sign * of.std[at]));
    const data = [
      order.map((at) => separation[at] / x.factor),
      ...ofWays.flatMap((of) => [
        column(of?.mean),
        column(sum(of, 1)),
        column(sum(of, -1)),
        column(of?.integral),
      ]),
    ];
    // The well is shown; compression goes on far above.
    const range = {
      x: this.#wide(data, depth / y.factor),
      y: (lowest < 0 ? [lowest - Math.min(std, depth) - 0.1 * depth, depth] : [0, 1.1 * depth]).map(
        (end) => end / y.factor,
      ),
    };
    const kind = known[0].mean ? "mean over pads" : "integral";
    const lowests = known.map((of) => {
      const force = finite(of.mean).length > 0 ? of.mean : of.integral;
      const at = force.reduce(
        (best, value, place) =>
          value !== null && (force[best] === null || value < force[best]) ? place : best,
        0,
      );
      return `${of.way}: lowest ${si(force[at], "N")} at ${si(of.separation[at], "m")}`;
    });
    this.figure.show({
      data,
      range,
      units: { x: x.unit, y: y.unit },
      text: `External force over separation, ${kind}. ${lowests.join("; ")}.`,
      header: [
        `h (${x.unit})`,
        ...known.flatMap(({ way }) => [
          `${way}, mean (${y.unit})`,
          `std (${y.unit})`,
          `integral (${y.unit})`,
        ]),
      ],
      rows: order.map((at) => [
        number(separation[at] / x.factor),
        ...known.flatMap((of) =>
          [of.mean, of.std, of.integral].map((values) => number((values?.[at] ?? NaN) / y.factor)),
        ),
      ]),
    });
  }

  /** From where forces fit the figure to where they have vanished. */
  #wide([x, ...all], depth) {
    const columns = [0, 3, 4, 7].map((place) => all[place]);
    const shown = x.map((_, at) => columns.some((of) => of[at] !== null && of[at] < depth));
    const isThere = x.map((_, at) =>
      columns.some((of) => of[at] !== null && Math.abs(of[at]) > 0.004 * depth),
    );
    const first = Math.max(shown.indexOf(true), 0),
      last = isThere.lastIndexOf(true);
    return [x[first], x[Math.min(last + 1, x.length - 1)] ?? x.at(-1)];
  }

  clear(reason) {
    this.figure.clear(reason);
  }
}

/** Probability that a pad stays adhered over the restoring force. */
export class Probability {
  constructor(root) {
    this.figure = new Figure(root, {
      x: ({ x }) => `restoring force (${x})`,
      y: () => "P (pad stays adhered)",
      series: [
        line("vermilion", "P with its 95 % interval"),
        edge(),
        edge(),
        line("ink", "range over plastic contacts", true),
        line("ink", null, true),
      ],
      bands: [{ series: [2, 3], fill: ink("vermilion", 0.2) }],
      read: ([x, p, high, low], at, { x: unit }) =>
        `above ${number(x[at])} ${unit}: P = ${percent(p[at])} (${percent(low[at])} to ${percent(high[at])})`,
    });
  }

  /** `above` has forces, p, low, high and range, as the core gives them. */
  show({ forces, p, low, high, range }, force) {
    const { factor, unit } = scale(forces[forces.length >> 1] || 1e-9, "N");
    const ofContacts = Object.values(range ?? {});
    const end = (of) =>
      forces.map((_, at) => (ofContacts.length > 1 ? of(...ofContacts.map((values) => values[at])) : null));
    const [smallest, largest] = [end(Math.min), end(Math.max)];
    const x = forces.map((of) => of / factor);
    const at = force === null ? -1 : forces.findIndex((of) => of >= force);
    const half = forces.find((_, place) => p[place] <= 0.5) ?? forces.at(-1);
    const there =
      at < 0
        ? ""
        : ` At about ${si(force, "N")}: ${percent(p[at])} (${percent(low[at])} to ${percent(high[at])}).`;
    this.figure.show({
      data: [x, p, high, low, smallest, largest],
      units: { x: unit },
      range: { x: [x[0], x.at(-1)], y: [0, 1.0001] },
      marks: force === null ? [] : [{ at: force / factor, words: si(force, "N") }],
      text: `Probability that the pull-off exceeds the restoring force: 50 % at ${si(half, "N")}.${there}`,
      header: [`restoring force (${unit})`, "P", "95 % from", "to", "models from", "to"],
      rows: forces.map((of, place) => [
        number(of / factor),
        ...[p, low, high, smallest, largest].map((values) => percent(values[place] ?? NaN)),
      ]),
    });
  }

  clear(reason) {
    this.figure.clear(reason);
  }
}
