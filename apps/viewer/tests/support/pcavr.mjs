// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The real command: makes a small scene, and serves it.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const command = process.env.PCAVR_COMMAND;

/// Two boxes on a table, a recorded push of each, and what is true of them; goes when the test ends.
export function makeScene() {
  const folder = mkdtempSync(join(tmpdir(), 'pcavr-browser-scene-'));
  const recording = join(folder, 'recording');
  const scene = join(folder, 'scene');
  const run = (...words) => execFileSync(command, words, { stdio: ['ignore', 'ignore', 'pipe'] });
  run('simulate', 'push', '--no-images', '--seed', '3', '-o', recording);
  run('build', recording, '-o', scene);
  return {
    folder,
    recording,
    scene,
    parameters: join(recording, 'truth', 'parameters.yaml'),
    remove: () => rmSync(folder, { recursive: true, force: true }),
  };
}

/// A server on a free port. `url` ends with a slash; `code` is empty where nobody asks for one.
export async function serve(...words) {
  const page = ['--page', process.env.PCAVR_PAGE];
  const server = spawn(command, ['--json', 'serve', ...words, '--port', '0', ...page]);
  const ended = new Promise((resolve) => server.on('exit', resolve));
  let said = '';
  let complaints = '';
  server.stderr.on('data', (text) => (complaints += text));
  const ready = await new Promise((resolve, reject) => {
    server.stdout.on('data', (text) => {
      said += text;
      // The first line, once it is whole, says where; a last one follows at the end.
      if (said.includes('\n')) resolve(JSON.parse(said.split('\n')[0]));
    });
    ended.then((code) => reject(new Error(`pcavr serve ended with ${code}: ${complaints}`)));
  });
  return {
    url: ready.addresses[0],
    code: ready.code,
    stop: async () => {
      server.kill('SIGTERM');
      return ended;
    },
  };
}
