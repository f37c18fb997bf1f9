// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Okabe & Ito's palette, distinguishable with any kind of colour vision. Not in the style sheet: a
// saved plot has them too.
export const seriesColors = ['#0072b2', '#d55e00', '#009e73', '#aa4499'];
export const bandColors = ['#f3dfb4', '#dde3e9', '#f7dd93', '#c9e7d8'];
export const laneColors = ['#d7dde3', '#b4bfca', '#e8b321', '#3fa57c'];
export const pinColor = seriesColors[3];
export const softInk = '#5b6570';
