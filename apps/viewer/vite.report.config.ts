// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from 'vite';
import { viteSingleFile } from 'vite-plugin-singlefile';

import { licenses } from './scripts/licenses.mjs';

// The reports' page: one file, into which the C++ library writes a report's data.
export default defineConfig({
  plugins: [licenses({ isInlined: true }), viteSingleFile()],
  build: {
    target: 'es2022',
    modulePreload: { polyfill: false },
    outDir: 'dist-report',
    rollupOptions: { input: 'report.html' },
  },
});
