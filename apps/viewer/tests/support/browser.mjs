// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A browser without a network: what a page asks for is recorded, and has to be this machine's.
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const flags = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  // Mesa's llvmpipe: half the cost of the browser's own software renderer.
  '--use-gl=angle',
  '--use-angle=gl-egl',
  '--ignore-gpu-blocklist',
];

export const viewport = { width: 640, height: 360 };

/// A browser with a profile of its own, which goes with it.
export async function openBrowser() {
  const profile = mkdtempSync(join(tmpdir(), 'pcavr-browser-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.PCAVR_CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    args: flags,
    viewport,
    ignoreHTTPSErrors: true, // the server's certificate is its own
  });
  return {
    context,
    // But for the empty one that it opened with: without any, the browser would end.
    closePages: () =>
      Promise.all(
        context
          .pages()
          .slice(1)
          .map((page) => page.close()),
      ),
    close: async () => {
      await context.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

/// A page, and all that it asked for and complained of.
export async function openPage(context, url) {
  const page = await context.newPage();
  const seen = { requests: [], errors: [] };
  page.on('request', (request) => seen.requests.push(request.url()));
  page.on('websocket', (socket) => seen.requests.push(socket.url()));
  page.on('requestfailed', (request) => seen.errors.push(`${request.url()} failed`));
  page.on('pageerror', (error) => seen.errors.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') seen.errors.push(message.text());
  });
  await page.goto(url);
  return { page, seen };
}

/// Those of the addresses that are not of this server, and not made by the page itself.
export function elsewhere(requests, url) {
  const { host } = new URL(url);
  return requests.filter((r) => !/^(data|blob):/.test(r) && new URL(r).host !== host);
}

/// Writes what the page looks like to the folder for pictures, where there is one.
export async function picture(page, name) {
  const folder = process.env.PCAVR_PICTURES;
  if (folder) await page.screenshot({ path: join(folder, `${name}.png`) });
}
