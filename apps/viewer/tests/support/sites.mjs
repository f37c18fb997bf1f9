// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Both sites of a link: a robot's site with a simulated plant, and an operator's site with the page.
import { spawn } from 'node:child_process';

const command = process.env.PCAVR_COMMAND;

/// Starts a site; `ready` is the JSON of its first line.
export async function startSite(...args) {
  const site = spawn(command, ['--json', ...args]);
  const ended = new Promise((resolve) => site.on('exit', resolve));
  let output = '';
  let errors = '';
  site.stderr.on('data', (text) => (errors += text));
  const ready = await new Promise((resolve, reject) => {
    site.stdout.on('data', (text) => {
      output += text;
      if (output.includes('\n')) resolve(JSON.parse(output.split('\n')[0]));
    });
    ended.then((code) => reject(new Error(`pcavr ${args[0]} ended with ${code}: ${errors}`)));
  });
  return {
    ready,
    errors: () => errors,
    signal: (name) => site.kill(name),
    /// The result, which is printed at the end.
    stop: async () => {
      site.kill('SIGCONT');
      site.kill('SIGTERM');
      await ended;
      return JSON.parse(output.slice(output.indexOf('\n') + 1) || 'null');
    },
  };
}

/// Seed 3 is that of makeScene.
export function startRobot(scene, port = 0, ...more) {
  const plant = ['--plant', 'push', '--seed', '3'];
  return startSite('robot-site', scene, ...plant, '--port', String(port), ...more);
}

export function startOperator(scene, port, ...more) {
  const page = ['--page', process.env.PCAVR_PAGE, '--page-port', '0'];
  return startSite('operator-site', scene, '--port', String(port), ...page, ...more);
}
