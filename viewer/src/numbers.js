// Numbers as people read them.

/** 1234567 as "1,234,567". */
export const grouped = (value) => Math.round(value).toLocaleString('en-US');

/** Digits behind the point that show steps of `resolution`. */
export function digitsFor(resolution) {
  if (!(resolution > 0)) return 6;
  return Math.min(12, Math.max(0, Math.ceil(-Math.log10(resolution) - 1e-9)));
}

/** With `digits` behind the point, and no "-0.00". */
export function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text;
}

/** About `significant` digits, without zeros at the end, powers of ten only where they help. */
export function short(value, significant = 4) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-5)
    return value
      .toExponential(significant - 1)
      .replace(/\.?0+e/, 'e')
      .replace('e+', 'e');
  return String(Number(value.toPrecision(significant)));
}

/** As `short`, a share as percent. */
export const percent = (share) => `${short(100 * share, 2)} %`;

/** Round numbers in [lo, hi], about `count` of them. */
export function ticks(lo, hi, count) {
  if (!(hi > lo)) return [lo];
  const rough = (hi - lo) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9)) * power;
  const marks = [];
  for (let i = Math.ceil(lo / step - 1e-6); i * step <= hi + 1e-6 * step; ++i) marks.push(i * step);
  return marks;
}
