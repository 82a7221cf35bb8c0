// The live page in a real browser: what a person does changes the physics, and nobody else is served.
//   CLOTHCHECK, CHROMIUM  programs;  SOURCES  the source tree;  SCREENSHOTS  where pictures are kept
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { chmodSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { request } from "node:http";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const { CLOTHCHECK, CHROMIUM, SOURCES, SCREENSHOTS } = process.env;
const axeSource = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const engines = ["native-verlet", "native-xpbd", "bullet-pbd", "ode-quick"];

let directory, port, server, address, browser, page;
const told = [];

// One that nobody has at this moment.
function freePort() {
	return new Promise((resolve) => {
		const one = createServer().listen(0, "127.0.0.1", () => {
			const { port } = one.address();
			one.close(() => resolve(port));
		});
	});
}

// Starts a server on the port, and returns its address.
function startServer(scene, engines) {
	server?.kill("SIGINT");
	server = spawn(CLOTHCHECK, ["view", scene, "--no-browser", "--port", port, "--out", directory, ...engines.flatMap((name) => ["-e", name])],
		{ cwd: SOURCES, env: { ...process.env, XDG_RUNTIME_DIR: directory } });
	return new Promise((resolve, reject) => {
		let said = "";
		server.stdout.on("data", (data) => {
			said += data;
			const found = said.match(/http:\S+/);
			if (found) resolve(found[0]);
		});
		server.on("exit", () => reject(new Error(said)));
	});
}

// Its exit status.
async function endServer() {
	server.kill("SIGINT");
	await new Promise((resolve) => (server.exitCode === null ? server.on("exit", resolve) : resolve()));
	return server.exitCode;
}

before(async () => {
	directory = mkdtempSync(join(tmpdir(), "clothcheck-view-"));
	port = await freePort();
	address = await startServer("cloth_two_corners", engines);
	browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
		"--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
	page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
	// without a graphics processor each picture is read back, and the driver complains of it
	page.on("console", (message) => /^\[\.WebGL-.*ReadPixels/.test(message.text()) || told.push(message.text()));
	page.on("pageerror", (error) => told.push(error.message));
	await page.goto(address);
	await frames(30);
});

after(async () => {
	await browser?.close();
	server?.kill("SIGINT");
	rmSync(directory, { recursive: true, force: true });
});

// Waits until so many more frames have come.
async function frames(more) {
	const from = await page.evaluate(() => globalThis.live?.frame?.number ?? 0);
	await page.waitForFunction((number) => globalThis.live?.frame?.number >= number, from + more, { timeout: 60000 });
}

async function screenshot(name) {
	if (!SCREENSHOTS) return;
	mkdirSync(SCREENSHOTS, { recursive: true });
	await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`) });
}

const status = () => page.locator("#status").textContent();
const order = (what) => page.evaluate((asked) => globalThis.live.send(asked), what);
const place = (particle, engine = 0) => page.evaluate(([index, of]) => [...globalThis.live.bodies[of].positions.array.slice(3 * index, 3 * index + 3)], [particle, engine]);
const apart = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

// Where a particle of the first engine is on the screen.
async function onScreen(particle) {
	const at = await page.evaluate((index) => {
		const { live, THREE } = globalThis, box = live.boxOf(0), array = live.bodies[0].positions.array;
		live.camera.aspect = box.width / box.height;
		live.camera.updateProjectionMatrix();
		const point = new THREE.Vector3(...array.slice(3 * index, 3 * index + 3)).project(live.camera);
		return [box.x + (point.x + 1) / 2 * box.width, box.top + (1 - point.y) / 2 * box.height];
	}, particle);
	const canvas = await page.locator("#canvas").boundingBox();
	return { x: canvas.x + at[0], y: canvas.y + at[1] };
}

// The status of a plain request.
// A viewer without a browser, whose every message would be told of to the one who drives that: its socket.
function joinIn() {
	const { hostname, port, host, origin, search } = new URL(address);
	const headers = { Host: host, Origin: origin, Connection: "Upgrade", Upgrade: "websocket",
		"Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==" };
	const asked = request({ hostname, port, path: `/live${search}`, headers });
	asked.end();
	return new Promise((resolve, reject) => {
		asked.on("upgrade", (answer, socket) => resolve(socket));
		asked.on("error", reject);
	});
}

// One message as such a socket sends it, under a mask of nothing.
function message(text, kind = 1) {
	const body = Buffer.from(text), is = body.length;
	const length = is < 126 ? [0x80 | is] : [0x80 | 126, is >> 8, is & 255];
	return Buffer.concat([Buffer.from([0x80 | kind, ...length, 0, 0, 0, 0]), body]);
}

function ask(path, headers = {}, method = "GET") {
	const { hostname, port } = new URL(address);
	return new Promise((resolve) => {
		const asked = request({ hostname, port, path, method, headers }, (answer) => {
			answer.resume();
			resolve(answer.statusCode);
		});
		asked.on("upgrade", (answer, socket) => {
			socket.destroy();
			resolve(101);
		});
		// who is refused an upgrade is hung up on
		asked.on("error", () => resolve(0));
		asked.end();
	});
}

test("only who has the token is served, and only this page's origin gets the stream", async () => {
	const { host, search, origin } = new URL(address);
	assert.equal(await ask("/" + search), 200);
	assert.equal(await ask("/"), 403);
	assert.equal(await ask("/?t=" + "0".repeat(32)), 403);
	assert.equal(await ask("/" + search, { Host: "evil.example" }), 403);
	assert.equal(await ask("/" + search, { Origin: "http://evil.example" }), 403);
	assert.equal(await ask("/etc/passwd" + search), 404);
	assert.equal(await ask("/../../etc/passwd" + search), 404);
	assert.equal(await ask("/" + search, {}, "POST"), 405);
	const upgrade = { Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "MDEyMzQ1Njc4OWFiY2RlZg==" };
	assert.equal(await ask("/live" + search, { ...upgrade, Origin: origin }), 101);
	for (const headers of [{}, { Origin: "http://evil.example" }, { Origin: "null" }, { Origin: origin, Host: "evil.example" }])
		assert.notEqual(await ask("/live" + search, { ...upgrade, ...headers }), 101);
	assert.notEqual(await ask("/live", { ...upgrade, Origin: origin }), 101);
	assert.ok(host.startsWith("127.0.0.1:"));
});

test("engines step side by side, and their numbers stand below", async () => {
	await frames(10);
	const rows = await page.locator("#table tr").allInnerTexts();
	assert.deepEqual(rows.map((row) => row.trim().split(/\s/)[0]), engines);
	for (const row of rows) assert.match(row, /\d/);
	const speed = await page.evaluate(async () => {
		const { live } = globalThis, draw = live.draw.bind(live);
		let drawn = 0;
		live.draw = () => (drawn++, draw());
		const from = live.frame.number;
		await new Promise((resolve) => setTimeout(resolve, 2000));
		live.draw = draw;
		return { drawn: drawn / 2, stepped: (live.frame.number - from) / 2 };
	});
	// how fast is this machine's business
	console.log(`drawn ${speed.drawn} and stepped ${speed.stepped} times a second`);
	await screenshot("live");
});

test("a click locks a point, another lets it go", async () => {
	await order({ do: "pause" });
	await page.waitForFunction(() => !globalThis.live.isPlaying);
	const { x, y } = await onScreen(210);
	await page.mouse.click(x, y);
	assert.ok(await page.evaluate(() => globalThis.live.pins.size === 3));
	const locked = await page.evaluate(() => [...globalThis.live.pins].find((particle) => particle !== 0 && particle !== 19));
	const before = await place(locked), other = await place(0), low = await place(390);
	await order({ do: "set", key: "gravity", value: "[0, 9.81, 0]" });
	await order({ do: "play" });
	await frames(40);
	assert.ok(apart(await place(locked), before) < 1e-6);
	for (let engine = 0; engine < engines.length; engine++) assert.ok(apart(await place(0, engine), other) < 1e-6);
	assert.ok((await place(390))[1] > low[1] + 0.05, "gravity points up");
	await page.evaluate((particle) => globalThis.live.lockOrFree(particle), locked);
	await frames(20);
	assert.ok(apart(await place(locked), before) > 1e-3);
	await order({ do: "set", key: "gravity", value: "[0, -9.81, 0]" });
});

test("a drag pulls a point, and dropping lets it swing", async () => {
	await frames(60);
	const from = await onScreen(399);
	await page.mouse.move(from.x, from.y);
	await page.mouse.down();
	await page.mouse.move(from.x + 30, from.y - 30, { steps: 5 });
	// of several that are seen in one place the nearest to it
	const particle = await page.evaluate(() => globalThis.live.grabbed), before = await place(particle);
	await page.mouse.move(from.x + 60, from.y - 60, { steps: 5 });
	await frames(60);
	const held = await place(particle);
	await frames(20);
	const later = await Promise.all(engines.map((_, engine) => place(particle, engine)));
	await page.mouse.up();
	assert.ok(apart(held, before) > 0.02);
	later.forEach((at, engine) => assert.ok(apart(at, held) < 1e-4, engines[engine]));
	await frames(20);
	assert.ok(apart(await place(particle), held) > 0.01);
});

test("the arrow of gravity is turned, and the cloth falls that way", async () => {
	await order({ do: "play" });
	const tip = await page.evaluate(() => {
		const box = live.boxOf(0), rect = document.getElementById("canvas").getBoundingClientRect();
		live.camera.aspect = box.width / box.height;
		live.camera.updateProjectionMatrix();
		const place = (point) => {
			const { x, y } = placeInBox(point, live.camera, box);
			return { x: rect.left + x, y: rect.top + y };
		};
		return { at: place(live.arrows[0].tip), foot: place(live.arrows[0].foot) };
	});
	await page.mouse.move(tip.at.x, tip.at.y);
	await page.mouse.down();
	await page.mouse.move(tip.foot.x, 2 * tip.foot.y - tip.at.y, { steps: 6 });
	await page.mouse.up();
	const gravity = await page.locator('input[data-key="gravity"]').evaluateAll((inputs) => inputs.map((input) => Number(input.value)));
	assert.ok(gravity[1] > 3, gravity.join(", "));
	const low = await place(390);
	await frames(40);
	assert.ok((await place(390))[1] > low[1] + 0.05, "it falls up");
	await order({ do: "set", key: "gravity", value: "[0, -9.81, 0]" });
	await frames(20);
});

test("keys let go of the pins and lock them again", async () => {
	await page.locator("#canvas").focus();
	const [first] = await page.evaluate(() => live.intro.pins), at = await place(first);
	await page.keyboard.press("1");
	await frames(20);
	assert.ok(apart(await place(first), at) > 1e-3);
	await page.keyboard.press("1");
	await frames(2);
	const held = await place(first);
	await frames(10);
	assert.ok(apart(await place(first), held) < 1e-6);
});

test("the keyboard alone plays, steps and sets", async () => {
	await page.locator("#canvas").focus();
	await page.keyboard.press("Space");
	await page.waitForFunction(() => !globalThis.live.isPlaying);
	const number = await page.evaluate(() => globalThis.live.frame.number);
	await page.keyboard.press(".");
	await page.waitForFunction((at) => globalThis.live.frame.number === at + 1, number);
	await page.locator('input[data-key="drag"]').focus();
	await page.keyboard.press("Control+A");
	await page.keyboard.type("-1");
	await page.keyboard.press("Tab");
	await page.waitForFunction(() => /drag is -1/.test(document.getElementById("status").textContent));
	await page.locator('input[data-key="drag"]').focus();
	await page.keyboard.press("Control+A");
	await page.keyboard.type("8");
	await page.keyboard.press("Tab");
});

test("what was done is saved as a scene whose results are those that were shown", async () => {
	await page.fill("#name", "done");
	await page.click("#save");
	await page.waitForFunction(() => /saved/.test(document.getElementById("status").textContent));
	const told = (await status()).match(/clothcheck (compare .*)$/)[1].split(" ");
	assert.equal(told[1], join(directory, "done.yaml"));
	const out = join(directory, "again");
	execFileSync(CLOTHCHECK, [...told, "--repeats", "0", "--patience", "0", "--out", out], { cwd: SOURCES });
	const rows = readFileSync(join(out, "metrics.csv"), "utf8").split("\n").map((line) => line.split(","));
	const shown = await page.evaluate(() => globalThis.live.frame.engines.map(({ sag, strain }) => ({ sag, strain })));
	engines.forEach((engine, i) => {
		const value = (metric) => Number(rows.find((row) => row[1] === engine && row[2] === metric)[4]);
		// shown as floats
		assert.ok(Math.abs(value("sag") - shown[i].sag) < 1e-6, `${engine}: ${value("sag")} ${shown[i].sag}`);
		assert.ok(Math.abs(value("stretch_max") - shown[i].strain) < 1e-6, engine);
	});
});

test("another frame rate starts over with longer steps, for all that look on", async () => {
	await page.fill("#rate", "30");
	await page.keyboard.press("Tab");
	await page.waitForFunction(() => Math.abs(globalThis.live.intro.step - 1 / 30) < 1e-12 && globalThis.live.frame?.number < 20);
	await order({ do: "play" });
	await frames(5);
	const { number, time } = await page.evaluate(() => globalThis.live.frame);
	assert.ok(Math.abs(time - number / 30) < 1e-5);
	await page.fill("#rate", "60");
	await page.keyboard.press("Tab");
	await page.waitForFunction(() => Math.abs(globalThis.live.intro.step - 1 / 60) < 1e-12);
});

test("ten viewers see the same", async () => {
	await order({ do: "play" });
	const seen = await page.evaluate(() => Promise.all(Array.from({ length: 10 }, () => new Promise((resolve) => {
		const socket = new WebSocket(`ws://${location.host}/live${location.search}`);
		let frames = 0;
		socket.binaryType = "arraybuffer";
		socket.onmessage = ({ data }) => {
			if (typeof data !== "string" && ++frames === 5) resolve(data.byteLength);
			if (frames < 5) socket.send("+");
			else socket.close();
		};
	}))));
	assert.equal(new Set(seen).size, 1);
});

