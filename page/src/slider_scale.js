/**
 * How the slider of a tunable runs. A declared range says what is allowed, often far more than anybody wants to try: a
 * mass may be 1 g or a million tons. The slider covers what is sensible around the default, the number beside it takes
 * all that is allowed.
 */

const DECADE = 10;
const WIDE = 100; // a range is wide when it spans more than this, relative to the value it is about
const SEVERAL = 1000; // a range of positive numbers up to this is shown whole, by a logarithm
const FROM_ZERO = 1000; // where the slider of a quantity that is zero ends, in its unit

/** @typedef {{lower: number, upper: number, kind: 'linear'|'log'|'power', whole: boolean}} Scale */

/**
 * The slider's range for a tunable as the program declares it; null bounds are infinite.
 * - linear over the declared range while that is of the size of the default,
 * - logarithmic for positive numbers of several decades, at most one decade each way from the default,
 * - finer near zero for a wide range whose default is zero.
 * @returns {Scale}
 */
export function sliderScale({ min, max, default: standard, value, kind }) {
  const least = min ?? -Infinity;
  const most = max ?? Infinity;
  const about = Number(standard ?? value ?? 0);
  const whole = kind === 'integer';
  const positive = whole ? 'linear' : 'log';
  if (!isWide(least, most, Math.abs(about))) return { lower: least, upper: most, kind: 'linear', whole };
  if (least > 0 && most <= SEVERAL * least) return { lower: least, upper: most, kind: positive, whole };
  if (about > 0 && least >= 0) {
    return { lower: Math.max(about / DECADE, least), upper: Math.min(about * DECADE, most), kind: positive, whole };
  }
  if (least >= 0) return { lower: least, upper: Math.min(most, FROM_ZERO), kind: 'power', whole };
  const reach = Math.max(2 * Math.abs(about), 1);
  return { lower: Math.max(about - reach, least), upper: Math.min(about + reach, most), kind: 'linear', whole };
}

function isWide(least, most, size) {
  const extent = Math.max(Math.abs(least), Math.abs(most));
  return extent > WIDE * (size || 1) || (least > 0 && most > WIDE * least);
}

/** The scale, longer where the value lies outside; null is no value. */
export function scaleWith(scale, value) {
  if (value === null || (value >= scale.lower && value <= scale.upper)) return scale;
  return { ...scale, lower: Math.min(scale.lower, value), upper: Math.max(scale.upper, value) };
}

/** Place of a value on the slider, 0 … 1. */
export function toPlace({ lower, upper, kind }, value) {
  const inside = Math.min(Math.max(value, lower), upper);
  if (upper === lower) return 0;
  if (kind === 'log' && lower > 0) return Math.log(inside / lower) / Math.log(upper / lower);
  const share = (inside - lower) / (upper - lower);
  return kind === 'power' ? Math.cbrt(share) : share;
}

/** Value at a place of the slider, rounded to three digits, which a slider cannot beat anyway. */
export function toValue({ lower, upper, kind, whole }, place) {
  if (place <= 0) return lower;
  if (place >= 1) return upper;
  if (whole) return Math.round(lower + place * (upper - lower));
  if (kind === 'log' && lower > 0) return roundTo(lower * (upper / lower) ** place, 3);
  const share = kind === 'power' ? place ** 3 : place;
  const value = lower + share * (upper - lower);
  const grain = DECADE ** Math.floor(Math.log10((upper - lower) / 500));
  return kind === 'power' ? roundTo(value, 3) : Number((Math.round(value / grain) * grain).toPrecision(12));
}

function roundTo(value, digits) {
  return Number(value.toPrecision(digits));
}

/** A number as people write it: what a float knows (seven digits), no zeros behind. */
export function formatNumber(value, digits = 7) {
  if (value === null || value === undefined) return '';
  return String(Number(Number(value).toPrecision(digits)));
}

/** Do two values of a tunable differ by more than a float's rounding? */
export function differs(a, b) {
  if (Array.isArray(a) && Array.isArray(b)) return a.length !== b.length || a.some((item, i) => differs(item, b[i]));
  if (typeof a === 'number' && typeof b === 'number')
    return Math.abs(a - b) > 1e-6 * Math.max(Math.abs(a), Math.abs(b));
  return (a ?? null) !== (b ?? null);
}
