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
