// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import type { DesktopTool } from '../input/desktop_tool';
import { Command, type LiveState } from '../protocol';
import { CallToAction } from './call_to_action';
import { byId, setPressed, setText } from './dom';
import { moveTo, project } from './labels';
import { SessionRecording } from './session_recording';
import { ToolRequest } from './tool_request';

/// The tool's buttons, its drag handle (the ring), and the handle for its height.
export class ToolPanel {
  private readonly section = byId('tool-section', HTMLElement);
  private readonly owner = byId('tool-owner', HTMLParagraphElement);
  private readonly take = byId('take', HTMLButtonElement);
  private readonly release = byId('release', HTMLButtonElement);
  private readonly hold = byId('hold', HTMLButtonElement);
  private readonly undo = byId('undo-reset', HTMLButtonElement);
  private readonly speed = byId('time-scale', HTMLOutputElement);
  private readonly clutch = byId('clutch', HTMLButtonElement);
  private readonly callToAction: CallToAction;
  private readonly request: ToolRequest;
  private readonly recording: SessionRecording;

  constructor(
    private readonly app: App,
    private readonly tool: DesktopTool,
    private readonly handle: HTMLButtonElement,
    private readonly heightHandle: HTMLButtonElement,
  ) {
    const { session } = app;
    this.section.hidden = false;
    this.callToAction = new CallToAction(app.view.bodies.some((body) => body.object.movable));
    this.request = new ToolRequest(session, () => tool.disengage());
    this.recording = new SessionRecording(session);
    this.take.addEventListener('click', () => {
      // A request stays until it is withdrawn.
      session.command(session.latest()?.hasAsked ? Command.release : Command.take);
    });
    this.release.addEventListener('click', () => {
      tool.disengage();
      tool.forgetHeight();
      session.command(Command.release);
    });
    this.hold.addEventListener('click', () => this.toggleHold());
    for (const name of ['slower', 'faster'] as const)
      byId(name, HTMLButtonElement).addEventListener('click', () => session.command(Command[name]));
    this.clutch.addEventListener('click', () => {
      tool.isClutchLocked = !tool.isClutchLocked;
      if (tool.isClutchLocked) app.canvas.focus();
    });
    byId('reset', HTMLButtonElement).addEventListener('click', () => {
      tool.disengage();
      tool.forgetHeight();
      session.command(Command.reset);
    });
    this.undo.addEventListener('click', () => {
      tool.disengage();
      session.command(Command.undoReset);
    });
    const plane = byId('drag-plane', HTMLSelectElement);
    plane.addEventListener('change', () => (tool.planeKind = plane.value as 'horizontal' | 'view'));
    // The handles cover part of the canvas, and forward its wheel events.
    for (const element of [handle, heightHandle])
      element.addEventListener('wheel', (event) =>
        app.canvas.dispatchEvent(new WheelEvent('wheel', event)),
      );
    for (const element of [app.canvas, handle] as HTMLElement[])
      element.addEventListener('keydown', (event) => {
        if (event.code === 'KeyH' && !event.repeat) this.toggleHold();
      });
  }

  /// Once a drawn frame.
  update(): void {
    const state = this.app.session.latest();
    const isTakenByOther = state !== null && state.isToolTaken && !state.hasTool;
    setText(this.owner, state ? ownerText(state) : '');
    setText(this.take, takeText(state, isTakenByOther));
    this.take.disabled = !state || state.hasTool;
    this.request.update(state);
    this.recording.update(state, this.app.session.welcome?.can_record ?? false);
    this.release.disabled = !state?.hasTool;
    this.hold.disabled = !state;
    this.undo.hidden = !state?.canUndoReset || isTakenByOther;
    setPressed(this.hold, state?.isOnHold ?? false);
    setText(this.speed, `${Math.round(100 * (state?.timeScale ?? 1))} %`);
    setText(this.hold, state?.isOnHold ? 'Continue' : 'Pause');
    setPressed(this.clutch, this.tool.isClutchLocked);
    this.handle.classList.toggle('engaged', this.tool.isEngaged);
    this.handle.classList.toggle('denied', isTakenByOther || (state?.isOnHold ?? false));
    this.callToAction.update(state, this.placeHandle(), this.tool.misses.text);
  }

  private toggleHold(): void {
    const state = this.app.session.latest();
    if (state) this.app.session.command(state.isOnHold ? Command.resume : Command.hold);
  }

  /// The ring's centre on the stage; null while it is not shown.
  private placeHandle(): { x: number; y: number } | null {
    const { view, canvas, renderer } = this.app;
    const at = project(
      view.tool.proxy.getWorldPosition(new Vector3()),
      view.camera,
      canvas.clientWidth,
      canvas.clientHeight,
    );
    const isShown = view.tool.group.visible && at !== null && !renderer.xr.isPresenting;
    // Hiding the handle during a drag would end the drag.
    for (const element of [this.handle, this.heightHandle])
      element.hidden = !isShown && !this.tool.isEngaged;
    if (!at || !isShown) return null;
    for (const element of [this.handle, this.heightHandle]) moveTo(element, at.x, at.y);
    return at;
  }
}

function ownerText(state: LiveState): string {
  if (state.hasTool) return 'You are using the tool.';
  if (state.hasAsked) return 'Asked for the tool: waiting for the page that has it.';
  if (state.isToolTaken) return 'Another page uses the tool.';
  return 'The tool is free: drag its ring.';
}

function takeText(state: LiveState | null, isTakenByOther: boolean): string {
  if (state?.hasAsked) return 'Stop asking';
  return isTakenByOther ? 'Ask for the tool' : 'Use the tool';
}
