// Results in words, each with the command that shows it.

async function startFindings() {
	if (!report.findings.length) return;
	const items = report.findings.map(({ kind, text, command }) => element("li", {},
		element("b", { textContent: kind }), `: ${text} `, ...copyable(command)));
	document.getElementById("findings-list").append(...items);
	document.getElementById("findings").hidden = false;
}
