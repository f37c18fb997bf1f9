// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// What a tiled scan may take.
export interface TileLimits {
  megabytes: number; // of the loaded tiles' vertices and triangles
  pixels: number; // a tile is replaced by finer ones where its error is larger on the screen
}

// Triangles of the scan that render at full frame rate: on a GPU, a headset or phone, a software
// renderer.
const triangles = { gpu: 2_000_000, mobile: 280_000, software: 50_000 };
const tiles: Record<Device, TileLimits> = {
  gpu: { megabytes: 400, pixels: 2 },
  mobile: { megabytes: 100, pixels: 4 },
  software: { megabytes: 60, pixels: 6 },
};
type Device = keyof typeof triangles;

function device(isSoftwareRendered: boolean): Device {
  if (isSoftwareRendered) return 'software';
  return /Android|Mobile|Quest/i.test(navigator.userAgent) ? 'mobile' : 'gpu';
}

/// A number above 0 in the page's address.
function requested(name: string): number | null {
  const value = Number(new URLSearchParams(location.search).get(name));
  return value > 0 ? value : null;
}

/// `?triangles=N` sets another budget.
export function triangleBudget(isSoftwareRendered: boolean): number {
  return requested('triangles') ?? triangles[device(isSoftwareRendered)];
}

/// `?tile-megabytes=N` sets another memory.
export function tileLimits(isSoftwareRendered: boolean): TileLimits {
  const limits = tiles[device(isSoftwareRendered)];
  return { ...limits, megabytes: requested('tile-megabytes') ?? limits.megabytes };
}
