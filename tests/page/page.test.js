// The report's page in a real browser, opened from disk. Makes a report of its own with the program, and of its CSVs
// another one in which an engine aborted.
//   CLOTHCHECK, CHROMIUM  programs;  SOURCES  the source tree;  SCREENSHOTS  where pictures are kept
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const { CLOTHCHECK, CHROMIUM, SOURCES, SCREENSHOTS } = process.env;
const axeSource = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const aborted = "signal 6, Aborted: the solver's own last words, at t = 0.5 s";
const run = (...words) => execFileSync(CLOTHCHECK, words, { cwd: SOURCES, encoding: "utf8" });

let directory, browser, page;
const told = [];

// A row of a CSV without quoted commas, as {column: text}.
function csvRows(file) {
	const [header, ...lines] = readFileSync(join(directory, file), "utf8").trim().split("\n");
	const columns = header.split(",");
	return lines.map((line) => {
		const fields = [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map((match) => match[1]?.replaceAll('""', '"') ?? match[2]);
		return Object.fromEntries(columns.map((column, i) => [column, fields[i]]));
	});
}

// ode-direct cannot finish the cloth in five seconds, seed-tecido does not model springs, and one run is made to abort.
function makeReport() {
	directory = mkdtempSync(join(tmpdir(), "clothcheck-page-"));
	const engines = ["native-verlet", "native-bars", "native-xpbd", "bullet-pbd", "ode-direct", "seed-tecido", "still"];
	run("compare", "cloth_two_corners", "bounce", "rope_hanging", ...engines.flatMap((name) => ["--engine", name]),
		"--repeats", "1", "--time-limit", "5", "--patience", "0", "--out", directory);
	const runs = readFileSync(join(directory, "runs.csv"), "utf8");
	const changed = runs.replace(/^(bounce,bullet-pbd,)ok,[^,]*,/m, `$1aborted,"${aborted}",`);
	assert.notEqual(changed, runs);
	writeFileSync(join(directory, "runs.csv"), changed);
	run("conform", "order", "mirror", "threads", "--engine", "native-verlet", "--engine", "bullet-pbd", "--out", directory);
	// of three checks, the second one of another step
	const scene = join(directory, "swing.yaml"), steps = (number) => ["--set", `native-verlet.substeps=${number}`];
	writeFileSync(scene, "name: swing\nrope: {particles: 2, spacing: 1, mass: 1}\nsprings: {stiffness: 50}\npins: [first]\n" +
		"gravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n");
	const check = (...words) => execFileSync(CLOTHCHECK, ["check", scene, "-e", "native-verlet", "--baseline",
		join(directory, "swing.csv"), "--history", directory, "--out", join(directory, "check"), ...words], { cwd: SOURCES });
	for (const number of [2, 3, 2]) check("--update", ...steps(number));
	run("report", directory);
}

before(async () => {
	makeReport();
	browser = await chromium.launch({
		executablePath: CHROMIUM,
		args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--no-first-run",
			"--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"],
	});
	page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
	// without a graphics processor each picture is read back, and the driver complains of it
	page.on("console", (message) => /^\[\.WebGL-.*ReadPixels/.test(message.text()) || told.push(`${message.type()}: ${message.text()}`));
	page.on("pageerror", (error) => told.push(`error: ${error.message}`));
	page.on("request", (request) => {
		const url = request.url();
		if (!/^(data|blob):/.test(url) && url !== `file://${directory}/index.html`) told.push(`request: ${url}`);
	});
	await page.goto(`file://${directory}/index.html`);
	await page.waitForFunction(() => document.body.dataset.ready === "yes");
});

after(async () => {
	await browser?.close();
	rmSync(directory, { recursive: true, force: true });
});

async function selectScene(name) {
	await page.selectOption("#scene-select", name);
	await page.locator('#scene[aria-busy="false"]').waitFor();
}

async function screenshot(name) {
	if (!SCREENSHOTS) return;
	mkdirSync(SCREENSHOTS, { recursive: true });
	await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`) });
}

test("the first screen answers which solver, and at what cost", async () => {
	const summary = csvRows("charts/summary.csv").filter((row) =>
		row.scene === "cloth_two_corners" && row.status === "ok" && row.is_better === "1" && row.engine !== "still" && Number(row.error) <= 0.01);
	const best = summary.sort((a, b) => Number(a.cpu_ms_per_s) - Number(b.cpu_ms_per_s))[0];
	assert.equal(await page.inputValue("#answer-scene"), "cloth_two_corners");
	const answer = page.locator("#answer-text");
	assert.equal(await answer.locator("strong").textContent(), best.engine);
	assert.ok((await answer.boundingBox()).y < 400);
	const cost = await page.locator("#answer-table tbody tr").first().locator("td").nth(3).getAttribute("data-value");
	assert.equal(Number(cost), Number(best.cpu_ms_per_s));
	const frame = await page.locator("#answer-table tbody tr").first().locator("td").nth(4).getAttribute("data-value");
	assert.ok(Math.abs(60 * Number(frame) / Number(cost) - 1) < 5e-3);
	await screenshot("first");
});

test("settings stand in the engine's own names, and a click copies them", async () => {
	const own = page.locator("#answer-own");
	await own.locator("summary").click();
	const text = await own.locator("pre").filter({ hasText: "bullet-pbd on cloth_two_corners" }).textContent();
	const rows = csvRows("ledger.csv").filter((row) => row.scene === "cloth_two_corners" && row.engine === "bullet-pbd");
	assert.ok(rows.length > 5);
	for (const row of rows) {
		const line = text.split("\n").find((one) => one.startsWith(`${row.native_parameter} = `) && one.includes(row.quantity));
		assert.equal(Number(line.match(/ = ([^;]*);/)[1]), Number(row.native_value), row.quantity);
	}
	await page.evaluate(() => navigator.clipboard.writeText = async (copied) => { window.copied = copied; });
	await own.getByLabel("copy bullet-pbd's own settings").click();
	assert.equal(await page.evaluate(() => window.copied), text);
	await own.locator("summary").click();
});

test("without the engines of whoever made the table, another one answers", async () => {
	const names = () => page.locator("#answer-table tbody .engine").allTextContents();
	assert.ok((await names()).some((name) => name.includes("native-")));
	await page.selectOption("#shown-engines", "others");
	await page.waitForFunction(() => !document.querySelector("#answer-table").textContent.includes("native-"));
	assert.ok((await names()).some((name) => name.includes("bullet-pbd")));
	assert.doesNotMatch(await page.locator("#answer-text").textContent(), /native-|seed-/);
	await page.selectOption("#shown-engines", "bullet");
	for (const place of ["#answer-table tbody .engine", "#summary-table thead .engine", "#conform-table thead .engine", "#replay-engines .engine"])
		await page.waitForFunction((place) => [...document.querySelectorAll(place)].map((one) => one.textContent.slice(2)).join() === "bullet-pbd", place);
	await page.selectOption("#shown-engines", "all");
	await page.waitForFunction(() => document.querySelectorAll("#replay-engines .engine").length > 1);
	await page.waitForFunction(() => document.querySelector("#answer-table").textContent.includes("native-"));
});

test("conformance cards stand side by side, verdict and value", async () => {
	const rows = csvRows("conform.csv");
	assert.equal(rows.length, 6);
	for (const { engine, property, verdict } of rows) {
		const column = await page.locator("#conform-table thead th").allTextContents();
		const index = column.findIndex((text) => text.includes(engine));
		const cell = page.locator(`#conform-table tr:has(th:text-is("${property}")) > :nth-child(${index + 1})`);
		assert.ok((await cell.textContent()).startsWith({ pass: "✓", fail: "✗", none: "–" }[verdict]), property);
		assert.ok((await cell.getAttribute("title")).startsWith(verdict));
	}
});

