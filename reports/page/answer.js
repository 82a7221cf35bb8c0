// The question that the page is opened for: which solver for a scene, within an error, and at what cost.

// Every way to run a scene that was measured: {engine, settings, error, cost}, cost in ms of CPU per simulated second.
async function waysToRun(scene) {
	const precision = await table("precision.csv");
	const summary = await table("summary.csv");
	const tried = (precision ? precision.rows : []).filter((row) => row.scene === scene && row.status === "ok")
		.map((row) => ({
			engine: row.engine, error: number(row.error), cost: 1e3 * number(row.cpu_s) / number(row.simulated_s),
			substeps: number(row.substeps), iterations: number(row.iterations),
		}));
	const runs = await table("runs.csv");
	const automatic = (summary ? summary.rows : []).filter((row) => row.scene === scene && row.status === "ok").map((row) => {
		const run = runs.rows.find((other) => other.scene === scene && other.engine === row.engine);
		return {
			engine: row.engine, error: number(row.error), cost: number(row.cpu_ms_per_s), metric: row.metric,
			substeps: number(run.substeps), iterations: number(run.iterations),
		};
	});
	return [...tried, ...automatic].filter((way) => way.engine !== "null" && way.error >= 0 && way.cost > 0);
}

// Each engine's cheapest way within an error, cheapest first; and of those that have none, the nearest.
function bestWays(ways, tolerance) {
	const within = new Map(), beyond = new Map();
	for (const way of ways) {
		const best = within.get(way.engine), nearest = beyond.get(way.engine);
		if (way.error <= tolerance && (!best || way.cost < best.cost)) within.set(way.engine, way);
		if (!nearest || way.error < nearest.error) beyond.set(way.engine, way);
	}
	for (const engine of within.keys()) beyond.delete(engine);
	return {
		within: [...within.values()].sort((a, b) => a.cost - b.cost),
		beyond: [...beyond.values()].sort((a, b) => a.error - b.error),
	};
}

function settingsText(way) {
	const substeps = `${way.substeps} substep${way.substeps === 1 ? "" : "s"}`;
	return way.iterations > 0 ? `${substeps}, ${way.iterations} iteration${way.iterations === 1 ? "" : "s"}` : substeps;
}

function answerText(scene, tolerance, { within, beyond }) {
	if (!within.length)
		return [`No engine comes within ${percent(tolerance)} on ${scene}`,
			beyond.length ? `; nearest is ${beyond[0].engine}, ${percent(beyond[0].error)} off.` : "."];
	const [best, next] = within;
	const text = [element("strong", { textContent: best.engine }), ` at ${settingsText(best)} a frame: an error of `,
		`${percent(best.error)} for ${readable(Number(best.cost.toPrecision(3)))} ms of CPU per simulated second.`];
	if (next) text.push(` Next is ${next.engine} at ${(next.cost / best.cost).toPrecision(2)} times that.`);
	return text;
}

function answerRow(way, best, isWithin) {
	const yaml = `${way.engine}: {substeps: ${way.substeps}${way.iterations > 0 ? `, iterations: ${way.iterations}` : ""}}`;
	return {
		engine: way.engine, within: isWithin ? "yes" : "no", error: String(way.error), "ms CPU per s": String(way.cost),
		"times the cheapest": best ? String(way.cost / best.cost) : "", settings: yaml,
	};
}

async function showAnswer() {
	const scene = document.getElementById("answer-scene").value;
	const tolerance = Number(document.getElementById("answer-error").value);
	const best = bestWays(await waysToRun(scene), tolerance);
	const rows = [...best.within.map((way) => answerRow(way, best.within[0], true)),
		...best.beyond.map((way) => answerRow(way, best.within[0], false))];
	document.getElementById("answer-text").replaceChildren(...answerText(scene, tolerance, best));
	document.getElementById("answer-table").replaceChildren(csvTable(
		["engine", "within", "error", "ms CPU per s", "times the cheapest", "settings"], rows,
		"Each engine's cheapest settings within that error, of those that were measured; for the others, the nearest they came"));
}

async function startAnswer() {
	const precision = await table("precision.csv");
	const summary = await table("summary.csv");
	const studied = new Set(precision ? precision.rows.map((row) => row.scene) : []);
	const measured = new Set((summary ? summary.rows : []).filter((row) => row.error !== "nan" && row.error !== "").map((row) => row.scene));
	const names = report.scenes.map((scene) => scene.name).filter((name) => studied.has(name) || measured.has(name));
	if (!names.length) return;
	const select = document.getElementById("answer-scene");
	const first = ["cloth_two_corners", ...studied].find((name) => names.includes(name));
	fillSelect(select, names, first);
	document.getElementById("answer").hidden = false;
	select.addEventListener("change", showAnswer);
	document.getElementById("answer-error").addEventListener("change", showAnswer);
	await showAnswer();
}
