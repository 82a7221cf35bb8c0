// Puts the page together.

// The hosts of a study, each with its processor; null where all ran on one.
function hostsOf(machine) {
	const rows = machine ? machine.rows.filter((row) => row.key.endsWith(": processor")) : [];
	return rows.length ? rows.map((row) => `${row.key.slice(0, -": processor".length)} (${row.value})`).join(", ") : null;
}

async function startMachine() {
	const machine = await table("machine.csv");
	const hosts = hostsOf(machine);
	if (hosts) {
		document.getElementById("machine").textContent =
			`clothcheck ${report.version} on ${hosts}: costs are only compared within one kind of processor`;
		return;
	}
	const value = (key) => machine.rows.find((row) => row.key === key)?.value || "?";
	document.getElementById("machine").textContent = machine
		? `clothcheck ${value("clothcheck")} on ${value("processor")}, ${value("cores")} cores, ${value("system")}, ${value("compiler")}, ${value("date")}`
		: `clothcheck ${report.version}; the report does not say on which machine it ran`;
}

// A file that the page carries is saved from it, a larger one is beside the page.
async function startDownloads() {
	const list = document.getElementById("download-list");
	for (const { file, rows, about } of report.tables) {
		const link = element("a", { href: file, textContent: file, download: file });
		if (document.getElementById("file:" + file))
			link.addEventListener("click", async (event) => {
				if (link.href.startsWith("blob:")) return;
				event.preventDefault();
				link.href = URL.createObjectURL(new Blob([await fileBytes(file)], { type: "text/csv" }));
				link.click();
			});
		const place = document.getElementById("file:" + file) ? "" : ", in a file beside this page";
		list.append(element("li", {}, link, `: ${about}, ${rows} rows${place}`));
	}
}

async function startPage() {
	const replay = new Replay();
	const parts = [startMachine, startEngines, startAnswer, startFindings, startSummary, startFailures, startConform, startHistory,
		startDownloads, () => startScene(replay), startGeneral];
	for (const part of parts) await part().catch(showTrouble);
	document.body.dataset.ready = "yes";
}

// What one part of the page cannot show leaves the others as they are.
function showTrouble(error) {
	document.querySelector("main").prepend(element("p", { role: "alert", textContent: `A part of this page failed: ${error.message}` }));
}

async function startScene(replay) {
	const select = document.getElementById("scene-select");
	const names = report.scenes.map((scene) => scene.name);
	if (!names.length) return;
	fillSelect(select, names, "cloth_two_corners");
	bindState("scene", select);
	for (const input of [select, document.getElementById("shown-engines")])
		input.addEventListener("change", () => showScene(select.value, replay).catch(showTrouble));
	document.getElementById("scene").hidden = false;
	await showScene(select.value, replay);
}

startPage();
