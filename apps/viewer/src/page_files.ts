// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

/// A file that the page has in itself.
interface CarriedFile {
  type: string; // media type
  gzip: boolean;
  base64: string;
}

let carried: Record<string, CarriedFile> | null = null;
let isCut = false;

/// Answers all requests from these files, without a server. `json`: files by path; if it is no JSON, as the page's file
/// is cut, each request fails. To be called before the first request.
export function carryFiles(json: string): void {
  try {
    carried = JSON.parse(json) as Record<string, CarriedFile>;
  } catch {
    isCut = true;
  }
}

/// As `fetch`: of the server, or of the files that the page carries.
export async function request(path: string): Promise<Response> {
  if (isCut)
    throw new Error('This file is cut: copy it again, or write it again by pcavr replay --html.');
  if (!carried) return fetch(path);
  const file = carried[path];
  if (!file) return new Response(null, { status: 404 });
  const blob = new Blob([bytesOf(file)], { type: file.type });
  if (!file.gzip) return new Response(blob);
  return new Response(blob.stream().pipeThrough(new DecompressionStream('gzip')));
}

/// The address of a file that is not gzipped, for an element's `src`.
export function addressOf(path: string): string {
  const file = carried?.[path];
  return file ? `data:${file.type};base64,${file.base64}` : path;
}

function bytesOf({ base64 }: CarriedFile): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}
