// Jolt's soft bodies as an engine, through the words of ../README.md: XPBD with one sweep over edges in each of its
// "iterations", which are substeps (Jolt's SoftBodyMotionProperties::Update divides its time step by mNumIterations).
import { readFileSync, writeSync } from 'node:fs';
import { createInterface } from 'node:readline';
import initialise from 'jolt-physics/wasm-compat';

const LAYERS = 2; // of objects: 0 does not move, 1 does
const ENDLESS = 100; // half the length of a cylinder without end, in sizes of the body
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
  pairs.EnableCollision(1, 1);
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

// The rotation whose columns are three axes.
function turnOf([x, y, z]) {
  const w = Math.sqrt(Math.max(0, 1 + x[0] + y[1] + z[2])) / 2;
  if (w > 0.1) return new jolt.Quat((y[2] - z[1]) / (4 * w), (z[0] - x[2]) / (4 * w), (x[1] - y[0]) / (4 * w), w);
  // by its largest part where w is small
  const parts = [x[0] - y[1] - z[2], y[1] - z[2] - x[0], z[2] - x[0] - y[1]];
  const most = parts.indexOf(Math.max(...parts));
  const [i, j, k] = [most, (most + 1) % 3, (most + 2) % 3];
  const columns = [x, y, z];
  const part = Math.sqrt(1 + parts[i]) / 2;
  const turn = [0, 0, 0, (columns[j][k] - columns[k][j]) / (4 * part)];
  turn[i] = part;
  turn[j] = (columns[i][j] + columns[j][i]) / (4 * part);
  turn[k] = (columns[i][k] + columns[k][i]) / (4 * part);
  return new jolt.Quat(...turn);
}

// A capsule stands along its second axis.
const capsule = (length, radius, along, across, third) =>
  [new jolt.CapsuleShape(length, radius), turnOf([across, along, third.map((part) => -part)])];

// To soft bodies Jolt's boxes have sharp edges: a rounded one is three, each out to two faces, and a capsule an edge.
function* boxPieces({ point, radius, axes, half }) {
  for (let k = 0; k < 3; k++) {
    const [l, m] = [(k + 1) % 3, (k + 2) % 3];
    const sides = half.map((side, axis) => (axis === k ? side + radius : side));
    yield [point, new jolt.BoxShape(new jolt.Vec3(...sides), 0), turnOf(axes)];
    if (radius === 0) return;
    for (const [one, other] of [[-1, -1], [-1, 1], [1, -1], [1, 1]]) {
      const at = point.map((x, i) => x + one * half[l] * axes[l][i] + other * half[m] * axes[m][i]);
      yield [at, ...capsule(half[k], radius, axes[k], axes[l], axes[m])];
    }
  }
}

// Jolt's shapes of a collider, where they are, and how they are turned. A cylinder without end is a capsule far longer
// than the body.
function* piecesOf(collider, size) {
  const { shape, point, normal, radius, axes, half } = collider;
  const straight = jolt.Quat.prototype.sIdentity();
  if (shape === 'sphere') yield [point, new jolt.SphereShape(radius), straight];
  else if (shape === 'plane')
    yield [point, new jolt.PlaneShape(new jolt.Plane(new jolt.Vec3(...normal), 0), undefined, 1e4), straight];
  else if (shape === 'box') yield* boxPieces(collider);
  else yield [point, ...capsule(Math.min(half[0], ENDLESS * size), radius, ...axes)];
}

// A collider's friction and restitution alone count: Jolt takes the root of the product of both bodies' friction, and
// the larger restitution.
function addCollider(bodies, collider, size) {
  for (const [point, solid, turn] of piecesOf(collider, size)) {
    const at = new jolt.RVec3(...point);
    const settings = new jolt.BodyCreationSettings(solid, at, turn, jolt.EMotionType_Static, 0);
    settings.mFriction = collider.friction * collider.friction;
    settings.mRestitution = collider.restitution;
    bodies.AddBody(bodies.CreateBody(settings).GetID(), jolt.EActivation_DontActivate);
  }
}

