// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Runs one browser test, or says what it lacks: `node run.mjs NAME`, 77 where it is skipped.
// PCAVR_COMMAND: the command. PCAVR_PAGE: the built page. PCAVR_PICTURES: where screenshots go.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const test = fileURLToPath(new URL(`${process.argv[2]}.test.mjs`, import.meta.url));
const chromium = process.env.PCAVR_CHROMIUM ?? '/usr/bin/chromium';
const skipped = 77;

function hasPackage(name) {
  try {
    createRequire(import.meta.url).resolve(name);
    return true;
  } catch {
    return false;
  }
}

const lacking = [
  [existsSync(chromium), `a browser at ${chromium}: apt-get install chromium`],
  [existsSync(process.env.PCAVR_COMMAND ?? ''), 'the pcavr command in PCAVR_COMMAND'],
  [existsSync(`${process.env.PCAVR_PAGE}/index.html`), 'the built page in PCAVR_PAGE'],
  ...['playwright-core', 'iwer', 'ws'].map((name) => [hasPackage(name), `${name}: npm ci`]),
].filter(([isThere]) => !isThere);

if (lacking.length > 0) {
  console.log(`skipped: ${process.argv[2]} needs ${lacking.map(([, what]) => what).join('; ')}`);
  process.exitCode = skipped;
} else {
  const run = spawnSync(process.execPath, ['--test', test], { stdio: 'inherit' });
  process.exitCode = run.status ?? 1;
}
