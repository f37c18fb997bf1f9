// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Another viewer at the server, by the published client of the Foxglove protocol and its decoder of
// ROS 2 messages, without a browser; and clients that misbehave.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';
import foxglove from '@foxglove/ws-protocol';
import WebSocket from 'ws';
import { putCup } from './support/cup.mjs';
import { distance, Live, until } from './support/live.mjs';
import { makeScene, serve } from './support/pcavr.mjs';
import { startOperator, startRobot } from './support/sites.mjs';

const { FoxgloveClient } = foxglove; // a CommonJS module
const limit = { timeout: 60_000 }; // [ms]
const protocols = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];

let scene;
let server;
const socketUrl = (url) => url.replace(/^http/, 'ws');

before(async () => {
  scene = makeScene();
  putCup(scene.scene, [0.3, 0.3], 0.04, 0.1);
  server = await serve(scene.scene, '--parameters', scene.parameters);
}, limit);
after(async () => {
  await server?.stop();
  scene?.remove();
});

/// Subscribes to all channels, `times` times each, and decodes what comes: newest message by topic.
class Viewer {
  topics = new Map(); // { channel, reader, newest, count } by topic
  errors = [];
  statuses = [];

  constructor(url, { protocol = protocols[0], times = 1 } = {}) {
    this.socket = new WebSocket(socketUrl(url), [protocol]);
    this.client = new FoxgloveClient({ ws: this.socket });
    const bySubscription = new Map();
    this.client.on('error', (error) => this.errors.push(error));
    this.client.on('status', (status) => this.statuses.push(status));
    this.client.on('serverInfo', (info) => (this.info = info));
    this.client.on('advertise', (channels) => {
      for (const channel of channels) {
        const reader = new MessageReader(parse(channel.schema, { ros2: true }));
        const topic = { channel, reader, newest: null, count: 0 };
        this.topics.set(channel.topic, topic);
        for (let i = 0; i < times; ++i)
          bySubscription.set(this.client.subscribe(channel.id), topic);
      }
    });
    this.client.on('message', ({ subscriptionId, timestamp, data }) => {
      const topic = bySubscription.get(subscriptionId);
      topic.newest = topic.reader.readMessage(data);
      topic.stamp = Number(timestamp) / 1e9;
      ++topic.count;
    });
  }

  newest(topic) {
    return this.topics.get(topic)?.newest;
  }

  close() {
    this.client.close();
  }
}

const point = ({ x, y, z }) => [x, y, z];

for (const protocol of protocols)
  test(`every channel is decoded by ${protocol}`, limit, async () => {
    const viewer = new Viewer(server.url, { protocol });
    const live = new Live(server.url);
    await until(() => live.state && viewer.topics.size > 0, 'both connected');
    assert.equal(viewer.socket.protocol, protocol);
    assert.equal(viewer.info.name, 'pcavr');
    const all = [...viewer.topics.values()];
    await until(() => all.every(({ newest }) => newest), 'a message of every channel');
    const [name] = live.welcome.objects;
    const [object] = live.state.objects;
    const pose = viewer.newest(`/predicted/${name}`);
    assert.equal(pose.header.frame_id, 'base');
    assert.ok(distance(point(pose.pose.position), object.position) < 1e-6);
    assert.ok(Math.abs(pose.header.stamp.sec - Date.now() / 1000) < 10, 'the time of day');
    const { transforms } = viewer.newest('/tf');
    const frames = transforms.map((transform) => transform.child_frame_id);
    const { markers } = viewer.newest('/scene');
    assert.deepEqual(
      markers.map(({ ns }) => ns),
      ['scan', ...live.welcome.objects],
    );
    for (const { header, points, colors } of markers) {
      assert.ok(points.length > 0 && points.length % 3 === 0);
      assert.ok(colors.length === 0 || colors.length === points.length);
      assert.ok(header.frame_id === 'base' || frames.includes(header.frame_id), header.frame_id);
    }
    const { width, point_step: step, data } = viewer.newest('/points');
    assert.equal(data.length, width * step);
    const { phases } = viewer.newest('/phases');
    assert.deepEqual(
      phases.map((phase) => [phase.object, phase.phase]),
      live.welcome.objects.map((other) => [other, 'free']),
    );
    const { parameters } = viewer.newest('/parameters');
    assert.ok(parameters.some((p) => p.object === name && p.name === 'mass' && p.value > 0));
    const [diagnostic] = viewer.newest('/diagnostics').status;
    assert.deepEqual([diagnostic.name, diagnostic.message], ['world', 'running']);
    assert.deepEqual(viewer.errors, []);
    viewer.close();
    live.close();
  });

test('a push is seen by a viewer as by a page', limit, async () => {
  const viewer = new Viewer(server.url);
  const live = new Live(server.url);
  await until(() => live.state && viewer.topics.size > 0, 'both connected');
  const name = live.welcome.objects[0];
  const [x, y, z] = live.state.objects[0].position;
  let maxForce = 0;
  viewer.client.on('message', () => {
    const force = viewer.newest(`/predicted_force/${name}`)?.wrench.force;
    if (force) maxForce = Math.max(maxForce, Math.hypot(force.x, force.y, force.z));
  });
  await live.moveToolOver([x, y - 0.2, z]);
  await live.moveTool([x, y - 0.2, z], [x, y - 0.05, z], 2);
  await until(() => maxForce > 0.5, 'a force');
  const moved = () => {
    const { position } = viewer.newest(`/predicted/${name}`).pose;
    return (
      distance(point(position), live.state.objects[0].position) < 1e-3 && position.y > y + 0.01
    );
  };
  await until(moved, 'the same pose at both');
  viewer.close();
  live.close();
});

