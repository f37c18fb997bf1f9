// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Command, Device, LiveState, Notice, Quaternion, Vector, Welcome } from '../protocol';
import { Latency, type LatencyFigures } from './latency';
import { pageClock } from './clock';
import type { FromWorker, ToWorker } from './socket_worker';

export type Connection = 'connecting' | 'open' | 'lost' | 'refused';

/// The window's side of the socket: the newest state, and what goes to the world.
///
/// The socket lives in a worker, which sends one state at a time and the next only when this one
/// was taken in: a window that draws slowly misses states, and never sees an old one.
export class Session {
  readonly latency = new Latency();
  connection: Connection = 'connecting';
  welcome: Welcome | null = null;
  skipped = 0; // states that were never taken in, as newer ones came
  private state: LiveState | null = null;
  private worker: Worker;
  private welcomeListeners: ((welcome: Welcome) => void)[] = [];
  private noticeListeners: ((notice: Notice) => void)[] = [];
  private connectionListeners: ((connection: Connection, reason: string) => void)[] = [];

  constructor(url: string) {
    this.worker = new Worker(new URL('./socket_worker.ts', import.meta.url), { type: 'module' });
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    this.post({ kind: 'open', url });
  }

  /// The newest state; null before the first, and where the connection is lost.
  latest(): LiveState | null {
    return this.state;
  }

  /// Says where the hand is: `tip` [m] in base. To be called once a frame while the clutch is held,
  /// and once more when it was let go.
  sendTool(tip: Vector, quaternion: Quaternion, clutch: boolean, device: Device): void {
    this.post({ kind: 'tool', clock: pageClock(), sample: { tip, quaternion, clutch, device } });
  }

  command(command: Command): void {
    this.post({ kind: 'command', command });
  }

  /// To be called when a frame with the newest state has been drawn.
  drawn(): void {
    if (this.state) this.latency.drawn(this.state, pageClock());
  }

  figures(): LatencyFigures {
    return this.latency.figures(pageClock());
  }

  onWelcome(listener: (welcome: Welcome) => void): void {
    this.welcomeListeners.push(listener);
  }

  onNotice(listener: (notice: Notice) => void): void {
    this.noticeListeners.push(listener);
  }

  onConnection(listener: (connection: Connection, reason: string) => void): void {
    this.connectionListeners.push(listener);
  }

  private receive(message: FromWorker): void {
    switch (message.kind) {
      case 'state':
        this.post({ kind: 'taken' });
        this.state = message.state;
        this.skipped += message.skipped;
        this.latency.received(message.state, pageClock(), message.clockOffset);
        break;
      case 'welcome':
        this.welcome = message.welcome;
        this.welcomeListeners.forEach((listener) => listener(message.welcome));
        break;
      case 'notice':
        this.noticeListeners.forEach((listener) => listener(message.notice));
        break;
      case 'connection':
        this.connection = message.connection;
        if (message.connection !== 'open') this.state = null;
        this.connectionListeners.forEach((l) => l(message.connection, message.reason));
    }
  }

  private post(message: ToWorker): void {
    this.worker.postMessage(message);
  }
}