test("results are said in words, each with its command", async () => {
	const said = await page.locator("#findings-list li").allTextContents();
	const breakdown = said.find((text) => text.startsWith("breakdown: bullet-pbd breaks down on bounce"));
	assert.ok(breakdown?.includes(aborted), said.join("\n"));
	assert.ok(said.some((text) => text.startsWith("model: native-bars has no structural stiffness (1000 N/m)")));
	for (const item of await page.locator("#findings-list code").allTextContents()) assert.match(item, /^clothcheck /);
});

test("what moved from version to version is drawn", async () => {
	const rows = csvRows("history.csv").filter((row) => row.metric === "stretch_max");
	assert.equal(rows.length, 3);
	const row = page.locator('#history-table tr:has(td:text-is("stretch_max"))');
	assert.equal((await row.locator("polyline").getAttribute("points")).split(" ").length, 3);
	for (const { value } of rows) assert.ok((await row.locator("td").nth(2).getAttribute("title")).includes(value));
});

test("a stricter error excludes engines", async () => {
	const within = () => page.locator("#answer-table td[data-value=yes]").count();
	const before = await within();
	await page.selectOption("#answer-error", "0.0001");
	await page.waitForFunction((count) => document.querySelectorAll("#answer-table td[data-value=yes]").length < count, before);
	await page.selectOption("#answer-error", "0.01");
});

