// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { defineConfig, type Plugin } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

import { licenses } from './scripts/licenses.mjs';

/// The page as it is served, but started by replay_file.ts from the files that it carries.
function carriesFiles(): Plugin {
  const served = '<script type="module" src="/src/main.ts"></script>';
  const carrying = `<script type="application/json" id="carried-files">
      CARRIED_FILES
    </script>
    <script type="module" src="/src/replay_file.ts"></script>`;
  return {
    name: 'pcavr-carries-files',
    transformIndexHtml: {
      order: 'pre',
      handler(html) {
        if (!html.includes(served)) throw new Error(`index.html has no ${served}`);
        return html.replace(served, carrying);
      },
    },
  };
}

// A replay in one file, into which the C++ library writes the files of scene and replay.
export default defineConfig({
  plugins: [carriesFiles(), licenses({ isInlined: true }), viteSingleFile()],
  define: { IS_ONE_FILE: 'true' },
  build: { target: 'es2022', modulePreload: { polyfill: false }, outDir: 'dist/replay' },
});
