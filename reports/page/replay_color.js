// What the colours of a replay tell. A view has data, the replay, values, of each particle, and shownEngines().

// Each particle's values at a time, and the title of their scale.
const colorings = {
	strain: { title: () => "strain of a particle's most stretched spring", unit: "", isThere: (data) => data.rests.length > 0,
		values: (replay, positions, path, time, out) => strainsAt(replay.data, positions, out) },
	distance: { title: (data) => data.paths.has("truth") ? "distance to the truth" : "distance to the first engine", unit: " m", isThere: () => true,
		values: (replay, positions, path, time, out) => distancesAt(replay.data, positions, basePath(replay.data, replay.shownEngines()), time, out) },
	speed: { title: () => "speed", unit: " m/s", isThere: () => true,
		values: (replay, positions, path, time, out) => speedsAt(replay.data, path, time, out) },
};

// What the engine in the middle has at most.
function middleOfMost(view, coloring, end) {
	const positions = new Float32Array(3 * view.data.particles);
	const most = view.shownEngines().map((name) => {
		const path = view.data.paths.get(name);
		return Math.max(...[0.2, 0.4, 0.6, 0.8, 1].map((share) => {
			positionsAt(view.data, path, share * end, positions);
			coloring.values(view, positions, path, share * end, view.values);
			return view.values.reduce((a, b) => Math.max(a, b || 0), 0);
		}));
	}).sort((a, b) => a - b);
	return most[Math.floor(most.length / 2)] || 1e-9;
}