test("errors that cancel by chance are not recommended, and the cheapest of what holds is", async () => {
	const way = (engine, substeps, told, cost) => ({ engine, substeps, iterations: 1, error: told, told, cost });
	const best = await page.evaluate((ways) => bestWays(ways, 0.01), [
		way("lucky", 1, 0.001, 1), way("lucky", 2, 0.1, 2), way("lucky", 4, 0.002, 4),
		way("steady", 1, 0.05, 1), way("steady", 2, 0.005, 2), way("steady", 4, 0.001, 5), way("poor", 8, 0.5, 1)]);
	assert.deepEqual(best.within.map(({ engine, substeps }) => [engine, substeps]), [["steady", 2], ["lucky", 4]]);
	assert.deepEqual(best.beyond.map(({ engine }) => engine), ["poor"]);
});

test("a scene without a truth has no answer, and it is said", async () => {
	const told = await page.evaluate(() => answerText("cloth_on_sphere", 0.01, { within: [], beyond: [] },
		{ metric: "position_rms", isKnown: false, uncertainty: 0, rows: [] }).join(""));
	assert.match(told, /^Nobody can say for cloth_on_sphere: it has no truth that tells solvers apart/);
	const scenes = await page.locator("#answer-scene option").allTextContents();
	assert.deepEqual(scenes.toSorted(), ["bounce", "cloth_two_corners", "rope_hanging"]);
});

test("the summary holds the numbers of the CSVs", async () => {
	for (const row of csvRows("charts/summary.csv")) {
		if (row.engine === "seed-tecido") continue;
		const cell = page.locator(`#summary-table tr:has(a:text-is("${row.scene}")) td[data-engine="${row.engine}"]`);
		assert.equal(await cell.getAttribute("data-error"), row.error);
		assert.equal(await cell.getAttribute("data-cost"), row.cpu_ms_per_s);
		assert.equal(await cell.getAttribute("data-status"), row.status);
	}
	assert.match(await page.textContent("#summary-left-out"), /seed-tecido\.$/);
});

test("each scene of the summary has its picture and its sentence", async () => {
	await page.locator("#summary-table").scrollIntoViewIfNeeded();
	await page.waitForFunction(() => [...document.querySelectorAll("#summary-table .picture")].every((picture) => picture.dataset.drawn));
	const pictures = await page.locator("#summary-table tbody tr").evaluateAll((rows) => rows.map((row) => {
		const canvas = row.querySelector(".picture"), { width, height } = canvas;
		const pixels = canvas.getContext("2d").getImageData(0, 0, width, height).data;
		return { inked: pixels.filter((value, i) => i % 4 === 3 && value > 0).length, sentence: row.querySelector(".sentence").textContent };
	}));
	assert.equal(pictures.length, 3);
	for (const { inked, sentence } of pictures) {
		assert.ok(inked > 10, `${inked} pixels`);
		assert.match(sentence, /^[A-Z].*\.$/);
	}
	await page.evaluate(() => scrollTo(0, 0));
});

// A row that grew under the mouse would lose its click.
test("a row of the summary has its height before its picture is drawn", async () => {
	const [drawn, before] = await page.evaluate(() => {
		const select = document.getElementById("summary-metric");
		select.dispatchEvent(new Event("change"));
		const rows = [...document.querySelectorAll("#summary-table tbody tr")];
		return [document.querySelectorAll("#summary-table .picture[data-drawn]").length, rows.map((row) => row.getBoundingClientRect().height)];
	});
	assert.equal(drawn, 0);
	await page.locator("#summary-table").scrollIntoViewIfNeeded();
	await page.waitForFunction(() => [...document.querySelectorAll("#summary-table .picture")].every((picture) => picture.dataset.drawn));
	const after = await page.locator("#summary-table tbody tr").evaluateAll((rows) => rows.map((row) => row.getBoundingClientRect().height));
	assert.deepEqual(after, before);
	await page.evaluate(() => scrollTo(0, 0));
});

