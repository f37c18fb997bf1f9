// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A server between page and server, which changes what it is told to, and can break the line.
import { createServer, request } from 'node:http';
import WebSocket, { WebSocketServer } from 'ws';

/// Passes everything on; each WebSocket message from the server through `change`.
export async function between(url, change) {
  const there = new URL(url);
  const pairs = new Set();
  const server = createServer((asked, answer) => {
    const { hostname, port } = there;
    const { method, url: path, headers } = asked;
    const passed = request({ hostname, port, method, path, headers }, (got) => {
      answer.writeHead(got.statusCode, got.headers);
      got.pipe(answer);
    });
    asked.pipe(passed);
  });
  const sockets = new WebSocketServer({ server });
  sockets.on('connection', (page) => {
    const world = new WebSocket(new URL('/live', url.replace(/^http/, 'ws')));
    const early = [];
    pairs.add(page);
    world.on('open', () => early.splice(0).forEach((message) => world.send(message)));
    world.on('message', (message) => page.send(change(message)));
    world.on('close', () => page.terminate());
    page.on('message', (message) =>
      world.readyState === WebSocket.OPEN ? world.send(message) : early.push(message),
    );
    page.on('close', () => {
      pairs.delete(page);
      world.terminate();
    });
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    drop: () => pairs.forEach((page) => page.terminate()),
    close: () => {
      pairs.forEach((page) => page.terminate());
      server.close();
      server.closeAllConnections();
    },
  };
}
