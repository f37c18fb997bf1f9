// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { Vector3 } from 'three';
import type { App } from '../app';
import { Command, Device, type LiveState, type Quaternion, type Vector } from '../protocol';
import { Clutch } from './clutch';
import { type Hand, HandReader, type Side, toQuaternion, toVector } from './hands';
import { HandsView } from './hands_view';
import { HoldSign } from './hold_sign';
import { Moving } from './moving';
import { Panel } from './panel';
import { Person } from './person';
import { Pulses } from './pulses';
import { floorGrid, lend } from './stage';
import { floorOf, type Ground, startingPlace } from './start';

/// A person in the scene with a headset: enters, leaves, pushes, feels, moves about.
///
/// Only a hand moves the tool, only with the clutch closed, and only while everything that says
/// where the hand is can be trusted. The headset's own pose moves the picture and nothing else.
export class VrMode {
  readonly person = new Person();
  readonly clutch = new Clutch();
  private readonly reader = new HandReader();
  private readonly hands = new HandsView();
  private readonly panel = new Panel();
  private readonly sign = new HoldSign();
  private readonly pulses = new Pulses();
  private readonly moving: Moving;
  private readonly floor = floorGrid();
  private listeners: ((isPresenting: boolean) => void)[] = [];
  private xr: XRSession | undefined;
  private toolSide: Side = 'right';
  private isPlaced = false;
  private hadTool = false;
  private giveCameraBack = () => {};
  private sent: { tip: Vector; quaternion: Quaternion; device: Device } | undefined;

