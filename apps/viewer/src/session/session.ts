// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Command, Device, LiveState, Notice, Quaternion, Vector, Welcome } from '../protocol';
import { Latency, type LatencyStats } from './latency';
import { pageClock } from './clock';
import type { FromWorker, ToWorker } from './socket_worker';

export type Connection = 'connecting' | 'open' | 'lost' | 'refused';

/// The window's side of the socket: receives the newest state, sends tool samples and commands.
///
/// The socket runs in a worker with backpressure: it posts one state at a time, and the next only
/// after this one was acknowledged. A window that draws slowly skips states, and never gets an old
/// one.
export class Session {
  readonly latency = new Latency();
  connection: Connection = 'connecting';
  welcome: Welcome | null = null;
  toolDelay = 0; // [s] from a motion of the hand to when the server gets it: of a busy window
  skipped = 0; // states replaced by newer ones before the window read them
  private state: LiveState | null = null;
  private welcomeListeners: ((welcome: Welcome) => void)[] = [];
  private noticeListeners: ((notice: Notice) => void)[] = [];
  private connectionListeners: ((connection: Connection, reason: string) => void)[] = [];

  /// `worker`: of socket_worker.ts; null where there is no server, and never a state.
  constructor(
    private readonly worker: Worker | null,
    url = '',
  ) {
    if (!worker) return;
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    this.post({ kind: 'open', url });
  }

  /// The newest state; null before the first, and while the connection is lost.
  latest(): LiveState | null {
    return this.state;
  }

  /// Sends the hand's pose at the time `clock` [s of the page's clock]: `tip` [m] in base. To be
  /// called while the clutch is closed, and once more when it has opened. A sample that is late is
  /// played as much later as others are: `toolDelay`.
  sendTool(
    tip: Vector,
    quaternion: Quaternion,
    clutch: boolean,
    device: Device,
    clock = pageClock(),
  ): void {
    this.post({ kind: 'tool', clock, sample: { tip, quaternion, clutch, device } });
  }

  /// Opens the clutch at once: what was sent before and is not played yet is forgotten.
  openClutch(): void {
    this.post({ kind: 'open_clutch' });
  }

  command(command: Command): void {
    this.post({ kind: 'command', command });
  }

  /// To be called when a frame with the newest state has been drawn.
  recordDrawn(): void {
    if (this.state) this.latency.recordDrawn(this.state, pageClock());
  }

  latencyStats(): LatencyStats {
    return this.latency.stats(pageClock());
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
        this.post({ kind: 'acknowledge' });
        this.state = message.state;
        this.skipped += message.skipped;
        this.toolDelay = message.toolDelay;
        this.latency.recordReceived(message.state, pageClock(), message.clockOffset);
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
    this.worker?.postMessage(message);
  }
}
