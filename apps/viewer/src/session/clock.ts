// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// This page's clock [s]: common to its window and its workers, whose `performance.now()` have
/// different origins.
export function pageClock(): number {
  return (performance.timeOrigin + performance.now()) / 1000;
}
