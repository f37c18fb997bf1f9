// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { connect } from './session/connect';
import { start } from './start';

void start(
  () => connect(`${location.protocol.replace('http', 'ws')}//${location.host}/live`),
  async (app) => {
    if (navigator.xr) (await import('./vr/index')).attachVr(app);
  },
);
