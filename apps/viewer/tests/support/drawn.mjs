// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What a page draws, read from its test hook.

/// The drawn poses of the bodies in base, in the scene's order.
export function drawnBodies(page) {
  return page.evaluate(() => window.__pcavr.bodies);
}

/// Waits until the initial scene is loaded and drawn.
export function loaded(page) {
  return page.waitForFunction(
    () => window.__pcavr?.scene.isComplete && window.__pcavr.scene.firstFrameTime > 0,
  );
}

/// The page coordinates at which a point of base [m] is drawn.
export function onScreen(page, position) {
  return page.evaluate((p) => {
    const { app } = window.__pcavr;
    const point = app.view.tool.proxy.position.clone().set(...p);
    app.base.localToWorld(point).project(app.camera);
    const { left, top, width, height } = app.canvas.getBoundingClientRect();
    return { x: left + (0.5 + 0.5 * point.x) * width, y: top + (0.5 - 0.5 * point.y) * height };
  }, position);
}

/// Shows the panel, which is hidden at first in a small window.
export async function openPanel(page) {
  if (await page.locator('#panel').isHidden())
    await page.click('#sheet-grip, #panel-toggle >> visible=true');
}
