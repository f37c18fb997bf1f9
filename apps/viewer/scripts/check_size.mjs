// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Limits the size of all JavaScript that the page can load, and of a report without data, gzipped.
import { readdirSync, readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const maxPage = 260_000; // [bytes]
const maxReport = 110_000; // [bytes]

function gzippedSize(file) {
  return gzipSync(readFileSync(file), { level: 9 }).length;
}

function check(bytes, limit, what) {
  console.log(`${String(bytes).padStart(8)}  bytes of ${what} gzipped, limit ${limit}`);
  if (bytes > limit) process.exitCode = 1;
}

const assets = new URL('../dist/assets/', import.meta.url);
let total = 0;
for (const name of readdirSync(assets).filter((file) => file.endsWith('.js'))) {
  const bytes = gzippedSize(new URL(name, assets));
  total += bytes;
  console.log(`${String(bytes).padStart(8)}  ${name}`);
}
check(total, maxPage, 'JavaScript');
check(gzippedSize(new URL('../dist-report/report.html', import.meta.url)), maxReport, 'a report');
