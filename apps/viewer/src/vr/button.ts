// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { VrMode } from './vr_mode';

/// The button that shows the scene in the real room; hidden where the headset cannot.
export function passthroughButton(vr: VrMode, onError: (text: string) => void): HTMLButtonElement {
  const button = document.createElement('button');
  button.type = 'button';
  button.id = 'passthrough-button';
  button.textContent = 'Enter room';
  button.title = 'Show the scene in the real room (passthrough), to be placed by hand';
  button.hidden = true;
  button.addEventListener('click', () => {
    vr.enter('immersive-ar').catch((error: unknown) =>
      onError(`Passthrough: ${error instanceof Error ? error.message : error}`),
    );
  });
  let isSupported = false;
  const show = () => void (button.hidden = !isSupported || vr.isPresenting);
  const checkSupport = async () => {
    isSupported = await VrMode.isSupported('immersive-ar');
    show();
  };
  vr.onChange(show);
  navigator.xr?.addEventListener('devicechange', () => void checkSupport());
  void checkSupport();
  return button;
}

/// The button that enters and leaves VR; disabled while no headset is connected.
export function vrButton(vr: VrMode, onError: (text: string) => void): HTMLButtonElement {
  const button = document.createElement('button');
  button.type = 'button';
  button.id = 'vr-button';
  button.disabled = true;
  const label = (isPresenting: boolean) =>
    void (button.textContent = isPresenting ? 'Leave VR' : 'Enter VR');
  label(false);
  vr.onChange(label);
  button.addEventListener('click', () => {
    const change = vr.isPresenting ? vr.leave() : vr.enter();
    change.catch((error: unknown) =>
      onError(`VR: ${error instanceof Error ? error.message : error}`),
    );
  });
  const checkSupport = async () => {
    button.disabled = !(await VrMode.isSupported());
    button.title = button.disabled ? 'No headset is connected' : 'Show the scene in the headset';
  };
  navigator.xr?.addEventListener('devicechange', () => void checkSupport());
  void checkSupport();
  return button;
}
