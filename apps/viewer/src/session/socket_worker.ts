// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The socket's worker thread. It buffers one state for a busy window, the newest (backpressure).
import {
  MessageType,
  protocolVersion,
  readHeader,
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
import { Playout } from './playout';

export type ToWorker =
  | { kind: 'open'; url: string }
  | { kind: 'acknowledge' } // the window has read the state
  | { kind: 'tool'; clock: number; sample: ToolSample }
  | { kind: 'open_clutch' } // at once
  | { kind: 'command'; command: Command };

export type FromWorker =
  | { kind: 'state'; state: LiveState; skipped: number; clockOffset: number; toolDelay: number }
  | { kind: 'welcome'; welcome: Welcome }
  | { kind: 'notice'; notice: Notice }
  | { kind: 'connection'; connection: 'open' | 'lost' | 'refused'; reason: string };

const pingSeconds = 1;
const firstRetrySeconds = 0.5;
const maxRetrySeconds = 1; // exponential backoff up to here: a restarted server is back in 2 s
// States come 60 to 90 times a second; with the time to the next check and frame below 0.5 s.
const stallSeconds = 0.35;
const firstStateSeconds = 2; // longer: the page of a loaded machine has just begun
const stallCheckSeconds = 0.05;
const maxBuffered = 4096; // [bytes] not yet sent: above, tool samples are dropped instead of queued

const playSeconds = 0.004; // between two looks for samples that are due
const repeatSeconds = 0.03; // a window that samples its pointer sends four times as often
const minStampStep = 1e-4; // [s]
const maxHeldSeconds = 1; // longer: the window hangs, and the server opens the clutch
let url = '';
let socket: WebSocket | null = null;
let sequence = 0;
let newestSequence = 0;
let pendingState: LiveState | null = null;
let isAwaitingAck = false;
let skipped = 0;
let retrySeconds = firstRetrySeconds;
let isRejected = false;
let pingTimer: ReturnType<typeof setInterval> | undefined;
let offset = new ClockOffset();
let lastState: number | null = null; // [s] when one was received on this connection
let isStalled = false;

const playout = new Playout<ToolSample>();
let heldSample: ToolSample | null = null; // the newest that was played, with the clutch closed
let heldSince = 0; // [s]
let lastToolSent = 0; // [s]
setInterval(play, 1000 * playSeconds);
setInterval(repeatHeld, 1000 * repeatSeconds);

const post = (message: FromWorker) => self.postMessage(message);

self.onmessage = (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  switch (message.kind) {
    case 'open':
      url = message.url;
      connect();
      break;
    case 'acknowledge':
      isAwaitingAck = false;
      forwardState();
      break;
    case 'tool':
      playout.add(pageClock(), message.clock, message.sample);
      play();
      break;
    case 'open_clutch':
      playout.clear();
      if (heldSample) sendTool(pageClock(), { ...heldSample, clutch: false });
      break;
    case 'command':
      send(writeCommand(++sequence, pageClock(), message.command));
  }
};

function connect(): void {
  sequence = 0;
  newestSequence = 0;
  offset = new ClockOffset();
  lastState = null;
  isStalled = false;
  heldSample = null;
  playout.clear();
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
  opened.onclose = (event) => reconnect(event.reason);
}

/// A server that hangs or cannot be reached keeps its socket open for long: only the states show it.
setInterval(() => {
  if (lastState === null || isStalled || pageClock() - lastState < stallSeconds) return;
  isStalled = true;
  pendingState = null;
  post({ kind: 'connection', connection: 'lost', reason: 'no state from the server' });
}, stallCheckSeconds * 1000);

function recordState(): void {
  lastState = pageClock();
  if (!isStalled) return;
  isStalled = false;
  post({ kind: 'connection', connection: 'open', reason: '' });
}

function send(message: ArrayBuffer): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(message);
}

function play(): void {
  for (const { clock, sample } of playout.take(pageClock())) {
    // A sample that opens the clutch is never dropped.
    if (sample.clutch && socket && socket.bufferedAmount > maxBuffered) continue;
    sendTool(clock, sample);
  }
}

function sendTool(clock: number, sample: ToolSample): void {
  heldSample = sample.clutch ? sample : null;
  heldSince = pageClock();
  // Newer than a repetition that was sent while this sample was on its way from the window.
  lastToolSent = Math.max(clock, lastToolSent + minStampStep);
  send(writeTool(++sequence, lastToolSent, sample));
}

/// A window that is busy drawing sends nothing: the hand is where it was, and the clutch stays closed.
function repeatHeld(): void {
  const now = pageClock();
  if (!heldSample || now - lastToolSent < repeatSeconds || now - heldSince > maxHeldSeconds) return;
  if (socket && socket.bufferedAmount > maxBuffered) return;
  lastToolSent = now;
  send(writeTool(++sequence, now, heldSample));
}

function ping(): void {
  send(writePing(++sequence, pageClock()));
}

function reconnect(reason: string): void {
  clearInterval(pingTimer);
  lastState = null;
  pendingState = null;
  if (isRejected) return;
  post({ kind: 'connection', connection: 'lost', reason: reason || 'no response from the server' });
  setTimeout(connect, retrySeconds * 1000);
  retrySeconds = Math.min(2 * retrySeconds, maxRetrySeconds);
}

function rejectServer(reason: string): void {
  isRejected = true;
  socket?.close();
  post({ kind: 'connection', connection: 'refused', reason });
}

function receive(data: unknown): void {
  if (!(data instanceof ArrayBuffer)) return;
  const header = readHeader(data);
  if (!header) {
    const version = readVersion(data);
    if (version !== null && version !== protocolVersion) rejectServer(versionMismatch(version));
    return;
  }
  if (header.sequence <= newestSequence) return;
  newestSequence = header.sequence;
  switch (header.type) {
    case MessageType.welcome:
      acceptWelcome(readJson<Welcome>(data));
      break;
    case MessageType.state: {
      const state = readState(data);
      if (!state) return rejectServer('The server sends states of another layout: reload.');
      recordState();
      if (pendingState) ++skipped;
      pendingState = state;
      forwardState();
      break;
    }
    case MessageType.notice: {
      const notice = readJson<Notice>(data);
      if (notice) post({ kind: 'notice', notice });
      break;
    }
    case MessageType.pong: {
      const sent = readPong(data);
      if (sent !== null) offset.add(sent, pageClock(), header.clock);
    }
  }
}

function versionMismatch(version: number): string {
  return `The server uses protocol version ${version}, this page ${protocolVersion}: reload.`;
}

function acceptWelcome(message: Welcome | null): void {
  if (!message) return;
  if (message.protocol !== protocolVersion) {
    rejectServer(versionMismatch(message.protocol));
    return;
  }
  retrySeconds = firstRetrySeconds;
  if (message.mode === 'live') lastState = pageClock() + firstStateSeconds - stallSeconds;
  post({ kind: 'welcome', welcome: message });
  post({ kind: 'connection', connection: 'open', reason: '' });
}

function forwardState(): void {
  if (isAwaitingAck || !pendingState) return;
  isAwaitingAck = true;
  const toolDelay = playout.delay;
  // As the window stamped it.
  pendingState.toolClock -= toolDelay;
  post({ kind: 'state', state: pendingState, skipped, clockOffset: offset.seconds(), toolDelay });
  pendingState = null;
  skipped = 0;
}
