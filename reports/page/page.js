// Puts the page together.

async function startMachine() {
	const machine = await table("machine.csv");
	const value = (key) => machine.rows.find((row) => row.key === key)?.value || "?";
	document.getElementById("machine").textContent = machine
		? `clothcheck ${value("clothcheck")} on ${value("processor")}, ${value("cores")} cores, ${value("system")}, ${value("compiler")}, ${value("date")}`
		: `clothcheck ${report.version}; the report does not say on which machine it ran`;
}

// A file that the page carries is saved from it, a larger one is beside the page.
function startDownloads() {
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
		list.append(element("li", {}, link, `: ${about}, ${rows} rows`));
	}
}

async function startPage() {
	await startMachine();
	await startAnswer();
	const replay = new Replay();
	await startSummary((scene) => showScene(scene, replay));
	await startFailures();
	startDownloads();
	if (report.scenes.length) {
		const select = document.getElementById("scene-select");
		const names = report.scenes.map((scene) => scene.name);
		fillSelect(select, names, "cloth_two_corners");
		select.addEventListener("change", () => showScene(select.value, replay));
		document.getElementById("scene").hidden = false;
		await showScene(select.value, replay);
	}
	await startGeneral();
	document.body.dataset.ready = "yes";
}

startPage();
