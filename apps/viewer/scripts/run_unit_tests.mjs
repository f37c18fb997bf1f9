// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Node 18 does not run TypeScript: esbuild (a dependency of Vite) bundles the tests to JavaScript.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const unit = fileURLToPath(new URL('../unit/', import.meta.url));
const outdir = mkdtempSync(join(tmpdir(), 'pcavr-viewer-'));
const tests = readdirSync(unit).filter((name) => name.endsWith('.test.ts'));
await build({
  entryPoints: tests.map((name) => join(unit, name)),
  bundle: true,
  platform: 'node',
  format: 'esm',
  outExtension: { '.js': '.mjs' },
  outdir,
  logLevel: 'warning',
});
const files = tests.map((name) => join(outdir, name.replace(/ts$/, 'mjs')));
const run = spawnSync(process.execPath, ['--test', ...files], { stdio: 'inherit' });
rmSync(outdir, { recursive: true });
process.exitCode = run.status ?? 1;
