// The question that the page is opened for: which solver for a scene, within an error, and at what cost.

// A scene's rows of summary.csv: {metric, isKnown: whether any error is, uncertainty, rows}.
async function factsOf(scene) {
	const summary = await table("summary.csv");
	const rows = (summary ? summary.rows : []).filter((row) => row.scene === scene && row.engine !== "still");
	const named = rows.find((row) => row.metric) || {};
	return {
		metric: named.metric || "position_rms", isKnown: Boolean(named.metric), uncertainty: number(named.uncertainty) || 0, rows,
	};
}

// What was tried in the precision study: {engine, source, error, told, cost in ms of CPU per simulated second, …}.
async function triedWays(scene, facts) {
	const precision = await table("precision.csv");
	if (!precision || facts.metric !== "position_rms") return [];
	return precision.rows.filter((row) => row.scene === scene && row.status === "ok").map((row) => ({
		engine: row.engine, source: "precision.csv", machine: row.host || "", error: number(row.error),
		told: Math.max(number(row.error), facts.uncertainty), cost: 1e3 * number(row.cpu_s) / number(row.simulated_s),
		substeps: number(row.substeps), iterations: number(row.iterations),
	}));
}

// What the comparison ran at automatic settings.
async function automaticWays(scene, facts) {
	const runs = await table("runs.csv");
	return facts.rows.filter((row) => row.status === "ok" && row.is_better === "1").map((row) => {
		const run = runs.rows.find((other) => other.scene === scene && other.engine === row.engine);
		const part = isPart(row) ? `, of which ${readable(number(row.timed_s))} of ${readable(number(row.duration_s))} s were timed` : "";
		return {
			engine: row.engine, source: "runs.csv" + part, machine: row.machine || "", error: number(row.error),
			told: Math.max(number(row.error), facts.uncertainty), cost: number(row.cpu_ms_per_s),
			substeps: number(run.substeps), iterations: number(run.iterations),
		};
	});
}

// Every way to run a scene: of an engine those of the study where it was in it, for they time the whole scene.
async function waysToRun(scene, facts) {
	const tried = await triedWays(scene, facts), studied = new Set(tried.map((way) => way.engine));
	const automatic = (await automaticWays(scene, facts)).filter((way) => !studied.has(way.engine));
	return ofOneMachine([...tried, ...automatic].filter((way) => way.error >= 0 && way.cost > 0));
}

// Costs of unlike machines say nothing of each other: those of the machine that ran most.
function ofOneMachine(ways) {
	const counts = new Map();
	for (const way of ways) counts.set(way.machine, (counts.get(way.machine) || 0) + 1);
	const [most] = [...counts.entries()].sort((a, b) => b[1] - a[1]);
	return most ? ways.filter((way) => way.machine === most[0]) : ways;
}

// A setting counts where finer steps do no worse: else errors that cancel by chance would be recommended.
function holds(way, ways, tolerance) {
	return ways.every((other) => other.engine !== way.engine || other.iterations !== way.iterations ||
		other.substeps < way.substeps || other.told <= tolerance);
}

