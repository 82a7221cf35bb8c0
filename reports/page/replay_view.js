// What is drawn of a replay: one body an engine, the truth, the colliders. Colour is strain or the engine's own.

// From pale to dark red over the strain's range: lightness alone tells it, too.
function strainColor(share, out, at) {
	const s = Math.min(1, Math.max(0, share));
	out[at] = 0.86 - 0.36 * s;
	out[at + 1] = 0.84 - 0.8 * s;
	out[at + 2] = 0.8 - 0.7 * s;
}

// A mesh's own triangles, and two for each square of a cloth.
function bodyTriangles(replay) {
	const { columns, cloth } = replay, triangles = [...replay.triangles];
	for (let i = 0; columns > 1 && i + columns + 1 < cloth; i++) {
		if (i % columns === columns - 1) continue;
		triangles.push(i, i + columns, i + 1, i + 1, i + columns, i + columns + 1);
	}
	return triangles;
}

// A body's geometry with room for positions and colours, shared by its surface, lines and dots.
function bodyGeometry(replay, positions, colors, index) {
	const geometry = new THREE.BufferGeometry();
	geometry.setAttribute("position", positions);
	if (colors) geometry.setAttribute("color", colors);
	if (index) geometry.setIndex(index);
	geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), Infinity);
	return geometry;
}

// What of a body is drawn as lines: all its springs, and of a cloth, whose truth it is, every third row and column.
function lineEnds(replay) {
	const { columns, cloth, springs } = replay;
	const lastRow = columns ? cloth / columns - 1 : 0;
	const isKept = (place, last) => place % 3 === 0 || place === last;
	const kept = [];
	for (let i = 0; i < springs.length; i += 2) {
		const row = Math.floor(springs[i] / columns), column = springs[i] % columns;
		const isAcross = springs[i + 1] === springs[i] + 1;
		if (!columns || springs[i + 1] >= cloth || (isAcross ? isKept(row, lastRow) : isKept(column, columns - 1))) kept.push(springs[i], springs[i + 1]);
	}
	return kept;
}

// A rigid body, of its radius and half its core.
function makeRigid([radius, ...half]) {
	const isSphere = half.every((side) => side === 0);
	const geometry = isSphere ? new THREE.SphereGeometry(0.99 * radius, 16, 12)
		: new THREE.BoxGeometry(...half.map((side) => 2 * (side + radius)), 2, 2, 2);
	return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0x555555, wireframe: true, transparent: true, opacity: 0.6 }));
}

// Where its centre and the tips of its axes say.
function placeRigid(replay, mesh, index, at) {
	const point = (particle) => new THREE.Vector3(...at.slice(3 * particle, 3 * particle + 3));
	const tip = replay.cloth + replay.bodies.length + 2 * index;
	mesh.position.copy(point(replay.cloth + index));
	const [x, y] = [tip, tip + 1].map((particle) => point(particle).sub(mesh.position).normalize());
	const z = x.clone().cross(y).normalize();
	mesh.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, z.clone().cross(x), z));
}

