// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// With six significant digits, without trailing zeros.
export function number(value: number): string {
  return String(Number(value.toPrecision(6)));
}
