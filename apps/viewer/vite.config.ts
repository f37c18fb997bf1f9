// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

import { licenses } from './scripts/licenses.mjs';

// `npm run dev` forwards to a separate server: `pcavr serve SCENE --port 8080`.
const tileLoader = fileURLToPath(new URL('src/scene/tile_loader.ts', import.meta.url));
const server = 'http://127.0.0.1:8080';

export default defineConfig({
  plugins: [licenses()],
  define: { IS_ONE_FILE: 'false' },
  resolve: { alias: { 'three/addons/loaders/GLTFLoader.js': tileLoader } },
  build: { target: 'es2022', modulePreload: { polyfill: false }, chunkSizeWarningLimit: 750 },
  worker: { format: 'es' },
  server: {
    proxy: { '/api': server, '/scene': server, '/live': { target: server, ws: true } },
  },
});
