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

function summaryCell(row) {
	if (!row) return element("td");
	const kind = Number(row.class);
	const made = element("td", { className: "class-" + kind, title: `${row.engine} on ${row.scene}: ${classWords[kind]}${row.machine ? `; timed on ${row.machine}` : ""}` });
	made.dataset.engine = row.engine;
	made.dataset.error = row.error;
	made.dataset.cost = row.cpu_ms_per_s;
	made.dataset.status = row.status;
	const error = number(row.error), cost = number(row.cpu_ms_per_s);
	if (kind >= 5) made.append(row.status);
	else made.append(`${classSigns[kind]} ${Number.isNaN(error) ? "no truth" : percent(error)}${isVague(row) ? " ?" : ""}`);
	if (row.is_cheapest === "1") made.append(" ★");
	if (!Number.isNaN(cost) && kind < 5)
		made.append(element("small", { textContent: `${isPart(row) ? "≈ " : ""}${readable(Number(cost.toPrecision(3)))} ms` }));
	return made;
}

function summaryRow(scene, engines, rows, open) {
	const link = element("a", { href: "#scene", textContent: scene });
	link.addEventListener("click", () => open(scene));
	const metric = rows.map((row) => row.metric).find((name) => name) || "";
	return element("tr", {}, element("th", { scope: "row" }, link), element("td", { textContent: metric }),
		...engines.map((engine) => summaryCell(rows.find((row) => row.engine === engine))));
}

// open is called with the scene whose name is clicked.
async function startSummary(open) {
	const summary = await table("summary.csv");
	if (!summary) return;
	const engines = report.engines.map((engine) => engine.name)
		.filter((name) => summary.rows.some((row) => row.engine === name));
	const scenes = [...new Set(summary.rows.map((row) => row.scene))];
	const heading = element("tr", {}, element("th", { scope: "col", textContent: "scene" }),
		element("th", { scope: "col", textContent: "error of" }),
		...engines.map((engine) => element("th", { scope: "col" }, engineName(engine))));
	const body = scenes.map((scene) =>
		summaryRow(scene, engines, summary.rows.filter((row) => row.scene === scene), open));
	document.getElementById("summary-table").append(
		element("table", {}, element("thead", {}, heading), element("tbody", {}, ...body)));
	document.getElementById("summary").hidden = false;
}

// What went wrong comes first, what an engine does not model at all last.
async function startFailures() {
	const runs = await table("runs.csv");
	const failed = runs ? runs.rows.filter((row) => row.status !== "ok") : [];
	if (!failed.length) return;
	const isRefusal = (row) => ["unsupported", "refused"].includes(row.status);
	const rows = [...failed.filter((row) => !isRefusal(row)), ...failed.filter(isRefusal)];
	document.getElementById("failures-table").append(csvTable(["status", "scene", "engine", "reason", "command"], rows,
		`${rows.length} of ${runs.rows.length} runs; the command repeats one`));
	document.getElementById("failures").hidden = false;
}
