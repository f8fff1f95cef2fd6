// The answer above the figures: a number, its interval and model range, and the assessment.

import { by } from "./dom.js";
import { percent, si } from "./quantity.js";

const newtons = (value) => si(value, "N");

/** The range over the plastic contacts, where there are several. */
function rangeOf(values, shown) {
  const known = Object.values(values ?? {}).filter((value) => typeof value === "number");
  if (known.length < 2) return "";
  return `; model range ${shown(Math.min(...known))} to ${shown(Math.max(...known))}`;
}

function meanOf({ count, mean, interval: [low, high], range }) {
  if (count === 0) return "No pad reaches the preload.";
  const models = rangeOf(range, (value) => si(value, "N", 3));
  return `Mean pull-off ${newtons(mean)} (95 % interval ${newtons(low)} to ${newtons(high)}${models}).`;
}

/** Shows results; `of` is their part after a preload, or of the whole curve. */
export function showAnswer({ warnings, independence, cross_check: check }, of) {
  const { stuck, count, mean } = of;
  by("answer").classList.remove("stale");
  if (stuck && stuck.p !== null) {
    const interval = `95 % interval ${percent(stuck.low)} to ${percent(stuck.high)}`;
    by("value").textContent = `${percent(stuck.p)} of the pads stay adhered`;
    by("more").textContent = `${interval}${rangeOf(stuck.range, percent)}. ${meanOf(of)}`;
  } else {
    by("value").textContent = count > 0 ? `Pull-off ${newtons(mean)}` : "No pull-off";
    by("more").textContent = meanOf(of);
  }
  const warned =
    ["no warning", "1 warning, stated below"][warnings.length] ?? `${warnings.length} warnings, stated below`;
  const words = [`independence: ${independence.verdict}`, `cross-check: ${check.verdict}`, warned];
  by("verdicts").textContent = words.join(" · ");
}