test("the summary is of whichever metric is asked for", async () => {
	await page.selectOption("#summary-metric", "stretch_max");
	const rows = csvRows("metrics.csv").filter((row) => row.metric === "stretch_max" && row.error !== "nan");
	assert.ok(rows.length > 5);
	for (const row of rows) {
		const cell = page.locator(`#summary-table tr:has(a:text-is("${row.scene}")) td[data-engine="${row.engine}"]`);
		if ((await cell.getAttribute("data-status")) === "ok") assert.equal(Number(await cell.getAttribute("data-error")), Number(row.error));
	}
	await page.selectOption("#summary-metric", "");
});

test("a link shows what it was made of", async () => {
	const other = await browser.newPage();
	await other.goto(`file://${directory}/index.html#scene=bounce&error=0.001&engines=bullet&metric=sag&t=0.25`);
	await other.waitForFunction(() => document.body.dataset.ready === "yes");
	const value = (id) => other.inputValue(id);
	assert.deepEqual(await Promise.all(["#answer-scene", "#scene-select", "#answer-error", "#shown-engines", "#summary-metric", "#replay-time"].map(value)),
		["bounce", "bounce", "0.001", "bullet", "sag", "0.25"]);
	await other.selectOption("#answer-scene", "cloth_two_corners");
	await other.locator('#scene[aria-busy="false"]').waitFor();
	assert.equal(await value("#scene-select"), "cloth_two_corners");
	const kept = new URLSearchParams(new URL(other.url()).hash.slice(1));
	assert.deepEqual(Object.fromEntries(kept), { scene: "cloth_two_corners", error: "0.001", engines: "bullet", metric: "sag" });
	await other.goto(`file://${directory}/index.html#scene=nothing&error=7&engines=%3Cb%3E`);
	await other.reload();
	await other.waitForFunction(() => document.body.dataset.ready === "yes");
	assert.deepEqual(await Promise.all(["#scene-select", "#answer-error", "#shown-engines"].map(value)), ["cloth_two_corners", "0.01", "all"]);
	await other.close();
});

test("a scene's name in the summary leads to it", async () => {
	await page.click('#summary-table a:text-is("rope_hanging")');
	// the address changes after the click has been answered
	await page.waitForFunction(() => /^A rope/.test(document.getElementById("scene-about").textContent));
	assert.equal(await page.inputValue("#scene-select"), "rope_hanging");
	assert.ok(await page.locator("#scene").evaluate((section) => section.getBoundingClientRect().top < innerHeight));
});

test("a click copies a command", async () => {
	await page.evaluate(() => navigator.clipboard.writeText = async (text) => { window.copied = text; });
	await page.locator("#findings-list .copy").first().click();
	assert.equal(await page.evaluate(() => window.copied), await page.locator("#findings-list code").first().textContent());
});

test("aborted, timed out and unsupported runs are there with reason and command", async () => {
	assert.equal(await page.locator("#refusals table").isVisible(), false);
	await page.locator("#refusals summary").click();
	const text = await page.locator("#failures-table").innerText() + await page.locator("#refusals").innerText();
	for (const { scene, engine, status, reason, command } of csvRows("runs.csv")) {
		if (status === "ok") continue;
		for (const word of [scene, engine, status, reason, command]) assert.ok(text.includes(word), word);
	}
	for (const word of ["aborted", aborted, "timed_out", "after the limit of 5 s", "unsupported"]) assert.ok(text.includes(word), word);
});

test("tables of a scene hold its rows, and are sorted by a click", async () => {
	await selectScene("rope_hanging");
	const details = page.locator('details[data-file="metrics.csv"]');
	await details.locator("summary").click();
	await details.locator("table").waitFor();
	const wanted = csvRows("metrics.csv").filter((row) => row.scene === "rope_hanging");
	const column = (index) => details.locator(`tbody td:nth-child(${index})`).evaluateAll((cells) => cells.map((cell) => cell.dataset.value));
	assert.deepEqual(await column(4), wanted.map((row) => row.value));
	assert.deepEqual(await column(8), wanted.map((row) => row.error));
	await details.locator("th button", { hasText: /^value$/ }).click();
	const sorted = (await column(4)).filter((text) => text !== "").map(Number);
	assert.deepEqual(sorted, [...sorted].sort((a, b) => a - b));
	await details.locator("summary").click();
});