// A rigid body of Jolt's own: a rounded box is one box with that convex radius.
function addBody(bodies, body, scene) {
  const [x, y, z, vx, vy, vz, mass] = scene.particles[body.particle];
  const { shape, radius, half, axes } = body;
  const solid = shape === 'sphere' ? new jolt.SphereShape(radius)
    : new jolt.BoxShape(new jolt.Vec3(...half.map((side) => side + radius)), radius);
  const turn = shape === 'sphere' ? jolt.Quat.prototype.sIdentity() : turnOf(axes);
  const settings = new jolt.BodyCreationSettings(solid, new jolt.RVec3(x, y, z), turn, jolt.EMotionType_Dynamic, 1);
  settings.mLinearVelocity = new jolt.Vec3(vx, vy, vz);
  settings.mAngularVelocity = new jolt.Vec3(...body.spin);
  settings.mFriction = body.friction * body.friction;
  settings.mRestitution = body.restitution;
  settings.mLinearDamping = scene.drag;
  settings.mAngularDamping = 0;
  settings.mAllowSleeping = false;
  settings.mMaxLinearVelocity = 1e6;
  settings.mMaxAngularVelocity = 1e6;
  settings.mOverrideMassProperties = jolt.EOverrideMassProperties_CalculateInertia;
  settings.mMassPropertiesOverride.mMass = mass;
  const made = bodies.CreateBody(settings);
  bodies.AddBody(made.GetID(), jolt.EActivation_Activate);
  return { made, start: turn };
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
    makeShape(scene.particles.slice(0, scene.particles.length - scene.bodies.length), scene.springs), new jolt.RVec3(0, 0, 0), jolt.Quat.prototype.sIdentity(), 1);
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
  scene.colliders.forEach((collider) => addCollider(bodies, collider, scene.size));
  made.rigid = scene.bodies.map((body) => addBody(bodies, body, scene));
  made.motion = jolt.castObject(made.body.GetMotionProperties(), jolt.SoftBodyMotionProperties);
  // Jolt shares a body's force out among its vertices
  made.push = new jolt.Vec3(...scene.force.map((f) => f * (scene.particles.length - scene.bodies.length)));
  made.one = new jolt.Vec3(...scene.force);
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
  if (scene.bodies.some((body) => body.hung.length > 0))
    return 'refuse edges of Jolt\'s soft bodies join their own vertices, not rigid bodies\n';
  world = build(scene);
  return `uses substeps ${world.substeps}\nuses updates ${world.updates}\n${ledger(world)}ready\n`;
}

function step() {
  world.body.AddForce(world.push);
  for (const { made } of world.rigid) made.AddForce(world.one);
  world.jolt.Step(world.step, world.updates);
  const { mMin, mMax } = world.motion.GetLocalBounds();
  return [mMin, mMax].every((at) => Number.isFinite(at.GetX() + at.GetY() + at.GetZ())) ? 'ok\n' : 'diverged\n';
}

const list = (vector) => [vector.GetX(), vector.GetY(), vector.GetZ()];

// [2][particles][3] doubles, and of each rigid body, whose centres come last, how it is turned from its start and its
// spin.
function read() {
  const count = world.particles.length;
  const cloth = count - world.rigid.length;
  const state = new Float64Array(6 * count + 7 * world.rigid.length);
  world.rigid.forEach(({ made, start }, i) => {
    const turn = made.GetRotation().MulQuat(start.Conjugated());
    state.set(list(made.GetCenterOfMassPosition()), 3 * (cloth + i));
    state.set(list(made.GetLinearVelocity()), 3 * (count + cloth + i));
    state.set([turn.GetW(), turn.GetX(), turn.GetY(), turn.GetZ(), ...list(made.GetAngularVelocity())], 6 * count + 7 * i);
  });
  for (let i = 0; i < cloth; i++) {
    const { mPosition, mVelocity } = world.motion.GetVertex(i);
    state.set(list(mPosition), 3 * i);
    state.set(list(mVelocity), 3 * (count + i));
  }
  return Buffer.from(state.buffer);
}

function release(particle) {
  const vertex = world.motion.GetVertex(particle);
  vertex.mInvMass = 1 / world.particles[particle][6];
  vertex.mVelocity = new jolt.Vec3(0, 0, 0);
  return '';
}

const numbersOf = (words) => words.map((word) => (word === 'inf' ? Infinity : Number(word)));

// The numbers that are a collider's are taken from the others.
function takeCollider(shape, numbers) {
  const take = (count) => numbers.splice(0, count);
  const collider = { shape, point: take(3) };
  if (shape === 'plane') collider.normal = take(3);
  if (!['plane', 'sphere'].includes(shape)) Object.assign(collider, { axes: [take(3), take(3), take(3)], half: take(3) });
  if (shape !== 'plane') [collider.radius] = take(1);
  [collider.restitution, collider.friction] = take(2);
  return collider;
}

const readCollider = ([shape, ...words]) => takeCollider(shape, numbersOf(words));

function readBody([particle, shape, ...words]) {
  const numbers = numbersOf(words);
  const body = takeCollider(shape, numbers);
  return { ...body, particle: Number(particle), spin: numbers.slice(0, 3), hung: numbers.slice(7) };
}

const springOf = (words) => words.map((word, i) => (i === 5 ? word : numbersOf([word])[0]));
const lists = {
  particles: (words) => words.map(Number), springs: springOf, colliders: readCollider, bodies: readBody,
};

// The lines of a scene, one by one; true at its end.
function sceneReader() {
  const scene = { particles: [], springs: [], colliders: [], bodies: [], settings: {} };
  let kind = null;
  let left = 0;
  const take = (line) => {
    const words = line.split(' ');
    if (left > 0) {
      scene[kind].push(lists[kind](words));
      left -= 1;
    } else if (lists[words[0]]) {
      kind = words[0];
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
models springs rigid damping gravity force drag velocity plane sphere release solids bodies uneven
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
    pace: () => { world.step = Number(argument); return ''; },
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
