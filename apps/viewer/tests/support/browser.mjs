// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A browser without network access; all requests of a page are recorded and must be local.
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

/// A browser with a temporary profile, removed when it is closed.
export async function openBrowser() {
  const profile = mkdtempSync(join(tmpdir(), 'pcavr-browser-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.PCAVR_CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    args: flags,
    viewport,
    ignoreHTTPSErrors: true, // the server's certificate is self-signed
  });
  return {
    context,
    // Except the initial empty page: without any page the browser would exit.
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

/// A page, with all its requests and errors.
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

/// The requests to other hosts than this server; data and blob URLs are local.
export function foreignRequests(requests, url) {
  const { host } = new URL(url);
  return requests.filter((r) => !/^(data|blob):/.test(r) && new URL(r).host !== host);
}

/// Takes a screenshot if PCAVR_PICTURES names a folder.
export async function screenshot(page, name) {
  const folder = process.env.PCAVR_PICTURES;
  if (folder) await page.screenshot({ path: join(folder, `${name}.png`) });
}
