// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Opens a log of `pcavr replay --mcap` in Rerun's web viewer, in a browser without a screen, and takes a picture
// to look at. The viewer (46 MB) is no dependency of the project: install it for this, beside the page's packages.
//   cd apps/viewer && npm install --no-save @rerun-io/web-viewer && cd ../..
//   node bench/rerun.mjs replay.mcap rerun.png [SECONDS]
import { createReadStream } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const [log, picture, seconds = '30'] = process.argv.slice(2);
if (!picture) {
  console.error('usage: node bench/rerun.mjs LOG.mcap PICTURE.png [SECONDS]');
  process.exit(1);
}
const folder = fileURLToPath(new URL('../apps/viewer', import.meta.url));
const packages = createRequire(join(folder, 'package.json'));
const { chromium } = packages('playwright-core');
const viewer = join(folder, 'node_modules/@rerun-io/web-viewer');
const size = { width: 1400, height: 900 };
const page = `<!doctype html><body style="margin:0"><script type="module">
import { WebViewer } from '/viewer/index.js';
await new WebViewer().start(location.origin + '/log.mcap', document.body, {
  width: '${size.width}px', height: '${size.height}px', render_backend: 'webgl', hide_welcome_screen: true,
});
document.title = 'started';
</script>`;

const types = { js: 'text/javascript', wasm: 'application/wasm' };
const server = createServer(({ url }, response) => {
  if (url === '/') return response.setHeader('content-type', 'text/html').end(page);
  const inside = normalize(decodeURI(url.split('?')[0]));
  let file = inside === '/log.mcap' ? log : join(viewer, inside.replace(/^\/viewer\//, ''));
  if (file.endsWith('re_viewer')) file += '.js'; // as a bundler would resolve it
  response.setHeader('content-type', types[file.split('.').pop()] ?? 'application/octet-stream');
  createReadStream(file)
    .on('error', () => response.writeHead(404).end())
    .pipe(response);
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));

const browser = await chromium.launch({
  executablePath: process.env.PCAVR_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
});
const tab = await browser.newPage({ viewport: size });
tab.on('pageerror', (error) => console.error(String(error)));
await tab.goto(`http://127.0.0.1:${server.address().port}/`);
await tab.waitForFunction(() => document.title === 'started', null, { timeout: 120_000 });
await tab.waitForTimeout(1000 * Number(seconds));
await tab.screenshot({ path: picture, timeout: 120_000 });
await browser.close();
server.close();
