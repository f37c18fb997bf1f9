// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The log of a replay, by the published reader of MCAP and decoder of ROS 2 messages, without a browser.
import assert from 'node:assert/strict';
import { open, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';
import { McapIndexedReader } from '@mcap/core';
import { makeScene, run } from './support/pcavr.mjs';

const limit = { timeout: 120_000 }; // [ms]
const maxChunk = 2_000_000; // [bytes] what a cut may cost: the record that it is in
let made;
let file;
before(() => {
  made = makeScene(() => {}, ['--frames-per-second', '4', '--image-size', '640x480']);
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

async function openIndexed(path) {
  const handle = await open(path);
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

/// The decoder of each channel by its id, with the channel's topic.
function decodersOf(reader) {
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
  return decoders;
}

/// Reads a log by its index, in order of time: the newest message of each topic, and what it has in all.
async function readIndexed(path) {
  const { handle, reader } = await openIndexed(path);
  const decoders = decodersOf(reader);
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
  return { newest, count, topics: [...decoders.values()].map(({ topic }) => topic).sort() };
}

test(
  'every channel of a log is read by its index, in order of time, and decoded',
  limit,
  async () => {
    const { newest, topics } = await readIndexed(file);
    assert.deepEqual([...newest.keys()].sort(), topics);
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

test('a log whose writer was killed is read by its index once it is recovered', limit, async () => {
  const whole = await readIndexed(file);
  const bytes = await readFile(file);
  for (const share of [0.8, 0.95]) {
    const cut = join(made.folder, 'cut.mcap');
    const recovered = join(made.folder, `recovered_${share}.mcap`);
    await writeFile(cut, bytes.subarray(0, Math.round(share * bytes.length)));
    await assert.rejects(openIndexed(cut));
    const said = JSON.parse(run('--json', 'inspect', cut, '--recover', '-o', recovered));
    const { newest, count, topics } = await readIndexed(recovered);
    assert.deepEqual(topics, whole.topics);
    assert.deepEqual([...newest.keys()].sort(), topics);
    assert.ok(count < whole.count);
    assert.equal(Number(count), said.messages);
    assert.ok(said.lost_bytes < maxChunk, `${said.lost_bytes} bytes lost`);
  }
});
