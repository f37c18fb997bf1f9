// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// In the server's base frame: metres, z up.
export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number]; // x y z w