test("a chart answers when pointed at, hides a series, and comes closer", async () => {
	await selectScene("rope_hanging");
	const figure = page.locator('#scene-charts figure[data-chart="cost"]'), svg = figure.locator("svg");
	await svg.scrollIntoViewIfNeeded();
	// each engine's mark tells the numbers of its row
	const rows = readFileSync(join(directory, "charts/rope_hanging.cost.csv"), "utf8").trim().split("\n").slice(1).map((line) => line.split(","));
	const engine = rows.find((row) => row[0] === "native-xpbd");
	const at = await figure.evaluate((figure, name) => {
		const groups = [...figure.querySelectorAll("g[id*=gnuplot_plot_]")];
		const group = groups.find((group) => group.querySelector("text")?.textContent.trim() === name);
		const box = group.querySelector("use").getBoundingClientRect();
		return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
	}, "native-xpbd");
	await page.mouse.move(at.x, at.y);
	const told = await figure.locator(".chart-tip").innerText(), [, y, x] = /^native-xpbd: (\S+) at (\S+)$/.exec(told);
	const near = (value, wanted) => assert.ok(Math.abs(Number(value) / Number(wanted) - 1) < 0.02, `${value}, ${wanted}`);
	near(x, engine[1]);
	near(y, engine[2]);
	// its name in the key takes it away, for the pointer too, and brings it back
	const key = figure.getByRole("button", { name: "show native-xpbd" });
	await key.click();
	assert.equal(await key.getAttribute("aria-pressed"), "false");
	await page.mouse.move(at.x + 1, at.y);
	assert.doesNotMatch(await figure.locator(".chart-tip").innerText(), /native-xpbd/);
	await key.press("Enter");
	assert.equal(await key.getAttribute("aria-pressed"), "true");
	const whole = await svg.getAttribute("viewBox");
	await svg.press("+");
	assert.notEqual(await svg.getAttribute("viewBox"), whole);
	await svg.press("0");
	assert.equal(await svg.getAttribute("viewBox"), whole);
});

// A chart of the first asked for, or its replay, is held up until the second is shown, and comes last.
for (const held of ["cloth_two_corners.cost.svg", "cloth_two_corners.replay"])
	test(`of two scenes asked for in a row the second is shown, when ${held} is late`, async () => {
		await selectScene("bounce");
		const end = await page.getAttribute("#replay-time", "max");
		await page.evaluate(async (held) => {
			const unpack = fileBytes;
			let release;
			const second = new Promise((resolve) => release = resolve);
			const isHeld = new Promise((resolve) => fileBytes = async (name) => {
				const bytes = await unpack(name);
				if (name === held) {
					resolve();
					await second;
				}
				return bytes;
			});
			const ask = (name) => {
				const select = document.getElementById("scene-select");
				select.value = name;
				select.dispatchEvent(new Event("change"));
			};
			ask("cloth_two_corners");
			await isHeld;
			ask("bounce");
			while (document.getElementById("scene").ariaBusy !== "false") await new Promise((resolve) => setTimeout(resolve));
			release();
			fileBytes = unpack;
			await new Promise((resolve) => setTimeout(resolve, 500));
		}, held);
		assert.equal(await page.inputValue("#scene-select"), "bounce");
		assert.equal(await page.getAttribute("#replay-time", "max"), end);
		const titles = await page.locator("#scene-charts figcaption").allTextContents();
		assert.ok(titles.length > 0);
		for (const title of titles) assert.match(title, /^bounce/);
	});

