// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { App } from './app';
import { fetchScene, type SessionInfo } from './scene/scene_model';
import { Session } from './session/session';
import { byId } from './ui/dom';
import { Messages } from './ui/messages';
import { offerOtherDevice, pair } from './ui/pairing';
import { ThemeSwitch } from './ui/theme';
import { Page } from './page';

/// Starts the page: pairs, fetches the scene, renders, connects.
async function main(): Promise<void> {
  const messages = new Messages();
  const theme = new ThemeSwitch();
  try {
    const info = await pair();
    offerOtherDevice(info);
    await open(info, messages, theme);
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    messages.show({ level: 'error', text }, true);
  }
}

async function open(info: SessionInfo, messages: Messages, theme: ThemeSwitch): Promise<void> {
  const model = await fetchScene();
  const session = new Session(`${location.protocol.replace('http', 'ws')}//${location.host}/live`);
  const canvas = byId('view', HTMLCanvasElement);
  const actions = byId('actions', HTMLDivElement);
  const app = new App(canvas, session, actions, (notice) => messages.show(notice));
  app.view.setModel(model);
  const page = new Page(app, model, info, messages, theme);
  app.start();
  const loaded = page.load();
  if (navigator.xr) (await import('./vr/index')).attachVr(app);
  await loaded;
}

void main();
