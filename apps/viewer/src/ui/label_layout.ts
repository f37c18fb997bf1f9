// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// [CSS pixels] on the stage.
export interface Area {
  left: number;
  top: number;
  width: number;
  height: number;
}

const gap = 4; // [CSS pixels] between two areas

export function overlap(a: Area, b: Area): boolean {
  return (
    a.left < b.left + b.width + gap &&
    b.left < a.left + a.width + gap &&
    a.top < b.top + b.height + gap &&
    b.top < a.top + a.height + gap
  );
}

/// `wanted`, moved as little as possible beside the taken areas, on the stage; where nothing is free,
/// `wanted` itself.
export function clearOf(
  wanted: Area,
  taken: readonly Area[],
  stage: { width: number; height: number },
): Area {
  const xs = [wanted.left];
  const ys = [wanted.top];
  for (const { left, top, width, height } of taken) {
    xs.push(left - wanted.width - gap, left + width + gap);
    ys.push(top - wanted.height - gap, top + height + gap);
  }
  const distance = ({ left, top }: Area) => Math.hypot(left - wanted.left, top - wanted.top);
  const isFree = (area: Area) =>
    area.left >= 0 &&
    area.top >= 0 &&
    area.left + area.width <= stage.width &&
    area.top + area.height <= stage.height &&
    !taken.some((one) => overlap(area, one));
  let best: Area | null = null;
  for (const left of xs) {
    for (const top of ys) {
      const area = { ...wanted, left, top };
      if ((!best || distance(area) < distance(best)) && isFree(area)) best = area;
    }
  }
  return best ?? wanted;
}
