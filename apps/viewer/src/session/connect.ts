// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Session } from './session';

/// A session with a server, whose socket runs in a worker.
export function connect(url: string): Session {
  const script = new URL('./socket_worker.ts', import.meta.url);
  return new Session(new Worker(script, { type: 'module' }), url);
}
