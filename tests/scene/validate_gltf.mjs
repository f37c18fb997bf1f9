// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Runs the Khronos glTF validator on the given files, and prints its messages.
//
//   node validate_gltf.mjs FOLDER_WITH_NODE_MODULES FILE.glb...
//
// Exit code: 0 if no file has an error or a warning.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const [folder, ...files] = process.argv.slice(2);
const validator = createRequire(join(folder, 'package.json'))('gltf-validator');

let issues = 0;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
  for (const { code, message, pointer } of messages) console.log(`  ${code} ${pointer}: ${message}`);
  issues += numErrors + numWarnings;
}
process.exit(issues === 0 ? 0 : 1);
