// The conformance cards: properties by engines.

const verdictSigns = { pass: "✓", fail: "✗", none: "–" };
const verdictClasses = { pass: "class-1", fail: "class-3", none: "class-6" };

function conformCell(row) {
	if (!row) return element("td");
	const value = number(row.value);
	const made = element("td", {
		className: verdictClasses[row.verdict],
		title: `${row.verdict}${row.tolerance ? `, within ${row.tolerance}` : ""}: ${row.reason}`,
	});
	made.append(`${verdictSigns[row.verdict]} ${Number.isNaN(value) ? "" : readable(Number(value.toPrecision(2)))}`);
	return made;
}

function showConform(cards) {
	const engines = [...new Set(cards.rows.map((row) => row.engine))].filter(isShown);
	const properties = [...new Set(cards.rows.map((row) => row.property))];
	const heading = element("tr", {}, element("th", { scope: "col", textContent: "property" }),
		...engines.map((engine) => element("th", { scope: "col" }, engineName(engine))));
	const body = properties.map((property) => element("tr", {}, element("th", { scope: "row", textContent: property }),
		...engines.map((engine) => conformCell(cards.rows.find((row) => row.engine === engine && row.property === property)))));
	document.getElementById("conform-table").replaceChildren(
		element("table", {}, element("thead", {}, heading), element("tbody", {}, ...body)));
	document.getElementById("conform").hidden = !engines.length;
}

async function startConform() {
	const cards = await table("conform.csv");
	if (!cards) return;
	document.getElementById("shown-engines").addEventListener("change", () => showConform(cards));
	showConform(cards);
}
