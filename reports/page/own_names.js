// Settings as an engine's own programs write them: what the ledger has of a run, line by line.

// Lines that assign what the scene comes to; "" where the ledger does not know the run.
function ownLines(scene, way, rows) {
	const of = rows.filter((row) => row.scene === scene && row.engine === way.engine);
	if (!of.length) return "";
	const steps = [`substeps = ${way.substeps};`, ...(way.iterations > 0 ? [`iterations = ${way.iterations};`] : [])];
	const lines = of.map((row) => {
		const value = number(row.native_value), wanted = readable(number(row.wanted)) || row.wanted;
		const why = `${row.quantity} ${wanted} ${row.unit}: ${row.formula}`;
		if (row.match === "impossible") return `// not ${why}`;
		return `${row.native_parameter} = ${Number.isNaN(value) ? row.native_value : value}; // ${why}`;
	});
	return [`// ${way.engine} on ${scene}`, ...steps, ...lines].join("\n");
}

function ownBlock(way, text) {
	const button = copyButton(text, `copy ${way.engine}'s own settings`);
	return element("div", {}, element("h3", {}, engineName(way.engine), " ", button),
		element("pre", { textContent: text, tabIndex: 0, ariaLabel: `${way.engine}'s own settings` }));
}

// Those of the ways that the comparison itself ran: other steps come to other numbers.
async function showOwnNames(scene, ways) {
	const [ledger, runs] = [await table("ledger.csv"), await table("runs.csv")];
	const ran = (way) => runs.rows.some((run) => run.scene === scene && run.engine === way.engine &&
		number(run.substeps) === way.substeps && (number(run.iterations) || 0) === (way.iterations || 0));
	const blocks = (ledger && runs ? ways.filter(ran) : []).map((way) => [way, ownLines(scene, way, ledger.rows)]).filter(([, text]) => text);
	const details = document.getElementById("answer-own");
	details.hidden = !blocks.length;
	details.replaceChildren(element("summary", { textContent: "The same settings in each engine's own names, to paste" }),
		...blocks.map(([way, text]) => ownBlock(way, text)));
}