test("the replay holds the runs' positions", async () => {
	const file = readFileSync(join(directory, "replays/cloth_two_corners.replay"));
	const headerSize = file.indexOf("\ndata\n") + "\ndata\n".length;
	const header = file.subarray(0, headerSize).toString();
	const count = (word) => Number(header.match(new RegExp(`^${word} (\\d+)$`, "m"))[1]);
	const names = [...header.matchAll(/^path (\S+)$/gm)].map((match) => match[1]);
	const [particles, frames] = [count("particles"), count("frames")];
	const start = headerSize + 4 * frames + 12 * count("springs");
	const unpacked = await page.evaluate(async () => {
		const replay = parseReplay(await fileBytes("cloth_two_corners.replay"));
		return { names: [...replay.paths.keys()], paths: [...replay.paths.values()].map((path) => [...path]) };
	});
	assert.deepEqual(unpacked.names, names);
	// half a quantum of the packing, of a box at most twice as wide as 2 m of cloth and swing; and the rounding of float32
	const bound = 0.5 * 4 / (1 << 21) + 2 ** -22;
	names.forEach((name, i) => {
		for (let k = 0; k < 3 * particles * frames; k++) {
			const at = file.readFloatLE(start + 4 * (i * 3 * particles * frames + k));
			assert.ok(Number.isNaN(at) ? Number.isNaN(unpacked.paths[i][k]) : Math.abs(at - unpacked.paths[i][k]) <= bound, `${name} ${k}`);
		}
	});
});

test("a collider that moves is where its path takes it", async () => {
	const places = await page.evaluate(() => {
		const { solids: [ball], planes: [floor] } = parseHeader("plane 0 0 0 0 1 0\nsphere 1 2 3 0.5\nmoves 0 0 0 0 1 0 2 0 2 0 2 4\ndata\n");
		return [floor.moves ?? null, movedAt(ball.moves, 0.25), movedAt(ball.moves, 1.5), movedAt(ball.moves, 9)];
	});
	assert.deepEqual(places, [null, [0, 0.5, 0], [0, 2, 2], [0, 2, 4]]);
});

test("a solid is drawn where it is, as large as it is", async () => {
	const sizes = await page.evaluate(() => {
		// along y, half of 2 m long
		const axes = "0 1 0 -1 0 0 0 0 1";
		const lines = [`capsule 1 2 3 0.5 ${axes} 1 0 0`, `cylinder 1 2 3 0.5 ${axes} 1 0 0`, `box 1 2 3 0.25 ${axes} 1 0.5 2`, "sphere 1 2 3 0.5"];
		const { solids } = parseHeader(`${lines.join("\n")}\ndata\n`);
		const group = makeColliders({ planes: [], solids, particles: 1, paths: new Map([["a", new Float32Array([0, 0, 0, 1, 1, 1])]]) });
		group.updateMatrixWorld(true);
		return group.children.map((solid) => {
			const box = new THREE.Box3().setFromObject(solid);
			return [...box.getCenter(new THREE.Vector3()).toArray(), ...box.getSize(new THREE.Vector3()).toArray()];
		});
	});
	// what is round is drawn a hundredth thinner, of flat facets
	const wanted = [[1, 2, 3, 1, 3, 1], [1, 2, 3, 1, 2, 1], [1, 2, 3, 1.5, 2.5, 4.5], [1, 2, 3, 1, 1, 1]];
	for (const [i, size] of wanted.entries())
		for (const [k, number] of size.entries()) assert.ok(Math.abs(sizes[i][k] - number) <= 0.03, `${i}: ${sizes[i]}`);
});

test("a replay opens where paths are farthest from each other", async () => {
	const [apart, moving, alone] = await page.evaluate(() => {
		const replay = (paths) => ({ particles: 1, times: [0, 1, 2], paths: new Map(Object.entries(paths).map(([name, xs]) => [name, xs.flatMap((x) => [x, 0, 0])])) });
		const still = [0, 0, 0];
		// a truth that stands still is where things come to, one that moves is where they should be
		return [widestTime(replay({ a: [9, 8, 0], b: [9, 5, 1], truth: still }), ["a", "b"]),
			widestTime(replay({ a: [0, 1, 5], truth: [0, 3, 5] }), ["a"]), widestTime(replay({ a: [0, 1, 5] }), ["a"])];
	});
	assert.deepEqual([apart, moving, alone], [1, 1, 2]);
});

test("a camera sees a box as near as can be", async () => {
	const shares = await page.evaluate(() => [0.3, 1, 3].map((aspect) => {
		const box = new THREE.Box3(new THREE.Vector3(-1, -2, 0), new THREE.Vector3(2, 3, 0.5));
		const away = new THREE.Vector3(0.55, 0.35, 1).normalize(), camera = new THREE.PerspectiveCamera(35, aspect, 0.01, 1000);
		const middle = box.getCenter(new THREE.Vector3());
		camera.position.copy(middle).addScaledVector(away, fitDistance(box, away, 35, aspect));
		camera.lookAt(middle);
		camera.updateMatrixWorld();
		camera.updateProjectionMatrix();
		return Math.max(...[...Array(8).keys()].flatMap((k) => new THREE.Vector3(box[k & 1 ? "max" : "min"].x, box[k & 2 ? "max" : "min"].y, box[k & 4 ? "max" : "min"].z)
			.project(camera).toArray().slice(0, 2).map(Math.abs)));
	}));
	for (const share of shares) assert.ok(share < 1 && share > 0.8, String(share));
});

