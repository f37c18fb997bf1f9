// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Runs the pcavr command: makes a small scene, and serves it.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const command = process.env.PCAVR_COMMAND;

/// Runs the command to its end, and returns what it prints; throws with its messages if it fails.
export const run = (...args) => execFileSync(command, args, { stdio: ['ignore', 'pipe', 'pipe'] });

/// Two boxes on a table, a simulated recording with a push of each, and its ground truth.
/// `change` gets the recording's folder before the scene is built. `images`: arguments of `simulate` that say
/// how it is seen; by default not at all.
export function makeScene(change = () => {}, images = ['--no-images'], seed = 3) {
  const folder = mkdtempSync(join(tmpdir(), 'pcavr-browser-scene-'));
  const recording = join(folder, 'recording');
  const scene = join(folder, 'scene');
  run('simulate', 'push', ...images, '--seed', String(seed), '-o', recording);
  change(recording);
  run('build', recording, '-o', scene);
  return {
    folder,
    recording,
    scene,
    parameters: join(recording, 'truth', 'parameters.yaml'),
    remove: () => rmSync(folder, { recursive: true, force: true }),
  };
}

/// Starts a server on a free port. `url` ends with a slash; `code` is empty without pairing.
export function serve(...args) {
  return serveAt(0, ...args);
}

/// Starts a server on a port.
export async function serveAt(port, ...args) {
  const page = ['--page', process.env.PCAVR_PAGE];
  const server = spawn(command, ['--json', 'serve', ...args, '--port', String(port), ...page]);
  const ended = new Promise((resolve) => server.on('exit', resolve));
  let output = '';
  let errors = '';
  server.stderr.on('data', (text) => (errors += text));
  const ready = await new Promise((resolve, reject) => {
    server.stdout.on('data', (text) => {
      output += text;
      // The first complete line has the addresses; a result line follows at the end.
      if (output.includes('\n')) resolve(JSON.parse(output.split('\n')[0]));
    });
    ended.then((code) => reject(new Error(`pcavr serve ended with ${code}: ${errors}`)));
  });
  return {
    url: ready.addresses[0],
    code: ready.code,
    signal: (name) => server.kill(name),
    ended,
    stop: async () => {
      server.kill('SIGTERM');
      return ended;
    },
  };
}