// {group, positions, colors, rigid}: changed by showBody. A cloth is a surface, its truth and all other bodies are lines: many
// lines are what drawing without a graphics processor spends its time on.
function makeBody(replay, ghost) {
	const positions = new THREE.BufferAttribute(new Float32Array(3 * replay.particles), 3);
	const colors = ghost ? null : new THREE.BufferAttribute(new Float32Array(3 * replay.particles), 3);
	const look = ghost ? { color: 0x555555, transparent: true, opacity: 0.45 } : { vertexColors: THREE.VertexColors };
	const group = new THREE.Group();
	const triangles = bodyTriangles(replay);
	const isSurface = triangles.length > 0 && !ghost;
	if (isSurface) {
		const surface = new THREE.MeshBasicMaterial({ ...look, side: THREE.DoubleSide, polygonOffset: true,
			polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
		group.add(new THREE.Mesh(bodyGeometry(replay, positions, colors, triangles), surface));
	}
	if (replay.springs.length && !isSurface)
		group.add(new THREE.LineSegments(bodyGeometry(replay, positions, colors, lineEnds(replay)), new THREE.LineBasicMaterial(look)));
	if (replay.cloth <= 64) {
		const dots = bodyGeometry(replay, positions, colors);
		dots.setDrawRange(0, replay.cloth);
		group.add(new THREE.Points(dots, new THREE.PointsMaterial({ ...look, size: ghost ? 14 : 8, sizeAttenuation: false })));
	}
	const rigid = replay.bodies.map(makeRigid);
	for (const body of rigid) group.add(body);
	return { group, positions, colors, rigid };
}

// Darkens what turns away from a light beside the camera's first place, so that folds show.
function shadeCloth(replay, at, colors) {
	const { columns, cloth } = replay;
	for (let i = 0; columns > 1 && i < cloth; i++) {
		const across = i % columns === columns - 1 ? i - 1 : i, down = i + columns < cloth ? i : i - columns;
		const [ax, ay, az] = [0, 1, 2].map((axis) => at[3 * (across + 1) + axis] - at[3 * across + axis]);
		const [dx, dy, dz] = [0, 1, 2].map((axis) => at[3 * (down + columns) + axis] - at[3 * down + axis]);
		const nx = ay * dz - az * dy, ny = az * dx - ax * dz, nz = ax * dy - ay * dx;
		const light = Math.abs(0.3 * nx + 0.5 * ny + 0.81 * nz) / (Math.hypot(nx, ny, nz) || 1);
		for (let axis = 0; axis < 3; axis++) colors[3 * i + axis] *= 0.55 + 0.45 * light;
	}
}

//   values  of each particle, coloured over their range; null where the colour is the engine's own
function paintBody(replay, body, values, range, engine) {
	const out = body.colors.array;
	if (engine) {
		const color = new THREE.Color(engine);
		for (let i = 0; i < replay.particles; i++) color.toArray(out, 3 * i);
	} else
		for (let i = 0; i < replay.particles; i++) strainColor(values[i] / range, out, 3 * i);
	for (const { material } of body.rigid) material.color.set(engine || 0x555555);
	shadeCloth(replay, body.positions.array, out);
	body.colors.needsUpdate = true;
}

// Moves a body to a time; false where the run had ended or flown off, and the body is hidden.
function showBody(replay, body, path, time) {
	positionsAt(replay, path, time, body.positions.array);
	body.group.visible = !body.positions.array.some(Number.isNaN);
	body.positions.needsUpdate = true;
	body.rigid.forEach((mesh, index) => placeRigid(replay, mesh, index, body.positions.array));
	return body.group.visible;
}

// Along the first axis; what is round is made to stand along the second.
function solidGeometry(collider) {
	const radius = 0.99 * collider[3], [along, second, third] = collider.slice(13);
	if (collider.shape === "sphere") return new THREE.SphereGeometry(radius, 24, 16);
	if (collider.shape === "box")
		return new THREE.BoxGeometry(...[along, second, third].map((half) => 2 * (half + radius)), 4, 4, 4);
	if (collider.shape === "cylinder")
		return new THREE.CylinderGeometry(radius, radius, 2 * along, 24, 8, true).rotateZ(Math.PI / 2);
	const outline = [];
	for (let angle = -6; angle <= 6; angle++) {
		const turn = angle / 6 * Math.PI / 2;
		outline.push(new THREE.Vector2(radius * Math.cos(turn), radius * Math.sin(turn) + Math.sign(angle) * along));
	}
	return new THREE.LatheGeometry(outline, 24).rotateZ(Math.PI / 2);
}

//   size  m, of what is to be seen: half the side of a plane
function makeColliders(replay, size) {
	const group = new THREE.Group();
	const place = (object, collider) => {
		object.position.set(...collider.slice(0, 3));
		object.userData = { at: collider.slice(0, 3), moves: collider.moves };
		group.add(object);
	};
	for (const collider of replay.solids) {
		const solid = new THREE.Mesh(solidGeometry(collider),
			new THREE.MeshBasicMaterial({ color: 0x9aa7b5, wireframe: true, transparent: true, opacity: 0.5 }));
		if (collider.shape !== "sphere") {
			const axes = [4, 7, 10].map((at) => new THREE.Vector3(...collider.slice(at, at + 3)));
			solid.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(...axes));
		}
		place(solid, collider);
	}
	for (const collider of replay.planes) {
		const grid = new THREE.GridHelper(2 * size, 20, 0xb0b8c0, 0xd5dae0);
		grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...collider.slice(3)));
		place(grid, collider);
	}
	return group;
}

// Moves the colliders that move to a time.
function moveColliders(group, time) {
	for (const { position, userData } of group.children) {
		if (!userData.moves) continue;
		const moved = movedAt(userData.moves, time);
		position.set(...userData.at.map((start, axis) => start + moved[axis]));
	}
}

// The least and largest corner of where paths go: what the camera looks at.
function boundsOf(replay, names) {
	const box = new THREE.Box3(), point = new THREE.Vector3();
	for (const name of names) {
		const path = replay.paths.get(name), stride = 3 * Math.max(1, Math.floor(path.length / 3 / 20000));
		for (let i = 0; i < path.length; i += stride)
			if (!Number.isNaN(path[i])) box.expandByPoint(point.set(path[i], path[i + 1], path[i + 2]));
	}
	return box;
}

// How far from the middle of a box a camera sees all of it, and a tenth more.
//   away  from the middle to the camera, of length 1;  fov  degrees, from top to bottom;  aspect  width by height
function fitDistance(box, away, fov, aspect) {
	const middle = box.getCenter(new THREE.Vector3()), tangent = Math.tan(fov / 2 * Math.PI / 180);
	const right = new THREE.Vector3(0, 1, 0).cross(away).normalize(), up = away.clone().cross(right);
	let distance = 1e-3;
	for (let corner = 0; corner < 8; corner++) {
		const at = new THREE.Vector3(...["x", "y", "z"].map((axis, i) => (corner >> i & 1 ? box.max : box.min)[axis])).sub(middle);
		const needed = Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) / aspect) / tangent;
		distance = Math.max(distance, at.dot(away) + needed);
	}
	return 1.1 * distance;
}

// How many views stand beside each other where they are as large as can be.
function columnsFor(count, width, height) {
	const side = (columns) => Math.min(width / columns, height / Math.ceil(count / columns));
	let best = 1;
	for (let columns = 2; columns <= count; columns++) if (side(columns) > side(best)) best = columns;
	return best;
}

// Arrow keys turn a camera about what it looks at, + and - bring it closer. False for any other key.
function turnCamera(camera, target, key) {
	const turns = { ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, -0.1, 1], ArrowDown: [0, 0.1, 1],
		"+": [0, 0, 0.9], "-": [0, 0, 1.1] };
	if (!turns[key]) return false;
	const [around, over, closer] = turns[key];
	const place = new THREE.Spherical().setFromVector3(camera.position.clone().sub(target));
	place.theta += around;
	place.phi += over;
	place.radius *= closer;
	place.makeSafe();
	camera.position.setFromSpherical(place).add(target);
	return true;
}
