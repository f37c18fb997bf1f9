// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from '../app';
import { byId, create, setPressed, setText } from './dom';
import { drawCaption, type Caption } from './video_caption';

const rate = 30; // [Hz] at most: of what is drawn
const bitRate = 8e6; // [bit/s]: the edges of bodies stay sharp at 1920 x 1080
const kinds = [
  { type: 'video/mp4;codecs=avc1.640028', extension: 'mp4' },
  { type: 'video/webm;codecs=vp9', extension: 'webm' },
  { type: 'video/webm', extension: 'webm' },
];

/// Records what the view shows, with a caption, from one press of its button to the next, and saves it
/// as NAME.mp4, or NAME.webm where the browser has no H.264.
export class ViewVideo {
  private readonly button = byId('save-video', HTMLButtonElement);
  private readonly canvas = create('canvas');
  private recorder: MediaRecorder | null = null;

  constructor(
    private readonly app: App,
    private readonly name: string,
    private readonly caption: () => Caption,
  ) {
    this.button.addEventListener('click', () => (this.recorder ? this.stop() : this.start()));
    app.onFrame(() => {
      if (this.recorder) app.invalidate(); // the caption's time goes on where nothing moves
    });
    app.onDrawn(() => {
      if (this.recorder) this.draw();
    });
  }

  private start(): void {
    const kind = kinds.find(({ type }) => window.MediaRecorder?.isTypeSupported(type));
    if (!kind)
      return this.app.notify({ level: 'error', text: 'This browser does not record videos.' });
    const { width, height } = this.app.canvas;
    // H.264 needs even sides.
    Object.assign(this.canvas, { width: width & ~1, height: height & ~1 });
    const options = { mimeType: kind.type, videoBitsPerSecond: bitRate };
    const stream = this.canvas.captureStream(rate);
    const recorder = new MediaRecorder(stream, options);
    const parts: Blob[] = [];
    recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
    recorder.addEventListener('error', () =>
      this.app.notify({ level: 'error', text: 'The browser could not record the video.' }),
    );
    recorder.addEventListener('stop', () => {
      for (const track of stream.getTracks()) track.stop();
      if (this.recorder === recorder) this.stop(); // the browser has ended it
      const video = new Blob(parts, { type: kind.type });
      if (video.size > 0) this.save(video, kind);
    });
    recorder.start();
    this.recorder = recorder;
    this.showButton();
    this.app.invalidate();
  }

  private stop(): void {
    if (this.recorder?.state === 'recording') this.recorder.stop();
    this.recorder = null;
    this.showButton();
  }

  private showButton(): void {
    setPressed(this.button, this.recorder !== null);
    setText(this.button, this.recorder ? 'Stop and save' : 'Record video');
  }

  private save(video: Blob, { extension }: { extension: string }): void {
    const url = URL.createObjectURL(video);
    create('a', { href: url, download: `${this.name || 'scene'}.${extension}` }).click();
    setTimeout(() => URL.revokeObjectURL(url));
  }

  /// The view in the size at the start, also after the window's size has changed.
  private draw(): void {
    const pen = this.canvas.getContext('2d')!;
    const { width, height } = this.canvas;
    pen.drawImage(this.app.canvas, 0, 0, width, height);
    drawCaption(pen, this.caption(), this.app.canvas.width / this.app.canvas.clientWidth);
  }
}
