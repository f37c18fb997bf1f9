// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The fixture of a test file: a scene, its server, a browser, and optionally an independent client.
import { after, afterEach, before } from 'node:test';
import { openBrowser, openPage } from './browser.mjs';
import { installHeadset } from './headset.mjs';
import { Live, until } from './live.mjs';
import { makeScene, serve } from './pcavr.mjs';

export const limit = { timeout: 60_000 }; // [ms]

/// The arguments of `pcavr serve` for a live scene.
export const sceneArguments = ({ scene, parameters }) => [scene, '--parameters', parameters];

/// Set up before the tests of a file and torn down after them; pages are closed after each test.
/// `serverArguments`: of `pcavr serve` for the scene. `changeRecording`, `images`: see makeScene. `skip`: no setup, as all tests are skipped.
/// `onReady` runs after the setup: the hooks of one file don't wait for each other.
export function setStage(
  {
    serverArguments = sceneArguments,
    changeRecording,
    images,
    headset = false,
    world = false,
    skip = false,
  } = {},
  onReady = () => {},
) {
  const stage = { open: (url = stage.server.url) => openPage(stage.browser.context, url) };

  before(async () => {
    if (skip) return;
    stage.scene = makeScene(changeRecording, images);
    stage.server = await serve(...serverArguments(stage.scene));
    stage.browser = await openBrowser();
    if (headset) await installHeadset(stage.browser.context);
    if (world) {
      stage.world = new Live(stage.server.url);
      await until(() => stage.world.state, 'the first state');
    }
    await onReady(stage);
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
