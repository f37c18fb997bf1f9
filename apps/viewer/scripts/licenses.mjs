// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The licences of the packages that are in a built page, which their authors require to go with it.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';

/** The folder of the package that a module is of; null for our own modules. */
export function packageOf(module) {
  const path = module.replace(/^\0/, '').split('?')[0];
  if (!path.includes('/node_modules/')) return null;
  for (let folder = dirname(path); !folder.endsWith('/node_modules'); folder = dirname(folder)) {
    const file = join(folder, 'package.json');
    if (existsSync(file) && JSON.parse(readFileSync(file, 'utf8')).name) return folder;
  }
  return null;
}

/** Name, version and licence of a package. A package without the text of its licence is an error. */
export function noticeOf(folder) {
  const { name, version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((entry) => /^(licen[cs]e|copying)/i.test(entry));
  if (!file) throw new Error(`${name} has no file with its licence`);
  const text = readFileSync(join(folder, file), 'utf8').trim();
  return `${name} ${version} (${license})\n\n${text}\n`;
}

/** The notices of all packages that a bundle contains, in the order of their names. */
export function noticesOf(bundle) {
  const modules = Object.values(bundle).flatMap((output) => output.moduleIds ?? []);
  const folders = new Set(modules.map(packageOf).filter(Boolean));
  const line = `\n${'-'.repeat(80)}\n\n`;
  return ['This page contains:\n', ...[...folders].map(noticeOf).sort()].join(line);
}

/** For Vite: `licenses.txt` beside the page, and with `isInlined` inside each page itself. */
export function licenses({ isInlined = false } = {}) {
  return {
    name: 'pcavr-licenses',
    enforce: 'post',
    generateBundle(_, bundle) {
      const source = noticesOf(bundle);
      if (!isInlined)
        return void this.emitFile({ type: 'asset', fileName: 'licenses.txt', source });
      const text = source.replaceAll('<', '&lt;');
      for (const output of Object.values(bundle)) {
        if (!output.fileName.endsWith('.html')) continue;
        output.source = output.source.replace(
          '</body>',
          () => `<script type="text/plain" id="licenses">\n${text}</script>\n</body>`,
        );
      }
    },
  };
}
