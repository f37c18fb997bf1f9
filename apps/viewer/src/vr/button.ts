// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { VrMode } from './vr_mode';

/// The button that enters and leaves; grey as long as no headset is connected.
export function vrButton(vr: VrMode, onError: (words: string) => void): HTMLButtonElement {
  const button = document.createElement('button');
  button.type = 'button';
  button.id = 'vr-button';
  button.disabled = true;
  const label = (isPresenting: boolean) =>
    void (button.textContent = isPresenting ? 'Leave VR' : 'Enter VR');
  label(false);
  vr.onChange(label);
  button.addEventListener('click', () => {
    const turn = vr.isPresenting ? vr.leave() : vr.enter();
    turn.catch((error: unknown) =>
      onError(`VR: ${error instanceof Error ? error.message : error}`),
    );
  });
  const look = async () => {
    button.disabled = !(await VrMode.isSupported());
    button.title = button.disabled
      ? 'No headset is connected'
      : 'Stand in the scene with a headset';
  };
  navigator.xr?.addEventListener('devicechange', () => void look());
  void look();
  return button;
}
