// Small pieces of the page: elements, numbers, tables that can be sorted.

// An element with properties, and children that are elements or text.
function element(name, properties = {}, ...children) {
	const made = Object.assign(document.createElement(name), properties);
	made.append(...children);
	return made;
}

// A number as people read it; the whole of it is in the element's title.
function readable(value) {
	if (Number.isNaN(value)) return "";
	if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
	const size = Math.abs(value);
	if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2).replace("-", "−").replace("e−", "e-");
	return String(Number(value.toPrecision(4)));
}

function percent(error) {
	return error >= 1e-4 ? readable(Number((100 * error).toPrecision(2))) + " %" : readable(error);
}

const looks = new Map(report.engines.map((engine) => [engine.name, engine]));

// An engine's name with the mark that it has in every chart.
function engineName(name) {
	const look = looks.get(name);
	const sign = element("span", { textContent: (look ? look.sign : "–") + " ", ariaHidden: "true" });
	sign.style.setProperty("--mark", look ? look.color : "#707070");
	return element("span", { className: "engine" }, sign, name);
}

// Text that is meant to be used elsewhere, with a button that takes it there.
function copyable(text) {
	return [element("code", { textContent: text }), " ", copyButton(text, `copy ${text}`)];
}

function copyButton(text, ariaLabel) {
	const button = element("button", { type: "button", className: "copy", textContent: "copy", ariaLabel });
	button.addEventListener("click", async () => {
		await navigator.clipboard.writeText(text);
		button.textContent = "copied";
		setTimeout(() => button.textContent = "copy", 1500);
	});
	return button;
}

function cell(column, text) {
	const value = number(text);
	const isNumber = text !== "" && !Number.isNaN(value);
	const made = element("td", { className: isNumber ? "number" : "text" });
	made.dataset.value = text;
	if (column === "engine" || column === "other_engine") made.append(engineName(text));
	else if (["command", "settings"].includes(column) && text !== "") made.append(...copyable(text));
	else made.textContent = isNumber ? readable(value) : text;
	if (isNumber && made.textContent !== text) made.title = text;
	return made;
}

function sortBy(body, index, heading) {
	const ascending = heading.ariaSort !== "ascending";
	for (const other of heading.parentElement.children) other.ariaSort = "none";
	heading.ariaSort = ascending ? "ascending" : "descending";
	const key = (row) => row.children[index].dataset.value;
	const order = (a, b) => {
		const difference = number(key(a)) - number(key(b));
		return Number.isNaN(difference) ? key(a).localeCompare(key(b)) : difference;
	};
	const rows = [...body.rows].sort((a, b) => (ascending ? order(a, b) : order(b, a)));
	body.append(...rows);
}

// A table of some columns of a CSV's rows; a click on a heading sorts it.
function csvTable(columns, rows, caption) {
	const body = element("tbody", {}, ...rows.map((row) =>
		element("tr", {}, ...columns.map((column) => cell(column, row[column])))));
	const headings = columns.map((column, index) => {
		const button = element("button", { type: "button", textContent: column.replaceAll("_", " ") });
		const heading = element("th", { scope: "col", ariaSort: "none" }, button);
		button.addEventListener("click", () => sortBy(body, index, heading));
		return heading;
	});
	return element("table", {}, element("caption", { textContent: caption }),
		element("thead", {}, element("tr", {}, ...headings)), body);
}

// The same in a box that scrolls.
function wideTable(columns, rows, caption) {
	return element("div", { className: "wide", tabIndex: 0, role: "region", ariaLabel: caption },
		csvTable(columns, rows, caption));
}

// A table in details, whose summary says of what; hidden where it is empty.
function foldRefusals(details, rows, columns, title) {
	details.hidden = !rows.length;
	details.replaceChildren(element("summary", { textContent: title }), wideTable(columns, rows, title));
}

function fillSelect(select, names, chosen) {
	select.replaceChildren(...names.map((name) => element("option", { value: name, textContent: name })));
	if (names.includes(chosen)) select.value = chosen;
}
