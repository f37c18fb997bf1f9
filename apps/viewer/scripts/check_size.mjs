// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Limits the size of all JavaScript that the page can load, gzipped as transferred.
import { readdirSync, readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const maxBytes = 250_000;
const folder = new URL('../dist/assets/', import.meta.url);
let total = 0;
for (const name of readdirSync(folder).filter((file) => file.endsWith('.js'))) {
  const bytes = gzipSync(readFileSync(new URL(name, folder)), { level: 9 }).length;
  total += bytes;
  console.log(`${String(bytes).padStart(8)}  ${name}`);
}
console.log(`${String(total).padStart(8)}  bytes of JavaScript gzipped, limit ${maxBytes}`);
if (total > maxBytes) process.exitCode = 1;
