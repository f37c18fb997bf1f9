// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// What the tests of a file share: a scene, the server that shows it, a browser, and where it is
// wanted a second opinion on the world.
import { after, afterEach, before } from 'node:test';
import { openBrowser, openPage } from './browser.mjs';
import { wearHeadset } from './headset.mjs';
import { Live, until } from './live.mjs';
import { makeScene, serve } from './pcavr.mjs';

export const limit = { timeout: 60_000 }; // [ms]

/// What `pcavr serve` is told to show a scene live.
export const ofScene = ({ scene, parameters }) => [scene, '--parameters', parameters];

/// Made before the tests of the file that asks for it, and gone after them; pages go after each test.
/// `words`: what `pcavr serve` is told of the scene. `skip`: nothing is made, as all tests are skipped.
/// `isSet` is called when the rest is there: hooks of one file don't wait for each other.
export function setStage(
  { words = ofScene, headset = false, world = false, skip = false } = {},
  isSet = () => {},
) {
  const stage = { open: (url = stage.server.url) => openPage(stage.browser.context, url) };

  before(async () => {
    if (skip) return;
    stage.scene = makeScene();
    stage.server = await serve(...words(stage.scene));
    stage.browser = await openBrowser();
    if (headset) await wearHeadset(stage.browser.context);
    if (world) {
      stage.world = new Live(stage.server.url);
      await until(() => stage.world.state, 'the first state');
    }
    await isSet(stage);
  }, limit);

  afterEach(() => stage.browser?.closePages());

  after(async () => {
    stage.world?.close();
    await stage.browser?.close();
    await stage.server?.stop();
    stage.scene?.remove();
  });
  return stage;
}
