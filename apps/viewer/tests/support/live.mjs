// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// An independent client of docs/live-protocol.md, without the page's code, as a reference.
import WebSocket from 'ws';

const headerBytes = 24;
const types = { welcome: 1, state: 2, notice: 3, hello: 16, tool: 17, command: 18 };

/// Sends and receives as a page does. `state` is the newest, null before the first.
export class Live {
  sequence = 0;
  state = null;
  welcome = null;
  notices = [];
  isClosed = false;
  onState = () => {};

  constructor(url, { protocol = 1, headers = {} } = {}) {
    this.socket = new WebSocket(`${url.replace(/^http/, 'ws')}live`, {
      headers,
      rejectUnauthorized: false,
    });
    this.socket.binaryType = 'nodebuffer';
    this.socket.on('open', () =>
      this.send(types.hello, Buffer.from(JSON.stringify({ protocol, version: 'test' }))),
    );
    this.socket.on('message', (bytes) => this.receive(bytes));
    this.ended = new Promise((resolve) => {
      this.socket.on('unexpected-response', (_, response) => resolve(response.statusCode));
      this.socket.on('close', (code) => resolve(code));
      this.socket.on('error', () => resolve('error'));
    }).then((reason) => {
      this.isClosed = true;
      return reason;
    });
  }

  tool(tip, isClosed) {
    const body = Buffer.alloc(32);
    [...tip, 0, 0, 0, 1].forEach((value, i) => body.writeFloatLE(value, 4 * i));
    body[28] = isClosed ? 1 : 0;
    body[29] = 2;
    this.send(types.tool, body);
  }

  /// Moves the tool's tip with the clutch closed, in steps of 4 ms.
  async moveTool(from, to, seconds) {
    const steps = Math.round(seconds / 0.004);
    for (let i = 1; i <= steps; ++i) {
      this.tool(
        from.map((value, k) => value + ((to[k] - value) * i) / steps),
        true,
      );
      await new Promise((resolve) => setTimeout(resolve, 4));
    }
  }

  /// Takes the tool, and moves it from where it is to `to` above all bodies: it starts beside one, at
  /// mid-height. Repeated where a busy machine has paused for so long that the tool was released.
  async moveToolOver(to, height = 0.3) {
    const above = ([x, y]) => [x, y, height];
    for (let attempt = 0; attempt < 3; ++attempt) {
      this.command(4); // take
      await until(() => this.state.hasTool, 'the tool');
      const { proxy } = this.state;
      await this.moveTool(proxy, above(proxy), 0.5);
      await this.moveTool(above(proxy), above(to), 1);
      await this.moveTool(above(to), to, 0.5);
      await this.moveTool(to, to, 0.1);
      if (distance(this.state.proxy, to) < 0.01) return;
      this.tool(to, false);
    }
    throw new Error(`the tool is not at ${to} but at ${this.state.proxy}`);
  }

  command(number) {
    const body = Buffer.alloc(4);
    body.writeUInt32LE(number);
    this.send(types.command, body);
  }

  close() {
    this.socket.terminate();
  }

  send(type, body) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const message = Buffer.alloc(headerBytes + body.length);
    message.write('PCVR');
    message[4] = 1;
    message[5] = type;
    message.writeUInt32LE(++this.sequence, 8);
    message.writeUInt32LE(body.length, 12);
    message.writeDoubleLE(performance.now() / 1000, 16);
    body.copy(message, headerBytes);
    this.socket.send(message);
  }

  receive(bytes) {
    const body = bytes.subarray(headerBytes);
    if (bytes[5] === types.state) {
      this.state = decodeState(body);
      this.onState(this.state);
    }
    if (bytes[5] === types.welcome) this.welcome = JSON.parse(body);
    if (bytes[5] === types.notice) this.notices.push(JSON.parse(body));
  }
}

function decodeState(body) {
  const floats = (at, n) => Array.from({ length: n }, (_, i) => body.readFloatLE(at + 4 * i));
  const flags = body.readUInt32LE(16);
  const objects = [];
  for (let i = 0; i < body.readUInt32LE(100); ++i) {
    const at = 104 + 48 * i;
    objects.push({
      position: floats(at, 3),
      quaternion: floats(at + 12, 4),
      force: floats(at + 28, 3),
      phase: body[at + 40],
      isOutside: (body[at + 41] & 1) !== 0,
      isBlocked: (body[at + 41] & 2) !== 0,
      isSaturated: (body[at + 41] & 4) !== 0,
      speed: body.readFloatLE(at + 44),
    });
  }
  return {
    time: body.readDoubleLE(0),
    isEngaged: (flags & 1) !== 0,
    isOnHold: (flags & 2) !== 0,
    hasTool: (flags & 8) !== 0,
    isToolTaken: (flags & 16) !== 0,
    touched: body.readInt32LE(20),
    hip: floats(24, 3),
    proxy: floats(36, 3),
    force: floats(48, 3),
    pulses: body.readUInt32LE(64),
    cycles: body.readUInt32LE(68),
    lateCycles: body.readUInt32LE(72),
    objects,
  };
}

/// Waits until `condition` returns a truthy value, and returns it.
export async function until(condition, what, milliseconds = 15000) {
  const end = performance.now() + milliseconds;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (performance.now() > end) throw new Error(`timed out waiting for: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/// The distance of two points [m].
export function distance(a, b) {
  return Math.hypot(...a.map((value, i) => value - b[i]));
}
