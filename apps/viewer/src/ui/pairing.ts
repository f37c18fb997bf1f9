// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import { fetchJson, type SessionInfo } from '../scene/scene_model';
import { byId } from './dom';

/// Asks for the pairing code until the server accepts it; returns at once if already paired.
export async function pair(): Promise<SessionInfo> {
  const offered = takeCodeOfLink();
  const session = await fetchJson<SessionInfo>('/api/session');
  if (session.paired) return session;
  if (offered !== null && (await tryCode(offered)) === '')
    return fetchJson<SessionInfo>('/api/session');
  const dialog = byId('pairing', HTMLDialogElement);
  const code = byId('pairing-code', HTMLInputElement);
  const error = byId('pairing-error', HTMLParagraphElement);
  dialog.oncancel = (event) => event.preventDefault();
  if (!dialog.open) dialog.showModal();
  return new Promise((resolve) => {
    byId('pairing-form', HTMLFormElement).onsubmit = async (event) => {
      event.preventDefault();
      error.textContent = await tryCode(code.value.trim());
      if (error.textContent !== '') return code.select();
      dialog.close();
      resolve(await fetchJson<SessionInfo>('/api/session'));
    };
  });
}

/// Shows the QR code of this page's address with the pairing code, once it is asked for.
export function offerOtherDevice({ code_picture }: SessionInfo): void {
  const details = byId('other-device', HTMLDetailsElement);
  details.hidden = !code_picture;
  const picture = details.querySelector('img')!;
  picture.addEventListener('load', () => details.scrollIntoView());
  details.addEventListener('toggle', () => {
    if (details.open) picture.src = '/api/code.svg';
  });
}

/// The code of the address that the server's QR code has; removed from it, as links are passed on.
function takeCodeOfLink(): string | null {
  const fields = new URLSearchParams(location.hash.slice(1));
  const code = fields.get('code');
  if (code === null) return null;
  fields.delete('code');
  const rest = `${fields}` === '' ? '' : `#${fields}`;
  history.replaceState(null, '', location.pathname + location.search + rest);
  return code;
}

/// Sends the code; returns the error message, empty on success.
async function tryCode(code: string): Promise<string> {
  try {
    const headers = { 'content-type': 'application/json' };
    const body = JSON.stringify({ code });
    const { ok, status } = await fetch('/api/pair', { method: 'POST', headers, body });
    if (ok) return '';
    if (status === 429) return 'Too many attempts: wait one minute.';
    return status === 403 ? 'Wrong code.' : `Pairing failed: HTTP status ${status}.`;
  } catch {
    return 'No response from the server.';
  }
}
