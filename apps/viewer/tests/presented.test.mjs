// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// When a frame counts as drawn, measured from outside: by the browser's trace, whose times are the
// system's CLOCK_MONOTONIC and not the page's clock.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { loaded } from './support/drawn.mjs';
import { limit, setStage } from './support/stage.mjs';

const stage = setStage();
const frameCategory = 'disabled-by-default-devtools.timeline.frame';

/// The events of the browser's trace over `duration` [ms].
async function trace(page, duration) {
  const session = await page.context().newCDPSession(page);
  const events = [];
  session.on('Tracing.dataCollected', ({ value }) => events.push(...value));
  const complete = new Promise((resolve) => session.once('Tracing.tracingComplete', resolve));
  const categories = `blink.user_timing,cc,benchmark,${frameCategory}`;
  await session.send('Tracing.start', { categories, transferMode: 'ReportEvents' });
  await page.waitForTimeout(duration);
  await session.send('Tracing.end');
  await complete;
  return events.sort((a, b) => a.ts - b.ts);
}

/// The compositor's frames [s]: from the page's turn, in which it draws, until presented.
function presentedFrames(events) {
  const open = new Map();
  const frames = [];
  for (const { name, ph, ts, pid, cat, id2, id } of events) {
    if (!cat.includes(frameCategory)) continue;
    const key = `${pid} ${JSON.stringify(id2 ?? id)}`;
    const frame = open.get(key) ?? {};
    if (name === 'PipelineReporter') {
      open.set(key, {});
      if (ph === 'e' && frame.drawn && frame.presented) frames.push(frame);
    }
    if (name === 'SendBeginMainFrameToCommit' && ph === 'b') frame.begin = ts / 1e6;
    if (name === 'SendBeginMainFrameToCommit' && ph === 'e') frame.drawn = ts / 1e6;
    if (name.startsWith('SubmitCompositorFrameToPresentation') && ph === 'e')
      frame.presented = ts / 1e6;
  }
  return frames;
}

const quantile = (values, share) =>
  [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];
const ms = (seconds) => `${(1000 * seconds).toFixed(2)} ms`;

test('a frame is drawn when it says so, and presented soon after', limit, async (t) => {
  const { page } = await stage.open();
  await loaded(page);
  await page.waitForFunction(() => window.__pcavr.state !== null);
  await page.evaluate(() => {
    const { app } = window.__pcavr;
    app.onFrame(() => app.invalidate());
    app.onDrawn(() => {
      // On the server's clock, as LinkPanel has it.
      const clock = (performance.timeOrigin + performance.now()) / 1000;
      performance.mark(`drawn ${clock + app.session.latency.offset()}`);
    });
  });
  await page.waitForTimeout(2000); // some pings
  const events = await trace(page, 4000);
  const stamps = events
    .filter(({ cat, name }) => cat.includes('blink.user_timing') && name.startsWith('drawn '))
    .map(({ ts, name }) => ({ stamped: Number(name.split(' ')[1]), outside: ts / 1e6 }));
  assert.ok(stamps.length > 10, `${stamps.length} frames`);
  const errors = stamps.map(({ stamped, outside }) => stamped - outside);
  t.diagnostic(
    `drawn by the page less by the trace: median ${ms(quantile(errors, 0.5))}, ` +
      `from ${ms(quantile(errors, 0))} to ${ms(quantile(errors, 1))}, ${errors.length} frames`,
  );
  assert.ok(Math.abs(quantile(errors, 0.5)) < 1e-3);
  const frames = presentedFrames(events);
  const waits = stamps.flatMap(({ outside }) => {
    const frame = frames.find(({ begin, drawn }) => begin <= outside && outside <= drawn);
    return frame ? [frame.presented - outside] : [];
  });
  t.diagnostic(
    `then until presented: median ${ms(quantile(waits, 0.5))}, 95 % ${ms(quantile(waits, 0.95))}, ` +
      `${waits.length} frames`,
  );
  assert.ok(waits.length > stamps.length / 2, `${waits.length} of ${stamps.length} are presented`);
  assert.ok(quantile(waits, 0) >= 0);
});
