// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { request } from '../page_files';
import type { LiveState, Welcome } from '../protocol';

const key = 'pcavr-reloaded'; // the announcement kept over a reload

/// Compares the server after a reconnect with that before it: with another scene, mode or version
/// the page is reloaded, and says so; a world that has started again is announced.
export class RestartCheck {
  private first: Welcome | null = null;
  private isReconnected = false; // and no state received since
  private worldTime = -Infinity; // [s]
  private scene: Promise<string> = sceneText();

  constructor(private readonly announce: (text: string) => void) {
    const text = takeStored();
    if (text) announce(text);
  }

  async onWelcome(welcome: Welcome): Promise<void> {
    const { first } = this;
    this.first = welcome;
    if (!first) return;
    this.isReconnected = true;
    const what = (await this.hasOtherScene())
      ? `the scene "${welcome.scene}"`
      : differenceOf(first, welcome);
    if (!what) return;
    store(`The server was restarted with ${what}: the page was loaded again.`);
    location.reload();
  }

  onState({ worldTime }: LiveState): void {
    if (this.isReconnected && worldTime < this.worldTime)
      this.announce('The server was restarted: the bodies are at their start.');
    this.isReconnected = false;
    this.worldTime = worldTime;
  }

  private async hasOtherScene(): Promise<boolean> {
    const before = await this.scene;
    const now = await sceneText();
    return now !== '' && before !== '' && now !== before;
  }
}

/// What a server does differently; empty if nothing.
export function differenceOf(before: Welcome, now: Welcome): string {
  if (now.scene !== before.scene) return `the scene "${now.scene}"`;
  if (now.mode !== before.mode) return now.mode === 'replay' ? 'a replay' : 'a live world';
  if (now.objects.join('\n') !== before.objects.join('\n')) return 'other objects';
  return now.version === before.version ? '' : `version ${now.version}`;
}

/// Empty without an answer.
async function sceneText(): Promise<string> {
  try {
    const response = await request('/api/scene.json');
    return response.ok ? await response.text() : '';
  } catch {
    return '';
  }
}

function store(text: string): void {
  try {
    sessionStorage.setItem(key, text);
  } catch {
    // Storage is blocked: the page is loaded again without a word.
  }
}

function takeStored(): string | null {
  try {
    const text = sessionStorage.getItem(key);
    sessionStorage.removeItem(key);
    return text;
  } catch {
    return null;
  }
}