test('a link gives the measured poses and force beside the predicted ones', limit, async (t) => {
  const robot = await startRobot(scene.scene);
  t.after(() => robot.stop());
  const site = await startOperator(scene.scene, robot.ready.port, '--parameters', scene.parameters);
  t.after(() => site.stop());
  const viewer = new Viewer(site.ready.addresses[0]);
  t.after(() => viewer.close());
  await until(() => viewer.topics.size > 0, 'the channels');
  const all = [...viewer.topics.values()];
  await until(() => all.every(({ newest }) => newest), 'a message of every channel', 30_000);
  assert.deepEqual([...viewer.newest('/camera/image/compressed').data.slice(0, 2)], [0xff, 0xd8]);
  const camera = viewer.newest('/camera/camera_info');
  assert.ok(camera.width > 0 && camera.height > 0);
  const [fx, , cx, , fy, cy] = camera.k;
  assert.ok(fx > 0.3 * camera.width && Math.abs(fx / fy - 1) < 0.05, `fx ${fx}, fy ${fy}`);
  assert.ok(Math.abs(cx - camera.width / 2) < 0.1 * camera.width, `cx ${cx}`);
  assert.ok(Math.abs(cy - camera.height / 2) < 0.1 * camera.height, `cy ${cy}`);
  const link = () => viewer.newest('/diagnostics').status.find(({ name }) => name === 'link');
  await until(() => link().message === 'connected', 'the link', 30_000);
  for (const topic of viewer.topics.keys()) {
    const tracked = topic.match(/^\/tracked\/(.*)$/);
    if (!tracked) continue;
    const apart = () => {
      const [a, b] = [topic, `/predicted/${tracked[1]}`].map((x) => viewer.newest(x).pose.position);
      return distance(point(a), point(b));
    };
    await until(() => apart() < 0.02, topic);
  }
  assert.deepEqual(viewer.errors, []);
});

/// Whether a page still gets its states at its rate.
async function assertServed(url) {
  const live = new Live(url);
  await until(() => live.state, 'a state');
  let states = 0;
  live.onState = () => ++states;
  await new Promise((resolve) => setTimeout(resolve, 1000));
  assert.ok(states > 20, `${states} states in 1 s`);
  live.close();
}

const raw = (protocol = protocols[0]) => new WebSocket(socketUrl(server.url), [protocol]);
const opened = (socket) => new Promise((resolve) => socket.on('open', resolve));
const closed = (socket) =>
  new Promise((resolve) => {
    socket.on('close', resolve);
    socket.on('error', () => {});
  });

test(
  'a viewer that asks for more than it reads is disconnected, and delays nobody',
  limit,
  async () => {
    const socket = raw();
    const end = closed(socket);
    await opened(socket);
    socket._socket.pause();
    // The scene is sent for each subscription: more than the system's buffers hold.
    const scene = { op: 'subscribe', subscriptions: [{ id: 1, channelId: 1 }] };
    for (let i = 0; i < 400; ++i) {
      socket.send(JSON.stringify(scene));
      socket.send(JSON.stringify({ op: 'unsubscribe', subscriptionIds: [1] }));
    }
    for (let i = 0; i < 3; ++i) await assertServed(server.url);
    await until(
      () => {
        socket.resume?.();
        socket._socket.resume();
        return socket.readyState === WebSocket.CLOSED;
      },
      'the end of the connection',
      30_000,
    );
    await end;
  },
);

test('subscribing to everything 100 times gives each message once', limit, async () => {
  const viewer = new Viewer(server.url, { times: 100 });
  const ended = closed(viewer.socket);
  await until(() => viewer.topics.size > 0, 'the channels');
  // It is notified, or disconnected for its flood; either way the server goes on.
  await Promise.race([ended, until(() => viewer.statuses.length > 0, 'a status')]);
  await assertServed(server.url);
  assert.ok((viewer.topics.get('/scene')?.count ?? 0) <= 1);
  viewer.close();
});

test(
  'a message of 10 MB, and those of the other protocol, end or change nothing',
  limit,
  async () => {
    const big = raw();
    const end = closed(big);
    await opened(big);
    big.send(Buffer.alloc(10_000_000));
    await end;
    const other = raw(protocols[1]);
    const replies = [];
    other.on('message', (bytes, isBinary) => isBinary || replies.push(JSON.parse(bytes)));
    await opened(other);
    const hello = Buffer.concat([Buffer.from('PCVR\x01\x10'), Buffer.alloc(18), Buffer.from('{}')]);
    for (const message of [hello, '{"op":"setParameters"}', '{', '[[[', '7', '{"op":3}', ''])
      other.send(message);
    const bad = {
      op: 'subscribe',
      subscriptions: [{}, 7, { id: -1, channelId: 1 }, { id: 1, channelId: 999 }],
    };
    other.send(JSON.stringify(bad));
    await until(() => replies.filter(({ op }) => op === 'status').length === 8, 'eight answers');
    assert.equal(other.readyState, WebSocket.OPEN);
    other.close();
    const page = new WebSocket(`${socketUrl(server.url)}live`, { headers: {} });
    const pageEnd = closed(page);
    await opened(page);
    page.send('{"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]}');
    await pageEnd;
    await assertServed(server.url);
  },
);

test('pages of other sites can not look in, viewers of this machine can', limit, async () => {
  const tryFrom = (origin) =>
    new Promise((resolve) => {
      const socket = new WebSocket(socketUrl(server.url), [protocols[0]], { origin });
      socket.on('open', () => (resolve(true), socket.close()));
      socket.on('error', () => resolve(false));
    });
  assert.equal(await tryFrom('https://evil.example'), false);
  assert.equal(await tryFrom('http://localhost.evil.example:8080'), false);
  assert.equal(await tryFrom('http://localhost:8080'), true);
});
