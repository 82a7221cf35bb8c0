// What check has measured, version by version.

// A line through values, oldest first, in a box of 120 by 24.
function sparkline(values, label) {
	const low = Math.min(...values), high = Math.max(...values), space = "http://www.w3.org/2000/svg";
	const svg = document.createElementNS(space, "svg"), line = document.createElementNS(space, "polyline");
	const x = (index) => 4 + (112 * index) / Math.max(1, values.length - 1);
	const y = (value) => (high > low ? 21 - (18 * (value - low)) / (high - low) : 12);
	line.setAttribute("points", values.map((value, index) => `${x(index)},${y(value)}`).join(" "));
	line.setAttribute("class", "history-line");
	for (const [name, text] of [["viewBox", "0 0 120 24"], ["width", "120"], ["height", "24"], ["role", "img"], ["aria-label", label]])
		svg.setAttribute(name, text);
	svg.append(line);
	return svg;
}

// Rows of one engine and metric, in the order they were written.
function historyGroups(rows) {
	const groups = new Map();
	for (const row of rows) {
		const key = `${row.engine}\t${row.metric}`;
		groups.set(key, [...(groups.get(key) || []), row]);
	}
	return [...groups.values()].filter((group) => group.some((row) => row.value !== group[0].value));
}

function historyRow(group) {
	const values = group.map((row) => number(row.value)), last = group[group.length - 1], first = group[0];
	const label = group.map((row) => `${row.date} ${row.version}: ${row.value}`).join("\n");
	const line = element("td", { title: label }, sparkline(values, `${last.engine}, ${last.metric}, ${values.length} values`));
	return element("tr", {}, element("td", {}, engineName(last.engine)), element("td", { textContent: last.metric }), line,
		element("td", { className: "number", textContent: readable(number(first.value)), title: first.value }),
		element("td", { className: "number", textContent: readable(number(last.value)), title: last.value }));
}

async function startHistory() {
	const history = await table("history.csv");
	if (!history || !history.rows.length) return;
	const select = document.getElementById("history-scene");
	const show = () => {
		const groups = historyGroups(history.rows.filter((row) => row.scene === select.value));
		const heading = ["engine", "metric", "over time", "first", "last"].map((textContent) => element("th", { scope: "col", textContent }));
		document.getElementById("history-table").replaceChildren(groups.length
			? element("table", {}, element("thead", {}, element("tr", {}, ...heading)), element("tbody", {}, ...groups.map(historyRow)))
			: "Nothing has moved.");
	};
	fillSelect(select, [...new Set(history.rows.map((row) => row.scene))], "");
	select.addEventListener("change", show);
	document.getElementById("history").hidden = false;
	show();
}