test("a hundred thousand messages that are none change nothing", async () => {
	const pins = await page.evaluate(() => globalThis.live.pins.size);
	const junk = ["", "{", "[]", "null", '{"do":1}', '{"do":"lock"}', '{"do":"lock","particle":-1}', '{"do":"set","key":"drag"}',
		'{"do":"drag","particle":0,"to":[]}', '{"do":"save","name":"/"}', "\u0000\u0001", '{"do":"' + "x".repeat(1500) + '"}', "y".repeat(5000)];
	const thousand = Buffer.concat(Array.from({ length: 1000 }, (_, i) => message(junk[i % junk.length])));
	const socket = await joinIn();
	socket.resume();
	for (let i = 0; i < 100; i++) if (!socket.write(thousand)) await once(socket, "drain");
	socket.end(message("not text", 2));
	await once(socket, "close");
	await frames(30);
	assert.equal(await page.evaluate(() => globalThis.live.pins.size), pins);
	assert.equal(server.exitCode, null);
});

test("another origin gets nothing", async () => {
	const other = await browser.newPage();
	const ended = await other.evaluate((url) => new Promise((resolve) => {
		const socket = new WebSocket(url);
		socket.onopen = () => resolve("open");
		socket.onclose = () => resolve("closed");
	}), address.replace("http", "ws").replace("/?", "/live?"));
	await other.close();
	assert.equal(ended, "closed");
});

