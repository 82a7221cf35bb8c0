// A solver of one's own as an engine of clothcheck: damped springs by symplectic Euler, in JavaScript.
//     clothcheck run SCENE --engine 'mine=node adapter.js'
const readline = require('node:readline');

let cloth = null;
let scene = null; // while its lines come
let rows = null; // and those of a list

function build({ particles, springs, step, gravity, force, drag, substeps }) {
  const links = springs.map(([a, b, rest, k, c]) => ({ a, b, rest, k, c }));
  const made = {
    x: particles.map((row) => row.slice(0, 3)),
    v: particles.map((row) => row.slice(3, 6)),
    mass: particles.map((row) => row[6]),
    pinned: particles.map((row) => row[7] > 0),
    links, gravity, force, frame: step[0], drag: drag[0],
  };
  const rates = links.map(({ a, b, k }) => (8 * k) / Math.min(made.mass[a], made.mass[b]));
  made.substeps = substeps || Math.max(1, Math.ceil(made.frame * Math.sqrt(Math.max(0, ...rates))));
  return made;
}

function step({ x, v, mass, pinned, links, gravity, force, drag }, dt) {
  const f = mass.map((m, i) => gravity.map((g, axis) => m * (g - drag * v[i][axis]) + force[axis]));
  for (const { a, b, rest, k, c } of links) {
    const d = x[a].map((from, axis) => x[b][axis] - from);
    const length = Math.sqrt(d.reduce((sum, e) => sum + e * e, 0));
    const speed = d.reduce((sum, e, axis) => sum + (e / length) * (v[b][axis] - v[a][axis]), 0);
    const pull = (k * (length - rest) + c * speed) / length;
    d.forEach((e, axis) => {
      f[a][axis] += pull * e;
      f[b][axis] -= pull * e;
    });
  }
  mass.forEach((m, i) => {
    for (let axis = 0; axis < 3 && !pinned[i]; axis++) {
      v[i][axis] += (dt * f[i][axis]) / m;
      x[i][axis] += dt * v[i][axis];
    }
  });
}

// A line of the scene, in SI units; the last one is "end".
function take(line) {
  const [word, ...rest] = line.split(' ');
  const numbers = rest.map(Number);
  if (rows && rows.left) {
    rows.list.push(line.split(' ').map(Number));
    rows.left -= 1;
  } else if (word === 'setting') scene[rest[0]] = Number(rest[1]);
  else if (['particles', 'springs', 'colliders'].includes(word)) rows = { list: (scene[word] = []), left: numbers[0] };
  else if (word !== 'end') scene[word] = numbers;
  else {
    cloth = build(scene);
    scene = rows = null;
    return `uses substeps ${cloth.substeps}\nready\n`;
  }
  return '';
}

function answer(line) {
  if (scene) return take(line);
  if (line === 'clothcheck 1') return 'clothcheck 1\n';
  if (line === 'hello')
    return 'version 1.0\nmodels springs damping gravity force drag velocity release\n' +
      'setting substeps 1 1e6 whole steps a frame\nend\n';
  if (line === 'quit') process.exit(0);
  if (line === 'begin') scene = { substeps: 0 };
  else if (line === 'read') return cloth.x.map((x, i) => `${[...x, ...cloth.v[i]].join(' ')}\n`).join('');
  else if (line.startsWith('release ')) cloth.pinned[Number(line.split(' ')[1])] = false;
  for (let i = 0; line === 'step' && i < cloth.substeps; i++) step(cloth, cloth.frame / cloth.substeps);
  return line === 'step' || line === 'ping' ? 'ok\n' : '';
}

readline.createInterface({ input: process.stdin }).on('line', (line) => process.stdout.write(answer(line)));
