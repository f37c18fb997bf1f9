// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import { hasRobotBase } from '../scene/scene_model';
import { Command, Device, type LiveState, type Quaternion, type Vector } from '../protocol';
import { BodyLabels } from './body_labels';
import { BodySizes } from './body_sizes';
import { Cards } from './cards';
import type { Gaze } from './clear_view';
import { Clutch } from './clutch';
import { type Hand, HandReader, type Side, toQuaternion, toVector } from './hands';
import { HandsView } from './hands_view';
import { Locomotion, nextScale, snapAngle } from './locomotion';
import { Panel, panelHeight, type PanelButton } from './panel';
import { playbackStep } from './panel_buttons';
import { Person } from './person';
import { Placing } from './placing';
import { Pulses } from './pulses';
import { RobotArrow } from './robot_arrow';
import { Sign } from './sign';
import { StopButton } from './stop_button';
import { attachCamera, makeFloorGrid } from './stage';
import { floorLevel, type Ground, startPose } from './start';

const takenByOther = 'another page controls the tool';
// Some twenty states; with the next frame the sign is there within 0.3 s.
const maxStateAge = 0.2; // [s]
const maxFrame = 0.15; // [s] of a frame: longer, a state is old because it is drawn late
// The server's steps of simulated over real time are 1, 0.5, 0.25 and 0.1.
const slowestTime = 0.1;
const timeSteps = 3;

/// The VR session: entering and leaving, the tool, haptic pulses, locomotion.
///
/// Only a tracked hand moves the tool, only with the clutch closed and no interlock active. The
/// headset's own pose changes the view and nothing else.
export class VrMode {
  readonly person = new Person();
  readonly clutch = new Clutch();
  readonly placing = new Placing(this.person);
  private readonly reader = new HandReader();
  private readonly hands = new HandsView();
  private readonly panel = new Panel();
  private readonly stopButton = new StopButton(panelHeight);
  private readonly cards = new Cards();
  private readonly sign = new Sign();
  private readonly robotArrow = new RobotArrow();
  private readonly sizes = new BodySizes(this.person);
  private readonly labels = new BodyLabels();
  private readonly pulses = new Pulses();
  private readonly locomotion: Locomotion;
  private readonly floor = makeFloorGrid();
  private listeners: ((isPresenting: boolean) => void)[] = [];
  private xr: XRSession | undefined;
  private toolSide: Side = 'right';
  private isPlaced = false;
  private isPassthrough = false;
  private hadTool = false;
  private restoreCamera = () => {};
  private lastUpdate = NaN; // [ms]
  private sent: { tip: Vector; quaternion: Quaternion; device: Device } | undefined;

