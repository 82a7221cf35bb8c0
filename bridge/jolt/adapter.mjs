// Jolt's soft bodies as an engine, through the words of ../README.md: XPBD with one sweep over edges in each of its
// "iterations", which are substeps (Jolt's SoftBodyMotionProperties::Update divides its time step by mNumIterations).
import { readFileSync, writeSync } from 'node:fs';
import { createInterface } from 'node:readline';
import initialise from 'jolt-physics/wasm-compat';

const LAYERS = 2; // of objects: 0 does not move, 1 does
const LEAST_SUBSTEPS = 5; // Jolt's own, mNumIterations
const MOST_SUBSTEPS = 50; // of those that it chooses itself
// A substep moves a point by g·h² of gravity: where that is fewer than so many spacings of floats at its place, what
// is rounded away shows in the sag.
const LEAST_SPACINGS = 16;

let jolt = null;
let world = null;

// A world of its own for each scene.
function makeWorld(gravity) {
  const settings = new jolt.JoltSettings();
  settings.mMaxWorkerThreads = 0;
  const pairs = new jolt.ObjectLayerPairFilterTable(LAYERS);
  pairs.EnableCollision(0, 1);
  const broad = new jolt.BroadPhaseLayerInterfaceTable(LAYERS, LAYERS);
  for (let layer = 0; layer < LAYERS; layer++) broad.MapObjectToBroadPhaseLayer(layer, new jolt.BroadPhaseLayer(layer));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new jolt.ObjectVsBroadPhaseLayerFilterTable(broad, LAYERS, pairs, LAYERS);
  const made = new jolt.JoltInterface(settings);
  made.GetPhysicsSystem().SetGravity(new jolt.Vec3(...gravity));
  return made;
}

// Particles as vertices, springs as edges whose compliance is 1/k. Faces and tethers would add what no spring is.
function makeShape(particles, springs) {
  const shape = new jolt.SoftBodySharedSettings();
  const vertex = new jolt.SoftBodySharedSettingsVertex();
  for (const [x, y, z, vx, vy, vz, mass, pinned] of particles) {
    for (const [to, values] of [[vertex.mPosition, [x, y, z]], [vertex.mVelocity, [vx, vy, vz]]])
      [to.x, to.y, to.z] = values;
    vertex.mInvMass = pinned ? 0 : 1 / mass;
    shape.mVertices.push_back(vertex);
  }
  for (const [a, b, rest, stiffness] of springs) {
    const edge = new jolt.SoftBodySharedSettingsEdge(a, b, 1 / stiffness);
    edge.mRestLength = rest;
    shape.mEdgeConstraints.push_back(edge);
    jolt.destroy(edge);
  }
  shape.Optimize();
  return shape;
}

// A collider's friction and restitution alone count: Jolt takes the root of the product of both bodies' friction, and
// the larger restitution.
function addCollider(bodies, { shape, point, normal, radius, restitution, friction }) {
  const at = new jolt.RVec3(...point);
  const solid =
    shape === 'sphere'
      ? new jolt.SphereShape(radius)
      : new jolt.PlaneShape(new jolt.Plane(new jolt.Vec3(...normal), 0), undefined, 1e4);
  const settings = new jolt.BodyCreationSettings(
    solid, at, jolt.Quat.prototype.sIdentity(), jolt.EMotionType_Static, 0);
  settings.mFriction = friction * friction;
  settings.mRestitution = restitution;
  bodies.AddBody(bodies.CreateBody(settings).GetID(), jolt.EActivation_DontActivate);
}

// As gravity moves points along its own axes, the spacing there counts.
function substepsFor({ step, gravity, particles, size }) {
  const longest = gravity.map((pull, axis) => {
    const farthest = particles.reduce((most, at) => Math.max(most, Math.abs(at[axis])), size);
    const spacing = 2 ** (Math.floor(Math.log2(farthest)) - 23);
    return pull === 0 ? 0 : Math.sqrt((LEAST_SPACINGS * spacing) / Math.abs(pull));
  });
  return Math.max(LEAST_SUBSTEPS, Math.min(MOST_SUBSTEPS, Math.floor(step / Math.max(...longest, 1e-30))));
}

function build(scene) {
  const made = { ...scene, jolt: makeWorld(scene.gravity) };
  made.updates = scene.settings.updates ?? 1;
  made.substeps = scene.settings.substeps ?? substepsFor(scene);
  const settings = new jolt.SoftBodyCreationSettings(
    makeShape(scene.particles, scene.springs), new jolt.RVec3(0, 0, 0), jolt.Quat.prototype.sIdentity(), 1);
  settings.mNumIterations = made.substeps;
  settings.mLinearDamping = scene.drag;
  settings.mMaxLinearVelocity = 1e6;
  settings.mFriction = 1;
  settings.mRestitution = 0;
  settings.mVertexRadius = 0;
  settings.mUpdatePosition = false;
  settings.mAllowSleeping = false;
  const bodies = made.jolt.GetPhysicsSystem().GetBodyInterface();
  made.body = bodies.CreateSoftBody(settings);
  bodies.AddBody(made.body.GetID(), jolt.EActivation_Activate);
  scene.colliders.forEach((collider) => addCollider(bodies, collider));
  made.motion = jolt.castObject(made.body.GetMotionProperties(), jolt.SoftBodyMotionProperties);
  // Jolt shares a body's force out among its vertices
  made.push = new jolt.Vec3(...scene.force.map((f) => f * scene.particles.length));
  return made;
}

