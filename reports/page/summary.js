// The matrix of scenes and engines, and the list of what failed.

const classSigns = ["✓✓", "✓", "~", "✗", "", "", ""];
const classWords = ["within 0.1 %", "within 1 %", "within 10 %", "worse than 10 %, or no better than moving nothing", "no truth",
	"failed", "not to be had"];

// True where the truth is known less well than the error is small.
function isVague(row) {
	return number(row.uncertainty) > number(row.error);
}

// True where the cost is of the scene's beginning only, which may be busier or quieter than the rest.
function isPart(row) {
	return number(row.timed_s) < 0.7 * number(row.duration_s);
}

// Of an error, as in summary.csv: within 0.1 %, 1 %, 10 %, beyond; or unknown.
function classOf(error) {
	return Number.isNaN(error) ? 4 : error <= 1e-3 ? 0 : error <= 1e-2 ? 1 : error <= 1e-1 ? 2 : 3;
}

function isRefusal(row) {
	return ["unsupported", "refused"].includes(row.status);
}

// Rows of summary.csv with the error of another metric; one with a unit is told as a share of its truth.
function ofMetric(rows, metric, metrics) {
	if (!metric) return rows;
	const found = new Map(metrics.filter((row) => row.metric === metric).map((row) => [`${row.scene} ${row.engine}`, row]));
	return rows.map((row) => {
		const other = found.get(`${row.scene} ${row.engine}`);
		if (Number(row.class) >= 5) return row;
		const scale = other && other.unit !== "1" ? Math.abs(number(other.truth)) : 1;
		const error = other ? number(other.error) / scale : NaN, uncertainty = other ? number(other.truth_uncertainty) / scale : NaN;
		return { ...row, metric, error: String(error), uncertainty: String(uncertainty), class: String(classOf(Math.max(error, uncertainty || 0))) };
	});
}

function summaryCell(row, isCheapest) {
	if (!row) return element("td");
	const kind = Number(row.class);
	const made = element("td", { className: "class-" + kind, title: `${row.engine} on ${row.scene}: ${classWords[kind]}${row.machine ? `; timed on ${row.machine}` : ""}` });
	Object.assign(made.dataset, { engine: row.engine, error: row.error, cost: row.cpu_ms_per_s, status: row.status });
	const error = number(row.error), cost = number(row.cpu_ms_per_s);
	if (kind >= 5) made.append(row.status);
	else made.append(`${classSigns[kind]} ${Number.isNaN(error) ? "no truth" : percent(error)}${isVague(row) ? " ?" : ""}`);
	if (isCheapest) made.append(" ★");
	if (!Number.isNaN(cost) && kind < 5)
		made.append(element("small", { textContent: `${isPart(row) ? "≈ " : ""}${readable(Number(cost.toPrecision(3)))} ms` }));
	return made;
}

// The cheapest within 1 % of those that are shown, on each machine.
function cheapestOf(rows) {
	const best = new Map();
	for (const row of rows) {
		const cost = number(row.cpu_ms_per_s), before = best.get(row.machine);
		if (Number(row.class) <= 1 && cost > 0 && (!before || cost < number(before.cpu_ms_per_s))) best.set(row.machine, row);
	}
	return new Set(best.values());
}

function summaryRow(scene, engines, rows) {
	const link = element("a", { href: `#scene=${encodeURIComponent(scene)}`, textContent: scene });
	const metric = rows.map((row) => row.metric).find((name) => name) || "", cheapest = cheapestOf(rows);
	const cellOf = (row) => summaryCell(row, cheapest.has(row));
	return element("tr", {}, element("th", { scope: "row" }, link, ...scenePicture(scene)), element("td", { textContent: metric }),
		...engines.map((engine) => cellOf(rows.find((row) => row.engine === engine))));
}

// An engine that none of the scenes can be run by has no column.
function showSummary(summary, metrics) {
	const all = ofMetric(summary.rows.filter(isRowShown), document.getElementById("summary-metric").value, metrics);
	const names = report.engines.map((engine) => engine.name).filter((name) => all.some((row) => row.engine === name));
	const engines = names.filter((name) => all.some((row) => row.engine === name && !isRefusal(row)));
	const leftOut = names.filter((name) => !engines.includes(name));
	const heading = element("tr", {}, element("th", { scope: "col", textContent: "scene" }),
		element("th", { scope: "col", textContent: "error of" }),
		...engines.map((engine) => element("th", { scope: "col" }, engineName(engine))));
	const body = [...new Set(all.map((row) => row.scene))].map((scene) =>
		summaryRow(scene, engines, all.filter((row) => row.scene === scene)));
	document.getElementById("summary-table").replaceChildren(
		element("table", {}, element("thead", {}, heading), element("tbody", {}, ...body)));
	document.getElementById("summary-left-out").textContent =
		leftOut.length ? `Without a column, for none of these scenes can be run in them: ${leftOut.join(", ")}.` : "";
}

async function startSummary() {
	const summary = await table("summary.csv"), metrics = (await table("metrics.csv"))?.rows || [];
	if (!summary) return;
	const select = document.getElementById("summary-metric");
	const names = [...new Set(metrics.filter((row) => !Number.isNaN(number(row.error))).map((row) => row.metric))];
	select.append(...names.map((name) => element("option", { value: name, textContent: name })));
	bindState("metric", select);
	for (const input of [select, document.getElementById("shown-engines")])
		input.addEventListener("change", () => showSummary(summary, metrics));
	showSummary(summary, metrics);
	document.getElementById("summary").hidden = false;
}

// What went wrong comes first, what an engine does not model at all is folded.
function showFailures(runs) {
	const failed = runs.rows.filter((row) => row.status !== "ok" && isRowShown(row));
	const columns = ["status", "scene", "engine", "reason", "command"];
	const broken = failed.filter((row) => !isRefusal(row)), refused = failed.filter(isRefusal);
	document.getElementById("failures-table").replaceChildren(broken.length
		? csvTable(columns, broken, `${broken.length} of ${runs.rows.length} runs; the command repeats one`)
		: `None of ${runs.rows.length} runs failed.`);
	foldRefusals(document.getElementById("refusals"), refused, columns, `${refused.length} of ${runs.rows.length} runs could not be had`);
	document.getElementById("failures").hidden = !failed.length;
}

async function startFailures() {
	const runs = await table("runs.csv");
	if (!runs) return;
	document.getElementById("shown-engines").addEventListener("change", () => showFailures(runs));
	showFailures(runs);
}
