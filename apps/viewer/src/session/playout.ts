// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

const windowSeconds = 2; // the oldest arrival that counts for the delay
const ageSeconds = 0.02; // younger samples are played at once: a timer of 8 ms that is a little late
const maxDelay = 0.95; // [s] for pictures of 2 Hz; older samples are of a window that hung
const slack = 0.03; // [s] the delay does not follow the time of each frame
const catchUp = 0.1; // of the time: the delay falls no faster, so that the tip goes 10 % faster at most

interface Stamped<Sample> {
  clock: number; // [s]
  sample: Sample;
}

/// Plays the samples of a hand as it moved, where a window that is busy drawing sends them late and
/// many at once: each is due the same delay after its time. The delay is the age of the oldest sample
/// that arrived lately: none while all come in time. In order of their times; none is left out.
export class Playout<Sample> {
  private queue: Stamped<Sample>[] = [];
  private arrivals: { at: number; age: number }[] = []; // with falling age
  private current = 0; // [s]
  private lastUpdate = NaN; // [s]

  /// [s] From a sample's time to when it is played.
  get delay(): number {
    return this.current;
  }

  /// A sample of the time `clock` [s] that has arrived at `now` [s].
  add(now: number, clock: number, sample: Sample): void {
    const age = now - clock;
    if (age > ageSeconds && age <= maxDelay) this.note(now, age);
    this.queue.push({ clock, sample });
  }

  /// The samples that are due at `now` [s], with the times at which they are played.
  take(now: number): Stamped<Sample>[] {
    this.update(now);
    const isLater = ({ clock }: Stamped<Sample>) => clock + this.current > now;
    const first = this.queue.findIndex(isLater);
    const due = this.queue.splice(0, first < 0 ? this.queue.length : first);
    return due.map(({ clock, sample }) => ({ clock: clock + this.current, sample }));
  }

  /// Forgets what is not played yet.
  clear(): void {
    this.queue = [];
  }

  private note(at: number, age: number): void {
    while (this.arrivals.length > 0 && this.arrivals[this.arrivals.length - 1]!.age <= age)
      this.arrivals.pop();
    this.arrivals.push({ at, age });
  }

  private update(now: number): void {
    while (this.arrivals.length > 0 && this.arrivals[0]!.at < now - windowSeconds)
      this.arrivals.shift();
    const needed = this.arrivals[0]?.age ?? 0;
    const seconds = Number.isFinite(this.lastUpdate) ? now - this.lastUpdate : 0;
    if (needed > this.current) this.current = needed + slack / 2;
    else if (needed === 0 || needed < this.current - slack)
      this.current = Math.max(needed, this.current - catchUp * seconds);
    this.lastUpdate = now;
  }
}