// What the scene asked, and what Jolt makes of it.
function ledger({ springs, gravity, force, drag, step, colliders, updates, substeps }) {
  const rows = [
    ['exact', step, 's', step / updates / substeps, 'time step', 'mNumIterations', 'step / updates / substeps'],
    ['exact', Math.hypot(...gravity), 'm/s2', Math.hypot(...gravity), 'gravity', 'SetGravity', 'g'],
  ];
  for (const kind of ['structural', 'shear', 'bend']) {
    const spring = springs.find((one) => one[5] === kind);
    if (spring)
      rows.push(['approximate', spring[3], 'N/m', 1 / spring[3], `${kind} stiffness`, 'Edge::mCompliance',
        '1/k, in m/N; one sweep a substep']);
  }
  const damped = springs.find((one) => one[4] > 0);
  if (damped)
    rows.push(['impossible', damped[4], 'N*s/m', 0, 'spring damping', 'none', 'Jolt has no damping of an edge']);
  if (drag > 0)
    rows.push(['approximate', drag, '1/s', drag, 'drag', 'mLinearDamping', '1 - drag*h of a speed stays each substep']);
  const push = Math.hypot(...force);
  if (push > 0)
    rows.push(['exact', push, 'N', push, 'force', 'Body::AddForce', 'F times the vertices, which share it']);
  for (const { friction, restitution } of colliders.slice(0, 1)) {
    rows.push(['approximate', friction, '1', friction ** 2, 'friction', 'Body::SetFriction',
      'its square: Jolt takes the root of the product with that of the cloth, 1']);
    rows.push(['approximate', restitution, '1', restitution, 'restitution', 'Body::SetRestitution', 'e']);
  }
  return rows.map(([match, wanted, unit, value, ...texts]) =>
    `ledger ${match} ${wanted} ${unit} ${value}; ${texts.join('; ')}\n`).join('');
}

function begin(scene) {
  world = build(scene);
  return `uses substeps ${world.substeps}\nuses updates ${world.updates}\n${ledger(world)}ready\n`;
}

function step() {
  world.body.AddForce(world.push);
  world.jolt.Step(world.step, world.updates);
  const { mMin, mMax } = world.motion.GetLocalBounds();
  return [mMin, mMax].every((at) => Number.isFinite(at.GetX() + at.GetY() + at.GetZ())) ? 'ok\n' : 'diverged\n';
}

// [2][particles][3] doubles.
function read() {
  const count = world.particles.length;
  const state = new Float64Array(6 * count);
  for (let i = 0; i < count; i++) {
    const { mPosition, mVelocity } = world.motion.GetVertex(i);
    state.set([mPosition.GetX(), mPosition.GetY(), mPosition.GetZ()], 3 * i);
    state.set([mVelocity.GetX(), mVelocity.GetY(), mVelocity.GetZ()], 3 * (count + i));
  }
  return Buffer.from(state.buffer);
}

function release(particle) {
  const vertex = world.motion.GetVertex(particle);
  vertex.mInvMass = 1 / world.particles[particle][6];
  vertex.mVelocity = new jolt.Vec3(0, 0, 0);
  return '';
}

function readCollider(words) {
  const [shape, ...rest] = words;
  const numbers = rest.map(Number);
  const isBall = shape === 'sphere';
  const [restitution, friction] = numbers.slice(isBall ? 4 : 6);
  return { shape, point: numbers.slice(0, 3), radius: numbers[3], normal: numbers.slice(3, 6), restitution, friction };
}

const springOf = (words) => words.map((word, i) => (i === 5 ? word : word === 'inf' ? Infinity : Number(word)));
const lists = { particles: (words) => words.map(Number), springs: springOf, colliders: readCollider };

// The lines of a scene, one by one; true at its end.
function sceneReader() {
  const scene = { particles: [], springs: [], colliders: [], settings: {} };
  let list = null;
  let left = 0;
  const take = (line) => {
    const words = line.split(' ');
    if (left > 0) {
      scene[list].push(lists[list](words));
      left -= 1;
    } else if (lists[words[0]]) {
      list = words[0];
      left = Number(words[1]);
    } else if (words[0] === 'setting') scene.settings[words[1]] = Number(words[2]);
    else if (['gravity', 'force'].includes(words[0])) scene[words[0]] = words.slice(1).map(Number);
    else if (words[0] !== 'end') scene[words[0]] = Number(words[1]);
    return left === 0 && words[0] === 'end';
  };
  return { scene, take };
}

const { version } = JSON.parse(readFileSync(new URL('./node_modules/jolt-physics/package.json', import.meta.url)));

const hello = () => `version jolt-physics ${version} float
about Jolt's soft body: XPBD, one sweep over compliant edges in each of its iterations, which are substeps
models springs rigid damping gravity force drag velocity plane sphere release
precision single
positions raw
setting substeps 1 100000 whole mNumIterations: substeps of an update (default: 50, fewer where floats end)
setting updates 1 10000 whole collision steps a frame, as PhysicsSystem::Update takes (default: 1)
end
`;

let reader = null;
function answer(line) {
  if (reader) {
    if (!reader.take(line)) return '';
    const { scene } = reader;
    reader = null;
    return begin(scene);
  }
  const [word, argument] = line.split(' ');
  if (word === 'begin') reader = sceneReader();
  else if (word === 'quit') process.exit(0);
  const answers = {
    clothcheck: () => 'clothcheck 1\n', hello, ping: () => 'ok\n', step, read, release: () => release(Number(argument)),
  };
  return answers[word] ? answers[word]() : '';
}

// Whole, whatever a pipe takes at a time.
function send(text) {
  const bytes = Buffer.from(text);
  for (let sent = 0; sent < bytes.length; ) sent += writeSync(1, bytes, sent);
}

jolt = await initialise();
createInterface({ input: process.stdin }).on('line', (line) => send(answer(line)));