  constructor(
    private readonly app: App,
    private readonly ground: () => Ground,
  ) {
    this.locomotion = new Locomotion(this.person, () => this.levels());
    this.person.rig.add(this.hands.group, this.panel.mesh, this.cards.group, this.sign.mesh);
    this.person.rig.add(this.labels.mesh, this.robotArrow.group);
    this.panel.mesh.add(this.stopButton.mesh);
    app.renderer.xr.setReferenceSpaceType('local-floor');
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) this.disengage('page hidden');
    });
    window.addEventListener('blur', () => this.disengage('page lost focus'));
    app.onBlind((isBlind) => isBlind && this.disengage('no picture'));
    window.addEventListener('pagehide', () => this.disengage('page closed'));
  }

  /// Where the robot stands, in base; null where the base frame is no robot's.
  private get robot(): Vector3 | null {
    const { model, arm } = this.app.view;
    if (!model || !hasRobotBase(model)) return null;
    return arm ? arm.group.position : new Vector3();
  }

  static async isSupported(kind: XRSessionMode = 'immersive-vr'): Promise<boolean> {
    return (await navigator.xr?.isSessionSupported(kind).catch(() => false)) ?? false;
  }

  get isPresenting(): boolean {
    return this.xr !== undefined;
  }

  /// The tool's tip as it was last sent [m], in base.
  get tip(): Vector | undefined {
    return this.sent?.tip;
  }

  /// The target of the teleport that is being aimed [m], in base.
  get teleportTarget(): Vector | undefined {
    return this.locomotion.target?.toArray();
  }

  onChange(listener: (isPresenting: boolean) => void): void {
    this.listeners.push(listener);
  }

  /// To be called from a click or key event: browsers require a user gesture.
  /// 'immersive-ar': the real room is seen behind the scene.
  async enter(kind: 'immersive-vr' | 'immersive-ar' = 'immersive-vr'): Promise<void> {
    if (this.xr || !navigator.xr) return;
    const xr = await navigator.xr.requestSession(kind, {
      requiredFeatures: ['local-floor'],
      optionalFeatures: ['hand-tracking', 'layers'],
    });
    xr.addEventListener('end', () => this.onSessionEnd());
    xr.addEventListener('visibilitychange', () => {
      if (xr.visibilityState !== 'visible') this.disengage('headset session not visible');
    });
    xr.addEventListener('inputsourceschange', (event) => {
      if (event.removed.some((source) => source.handedness === this.toolSide)) {
        this.disengage('controller disconnected');
      }
    });
    this.isPlaced = false;
    this.isPassthrough = kind === 'immersive-ar';
    this.placing.isActive = false;
    this.floor.visible = !this.isPassthrough;
    this.pulses.reset();
    this.restoreCamera = attachCamera(this.app.camera, this.person.rig);
    this.app.base.add(
      this.person.rig,
      this.hands.offsetLine,
      this.locomotion.view.group,
      this.floor,
    );
    this.xr = xr;
    this.lastUpdate = NaN;
    await this.app.renderer.xr.setSession(xr).catch(async (error: unknown) => {
      await xr.end();
      throw error;
    });
    this.listeners.forEach((listener) => listener(true));
  }

  async leave(): Promise<void> {
    await this.xr?.end();
  }

  /// Once per headset frame, before it is rendered. `now` in milliseconds.
  update(now: number, frame: XRFrame): void {
    const space = this.app.renderer.xr.getReferenceSpace();
    const viewer = space && frame.getViewerPose(space);
    if (!space || !viewer) {
      this.disengage('headset tracking lost');
      return;
    }
    const head = toVector(viewer.transform.position);
    const state = this.app.session.latest();
    const rotation = toQuaternion(viewer.transform.orientation);
    this.sign.show(this.trouble(state, (now - this.lastUpdate) / 1000), head, rotation);
    if (this.robot) this.robotArrow.show(this.person.toHeadset(this.robot), head, rotation);
    this.lastUpdate = now;
    if (!this.isPlaced) this.placePerson(head);
    const hands = this.reader.read(frame, space);
    const tool = hands.find((h) => h.side === this.toolSide);
    const free = hands.find((h) => h.side !== this.toolSide);
    this.handleButtons(now, hands, head, tool, free, state);
    this.updateTool(tool, state);
    this.placing.update(hands);
    this.moveUser(tool, free, head);
    if (state) this.pulses.update(now, state, this.clutch.isClosed ? tool?.actuator : undefined);
    const gaze = { head, forward: new Vector3(0, 0, -1).applyQuaternion(rotation) };
    this.show(now, hands, tool, free, gaze, state);
  }

  /// `frame`: seconds since the previous one.
  private trouble(state: LiveState | null, frame: number) {
    const { session } = this.app;
    const age = session.latencyStats().age;
    const isReplay = session.welcome?.mode === 'replay';
    // The worker notices a silent server whatever the picture does.
    const isSlow = frame > maxFrame;
    return {
      isLost:
        !isReplay && (!state || session.connection !== 'open' || (age > maxStateAge && !isSlow)),
      isSlow,
      isOutsideModel: state?.objects.some((object) => object.isOutsideModel) ?? false,
      isRefused: this.clutch.openReason === takenByOther,
      isOnHold: state?.isOnHold ?? false,
    };
  }

  private placePerson(head: Vector3): void {
    const { foot, heading } = startPose(this.ground(), head.y / this.person.scale);
    this.person.standAt(foot, heading, head);
    this.floor.position.copy(foot);
    this.isPlaced = true;
  }

  private levels() {
    const ground = this.ground();
    return [...ground.supports, floorLevel(ground)];
  }

  /// Buttons: hold and resume, reset, swap the tool hand.
  private handleButtons(
    now: number,
    hands: Hand[],
    head: Vector3,
    tool: Hand | undefined,
    free: Hand | undefined,
    state: LiveState | null,
  ): void {
    // The panel is at the free hand; a hand that moves the tool must not press its buttons.
    const tip = free && !this.clutch.isClosed ? tool?.fingertip : undefined;
    const touched = this.panel.pressedBy(tip);
    const { playback } = this.app;
    this.stopButton.mesh.visible = !playback;
    if (!playback) this.handleStop(now, tool?.fingertip, state);
    const isHoldPressed = touched === 'hold' || hands.some((h) => h.isHoldPressed);
    if (isHoldPressed && playback) playback.toggle();
    else if (isHoldPressed) this.toggleHold(state);
    const time = playback && this.panel.timeAt(tip, playback.duration);
    if (playback && typeof time === 'number') playback.seek(time);
    const isSwapped =
      (touched === 'swap' && !playback) || (tool?.isExtraPressed && !this.clutch.isClosed);
    if (isSwapped && free) this.toolSide = free.side;
    else if (touched === 'time') this.changeTimeScale(state);
    else if (touched) this.pressPanel(touched, now, head);
  }

  /// The emergency stop, also for a hand that moves the tool.
  private handleStop(now: number, tip: Vector3 | undefined, state: LiveState | null): void {
    const { session } = this.app;
    const at = tip && this.person.rig.localToWorld(tip.clone());
    const pressed = this.stopButton.update(at, state?.isStopped ?? false, now);
    if (pressed === 'release') session.command(Command.releaseStop);
    if (pressed !== 'stop') return;
    this.disengage('emergency stop');
    session.command(Command.emergencyStop);
  }

  /// The panel's other buttons: hands without a controller have no others.
  private pressPanel(button: PanelButton, now: number, head: Vector3): void {
    const { session, view, playback } = this.app;
    switch (button) {
      case 'reset':
        if (playback) playback.seek(playback.time - playbackStep);
        else if (session.latest()?.canUndoReset) session.command(Command.undoReset);
        else if (this.panel.confirmsReset(now)) session.command(Command.reset);
        break;
      case 'take':
        if (playback) playback.seek(playback.time + playbackStep);
        else this.takeOrGive(session.latest());
        break;
      case 'keep':
        session.command(Command.keep);
        break;
      case 'swap':
        playback?.nextSpeed();
        break;
      case 'place':
        this.disengage('placing the scene');
        this.placing.toggle();
        // The printed tags show where the scene belongs.
        if (this.placing.isActive) view.layers.show('tags', true);
        break;
      case 'scale':
        this.person.scaleTo(nextScale(this.person.scale), head);
        break;
      case 'recentre':
        this.placePerson(head);
        break;
      case 'scan':
        view.layers.show('mesh', !view.layers.isShown('mesh'));
        break;
      case 'turn':
        this.person.turnBy(-snapAngle, head);
        break;
      case 'leave':
        void this.leave();
    }
  }

  /// Asks for the tool or no longer asks; hands it over to who asks for it.
  private takeOrGive(state: LiveState | null): void {
    if (state?.isToolWanted) {
      this.disengage('tool handed over');
      this.app.session.command(Command.handOver);
    } else {
      this.app.session.command(state?.hasAsked ? Command.release : Command.take);
    }
  }

  /// To the next slower time; from the slowest back to real time, which the server reaches once no
  /// force acts.
  private changeTimeScale(state: LiveState | null): void {
    if (!state) return;
    const isSlowest = state.timeScale <= slowestTime;
    for (let i = 0; i < (isSlowest ? timeSteps : 1); i++)
      this.app.session.command(isSlowest ? Command.faster : Command.slower);
  }

  private toggleHold(state: LiveState | null): void {
    this.disengage('on hold');
    this.app.session.command(state?.isOnHold ? Command.resume : Command.hold);
  }

  /// Updates the clutch, and sends the hand's pose as the tool's.
  private updateTool(tool: Hand | undefined, state: LiveState | null): void {
    const was = this.clutch.isClosed;
    const is = this.clutch.update(tool?.isClutchHeld ?? false, this.interlock(tool, state));
    this.hadTool = is && (state?.hasTool ?? false);
    if (is && tool) {
      if (!was && !state?.hasTool) this.app.session.command(Command.take);
      const tip = this.person.toBase(tool.position);
      const rotation = this.person.rotationToBase(tool.rotation);
      this.sent = {
        tip: tip.toArray(),
        quaternion: rotation.toArray() as Quaternion,
        device: tool.isHand ? Device.hand : Device.controller,
      };
      this.send(true);
    } else if (was) {
      this.send(false);
    }
  }

  /// The condition that keeps the clutch open; empty if none.
  private interlock(tool: Hand | undefined, state: LiveState | null): string {
    if (this.app.session.connection !== 'open' || !state) return 'no connection';
    if (this.app.session.welcome?.mode === 'replay') return 'replay mode';
    if (state.isOnHold) return 'on hold';
    if (state.isToolTaken && !state.hasTool) return takenByOther;
    if (this.clutch.isClosed && this.hadTool && !state.hasTool) return 'server released the tool';
    if (this.placing.isActive) return 'placing: grip and move the scene';
    if (!tool) return 'hand not tracked';
    if (this.xr?.visibilityState !== 'visible') return 'headset session not visible';
    return '';
  }

  private send(isClosed: boolean): void {
    if (!this.sent) return;
    this.app.session.sendTool(this.sent.tip, this.sent.quaternion, isClosed, this.sent.device);
  }

  /// Opens the clutch at once, also between frames.
  private disengage(reason: string): void {
    const was = this.clutch.isClosed;
    this.clutch.open(reason);
    if (was) this.send(false);
  }

  /// Locomotion by the free hand, or by the only one; never while the clutch is closed.
  private moveUser(tool: Hand | undefined, free: Hand | undefined, head: Vector3): void {
    if (this.clutch.isClosed || this.placing.isActive) {
      this.locomotion.stop();
      return;
    }
    const onlyHand = tool?.isHand ? undefined : tool;
    this.locomotion.update(free ?? onlyHand, head, tool?.position ?? head);
  }

  private show(
    now: number,
    hands: Hand[],
    tool: Hand | undefined,
    free: Hand | undefined,
    gaze: Gaze,
    state: LiveState | null,
  ): void {
    this.hands.show(hands, this.toolSide);
    const isMoving = this.clutch.isClosed && tool && state;
    this.hands.showOffsetLine(
      isMoving ? this.person.toBase(tool.position).toArray() : undefined,
      isMoving ? state.hip : undefined,
    );
    const panelHand = free ?? tool;
    this.panel.mesh.visible = panelHand !== undefined;
    const { view } = this.app;
    const bodies = view.bodies.filter((body) => body.object.movable);
    const balls = bodies.map((body) => this.sizes.ball(body));
    const outward = panelHand?.side === 'right' ? 1 : -1;
    if (panelHand) this.panel.placeAbove(panelHand.position, gaze, balls, outward);
    this.cards.update(hands, this.toolSide, gaze, balls);
    this.labels.mesh.visible = view.layers.isShown('labels') && view.layers.isShown('bodies');
    this.labels.update(bodies, this.sizes, gaze.head);
    this.panel.show(this.panelText(state), now);
  }

  private panelText(state: LiveState | null) {
    const body = state && state.touchedObject >= 0 ? state.touchedObject : undefined;
    const name = body === undefined ? undefined : this.app.session.welcome?.objects[body];
    return {
      object: name ?? (state?.touchesScan ? 'scan' : ''),
      phase: body === undefined ? '' : (state?.objects[body]?.phase ?? ''),
      force: state ? Math.hypot(...state.force) : 0,
      age: this.app.session.latencyStats().age,
      isOnHold: state?.isOnHold ?? false,
      note: state?.isToolWanted ? 'another page asks for the tool' : this.clutch.openReason,
      scale: this.person.scale,
      canUndoReset: state?.canUndoReset ?? false,
      timeScale: state?.timeScale ?? 1,
      isScanShown: this.app.view.layers.isShown('mesh'),
      canTake: state !== null && state.isToolTaken && !state.hasTool,
      hasAsked: state?.hasAsked ?? false,
      isToolWanted: state?.isToolWanted ?? false,
      isPassthrough: this.isPassthrough,
      isPlacing: this.placing.isActive,
      playback: this.app.playback,
    };
  }

  private onSessionEnd(): void {
    this.disengage('VR session ended');
    this.app.session.command(Command.release);
    this.xr = undefined;
    this.placing.isActive = false;
    this.locomotion.stop();
    this.restoreCamera();
    this.person.rig.removeFromParent();
    this.hands.offsetLine.removeFromParent();
    this.locomotion.view.group.removeFromParent();
    this.floor.removeFromParent();
    this.listeners.forEach((listener) => listener(false));
    this.app.invalidate();
  }
}
