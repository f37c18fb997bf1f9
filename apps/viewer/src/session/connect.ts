// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Session } from './session';

/// A session with a server, whose socket runs in a worker.
export function connect(url: string): Session {
  // In one expression: Vite finds workers by it.
  const worker = new Worker(new URL('./socket_worker.ts', import.meta.url), { type: 'module' });
  return new Session(worker, url);
}
