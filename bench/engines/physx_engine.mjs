// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// PhysX 5 (npm physx-js-webidl): node physx_engine.mjs TOOLS JOBS
// options: solver "tgs" or "pgs", positionIterations, velocityIterations. A body with a law has friction by slip speed.
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { runJobs, TOOL_MASS } from "./experiment.mjs";
import { frictionShare, slipSpeed } from "./friction_law.mjs";

const [tools, jobs] = process.argv.slice(2);
const require = createRequire(resolve(tools, "package.json"));
// The module is built for browsers, and refuses to start where it finds node.
const { default: load } = await import(pathToFileURL(require.resolve("physx-js-webidl/physx-js-webidl.mjs")).href);
const P = await startWithoutProcess();
const version = P.PHYSICS_VERSION;
const functions = P.PxTopLevelFunctions.prototype;
const foundation = functions.CreateFoundation(version, new P.PxDefaultAllocator(), new P.PxDefaultErrorCallback());
const scale = new P.PxTolerancesScale();
const physics = functions.CreatePhysics(version, foundation, scale);
const dispatcher = functions.DefaultCpuDispatcherCreate(0);

async function startWithoutProcess() {
  const { readFileSync } = await import("node:fs");
  const wasmBinary = readFileSync(require.resolve("physx-js-webidl/physx-js-webidl.wasm"));
  const hidden = globalThis.process;
  globalThis.process = undefined;
  globalThis.window = {};
  try {
    return await load({ wasmBinary });
  } finally {
    globalThis.process = hidden;
    delete globalThis.window;
  }
}

const vector = (v) => new P.PxVec3(...v);
const pose = (p, q = [0, 0, 0, 1]) => new P.PxTransform(vector(p), new P.PxQuat(...q));
const numbers = (v) => [v.x, v.y, v.z];

function convexMesh(points) {
  const list = new P.PxArray_PxVec3(points.length);
  points.forEach((p, i) => list.set(i, vector(p)));
  const desc = new P.PxConvexMeshDesc();
  desc.flags.raise(P.PxConvexFlagEnum.eCOMPUTE_CONVEX);
  desc.points.count = points.length;
  desc.points.stride = 12;
  desc.points.data = list.begin();
  return functions.CreateConvexMesh(new P.PxCookingParams(scale), desc);
}

/** A material whose coefficients hold for a pair with one that has larger ones. */
function material({ friction, staticFriction }) {
  if (friction == null) return physics.createMaterial(0.5, 0.5, 0); // as PhysX's samples and Isaac have it
  const made = physics.createMaterial(staticFriction ?? friction, friction, 0);
  made.setFrictionCombineMode(P.PxCombineModeEnum.eMIN);
  return made;
}

/** Collision groups: word0 is what a shape is; all meet all in these scenes. */
function addShape(actor, geometry, surface, localPose) {
  const flags = new P.PxShapeFlags(P.PxShapeFlagEnum.eSIMULATION_SHAPE | P.PxShapeFlagEnum.eSCENE_QUERY_SHAPE);
  const shape = physics.createShape(geometry, surface, true, flags);
  shape.setSimulationFilterData(new P.PxFilterData(1, 1, 0, 0));
  if (localPose) shape.setLocalPose(localPose);
  actor.attachShape(shape);
}

function addBody(scene, world, options) {
  const { body } = world;
  const actor = physics.createRigidDynamic(pose(body.position, body.quaternion));
  addShape(actor, new P.PxConvexMeshGeometry(convexMesh(body.points)), material({ friction: body.friction }));
  const feet = body.feet.map((foot) => {
    const surface = material({ friction: foot.friction, staticFriction: foot.friction * body.static_ratio });
    addShape(actor, new P.PxSphereGeometry(foot.radius), surface, pose(foot.centre));
    return { surface, friction: foot.friction };
  });
  actor.setMass(body.mass);
  actor.setCMassLocalPose(pose(body.centre_of_mass, body.inertia_quaternion));
  actor.setMassSpaceInertiaTensor(vector(body.inertia));
  actor.setAngularDamping(0);
  actor.setSleepThreshold(0);
  actor.setStabilizationThreshold(0);
  actor.setSolverIterationCounts(options.positionIterations ?? 4, options.velocityIterations ?? 1);
  scene.addActor(actor);
  return { actor, feet };
}

/** Of feet that slip at a speed: one coefficient, as PhysX's static one is at least the sliding one. */
function setFriction(feet, share) {
  for (const { surface, friction } of feet) {
    surface.setStaticFriction(friction * share);
    surface.setDynamicFriction(friction * share);
  }
}

function makeEngine({ world, experiment, options }) {
  const desc = new P.PxSceneDesc(scale);
  desc.gravity = vector(world.gravity);
  desc.cpuDispatcher = dispatcher;
  desc.filterShader = functions.DefaultFilterShader();
  desc.solverType = options.solver === "tgs" ? P.PxSolverTypeEnum.eTGS : P.PxSolverTypeEnum.ePGS;
  const scene = physics.createScene(desc);
  for (const support of world.supports) {
    const actor = physics.createRigidStatic(pose(support.position, support.quaternion));
    addShape(actor, new P.PxBoxGeometry(...support.size.map((s) => s / 2)), material({ friction: world.partner_friction }));
    scene.addActor(actor);
  }
  const { actor: body, feet } = addBody(scene, world, options);
  const { law } = world.body;
  const tool = physics.createRigidDynamic(pose([0, 0, 50]));
  addShape(tool, new P.PxSphereGeometry(world.tool_radius), material({ friction: world.tip_friction }));
  tool.setMass(TOOL_MASS);
  tool.setMassSpaceInertiaTensor(vector([TOOL_MASS, TOOL_MASS, TOOL_MASS]));
  tool.setActorFlag(P.PxActorFlagEnum.eDISABLE_GRAVITY, true);
  tool.setSleepThreshold(0);
  scene.addActor(tool);
  const { dt } = experiment;
  let wanted = [0, 0, 0];
  const [v, w, target] = [vector([0, 0, 0]), vector([0, 0, 0]), pose([0, 0, 0])];
  const zero = vector([0, 0, 0]);
  const assign = (to, from) => (([to.x, to.y, to.z] = from), to);
  return {
    step() {
      if (law) {
        const slip = slipSpeed(law, numbers(body.getLinearVelocity()), numbers(body.getAngularVelocity()));
        setFriction(feet, frictionShare(law, slip));
      }
      scene.simulate(dt);
      scene.fetchResults(true);
    },
    setTool(p, velocity) {
      assign(target.p, p);
      tool.setGlobalPose(target);
      wanted = velocity.map(Math.fround);
      tool.setLinearVelocity(assign(v, velocity));
      tool.setAngularVelocity(zero);
    },
    toolForce: () => numbers(tool.getLinearVelocity()).map((value, i) => (TOOL_MASS * (wanted[i] - value)) / dt),
    state() {
      const { p, q } = body.getGlobalPose();
      return {
        position: numbers(p),
        quaternion: [q.x, q.y, q.z, q.w],
        velocity: numbers(body.getLinearVelocity()),
        spin: numbers(body.getAngularVelocity()),
      };
    },
    setVelocity(linear, angular) {
      body.setLinearVelocity(assign(v, linear));
      body.setAngularVelocity(assign(w, angular));
    },
    applyWrench(force, torque) {
      body.addForce(assign(v, force), P.PxForceModeEnum.eFORCE, true);
      body.addTorque(assign(w, torque), P.PxForceModeEnum.eFORCE, true);
    },
    delete: () => scene.release(),
  };
}

runJobs(jobs, makeEngine);
