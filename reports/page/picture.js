// A small picture of a scene and its sentence, for lists: its body at the end, by its truth or its first engine. It is drawn
// when it comes into sight, as replays take time to unpack.

const pictureSize = [96, 64];

// Places as seen from in front, above and the right: [x, y] of each, y downwards.
function seenFrom(positions, count) {
	const away = [0.47, 0.3, 0.83], right = [0.87, 0, -0.49], up = [-0.15, 0.95, -0.26], seen = [];
	for (let i = 0; i < count; i++) {
		const along = (axis) => axis[0] * positions[3 * i] + axis[1] * positions[3 * i + 1] + axis[2] * positions[3 * i + 2];
		seen.push([along(right), -along(up), along(away)]);
	}
	return seen;
}

// What fits all of these into the picture: (place) => [x, y] in pixels, with how many pixels a metre has.
function fitPicture(places) {
	const shown = places.filter(([x, y]) => Number.isFinite(x + y));
	const low = [0, 1].map((k) => Math.min(...shown.map((place) => place[k]))), high = [0, 1].map((k) => Math.max(...shown.map((place) => place[k])));
	const scale = Math.min(...[0, 1].map((k) => (pictureSize[k] - 10) / Math.max(high[k] - low[k], 1e-9)));
	const fit = (place) => [0, 1].map((k) => pictureSize[k] / 2 + scale * (place[k] - (low[k] + high[k]) / 2));
	return Object.assign(fit, { scale });
}

// Balls count as far as they reach; planes and what has no end do not.
function roundSolids(replay) {
	return replay.solids.filter((solid) => solid.shape === "sphere").map((solid) => ({ at: seenFrom(solid, 1)[0], radius: solid[3] }));
}

function paintPicture(canvas, replay) {
	const path = basePath(replay, [...replay.paths.keys()]), width = 3 * replay.particles;
	let last = replay.times.length - 1;
	while (last > 0 && Number.isNaN(path[last * width])) last--;
	const seen = seenFrom(path.subarray(last * width, (last + 1) * width), replay.particles), balls = roundSolids(replay);
	const corners = balls.flatMap(({ at, radius }) => [[at[0] - radius, at[1] - radius], [at[0] + radius, at[1] + radius]]);
	const fit = fitPicture([...seen.slice(0, replay.cloth), ...corners]), context = canvas.getContext("2d");
	// to be seen on light and dark
	const color = "#7a7f86";
	context.strokeStyle = color;
	context.globalAlpha = 0.35;
	for (const { at, radius } of balls) {
		context.beginPath();
		context.arc(...fit(at), radius * fit.scale, 0, 2 * Math.PI);
		context.stroke();
	}
	// of many springs each is a hair, so that a cloth is grey and its folds are dark
	context.globalAlpha = replay.springs.length > 200 ? 0.3 : 0.9;
	context.beginPath();
	for (let i = 0; i < replay.springs.length; i += 2) {
		context.moveTo(...fit(seen[replay.springs[i]]));
		context.lineTo(...fit(seen[replay.springs[i + 1]]));
	}
	context.stroke();
	context.globalAlpha = 1;
	context.fillStyle = color;
	for (const place of replay.cloth <= 64 ? seen.slice(0, replay.cloth) : []) {
		context.beginPath();
		context.arc(...fit(place), 2, 0, 2 * Math.PI);
		context.fill();
	}
	canvas.dataset.drawn = "yes";
}

const pictureWatch = new IntersectionObserver((entries) => {
	for (const { isIntersecting, target } of entries) {
		if (!isIntersecting) continue;
		pictureWatch.unobserve(target);
		fileBytes(target.dataset.scene + ".replay").then((bytes) => paintPicture(target, parseReplay(bytes)));
	}
});

// Nothing for a scene without a replay. It takes its room at once: a row that grew later would slip away under a click.
function scenePicture(name) {
	const file = document.getElementById(`file:${name}.replay`);
	if (!file) return [];
	const canvas = element("canvas", { className: "picture", width: pictureSize[0], height: pictureSize[1] });
	canvas.dataset.scene = name;
	canvas.setAttribute("aria-hidden", "true");
	pictureWatch.observe(canvas);
	return [canvas, element("small", { className: "sentence", textContent: file.dataset.about })];
}