// What the replay shows, and how many of its pixels are not paper.
async function picture() {
	await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
	const png = (await page.locator("#replay-canvas").screenshot()).toString("base64");
	const inked = await page.evaluate(async (text) => {
		const image = new Image();
		image.src = `data:image/png;base64,${text}`;
		await image.decode();
		const copy = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
		copy.getContext("2d").drawImage(image, 0, 0);
		const { data } = copy.getContext("2d").getImageData(0, 0, copy.width, copy.height);
		return data.filter((value, i) => i % 4 === 0 && value < 240).length;
	}, png);
	return { png, inked };
}

test("the slider moves the cloths, the mouse and the keys turn them", async () => {
	await selectScene("cloth_two_corners");
	assert.equal(await page.locator("#replay-engines input").count(), 6);
	await page.locator("#replay-canvas").scrollIntoViewIfNeeded();
	const slider = page.locator("#replay-time");
	const pictures = [];
	const look = async () => pictures.push(await picture());
	await look();
	await slider.evaluate((input) => { input.value = 0.5; input.dispatchEvent(new Event("input")); });
	await look();
	assert.match(await page.locator("#replay-now").textContent(), /^0\.500 s$/);
	const box = await page.locator("#replay-canvas").boundingBox();
	await page.mouse.move(box.x + 300, box.y + 200);
	await page.mouse.down();
	await page.mouse.move(box.x + 420, box.y + 240, { steps: 4 });
	await page.mouse.up();
	await look();
	await page.locator("#replay-canvas").focus();
	await page.keyboard.press("ArrowLeft");
	await look();
	for (const [color, scale] of [["speed", /^speed: 0.*m\/s and more$/], ["distance", /^distance to the truth: 0.* m and more$/], ["engine", null]]) {
		await page.selectOption("#replay-color", color);
		await look();
		if (scale) assert.match(await page.textContent("#replay-scale"), scale);
		else assert.ok(await page.locator("#replay-scale").isHidden());
	}
	await page.selectOption("#replay-layout", "over");
	await look();
	assert.equal(new Set(pictures.map(({ png }) => png)).size, pictures.length);
	for (const { inked } of pictures) assert.ok(inked > 2000);
	await page.selectOption("#replay-layout", "side");
	await page.selectOption("#replay-color", "strain");
	await picture();
	await screenshot("replay");
});

test("playing moves the time to its end", async () => {
	await page.locator("#replay-time").evaluate((input) => { input.value = input.max - 0.2; });
	await page.click("#replay-play");
	await page.waitForFunction(() => document.getElementById("replay-play").textContent === "Play");
	assert.equal(await page.locator("#replay-time").evaluate((input) => input.value === input.max), true);
});

test("a packed CSV is saved from the page as it was", async () => {
	const [download] = await Promise.all([page.waitForEvent("download"), page.click('#download-list a:text-is("runs.csv")')]);
	assert.deepEqual(readFileSync(await download.path()), readFileSync(join(directory, "runs.csv")));
});

test("everything is reached by keyboard, and axe finds nothing", async () => {
	await page.evaluate(() => document.activeElement.blur());
	const reached = new Set();
	for (let i = 0; i < 400; i++) {
		await page.keyboard.press("Tab");
		reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
	}
	for (const id of ["answer-scene", "answer-error", "scene-select", "replay-play", "replay-time", "replay-canvas", "SUMMARY"])
		assert.ok(reached.has(id), id);
	await page.evaluate(axeSource);
	for (const colorScheme of ["dark", "light"]) {
		await page.emulateMedia({ colorScheme });
		const { violations } = await page.evaluate(() => axe.run(document));
		assert.deepEqual(violations.map(({ id, nodes }) => `${colorScheme} ${id}: ${nodes.map((node) => node.html).join(" ")}`), []);
		await page.evaluate(() => scrollTo(0, 0));
		await screenshot(colorScheme);
	}
});

