// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { App } from './app';
import { fetchScene, type SessionInfo } from './scene/scene_model';
import type { Session } from './session/session';
import { byId } from './ui/dom';
import { Messages } from './ui/messages';
import { offerOtherDevice, pair } from './ui/pairing';
import { ThemeSwitch } from './ui/theme';
import { Page } from './page';

/// Starts the page: pairs, fetches the scene, connects, renders. `extend` adds to the page while its
/// scene loads.
export async function start(
  connect: () => Session,
  extend: (app: App) => Promise<void> = () => Promise.resolve(),
): Promise<void> {
  const messages = new Messages();
  const theme = new ThemeSwitch();
  const open = async (info: SessionInfo) => {
    const model = await fetchScene();
    const canvas = byId('view', HTMLCanvasElement);
    const actions = byId('actions', HTMLDivElement);
    const app = new App(canvas, connect(), actions, (notice) => messages.show(notice));
    app.view.setModel(model);
    const page = new Page(app, model, info, messages, theme);
    app.start();
    const loaded = page.load();
    await extend(app);
    await loaded;
  };
  try {
    const info = await pair();
    offerOtherDevice(info);
    await open(info);
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    messages.show({ level: 'error', text }, true);
  }
}
