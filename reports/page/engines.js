// Which engines the page shows: all, those of others, or one family's.

const familyNames = { native: "clothcheck's own", bullet: "Bullet", ode: "ODE", mujoco: "MuJoCo", jolt: "Jolt", seed: "the origins" };
// who keeps the table should not need to win it
const ownFamilies = ["native", "seed"];

function familyOf(engine) {
	return engine.split("-")[0];
}

function isShown(engine) {
	const wanted = document.getElementById("shown-engines").value;
	if (wanted === "all" || !engine) return true;
	return wanted === "others" ? !ownFamilies.includes(familyOf(engine)) : familyOf(engine) === wanted;
}

// A row of a CSV is of its engine, or of two.
function isRowShown(row) {
	return isShown(row.engine) || (row.other_engine !== undefined && isShown(row.other_engine));
}

async function startEngines() {
	const families = [...new Set(report.engines.map((engine) => familyOf(engine.name)))].filter((family) => family !== "still");
	const select = document.getElementById("shown-engines");
	select.append(...families.map((family) => element("option", { value: family, textContent: `${familyNames[family] || family} only` })));
	bindState("engines", select);
	document.getElementById("shown").hidden = families.length < 2;
}
