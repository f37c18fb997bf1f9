// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The socket's own thread. Between the server and a busy window it keeps one state, the newest.
import {
  MessageType,
  protocolVersion,
  readHead,
  readJson,
  readPong,
  readState,
  readVersion,
  writeCommand,
  writeJson,
  writePing,
  writeTool,
  type Command,
  type LiveState,
  type Notice,
  type ToolSample,
  type Welcome,
} from '../protocol';
import { pageClock } from './clock';
import { ClockOffset } from './clock_offset';

export type ToWorker =
  | { kind: 'open'; url: string }
  | { kind: 'taken' } // the window has taken the state in
  | { kind: 'tool'; clock: number; sample: ToolSample }
  | { kind: 'command'; command: Command };

export type FromWorker =
  | { kind: 'state'; state: LiveState; skipped: number; clockOffset: number }
  | { kind: 'welcome'; welcome: Welcome }
  | { kind: 'notice'; notice: Notice }
  | { kind: 'connection'; connection: 'open' | 'lost' | 'refused'; reason: string };

const pingSeconds = 1;
const firstRetrySeconds = 0.5;
const maxRetrySeconds = 8;
const maxBuffered = 4096; // [bytes] not yet sent: beyond, an older tool sample is worth nothing

let url = '';
let socket: WebSocket | null = null;
let sequence = 0;
let newestSequence = 0;
let waiting: LiveState | null = null;
let isWindowBusy = false;
let skipped = 0;
let retrySeconds = firstRetrySeconds;
let isRefused = false;
let pingTimer: ReturnType<typeof setInterval> | undefined;
let offset = new ClockOffset();

const tell = (message: FromWorker) => self.postMessage(message);

self.onmessage = (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  switch (message.kind) {
    case 'open':
      url = message.url;
      connect();
      break;
    case 'taken':
      isWindowBusy = false;
      passOn();
      break;
    case 'tool':
      // To let go is never old.
      if (message.sample.clutch && socket && socket.bufferedAmount > maxBuffered) break;
      send(writeTool(++sequence, message.clock, message.sample));
      break;
    case 'command':
      send(writeCommand(++sequence, pageClock(), message.command));
  }
};

function connect(): void {
  sequence = 0;
  newestSequence = 0;
  offset = new ClockOffset();
  const opened = new WebSocket(url);
  opened.binaryType = 'arraybuffer';
  socket = opened;
  opened.onopen = () => {
    const hello = { protocol: protocolVersion, version: 'pcavr-viewer' };
    send(writeJson(MessageType.hello, ++sequence, pageClock(), hello));
    ping();
    pingTimer = setInterval(ping, pingSeconds * 1000);
  };
  opened.onmessage = (event) => receive(event.data);
  opened.onclose = (event) => closed(event.reason);
}

function send(message: ArrayBuffer): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(message);
}

function ping(): void {
  send(writePing(++sequence, pageClock()));
}

function closed(reason: string): void {
  clearInterval(pingTimer);
  waiting = null;
  if (isRefused) return;
  tell({ kind: 'connection', connection: 'lost', reason: reason || 'the server does not answer' });
  setTimeout(connect, retrySeconds * 1000);
  retrySeconds = Math.min(2 * retrySeconds, maxRetrySeconds);
}

function refuse(reason: string): void {
  isRefused = true;
  socket?.close();
  tell({ kind: 'connection', connection: 'refused', reason });
}

function receive(data: unknown): void {
  if (!(data instanceof ArrayBuffer)) return;
  const head = readHead(data);
  if (!head) {
    const version = readVersion(data);
    if (version !== null && version !== protocolVersion)
      refuse(
        `The server speaks version ${version}, this page ${protocolVersion}: reload the page.`,
      );
    return;
  }
  if (head.sequence <= newestSequence) return;
  newestSequence = head.sequence;
  switch (head.type) {
    case MessageType.welcome:
      welcome(readJson<Welcome>(data));
      break;
    case MessageType.state: {
      const state = readState(data);
      if (!state) break;
      if (waiting) ++skipped;
      waiting = state;
      passOn();
      break;
    }
    case MessageType.notice: {
      const notice = readJson<Notice>(data);
      if (notice) tell({ kind: 'notice', notice });
      break;
    }
    case MessageType.pong: {
      const sent = readPong(data);
      if (sent !== null) offset.add(sent, pageClock(), head.clock);
    }
  }
}

function welcome(message: Welcome | null): void {
  if (!message) return;
  if (message.protocol !== protocolVersion) {
    refuse(`The server speaks version ${message.protocol}, this page ${protocolVersion}: reload.`);
    return;
  }
  retrySeconds = firstRetrySeconds;
  tell({ kind: 'welcome', welcome: message });
  tell({ kind: 'connection', connection: 'open', reason: '' });
}

function passOn(): void {
  if (isWindowBusy || !waiting) return;
  isWindowBusy = true;
  tell({ kind: 'state', state: waiting, skipped, clockOffset: offset.seconds() });
  waiting = null;
  skipped = 0;
}