  constructor(
    private readonly app: App,
    private readonly ground: () => Ground,
  ) {
    this.moving = new Moving(this.person, () => this.levels());
    this.person.rig.add(this.hands.group, this.panel.mesh, this.sign.mesh);
    app.renderer.xr.setReferenceSpaceType('local-floor');
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) this.letGo('the page is hidden');
    });
    window.addEventListener('blur', () => this.letGo('the page lost the focus'));
    window.addEventListener('pagehide', () => this.letGo('the page was left'));
  }

  static async isSupported(): Promise<boolean> {
    return (await navigator.xr?.isSessionSupported('immersive-vr').catch(() => false)) ?? false;
  }

  get isPresenting(): boolean {
    return this.xr !== undefined;
  }

  /// The tool's tip as it was last sent [m], in base.
  get tip(): Vector | undefined {
    return this.sent?.tip;
  }

  /// Where the ring lies [m], in base, while a teleport is aimed.
  get teleportTarget(): Vector | undefined {
    return this.moving.target?.toArray();
  }

  onChange(listener: (isPresenting: boolean) => void): void {
    this.listeners.push(listener);
  }

  /// To be called from a click or a key: browsers want a person's own wish.
  async enter(): Promise<void> {
    if (this.xr || !navigator.xr) return;
    const xr = await navigator.xr.requestSession('immersive-vr', {
      requiredFeatures: ['local-floor'],
      optionalFeatures: ['hand-tracking', 'layers'],
    });
    xr.addEventListener('end', () => this.left());
    xr.addEventListener('visibilitychange', () => {
      if (xr.visibilityState !== 'visible') this.letGo('the headset shows something else');
    });
    xr.addEventListener('inputsourceschange', (event) => {
      if (event.removed.some((source) => source.handedness === this.toolSide)) {
        this.letGo('the controller is gone');
      }
    });
    this.isPlaced = false;
    this.pulses.reset();
    this.giveCameraBack = lend(this.app.camera, this.person.rig);
    this.app.base.add(this.person.rig, this.hands.thread, this.moving.view.group, this.floor);
    this.xr = xr;
    await this.app.renderer.xr.setSession(xr).catch(async (error: unknown) => {
      await xr.end();
      throw error;
    });
    this.listeners.forEach((listener) => listener(true));
  }

  async leave(): Promise<void> {
    await this.xr?.end();
  }

  /// Once a frame of the headset, before it is drawn. `now` in milliseconds.
  update(now: number, frame: XRFrame): void {
    const space = this.app.renderer.xr.getReferenceSpace();
    const viewer = space && frame.getViewerPose(space);
    if (!space || !viewer) {
      this.letGo('the headset does not know where it is');
      return;
    }
    const head = toVector(viewer.transform.position);
    this.sign.show(
      this.app.session.latest()?.isOnHold ?? false,
      head,
      toQuaternion(viewer.transform.orientation),
    );
    if (!this.isPlaced) this.placePerson(head);
    const hands = this.reader.read(frame, space);
    const tool = hands.find((h) => h.side === this.toolSide);
    const free = hands.find((h) => h.side !== this.toolSide);
    const state = this.app.session.latest();
    this.press(hands, tool, free, state);
    this.follow(tool, state);
    this.move(tool, free, head);
    if (state) this.pulses.update(now, state, this.clutch.isClosed ? tool?.actuator : undefined);
    this.show(now, hands, tool, free, head, state);
  }

  private placePerson(head: Vector3): void {
    const { foot, heading } = startingPlace(this.ground());
    this.person.standAt(foot, heading, head);
    this.floor.position.copy(foot);
    this.isPlaced = true;
  }

  private levels() {
    const ground = this.ground();
    return [...ground.supports, { z: floorOf(ground), outline: null }];
  }

  /// Buttons: hold and go on, reset, the other hand for the tool.
  private press(
    hands: Hand[],
    tool: Hand | undefined,
    free: Hand | undefined,
    state: LiveState | null,
  ): void {
    // The panel is beside the free hand; and a hand that leads the tool presses nothing by the way.
    const tip = free && !this.clutch.isClosed ? tool?.fingertip : undefined;
    const touched = this.panel.pressedBy(tip);
    if (touched === 'hold' || hands.some((h) => h.beginsHold)) this.toggleHold(state);
    if (touched === 'reset') this.app.session.command(Command.reset);
    if (tool?.beginsExtra && free && !this.clutch.isClosed) this.toolSide = free.side;
  }

  private toggleHold(state: LiveState | null): void {
    this.letGo('on hold');
    this.app.session.command(state?.isOnHold ? Command.goOn : Command.hold);
  }

  /// The clutch, and the tool after the hand.
  private follow(tool: Hand | undefined, state: LiveState | null): void {
    const was = this.clutch.isClosed;
    const is = this.clutch.update(tool?.isClutchHeld ?? false, this.doubt(tool, state));
    this.hadTool = is && (state?.hasTool ?? false);
    if (is && tool) {
      if (!was && !state?.hasTool) this.app.session.command(Command.take);
      const tip = this.person.toBase(tool.place);
      const turn = this.person.rotationToBase(tool.rotation);
      this.sent = {
        tip: tip.toArray(),
        quaternion: turn.toArray() as Quaternion,
        device: tool.isHand ? Device.hand : Device.controller,
      };
      this.send(true);
    } else if (was) {
      this.send(false);
    }
  }

  /// Why the tool may not follow; empty where it may.
  private doubt(tool: Hand | undefined, state: LiveState | null): string {
    if (this.app.session.connection !== 'open' || !state) return 'no connection';
    if (this.app.session.welcome?.mode === 'replay') return 'a replay is shown';
    if (state.isOnHold) return 'on hold';
    if (state.isToolTaken && !state.hasTool) return 'another page has the tool';
    if (this.clutch.isClosed && this.hadTool && !state.hasTool) return 'the world let the tool go';
    if (!tool) return 'the hand is not seen';
    if (this.xr?.visibilityState !== 'visible') return 'the headset shows something else';
    return '';
  }

  private send(isClosed: boolean): void {
    if (!this.sent) return;
    this.app.session.sendTool(this.sent.tip, this.sent.quaternion, isClosed, this.sent.device);
  }

  /// Opens the clutch at once, outside of a frame.
  private letGo(reason: string): void {
    const was = this.clutch.isClosed;
    this.clutch.open(reason);
    if (was) this.send(false);
  }

  /// The person, by the free hand, or by the only one; never while the tool is held.
  private move(tool: Hand | undefined, free: Hand | undefined, head: Vector3): void {
    if (this.clutch.isClosed) {
      this.moving.stop();
      return;
    }
    const alone = tool?.isHand ? undefined : tool;
    this.moving.update(free ?? alone, head, tool?.place ?? head);
  }

  private show(
    now: number,
    hands: Hand[],
    tool: Hand | undefined,
    free: Hand | undefined,
    head: Vector3,
    state: LiveState | null,
  ): void {
    this.hands.show(hands, this.toolSide);
    const isLed = this.clutch.isClosed && tool && state;
    this.hands.showThread(
      isLed ? this.person.toBase(tool.place).toArray() : undefined,
      isLed ? state.hip : undefined,
    );
    const beside = free ?? tool;
    this.panel.mesh.visible = beside !== undefined;
    if (beside) this.panel.placeBy(beside.place, head);
    this.panel.show(this.words(state), now);
  }

  private words(state: LiveState | null) {
    const body = state && state.touchedObject >= 0 ? state.touchedObject : undefined;
    const name = body === undefined ? undefined : this.app.session.welcome?.objects[body];
    return {
      object: name ?? (state?.touchesScan ? 'scan' : ''),
      phase: body === undefined ? '' : (state?.objects[body]?.phase ?? ''),
      force: state ? Math.hypot(...state.force) : 0,
      age: this.app.session.figures().age,
      isOnHold: state?.isOnHold ?? false,
      note: this.clutch.openedBecause,
      scale: this.person.scale,
    };
  }

  private left(): void {
    this.letGo('VR was left');
    this.app.session.command(Command.giveBack);
    this.xr = undefined;
    this.moving.stop();
    this.giveCameraBack();
    this.person.rig.removeFromParent();
    this.hands.thread.removeFromParent();
    this.moving.view.group.removeFromParent();
    this.floor.removeFromParent();
    this.listeners.forEach((listener) => listener(false));
    this.app.invalidate();
  }
}
