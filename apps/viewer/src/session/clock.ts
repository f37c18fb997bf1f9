// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// This page's clock [s]: the same for its window and its workers, each of which counts
/// `performance.now()` from another start.
export function pageClock(): number {
  return (performance.timeOrigin + performance.now()) / 1000;
}
