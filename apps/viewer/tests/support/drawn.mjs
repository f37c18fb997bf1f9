// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a page draws, as it says itself.

/// The bodies' poses in base, in the scene's order.
export function drawnBodies(page) {
  return page.evaluate(() => window.__pcavr.bodies);
}

/// Waits until everything is loaded that the page shows at first.
export function loaded(page) {
  return page.waitForFunction(
    () => window.__pcavr?.scene.isComplete && window.__pcavr.scene.firstPicture > 0,
  );
}

/// Where on the page a point of base [m] is drawn.
export function onScreen(page, place) {
  return page.evaluate((p) => {
    const { app } = window.__pcavr;
    const point = app.view.tool.proxy.position.clone().set(...p);
    app.base.localToWorld(point).project(app.camera);
    const { left, top, width, height } = app.canvas.getBoundingClientRect();
    return { x: left + (0.5 + 0.5 * point.x) * width, y: top + (0.5 - 0.5 * point.y) * height };
  }, place);
}

/// The panel, which a small window begins without.
export async function openPanel(page) {
  if (await page.locator('#panel').isHidden()) await page.click('#panel-toggle');
}