// Each engine's cheapest way within an error, cheapest first; and of those that have none, the nearest.
function bestWays(ways, tolerance) {
	const within = new Map(), beyond = new Map();
	for (const way of ways) {
		const best = within.get(way.engine), nearest = beyond.get(way.engine);
		if (holds(way, ways, tolerance) && (!best || way.cost < best.cost)) within.set(way.engine, way);
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

function answerText(scene, tolerance, { within, beyond }, facts) {
	if (!within.length && facts.uncertainty > tolerance)
		return [`The truth of ${scene} is only known to ${percent(facts.uncertainty)}: nobody can say.`];
	if (!within.length && !beyond.length && !facts.isKnown)
		return [`Nobody can say for ${scene}: it has no truth that tells solvers apart. How far they are from each other is below.`];
	if (!within.length && !beyond.length) return [`No engine has an answer on ${scene}: the table says why.`];
	if (!within.length)
		return [`No engine comes within ${percent(tolerance)} on ${scene}; nearest is ${beyond[0].engine}, ${percent(beyond[0].error)} off.`];
	const [best, next] = within;
	const text = [element("strong", { textContent: best.engine }), ` at ${settingsText(best)} a frame: an error of `,
		`${inWords(best.error)} in ${facts.metric} for ${readable(Number(best.cost.toPrecision(3)))} ms of CPU per simulated second, ${readable(frameCost(best.cost))} ms of each 60 Hz frame.`];
	if (facts.uncertainty > best.error) text.push(` (The truth is known to ${percent(facts.uncertainty)}.)`);
	if (next) text.push(` Next is ${next.engine} at ${(next.cost / best.cost).toPrecision(2)} times that.`);
	return text;
}

// An error as people say it, and as it was measured.
function inWords(error) {
	const words = error < 1e-6 ? "less than 0.0001 %" : `${(100 * error).toFixed(Math.max(0, 1 - Math.floor(Math.log10(100 * error))))} %`;
	return `${words} (${readable(Number(error.toPrecision(2)))})`;
}

// The command that prints a program with these settings, where there is one.
function codeCommand(scene, way) {
	if (!looks.get(way.engine)?.hasCode) return "";
	const sets = [`--set ${way.engine}.substeps=${way.substeps}`];
	if (way.iterations > 0) sets.push(`--set ${way.engine}.iterations=${way.iterations}`);
	return `clothcheck code ${scene} --engine ${way.engine} ${sets.join(" ")}`;
}

// The cost of one frame of a game at 60 Hz, in ms, of a cost in ms per simulated second.
function frameCost(cost) {
	return Number((cost / 60).toPrecision(3));
}

function answerRow(scene, way, best, isWithin) {
	const yaml = `settings: {${way.engine}: {substeps: ${way.substeps}${way.iterations > 0 ? `, iterations: ${way.iterations}` : ""}}}`;
	return {
		engine: way.engine, within: isWithin ? "yes" : "no", error: String(way.error), "ms CPU per s": String(way.cost),
		"ms a 60 Hz frame": String(frameCost(way.cost)), "times the cheapest": best ? String(way.cost / best.cost) : "", settings: yaml, "measured in": way.source,
		command: codeCommand(scene, way),
	};
}

// Engines that ran, or failed, and have no way at all, and why.
function otherRows(facts, best) {
	const shown = new Set([...best.within, ...best.beyond].map((way) => way.engine));
	return facts.rows.filter((row) => !shown.has(row.engine) && !isRefusal(row)).map((row) => ({
		engine: row.engine, within: row.status !== "ok" ? row.status : row.error === "nan" ? "no truth" : "no better than still",
		error: row.error === "nan" ? "" : row.error, "ms CPU per s": "", "ms a 60 Hz frame": "", "times the cheapest": "", settings: "", "measured in": "runs.csv",
		command: "",
	}));
}

// Engines that cannot run the scene, with their reasons, folded.
async function showRefusals(scene, facts) {
	const runs = await table("runs.csv");
	const refused = new Set(facts.rows.filter(isRefusal).map((row) => row.engine));
	const rows = (runs ? runs.rows : []).filter((row) => row.scene === scene && refused.has(row.engine));
	foldRefusals(document.getElementById("answer-refusals"), rows, ["engine", "reason"],
		`${rows.length} of the engines cannot run ${scene}`);
}

let answersAsked = 0;

async function showAnswer() {
	const asked = ++answersAsked;
	const scene = document.getElementById("answer-scene").value;
	const tolerance = Number(document.getElementById("answer-error").value);
	const facts = await factsOf(scene);
	facts.rows = facts.rows.filter(isRowShown);
	const best = bestWays((await waysToRun(scene, facts)).filter(isRowShown), tolerance);
	if (asked !== answersAsked) return;
	const rows = [...best.within.map((way) => answerRow(scene, way, best.within[0], true)),
		...best.beyond.map((way) => answerRow(scene, way, best.within[0], false)), ...otherRows(facts, best)];
	document.getElementById("answer-text").replaceChildren(...answerText(scene, tolerance, best, facts));
	document.getElementById("answer-table").replaceChildren(csvTable(
		["engine", "within", "error", "ms CPU per s", "ms a 60 Hz frame", "times the cheapest", "settings", "measured in", "command"], rows,
		"Each engine's cheapest settings from which on finer steps stay within that error, of those that were measured; for the others, the nearest they came. The command prints a program with these settings"));
	await showOwnNames(scene, [...best.within, ...best.beyond]);
	await showRefusals(scene, facts);
}

async function startAnswer() {
	const precision = await table("precision.csv");
	const summary = await table("summary.csv");
	const studied = new Set(precision ? precision.rows.map((row) => row.scene) : []);
	const compared = new Set((summary ? summary.rows : []).map((row) => row.scene));
	const names = report.scenes.map((scene) => scene.name).filter((name) => studied.has(name) || compared.has(name));
	if (!names.length) return;
	const select = document.getElementById("answer-scene");
	const first = ["cloth_two_corners", ...studied].find((name) => names.includes(name));
	fillSelect(select, names, first);
	const error = document.getElementById("answer-error");
	bindState("scene", select);
	bindState("error", error);
	document.getElementById("answer").hidden = false;
	for (const input of [select, error, document.getElementById("shown-engines")])
		input.addEventListener("change", () => showAnswer().catch(showTrouble));
	await showAnswer();
}
