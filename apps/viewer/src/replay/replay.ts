// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from '../app';
import { fetchBytes, fetchJson } from '../scene/scene_model';
import { byId } from '../ui/dom';
import { eventsOf } from './events';
import { PicturePanel } from './picture_panel';
import type { Playback } from './playback';
import { PlottedObject } from './plotted_object';
import { phasesAt, poseAt, readReplay, type Replay, type ReplayModel } from './replay_data';
import { ReplayPlots } from './replay_plots';
import { Timeline } from './timeline';
import { TimelineBar } from './timeline_bar';

/// Replays a recording: the predicted bodies solid, the tracked ones as ghosts, on one timeline.
export class ReplayPlayer implements Playback {
  readonly timeline: Timeline;
  readonly picture: PicturePanel;
  private readonly bar: TimelineBar;
  private readonly plots: ReplayPlots;
  private readonly plotted: PlottedObject;

  private constructor(
    private readonly app: App,
    private readonly replay: Replay,
  ) {
    this.timeline = new Timeline(replay.model.duration);
    byId('dock', HTMLElement).hidden = false;
    this.bar = new TimelineBar(this.timeline, eventsOf(replay), app.canvas, () => this.show());
    this.plotted = new PlottedObject(replay.objects, () => this.showPlots());
    this.plots = new ReplayPlots(byId('plots', HTMLDivElement), replay, (t) => this.bar.seek(t));
    this.picture = new PicturePanel(replay.model.frames.t);
    app.playback = this;
    app.onFrame((_, seconds) => {
      if (this.timeline.advance(seconds)) this.show();
    });
    this.show();
  }

  static async load(app: App): Promise<ReplayPlayer> {
    const [model, binary] = await Promise.all([
      fetchJson<ReplayModel>('/api/replay.json'),
      fetchBytes('/api/replay.bin', () => {}),
    ]);
    return new ReplayPlayer(app, readReplay(model, binary, app.view.model?.robot?.start.length));
  }

  get time(): number {
    return this.timeline.time;
  }

  get duration(): number {
    return this.timeline.duration;
  }

  get isPlaying(): boolean {
    return this.timeline.isPlaying;
  }

  get speed(): number {
    return this.timeline.speed;
  }

  seek(time: number): void {
    this.bar.seek(time);
  }

  toggle(): void {
    this.bar.toggle();
  }

  nextSpeed(): void {
    this.bar.nextSpeed();
  }

  /// The measured force [N] on an object now.
  force(name: string): number {
    const object = this.replay.objects.find((o) => o.name === name);
    return object?.force.at(this.timeline.time)?.[1] ?? 0;
  }

  /// How far an object's prediction is from its tracking now [m]; NaN where that is not known.
  error(name: string): number {
    const object = this.replay.objects.find((o) => o.name === name);
    return object?.error.at(this.timeline.time)?.[1] ?? NaN;
  }

  private showPlots(): void {
    const object = this.plotted.at(this.timeline.time);
    if (object) this.plots.show(object);
    this.plots.setPlayhead(this.timeline.time);
  }

  private show(): void {
    const { time } = this.timeline;
    for (const object of this.replay.objects) {
      const body = this.app.view.body(object.name);
      if (!body) continue;
      const predicted = poseAt(object.predicted, time);
      const tracked = poseAt(object.tracked, time);
      if (predicted) body.place(predicted.position, predicted.quaternion);
      if (tracked) body.placeGhost(tracked.position, tracked.quaternion);
      else body.ghost.visible = false;
      body.setPhase(phasesAt(object, time).predicted, false);
    }
    const arm = this.replay.arm?.at(time);
    if (arm) this.app.view.arm?.show(arm.slice(1));
    this.showTool(time);
    this.bar.update();
    this.showPlots();
    this.picture.setTime(time);
    this.app.invalidate();
  }

  private showTool(time: number): void {
    const row = this.replay.tool.at(time);
    if (!row) return this.app.view.tool.hide();
    const [, x, y, z, fx, fy, fz] = row;
    // The recording has the force that the tool exerts; shown is the reaction, as on a live hand.
    this.app.view.showTool([x, y, z], [x, y, z], [-fx, -fy, -fz]);
  }
}
