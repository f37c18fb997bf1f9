// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Runs one browser test: `node run.mjs NAME`; exit code 77 if it is skipped, with what it needs.
// PCAVR_COMMAND: the pcavr binary. PCAVR_PICTURES: folder for screenshots. PCAVR_PAGE: the built
// page, by default apps/viewer/dist.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const test = fileURLToPath(new URL(`${process.argv[2]}.test.mjs`, import.meta.url));
const chromium = process.env.PCAVR_CHROMIUM ?? '/usr/bin/chromium';
const page = process.env.PCAVR_PAGE ?? fileURLToPath(new URL('../dist', import.meta.url));
const report = fileURLToPath(new URL('../dist-report/report.html', import.meta.url));
const skipped = 77;

function hasPackage(name) {
  try {
    createRequire(import.meta.url).resolve(name);
    return true;
  } catch {
    return false;
  }
}

const missing = [
  [existsSync(chromium), `a browser at ${chromium}: apt-get install chromium`],
  [existsSync(process.env.PCAVR_COMMAND ?? ''), 'the pcavr command in PCAVR_COMMAND'],
  [existsSync(`${page}/index.html`), `the built page in ${page}: npm run build`],
  [existsSync(report), `the reports' built page in ${report}: npm run build`],
  ...['playwright-core', 'iwer', 'ws', '@foxglove/ws-protocol', '@mcap/core', 'axe-core'].map(
    (name) => [hasPackage(name), `${name}: npm ci`],
  ),
].filter(([isPresent]) => !isPresent);

if (missing.length > 0) {
  console.log(`skipped: ${process.argv[2]} needs ${missing.map(([, what]) => what).join('; ')}`);
  process.exitCode = skipped;
} else {
  const env = { ...process.env, PCAVR_PAGE: page };
  const run = spawnSync(process.execPath, ['--test', test], { stdio: 'inherit', env });
  process.exitCode = run.status ?? 1;
}
