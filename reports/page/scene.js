// What there is of one scene, and of all: charts, and the rows of each CSV.

async function chartFigure(chart, scene) {
	const title = (scene ? scene + ": " : "") + chart.title, drawing = await chartElement(chart.file, title);
	const links = ["svg", "png", "csv"].flatMap((ending) =>
		[" ", element("a", { href: `charts/${chart.file}.${ending}`, textContent: ending })]);
	const figure = element("figure", {}, drawing, element("figcaption", {}, title + ":", ...links));
	figure.dataset.chart = chart.name;
	return figure;
}

async function chartBox(charts, scene) {
	return element("div", { className: "charts" }, ...(await Promise.all(charts.map((chart) => chartFigure(chart, scene)))));
}

// Opened, a table is made; most are never looked at.
function tableDetails(title, columns, rows) {
	const details = element("details", {}, element("summary", { textContent: `${title} (${rows.length} rows)` }));
	details.addEventListener("toggle", () => {
		if (details.open && details.children.length === 1) details.append(wideTable(columns, rows, title));
	});
	details.dataset.file = title.split(":")[0];
	return details;
}

async function sceneTables(scene) {
	const made = [];
	for (const { file, about } of report.tables) {
		const found = await table(file);
		if (!found || !found.columns.includes("scene")) continue;
		const rows = found.rows.filter((row) => row.scene === scene && isRowShown(row));
		const columns = found.columns.filter((column) => column !== "scene");
		if (rows.length) made.push(tableDetails(`${file}: ${about}`, columns, rows));
	}
	return made;
}

let scenesAsked = 0;

// Whoever asks for another scene while this one is unpacked gets the other one.
async function showScene(name, replay) {
	const asked = ++scenesAsked;
	const isWanted = () => asked === scenesAsked;
	const section = document.getElementById("scene");
	section.ariaBusy = "true";
	document.getElementById("scene-select").value = name;
	const scene = report.scenes.find((one) => one.name === name);
	try {
		const [charts, tables] = await Promise.all([chartBox(scene.charts, name), sceneTables(name)]);
		if (!isWanted()) return;
		document.getElementById("scene-charts").replaceChildren(charts);
		document.getElementById("scene-tables").replaceChildren(...tables);
		await replay.load(name, isWanted);
	} finally {
		if (isWanted()) section.ariaBusy = "false";
	}
}

async function startGeneral() {
	const box = document.getElementById("general-tables");
	for (const { file, about } of report.tables) {
		const found = await table(file);
		if (found && !found.columns.includes("scene")) box.append(tableDetails(`${file}: ${about}`, found.columns, found.rows));
	}
	if (report.charts.length) document.getElementById("general-charts").append(await chartBox(report.charts, null));
	document.getElementById("general").hidden = !box.children.length && !report.charts.length;
}