test("a phone's first screen has solver, settings and cost, and nothing is wider than it", async () => {
	await page.setViewportSize({ width: 390, height: 844 });
	await page.evaluate(() => scrollTo(0, 0));
	const { y, height } = await page.locator("#answer-text").boundingBox();
	assert.ok(y + height < 844);
	assert.match(await page.textContent("#answer-text"), /substep.* ms of CPU per simulated second/);
	assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 390));
	await screenshot("phone");
	await page.setViewportSize({ width: 1280, height: 800 });
});

test("on paper nothing is cut, black or a control", async () => {
	await selectScene("cloth_two_corners");
	await page.emulateMedia({ colorScheme: "dark" });
	await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
	// A4 across, without its margins
	await page.setViewportSize({ width: 1032, height: 700 });
	await page.emulateMedia({ media: "print", colorScheme: "dark" });
	const cut = await page.evaluate(() => [...document.querySelectorAll("main *")].filter((one) => one.checkVisibility() && one.getBoundingClientRect().right > 1033)
		.map((one) => `${one.tagName} ${one.id} ${one.textContent.slice(0, 80)}`));
	assert.deepEqual(cut, []);
	assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
	assert.equal(await page.locator("button.copy:visible, #replay-controls:visible, canvas:visible").count(), 0);
	assert.ok(await page.locator("#replay-print").evaluate((image) => image.naturalWidth > 100));
	if (SCREENSHOTS) await page.screenshot({ path: join(SCREENSHOTS, "print.png"), fullPage: true });
	await page.emulateMedia({ media: "screen", colorScheme: "light" });
	await page.setViewportSize({ width: 1280, height: 800 });
});

test("a page of a study alone opens, too", async () => {
	const study = mkdtempSync(join(tmpdir(), "clothcheck-study-"));
	cpSync(join(directory, "machine.csv"), join(study, "machine.csv"));
	run("stability", "rope_hanging", "--engine", "native-verlet", "--engine", "bullet-pbd", "--out", study);
	run("report", study);
	const other = await browser.newPage();
	const errors = [];
	other.on("pageerror", (error) => errors.push(error.message));
	await other.goto(`file://${study}/index.html`);
	await other.waitForFunction(() => document.body.dataset.ready === "yes");
	const figure = other.locator('figure[data-chart="stability"]');
	assert.equal(await figure.locator("svg").count(), 1);
	// the second panel has numbers of its own
	const file = join(study, "charts/rope_hanging.stability.csv");
	const found = readFileSync(file, "utf8").split("\n").map((line) => line.split(",")).filter((row) => row[0] === "bullet-pbd" && row[3] === "ok" && row[5] === "0");
	const at = await figure.evaluate((shown) => {
		const marks = [...shown.querySelectorAll("g[id*=gnuplot_plot_] use")].map((mark) => mark.getBoundingClientRect());
		return marks.sort((a, b) => b.x - a.x).map(({ x, y, width, height }) => [x + width / 2, y + height / 2]);
	});
	let told = null;
	for (const [x, y] of at) {
		await other.mouse.move(x, y);
		told = /^ok: (\S+) at (\S+)$/.exec(await figure.locator(".chart-tip").innerText());
		if (told) break;
	}
	const isNear = (value, wanted) => Math.abs(Number(value) / Number(wanted) - 1) < 0.02;
	assert.ok(found.some((row) => isNear(told[2], row[1]) && isNear(told[1], row[2])), told[0]);
	assert.equal(await other.locator("#answer").isHidden(), true);
	assert.deepEqual(errors, []);
	await other.close();
	rmSync(study, { recursive: true });
});

test("without scripts there are the results in words, and charts and tables beside the page", async () => {
	const plain = await browser.newContext({ javaScriptEnabled: false }), other = await plain.newPage();
	await other.goto(`file://${directory}/index.html`);
	assert.ok(await other.locator("noscript li").first().isVisible());
	const links = await other.locator("noscript a").evaluateAll((all) => all.map((link) => link.getAttribute("href")));
	assert.ok(links.includes("charts/cloth_two_corners.cost.svg") && links.includes("metrics.csv"));
	for (const link of links) assert.ok(statSync(join(directory, link)).size > 0, link);
	await plain.close();
});

test("nothing was fetched, and the console is empty", () => assert.deepEqual(told, []));