test("axe has nothing to object to, in light and in dark", async () => {
	for (const colorScheme of ["light", "dark"]) {
		await page.emulateMedia({ colorScheme });
		await page.evaluate(axeSource);
		const { violations } = await page.evaluate(() => globalThis.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa"] }));
		assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes[0].html, nodes[0].failureSummary]), []);
		await screenshot(`live-${colorScheme}`);
	}
	await page.setViewportSize({ width: 390, height: 800 });
	await frames(5);
	const wide = await page.evaluate(() => [...document.querySelectorAll("body *")].filter((one) => one.getBoundingClientRect().right > 391 && !one.closest("#numbers")).map((one) => one.outerHTML.slice(0, 80)));
	assert.deepEqual(wide, []);
	await screenshot("live-phone");
	await page.setViewportSize({ width: 1280, height: 900 });
});

test("a server that has ended is missed", async () => {
	assert.deepEqual(told, []);
	assert.equal(await endServer(), 0);
	await page.waitForFunction(() => /the server has gone/.test(document.getElementById("status").textContent), null, { timeout: 20000 });
});

test("started again on its port it is found, with whatever scene it has now", async () => {
	const kept = join(directory, `clothcheck-view-${port}`);
	assert.equal(statSync(kept).mode & 0o777, 0o600);
	assert.equal(await startServer("rope_hanging", ["native-verlet", "mujoco"]), address);
	await page.waitForFunction(() => document.getElementById("scene").textContent === "rope_hanging", null, { timeout: 20000 });
	await page.waitForFunction(() => globalThis.live.frame?.engines.length === 2 && globalThis.live.frame.number > 10, null, { timeout: 20000 });
	await endServer();
	// a secret that others can read is none
	chmodSync(kept, 0o644);
	assert.notEqual(await startServer("rope_hanging", ["native-verlet"]), address);
	assert.equal(statSync(kept).mode & 0o777, 0o600);
	await endServer();
});
