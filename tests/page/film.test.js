// A film: as many frames as its seconds have, of its size, in which something is drawn and moves.
//   CLOTHCHECK, CHROMIUM  programs;  SOURCES  the source tree
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

const { CLOTHCHECK, SOURCES } = process.env;
const hasFfmpeg = spawnSync("ffmpeg", ["-version"]).status === 0;
const skip = hasFfmpeg ? false : "ffmpeg is not there";
let directory;

before(() => directory = mkdtempSync(join(tmpdir(), "clothcheck-film-")));
after(() => rmSync(directory, { recursive: true, force: true }));

function film(...words) {
	return spawnSync(CLOTHCHECK, ["film", "cloth_two_corners@time.duration=0.3", ...words], { cwd: SOURCES, encoding: "utf8" });
}

// Its frames as bytes of grey.
function frames(file, width, height) {
	const bytes = execFileSync("ffmpeg", ["-v", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "gray", "-"], { maxBuffer: 1 << 28 });
	assert.equal(bytes.length % (width * height), 0);
	return Array.from({ length: bytes.length / (width * height) }, (_, i) => bytes.subarray(i * width * height, (i + 1) * width * height));
}

for (const ending of ["mp4", "gif"])
	test(`a film as ${ending}`, { skip }, () => {
		const file = join(directory, `short.${ending}`);
		const { status, stdout, stderr } = film("-e", "native-verlet", "-e", "bullet-pbd", "-o", file, "--size", "400x300", "--fps", "20");
		assert.equal(status, 0, stderr);
		assert.match(stdout, new RegExp(`=> ${file}`));
		const pictures = frames(file, 400, 300);
		assert.equal(pictures.length, 7);
		// cloth, captions and paper
		for (const picture of pictures) {
			const inked = picture.filter((value) => value < 230).length;
			assert.ok(inked > 1500 && inked < 60000, String(inked));
		}
		for (let i = 1; i < pictures.length; i++)
			assert.ok(pictures[i].filter((value, k) => Math.abs(value - pictures[i - 1][k]) > 20).length > 100, `frame ${i} is the one before`);
		assert.deepEqual(readdirSync(directory).filter((name) => /part$/.test(name)), []);
	});

// Frames stand above each other as the browser draws them: 37 of 300 px are more than the 8192 px after which some way
// of drawing begins anew.
test("each frame of a tall sheet has its name where the first has it", { skip }, () => {
	const file = join(directory, "short-tall.mp4");
	const { status, stderr } = film("-e", "native-verlet", "-o", file, "--size", "400x300", "--fps", "120");
	assert.equal(status, 0, stderr);
	const pictures = frames(file, 400, 300);
	assert.equal(pictures.length, 37);
	const name = (picture) => picture.filter((_, k) => k < 40 * 400 && k % 400 < 160), first = name(pictures[0]);
	assert.ok(first.filter((value) => value < 128).length > 200);
	for (const [i, picture] of pictures.entries()) {
		const off = name(picture).reduce((sum, value, k) => sum + Math.abs(value - first[k]), 0) / first.length;
		assert.ok(off < 5, `frame ${i} is ${off} off`);
	}
});

test("what cannot be filmed is said, and nothing is left", () => {
	for (const [words, said] of [[["-o", join(directory, "x.avi")], /ends in \.mp4 or \.gif/], [["--size", "401x300"], /even numbers/],
		[["--color", "taste"], /strain, distance, speed or engine/], [["--fps", "0"], /--fps/]]) {
		const { status, stderr } = film("-e", "native-verlet", ...words);
		assert.equal(status, 2, stderr);
		assert.match(stderr, said);
	}
	const { status, stderr } = spawnSync(CLOTHCHECK, ["film", "bounce", "-o", join(directory, "x.mp4")], { cwd: SOURCES, encoding: "utf8", env: { PATH: directory } });
	assert.notEqual(status, 0);
	assert.match(stderr, /Debian's package chromium, which is not there/);
	assert.deepEqual(readdirSync(directory).filter((name) => !/^short/.test(name)), []);
});
