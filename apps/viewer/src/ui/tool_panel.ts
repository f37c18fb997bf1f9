// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import type { App } from '../app';
import type { DesktopTool } from '../input/desktop_tool';
import { Command } from '../protocol';
import { byId, setPressed, setText } from './dom';
import { moveTo, project } from './labels';

/// The tool's buttons, and the ring to drag it by.
export class ToolPanel {
  private readonly section = byId('tool-section', HTMLElement);
  private readonly owner = byId('tool-owner', HTMLParagraphElement);
  private readonly take = byId('take', HTMLButtonElement);
  private readonly giveBack = byId('give-back', HTMLButtonElement);
  private readonly hold = byId('hold', HTMLButtonElement);
  private readonly clutch = byId('clutch', HTMLButtonElement);

  constructor(
    private readonly app: App,
    private readonly tool: DesktopTool,
    private readonly handle: HTMLButtonElement,
  ) {
    const { session } = app;
    this.section.hidden = false;
    this.take.addEventListener('click', () => session.command(Command.take));
    this.giveBack.addEventListener('click', () => {
      tool.letGo();
      session.command(Command.giveBack);
    });
    this.hold.addEventListener('click', () => this.toggleHold());
    this.clutch.addEventListener('click', () => {
      tool.isClutchLocked = !tool.isClutchLocked;
      if (tool.isClutchLocked) app.canvas.focus();
    });
    byId('reset', HTMLButtonElement).addEventListener('click', () => {
      tool.letGo();
      session.command(Command.reset);
    });
    const plane = byId('drag-plane', HTMLSelectElement);
    plane.addEventListener('change', () => (tool.planeKind = plane.value as 'level' | 'view'));
    // The ring lies over the scene, and passes on what is meant for it.
    handle.addEventListener('wheel', (event) =>
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
    setText(
      this.owner,
      !state
        ? ''
        : state.hasTool
          ? 'This page has the tool.'
          : isTakenByOther
            ? 'Another page has the tool.'
            : 'Nobody has the tool.',
    );
    this.take.disabled = !state || state.isToolTaken;
    this.giveBack.disabled = !state?.hasTool;
    this.hold.disabled = !state;
    setPressed(this.hold, state?.isOnHold ?? false);
    setPressed(this.clutch, this.tool.isClutchLocked);
    this.handle.classList.toggle('held', this.tool.isHeld);
    this.handle.classList.toggle('denied', isTakenByOther || (state?.isOnHold ?? false));
    this.placeHandle();
  }

  private toggleHold(): void {
    const state = this.app.session.latest();
    if (state) this.app.session.command(state.isOnHold ? Command.goOn : Command.hold);
  }

  private placeHandle(): void {
    const { view, canvas, renderer } = this.app;
    const at = project(
      view.tool.proxy.getWorldPosition(new Vector3()),
      view.camera,
      canvas.clientWidth,
      canvas.clientHeight,
    );
    const isShown = view.tool.group.visible && at !== null && !renderer.xr.isPresenting;
    // A handle that is dragged stays, or the drag would end with it.
    this.handle.hidden = !isShown && !this.tool.isHeld;
    if (at && isShown) moveTo(this.handle, at.x, at.y);
  }
}
