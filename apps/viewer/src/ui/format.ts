// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// Numbers formatted for display; a dash if not finite.

export function milliseconds(seconds: number): string {
  if (!Number.isFinite(seconds)) return '–';
  const ms = seconds * 1e3;
  return `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms`;
}

export function microseconds(seconds: number): string {
  return Number.isFinite(seconds) ? `${(seconds * 1e6).toFixed(0)} µs` : '–';
}

export function newtons(force: number): string {
  return Number.isFinite(force) ? `${force.toFixed(1)} N` : '–';
}

export function length(vector: readonly number[]): number {
  return Math.hypot(...vector);
}

/// Rounded to `digits` significant digits.
export function significant(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return '–';
  return Number(value.toPrecision(digits)).toLocaleString('en', {
    maximumSignificantDigits: digits,
  });
}

const maxDecimals = 6;
const small = 1e-3; // below it, and from `large` on, as a multiple of a power of ten
const large = 1e5;
const coarse = 1e3; // a standard deviation from which on the last digits say nothing

/// A value with its standard deviation, as in reports: no more digits than two of the latter,
/// "3.13 ± 0.21", "1.50e+04 ± 0.32e+04"; the value alone where that is not known.
export function uncertain(value: number, std: number | undefined): string {
  if (!Number.isFinite(value)) return '–';
  const known = std !== undefined && Number.isFinite(std) && std > 0 ? std : null;
  const size = Math.abs(value);
  const isCoarse = known !== null && known >= coarse;
  if (size >= large || (size > 0 && (size < small || isCoarse))) return scaled(value, known);
  return known === null ? readable(value) : withStd(value, known, '');
}

/// With three digits, and at most four decimals; not in multiples of a power of ten.
function readable(value: number): string {
  const decimals = value === 0 ? 0 : Math.min(Math.max(2 - powerOfTen(value), 0), 4);
  return value.toFixed(decimals);
}

/// As multiples of a power of ten, that of the value.
function scaled(value: number, std: number | null): string {
  const power = powerOfTen(value);
  const unit = 10 ** power;
  const factor = `e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;
  return std === null
    ? `${(value / unit).toFixed(2)}${factor}`
    : withStd(value / unit, std / unit, factor);
}

function withStd(value: number, std: number, factor: string): string {
  const decimals = Math.min(Math.max(1 - powerOfTen(std), 0), maxDecimals);
  return [value, std].map((number) => number.toFixed(decimals) + factor).join(' ± ');
}

function powerOfTen(value: number): number {
  return Math.floor(Math.log10(Math.abs(value)));
}

/// Three digits at most: 20 k for 19,999.
export function count(value: number): string {
  return value < 1000 ? significant(value) : `${significant(value / 1000)} k`;
}

export function megabytes(bytes: number): string {
  return `${(bytes / 1e6).toFixed(1)} MB`;
}

/// The yaw angle (about z) of a unit quaternion, in degrees.
export function heading([x, y, z, w]: readonly number[]): string {
  const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  return `${((yaw * 180) / Math.PI).toFixed(1)}°`;
}
