// Quantities as people write them.

const PREFIXES = { "-15": "f", "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" };

/** The factor and the unit that make readable numbers of values of about this size. */
export function scale(size, unit) {
  const power = Math.min(Math.max(3 * Math.floor(Math.log10(Math.abs(size)) / 3 + 1e-9), -15), 9);
  return size ? { factor: 10 ** power, unit: PREFIXES[power] + unit } : { factor: 1, unit };
}

/** A number with some significant digits, and a true minus sign. */
export function number(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  const text = value === 0 ? "0" : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}

/** A value in SI with the prefix that fits. */
export function si(value, unit, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  const { factor, unit: shown } = scale(value, unit);
  return `${number(value / factor, digits)} ${shown}`;
}

/** A probability in per cent. */
export const percent = (p, digits = 3) => `${number(100 * p, digits)} %`;

/** A value as a scene has it, by the largest of some units in which it is at least 1. */
export function written(value, units) {
  const [unit, factor] = [...units].reverse().find(([, one]) => value >= 0.9995 * one) ?? units[0];
  const text = String(Number((value / factor).toPrecision(3)));
  return unit ? `${text} ${unit}` : text;
}
