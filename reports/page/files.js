// What the page carries: a list of contents, and files, gzip in base64, that are unpacked when they are asked for.

const report = JSON.parse(document.getElementById("report").textContent);

// Bytes of a packed file; null where the page does not carry it.
async function fileBytes(name) {
	const element = document.getElementById("file:" + name);
	if (!element) return null;
	const packed = await (await fetch("data:application/octet-stream;base64," + element.textContent)).arrayBuffer();
	const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
	return new Response(stream).arrayBuffer();
}

async function fileText(name) {
	const bytes = await fileBytes(name);
	return bytes && new TextDecoder().decode(bytes);
}

// Rows of a CSV as arrays of text, without its header: RFC 4180.
function parseCsv(text) {
	const rows = [];
	const field = /(?:"((?:[^"]|"")*)"|([^,\n]*))(,|\n|$)/g;
	let row = [];
	while (field.lastIndex < text.length) {
		const [, quoted, plain, end] = field.exec(text);
		row.push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
		if (end === ",") continue;
		rows.push(row);
		row = [];
	}
	return rows;
}

const tables = new Map();

// A CSV of the report as {columns, rows}, rows as objects of text; null where there is none.
async function table(name) {
	if (!tables.has(name)) {
		const text = await fileText(name);
		const [columns, ...rows] = text === null ? [] : parseCsv(text);
		const asObject = (row) => Object.fromEntries(columns.map((column, i) => [column, row[i]]));
		tables.set(name, columns ? { columns, rows: rows.map(asObject) } : null);
	}
	return tables.get(name);
}

// A number of a field; NaN where it is empty.
function number(text) {
	if (text === "" || text === undefined) return NaN;
	return text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text);
}
