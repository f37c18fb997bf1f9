// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Rapier (npm @dimforge/rapier3d-compat): node rapier_engine.mjs TOOLS JOBS
// options: iterations of the solver.
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { runJobs, TOOL_MASS } from "./experiment.mjs";

const [tools, jobs] = process.argv.slice(2);
const require = createRequire(resolve(tools, "package.json"));
const loaded = await import(pathToFileURL(require.resolve("@dimforge/rapier3d-compat")).href);
const R = loaded.default ?? loaded;
await R.init();

const vector = ([x, y, z]) => ({ x, y, z });
const quaternion = ([x, y, z, w]) => ({ x, y, z, w });
const numbers = (v) => [v.x, v.y, v.z];
const zero = vector([0, 0, 0]);

/** A collider without mass, whose coefficient holds for a pair with a larger one; null: Rapier's default. */
function surface(desc, friction) {
  desc.setDensity(0);
  return friction == null ? desc : desc.setFriction(friction).setFrictionCombineRule(R.CoefficientCombineRule.Min);
}

function makeEngine({ world, experiment, options }) {
  const physics = new R.World(vector(world.gravity));
  physics.timestep = experiment.dt;
  if (options.iterations) physics.integrationParameters.numSolverIterations = options.iterations;
  for (const support of world.supports) {
    const [x, y, z] = support.position;
    const base = physics.createRigidBody(R.RigidBodyDesc.fixed().setTranslation(x, y, z).setRotation(quaternion(support.quaternion)));
    physics.createCollider(surface(R.ColliderDesc.cuboid(...support.size.map((s) => s / 2)), world.partner_friction), base);
  }
  const { body: made } = world;
  const body = physics.createRigidBody(
    R.RigidBodyDesc.dynamic()
      .setTranslation(...made.position)
      .setRotation(quaternion(made.quaternion))
      .setCanSleep(false)
      .setAdditionalMassProperties(made.mass, vector(made.centre_of_mass), vector(made.inertia), quaternion(made.inertia_quaternion)),
  );
  physics.createCollider(surface(R.ColliderDesc.convexHull(new Float32Array(made.points.flat())), made.friction), body);
  for (const foot of made.feet) {
    physics.createCollider(surface(R.ColliderDesc.ball(foot.radius).setTranslation(...foot.centre), foot.friction), body);
  }
  const tool = physics.createRigidBody(
    R.RigidBodyDesc.dynamic()
      .setTranslation(0, 0, 50)
      .setGravityScale(0)
      .setCanSleep(false)
      .setAdditionalMassProperties(TOOL_MASS, zero, vector([TOOL_MASS, TOOL_MASS, TOOL_MASS]), quaternion([0, 0, 0, 1])),
  );
  physics.createCollider(surface(R.ColliderDesc.ball(world.tool_radius), world.tip_friction), tool);
  let wanted = [0, 0, 0];
  return {
    step: () => physics.step(),
    setTool(p, velocity) {
      tool.setTranslation(vector(p), true);
      wanted = velocity.map(Math.fround);
      tool.setLinvel(vector(velocity), true);
      tool.setAngvel(zero, true);
    },
    toolForce: () => numbers(tool.linvel()).map((value, i) => (TOOL_MASS * (wanted[i] - value)) / experiment.dt),
    state() {
      const q = body.rotation();
      return { position: numbers(body.translation()), quaternion: [q.x, q.y, q.z, q.w], velocity: numbers(body.linvel()), spin: numbers(body.angvel()) };
    },
    setVelocity(linear, angular) {
      body.setLinvel(vector(linear), true);
      body.setAngvel(vector(angular), true);
    },
    applyWrench(force, torque) {
      body.resetForces(true);
      body.resetTorques(true);
      body.addForce(vector(force), true);
      body.addTorque(vector(torque), true);
    },
    delete: () => physics.free(),
  };
}

runJobs(jobs, makeEngine);
