// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { App } from './app';
import { fetchScene } from './scene/scene_model';
import { SceneLoader } from './scene/loading';
import { Session } from './session/session';

async function main(): Promise<void> {
  const session = new Session(`${location.protocol.replace('http', 'ws')}//${location.host}/live`);
  const canvas = document.querySelector('canvas')!;
  const app = new App(canvas, session, document.body, (notice) => console.info(notice.text));
  app.view.setModel(await fetchScene());
  session.onWelcome((welcome) => {
    app.view.setObjectOrder(welcome.objects);
    app.view.tool.setRadius(welcome.tool_radius);
  });
  const loader = new SceneLoader(
    app.view,
    () => {},
    () => app.invalidate(),
  );
  app.start();
  await loader.load(1e6);
  app.view.frameAll();
  app.invalidate();
  if (navigator.xr) (await import('./vr/index')).attachVr(app);
}

void main();
