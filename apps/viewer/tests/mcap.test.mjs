// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The log of a replay, by the published reader of MCAP and decoder of ROS 2 messages, without a browser.
import assert from 'node:assert/strict';
import { open } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';
import { McapIndexedReader } from '@mcap/core';
import { makeScene, run } from './support/pcavr.mjs';

const limit = { timeout: 120_000 }; // [ms]
let made;
let file;
before(() => {
  made = makeScene(() => {}, ['--frames-per-second', '4', '--duration', '6']);
  file = join(made.folder, 'replay.mcap');
  const parameters = ['--parameters', made.parameters];
  run(
    'replay',
    made.recording,
    '--scene',
    made.scene,
    ...parameters,
    '-o',
    `${made.folder}/run`,
    '--mcap',
    file,
  );
}, limit);
after(() => made?.remove());

async function openIndexed() {
  const handle = await open(file);
  const { size } = await handle.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await handle.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  return { handle, reader: await McapIndexedReader.Initialize({ readable }) };
}

test(
  'every channel of a log is read by its index, in order of time, and decoded',
  limit,
  async () => {
    const { handle, reader } = await openIndexed();
    const decoders = new Map();
    for (const channel of reader.channelsById.values()) {
      const schema = reader.schemasById.get(channel.schemaId);
      const text = new TextDecoder().decode(schema.data);
      const decoder =
        channel.messageEncoding === 'json'
          ? { readMessage: (data) => JSON.parse(new TextDecoder().decode(data)) }
          : new MessageReader(parse(text, { ros2: true }));
      decoders.set(channel.id, { topic: channel.topic, decoder });
    }
    const newest = new Map();
    let last = 0n;
    let count = 0n;
    for await (const { channelId, logTime, data } of reader.readMessages()) {
      assert.ok(logTime >= last, 'in order of time');
      last = logTime;
      ++count;
      const { topic, decoder } = decoders.get(channelId);
      newest.set(topic, decoder.readMessage(data));
    }
    await handle.close();
    assert.equal(count, reader.statistics.messageCount);
    const { markers } = newest.get('/scene');
    assert.ok(
      markers.every(({ points }) => points.length > 10),
      'the scan and the bodies have meshes',
    );
    assert.ok(newest.get('/points').width > 1000);
    assert.deepEqual([...newest.get('/camera/image/compressed').data.slice(0, 2)], [0xff, 0xd8]);
    assert.ok(newest.get('/camera/camera_info').k[0] > 100);
    const [name] = [...newest.keys()].filter((topic) => topic.startsWith('/predicted/'));
    const [at, seen] = [name, name.replace('predicted', 'tracked')].map(
      (topic) => newest.get(topic).pose.position,
    );
    assert.ok(Math.hypot(at.x - seen.x, at.y - seen.y, at.z - seen.z) < 0.02, 'as it was tracked');
  },
);
