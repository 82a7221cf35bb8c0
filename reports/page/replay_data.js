// A packed replay (src/replay.h) as arrays.

const noPosition = 1 << 21;

// Undoes the differences of one path's codes of 24 bits: to the frame before, and where it is led to the first path's.
function unpackCodes(bytes, first, width) {
	const count = bytes.length / 3, codes = new Uint32Array(count);
	for (let i = 0; i < count; i++) {
		const zigzag = bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16);
		let change = (zigzag >>> 1) ^ -(zigzag & 1);
		if (first) change += first[i] - (i < width ? 0 : first[i - width]);
		codes[i] = (change + (i < width ? 0 : codes[i - width])) & 0xffffff;
	}
	return codes;
}

// [frames][particles][3] m, NaN where there is no position.
function positionsOf(codes, least, largest) {
	const positions = new Float32Array(codes.length);
	for (let i = 0; i < codes.length; i++) {
		const axis = i % 3;
		positions[i] = codes[i] === noPosition ? NaN : least[axis] + (largest[axis] - least[axis]) * (codes[i] / (noPosition - 1));
	}
	return positions;
}

// Of each: its middle, its radius, and of all but a sphere three axes and half the core along them.
const solidKinds = ["sphere", "capsule", "cylinder", "box"];

function parseHeader(text) {
	const header = { paths: [], planes: [], solids: [], bodies: [] };
	let last = [];
	for (const line of text.split("\n")) {
		const [key, ...words] = line.split(" ");
		if (key === "path") header.paths.push(words[0]);
		else if (key === "about") header.about = words.join(" ");
		else if (key === "plane") header.planes.push(last = words.map(Number));
		else if (solidKinds.includes(key)) header.solids.push(last = Object.assign(words.map(Number), { shape: key }));
		else if (key === "body") header.bodies.push(words.map(Number));
		else if (key === "moves") last.moves = words.map(Number);
		else if (["columns", "particles", "springs", "triangles", "frames"].includes(key)) header[key] = Number(words[0]);
	}
	// behind the cloth's particles each rigid body has its centre, and behind these the tips of its first two axes
	header.cloth = header.particles - 3 * header.bodies.length;
	return header;
}

// {columns, particles, cloth, planes, solids, bodies, times, springs, rests, triangles, paths: Map of name to positions}
function parseReplay(buffer) {
	const bytes = new Uint8Array(buffer);
	const start = new TextDecoder("latin1").decode(bytes.subarray(0, 1 << 13));
	const headerSize = start.indexOf("\ndata\n") + "\ndata\n".length;
	const replay = parseHeader(new TextDecoder().decode(bytes.subarray(0, headerSize)));
	const names = replay.paths;
	let at = headerSize;
	const take = (Kind, count) => {
		const part = new Kind(buffer.slice(at, at + count * Kind.BYTES_PER_ELEMENT));
		at += count * Kind.BYTES_PER_ELEMENT;
		return part;
	};
	replay.times = take(Float32Array, replay.frames);
	replay.springs = take(Int32Array, 2 * replay.springs);
	replay.rests = take(Float32Array, replay.springs.length / 2);
	replay.triangles = take(Int32Array, 3 * replay.triangles);
	replay.paths = new Map();
	const width = 3 * replay.particles, count = replay.frames * width;
	let first = null;
	for (const name of names) {
		const isLed = take(Uint8Array, 1)[0] === 1;
		const least = take(Float32Array, 3), largest = take(Float32Array, 3);
		const codes = unpackCodes(take(Uint8Array, 3 * count), isLed ? first : null, width);
		first ??= codes;
		replay.paths.set(name, positionsOf(codes, least, largest));
	}
	return replay;
}

// How far a collider has come at a time: of [t, x, y, z, …], on straight lines.
function movedAt(moves, time) {
	let i = 0;
	while (i < moves.length - 8 && moves[i + 4] <= time) i += 4;
	const share = Math.min(1, Math.max(0, (time - moves[i]) / (moves[i + 4] - moves[i])));
	return [1, 2, 3].map((axis) => (1 - share) * moves[i + axis] + share * moves[i + 4 + axis]);
}

// Positions at a time, between frames on straight lines. Into out [3·particles].
function positionsAt(replay, path, time, out) {
	const { times, particles } = replay, width = 3 * particles;
	let frame = 0;
	while (frame < times.length - 2 && times[frame + 1] <= time) frame++;
	const next = Math.min(frame + 1, times.length - 1);
	const share = next > frame ? Math.min(1, Math.max(0, (time - times[frame]) / (times[next] - times[frame]))) : 0;
	for (let i = 0; i < width; i++)
		out[i] = (1 - share) * path[frame * width + i] + (share > 0 ? share * path[next * width + i] : 0);
}

// Each particle's largest strain of its springs. Into out [particles].
function strainsAt(replay, positions, out) {
	const { springs, rests } = replay;
	out.fill(0);
	for (let i = 0; i < rests.length; i++) {
		const a = springs[2 * i], b = springs[2 * i + 1];
		const length = Math.hypot(positions[3 * a] - positions[3 * b], positions[3 * a + 1] - positions[3 * b + 1],
			positions[3 * a + 2] - positions[3 * b + 2]);
		const strain = rests[i] > 0 ? length / rests[i] - 1 : 0;
		if (strain > out[a]) out[a] = strain;
		if (strain > out[b]) out[b] = strain;
	}
}

// The path that others are measured from: the truth's, or the first one's.
function basePath(replay, names) {
	return replay.paths.get("truth") || replay.paths.get(names[0]);
}

// Each particle's distance to a path at a time, m. Into out [particles].
function distancesAt(replay, positions, base, time, out) {
	const there = new Float32Array(positions.length);
	positionsAt(replay, base, time, there);
	for (let i = 0; i < out.length; i++)
		out[i] = Math.hypot(positions[3 * i] - there[3 * i], positions[3 * i + 1] - there[3 * i + 1], positions[3 * i + 2] - there[3 * i + 2]);
}

// Each particle's speed between the frames about a time, m/s. Into out [particles].
function speedsAt(replay, path, time, out) {
	const { times } = replay, width = 3 * replay.particles;
	let frame = 0;
	while (frame < times.length - 2 && times[frame + 1] <= time) frame++;
	const next = Math.min(frame + 1, times.length - 1), step = times[next] - times[frame];
	for (let i = 0; i < out.length; i++) {
		const change = (axis) => path[next * width + 3 * i + axis] - path[frame * width + 3 * i + axis];
		out[i] = step > 0 ? Math.hypot(change(0), change(1), change(2)) / step : 0;
	}
}

// The time at which paths are farthest, rms, from a truth that moves, or else from the first of them; the end where all
// are one.
function widestTime(replay, names) {
	const truth = replay.paths.get("truth"), width = 3 * replay.particles, last = (replay.times.length - 1) * width;
	const base = truth?.some((at, i) => i < width && at !== truth[last + i]) ? truth : replay.paths.get(names[0]);
	let widest = replay.times.length - 1, most = 0;
	for (const name of names)
		for (let frame = 0; frame < replay.times.length; frame++) {
			let sum = 0;
			for (let i = frame * width; i < (frame + 1) * width; i++) sum += (replay.paths.get(name)[i] - base[i]) ** 2;
			if (sum > most) [most, widest] = [sum, frame];
		}
	return replay.times[widest];
}
