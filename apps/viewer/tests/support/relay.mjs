// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// A proxy between page and server that can modify messages and drop connections.
import { createServer, request } from 'node:http';
import WebSocket, { WebSocketServer } from 'ws';

/// Forwards everything; each WebSocket message from the server passes through `change`, which drops it
/// by `null`.
export async function startRelay(url, change) {
  const upstream = new URL(url);
  const pages = new Set();
  const server = createServer((incoming, response) => {
    const { hostname, port } = upstream;
    const { method, url: path, headers } = incoming;
    const outgoing = request({ hostname, port, method, path, headers }, (answer) => {
      response.writeHead(answer.statusCode, answer.headers);
      answer.pipe(response);
    });
    incoming.pipe(outgoing);
  });
  const sockets = new WebSocketServer({ server });
  sockets.on('connection', (page) => {
    const world = new WebSocket(new URL('/live', url.replace(/^http/, 'ws')));
    const queued = [];
    pages.add(page);
    world.on('open', () => queued.splice(0).forEach((message) => world.send(message)));
    world.on('message', (message) => {
      const changed = change(message);
      if (changed !== null) page.send(changed);
    });
    world.on('close', () => page.terminate());
    page.on('message', (message) =>
      world.readyState === WebSocket.OPEN ? world.send(message) : queued.push(message),
    );
    page.on('close', () => {
      pages.delete(page);
      world.terminate();
    });
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    drop: () => pages.forEach((page) => page.terminate()),
    close: () => {
      pages.forEach((page) => page.terminate());
      server.close();
      server.closeAllConnections();
    },
  };
}
