// The live page: what the server sends is drawn, and what a person does is sent.

const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#7a5195", "#666666"];
const byId = (id) => document.getElementById(id);
const make = (name, properties = {}, ...children) => {
	const made = Object.assign(document.createElement(name), properties);
	made.append(...children);
	return made;
};
const short = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(3))) : "–");
const percentOf = (value) => (Number.isFinite(value) ? `${Number((100 * value).toPrecision(3))} %` : "–");
const headNumbers = 4, engineNumbers = 6;

class Live {
	constructor() {
		this.token = new URLSearchParams(location.search).get("t") || "";
		this.isPlaying = false;
		this.pins = new Set();
		this.grabbed = -1; // the particle that was pulled last
		this.bindKeys();
		this.connect();
	}

	// A server that was ended may come back: the page asks again.
	connect() {
		this.socket = new WebSocket(`ws://${location.host}/live?t=${this.token}`);
		this.socket.binaryType = "arraybuffer";
		this.socket.onmessage = ({ data }) => (typeof data === "string" ? this.hear(JSON.parse(data)) : this.take(data));
		this.socket.onclose = () => {
			this.say("the server has gone; looking for it again", true);
			setTimeout(() => this.connect(), 1000);
		};
	}

	send(order) {
		if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(order));
	}

	say(text, isBad = false) {
		byId("status").textContent = text;
		byId("status").classList.toggle("bad", isBad);
	}

	hear(message) {
		if (message.kind === "intro") this.begin(message);
		else if (message.kind === "error") this.say(message.text, true);
		else if (message.kind === "saved") this.say(`saved; this does the same again: ${message.text}`);
		else if (message.kind === "said") this.said(message.text);
		else if (message.kind === "ended") {
			this.ended.set(message.engine, message);
			this.say(`${this.intro.engines[message.engine].name} ${message.status}: ${message.text}`, true);
		}
	}

	said(text) {
		this.say(text);
		if (text !== "back to the start") return;
		this.ended.clear();
		this.pins = new Set(this.intro.pins);
		this.fillFields();
	}

	begin(intro) {
		const isNew = !this.intro;
		this.intro = intro;
		this.ended = new Map();
		this.pins = new Set(intro.pins);
		byId("scene").textContent = intro.scene;
		byId("about").textContent = intro.about;
		this.colors = intro.engines.map((_, i) => palette[i % palette.length]);
		this.scene = {
			columns: intro.columns, particles: intro.particles, cloth: intro.cloth, springs: intro.springs, rests: intro.rests,
			triangles: intro.triangles, bodies: intro.bodies, paths: new Map(),
			planes: intro.colliders.filter((one) => one.shape === "plane").map((one) => one.numbers),
			solids: intro.colliders.filter((one) => one.shape !== "plane").map((one) => Object.assign(one.numbers, { shape: one.shape })),
		};
		this.frame = null;
		if (isNew) this.startDrawing();
		this.build();
		byId("rate").value = short(1 / intro.step);
		this.makeFields();
		this.makeTable();
		this.say("click a point to lock it or let it go, drag it to pull");
		this.socket.send("+");
	}

	startDrawing() {
		this.renderer = new THREE.WebGLRenderer({ canvas: byId("canvas"), antialias: false });
		this.renderer.autoClear = false;
		// a picture that is seen through takes longer to put on the page
		const paint = () => this.renderer.setClearColor(new THREE.Color(getComputedStyle(document.body).backgroundColor));
		matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
			paint();
			this.redraw();
		});
		paint();
		this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
		this.controls = new THREE.OrbitControls(this.camera, byId("canvas"));
		this.controls.enableKeys = false;
		this.controls.addEventListener("change", () => this.redraw());
		window.addEventListener("resize", () => this.redraw());
		for (const id of ["layout", "color", "lines"]) byId(id).addEventListener("change", () => this.redraw());
		this.bindMouse();
	}

	build() {
		this.world = new THREE.Scene();
		this.bodies = this.intro.engines.map(() => makeBody(this.scene, false));
		this.wires = this.bodies.map((body) => {
			const wire = new THREE.LineSegments(bodyGeometry(this.scene, body.positions, null, this.scene.springs),
				new THREE.LineBasicMaterial({ color: 0x777777, transparent: true, opacity: 0.6 }));
			body.group.add(wire);
			return wire;
		});
		for (const body of this.bodies) this.world.add(body.group);
		this.pinDots = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ color: 0xd08000, size: 9, sizeAttenuation: false }));
		this.pinDots.frustumCulled = false;
		this.world.add(this.pinDots);
		this.arrows = ["gravity", "force"].map((key) =>
			new ForceArrow(key, arrowUnits[key] * (key === "force" ? this.intro.weight : 1), 0.5 * this.intro.size));
		this.strains = new Float32Array(this.scene.particles);
		this.isAimed = false;
	}

	// One frame: numbers of each engine, then positions of each.
	take(data) {
		const words = new Uint32Array(data), numbers = new Float32Array(data), count = words[3];
		const at = headNumbers + count * engineNumbers, width = 3 * this.scene.particles;
		this.frame = {
			number: words[0], time: numbers[1],
			engines: this.intro.engines.map((_, i) => {
				const of = headNumbers + i * engineNumbers;
				return { hasEnded: words[of] !== 0, cpu: numbers[of + 1], wall: numbers[of + 2], sag: numbers[of + 3], strain: numbers[of + 4], apart: numbers[of + 5] };
			}),
		};
		this.isPlaying = words[2] === 1;
		byId("play").textContent = this.isPlaying ? "Pause" : "Play";
		this.bodies.forEach((body, i) => {
			body.positions.array.set(numbers.subarray(at + i * width, at + (i + 1) * width));
			body.positions.needsUpdate = true;
			body.rigid.forEach((mesh, index) => placeRigid(this.scene, mesh, index, body.positions.array));
		});
		this.foretell();
		if (!this.isAimed) this.aim();
		this.redraw();
		this.socket.send("+");
	}

	// What is held is drawn where it will be at the end of the next frame, before the engines have got there: on its way to the
	// pointer, as fast as the server lets it.
	foretell() {
		if (!this.pull) return;
		const at = 3 * this.pull.particle, most = this.intro.fastest * this.intro.step;
		for (const { positions } of this.bodies) {
			const from = new THREE.Vector3().fromArray(positions.array, at), way = new THREE.Vector3(...this.pull.to).sub(from);
			from.add(way.clampLength(0, most)).toArray(positions.array, at);
			positions.needsUpdate = true;
		}
	}

	aim() {
		this.isAimed = true;
		const box = new THREE.Box3(), array = this.bodies[0].positions.array, point = new THREE.Vector3();
		for (let i = 0; i < array.length; i += 3) box.expandByPoint(point.set(array[i], array[i + 1], array[i + 2]));
		const sphere = box.getBoundingSphere(new THREE.Sphere()), radius = Math.max(0.75 * this.intro.size, sphere.radius, 1e-3);
		const colliders = makeColliders(this.scene, 2 * radius);
		this.world.add(colliders);
		this.arrows.forEach((arrow, i) => {
			arrow.place(sphere.center.clone().add(new THREE.Vector3((i ? 1 : -1) * 1.1 * radius, 0.6 * radius, 0)));
			arrow.show(this.intro[arrow.key]);
		});
		this.camera.near = radius / 100;
		this.camera.far = radius * 100;
		this.controls.target.copy(sphere.center).add(new THREE.Vector3(0, -0.4 * radius, 0));
		this.camera.position.copy(this.controls.target).add(new THREE.Vector3(0.55, 0.35, 1).setLength(4.4 * radius));
		this.controls.update();
	}

	redraw() {
		if (this.isDirty || !this.frame) return;
		this.isDirty = true;
		requestAnimationFrame(() => {
			this.isDirty = false;
			this.draw();
		});
	}

	paint(body, index) {
		const mode = byId("color").value;
		strainsAt(this.scene, body.positions.array, this.strains);
		paintBody(this.scene, body, this.strains, this.range(), mode === "engine" || !this.scene.rests.length ? this.colors[index] : null);
		if (mode !== "first") return;
		const here = body.positions.array, first = this.bodies[0].positions.array, out = body.colors.array;
		for (let i = 0; i < this.scene.particles; i++)
			strainColor(Math.hypot(here[3 * i] - first[3 * i], here[3 * i + 1] - first[3 * i + 1], here[3 * i + 2] - first[3 * i + 2]) /
				(0.05 * this.intro.size), out, 3 * i);
	}

	// Colours reach to the largest strain that there is, and no less than to a hundredth.
	range() {
		return Math.max(0.01, ...this.frame.engines.map((one) => one.strain).filter(Number.isFinite));
	}

	draw() {
		const canvas = byId("canvas"), width = canvas.clientWidth, height = canvas.clientHeight;
		const size = this.renderer.getSize(new THREE.Vector2());
		this.keepPace(width, height, size);
		this.bodies.forEach((body, i) => this.paint(body, i));
		const isOver = byId("layout").value === "over", all = this.bodies.map((_, i) => i);
		const views = isOver ? [all] : all.map((i) => [i]);
		this.renderer.setScissorTest(false);
		this.renderer.clear();
		this.renderer.setScissorTest(true);
		this.columns = columnsFor(views.length, width, height);
		this.rows = Math.ceil(views.length / this.columns);
		views.forEach((shown, i) => this.drawView(shown, this.boxOf(i)));
		drawArrows(byId("arrows"), this.arrows, this.camera, views.map((_, i) => this.boxOf(i)));
		this.label(views);
		this.showNumbers();
	}

	// Without a graphics processor a large picture takes too long: it is drawn coarser as long as frames come slower than 30 a
	// second, and finer again where they are quick.
	keepPace(width, height, size) {
		const now = performance.now(), took = now - (this.drawnAt ?? now);
		this.drawnAt = now;
		const before = this.coarseness ?? 1;
		// a pause between two frames is no slow frame
		if (took > 0 && took < 200) this.pace = 0.9 * (this.pace ?? 16) + 0.1 * took;
		if (this.pace > 33 && this.steadyAt !== undefined && now - this.steadyAt > 500) this.coarseness = Math.max(0.5, before * 0.8);
		if (this.pace < 20 && now - this.steadyAt > 3000) this.coarseness = Math.min(1, before * 1.25);
		if (this.steadyAt === undefined || this.coarseness !== before) this.steadyAt = now;
		this.coarseness ??= 1;
		if (size.x === width && size.y === height && this.coarseness === this.drawnCoarseness) return;
		this.drawnCoarseness = this.coarseness;
		this.renderer.setPixelRatio(this.coarseness);
		this.renderer.setSize(width, height, false);
	}

	boxOf(i) {
		const canvas = byId("canvas"), width = canvas.clientWidth / this.columns, height = canvas.clientHeight / this.rows;
		return { x: (i % this.columns) * width, top: Math.floor(i / this.columns) * height, width, height };
	}

	drawView(shown, { x, top, width, height }) {
		const y = byId("canvas").clientHeight - top - height;
		this.bodies.forEach((body, i) => {
			body.group.visible = shown.includes(i) && !body.positions.array.some(Number.isNaN);
			this.wires[i].visible = byId("lines").checked;
		});
		const array = this.bodies[shown[0]].positions.array, dots = new Float32Array(3 * this.pins.size);
		[...this.pins].forEach((particle, i) => dots.set(array.subarray(3 * particle, 3 * particle + 3), 3 * i));
		this.pinDots.geometry.setAttribute("position", new THREE.BufferAttribute(dots, 3));
		this.camera.aspect = width / height;
		this.camera.updateProjectionMatrix();
		this.renderer.setViewport(x, y, width, height);
		this.renderer.setScissor(x, y, width, height);
		this.renderer.render(this.world, this.camera);
	}

	label(views) {
		const key = JSON.stringify([views.map((_, i) => this.boxOf(i)), [...this.ended.keys()]]);
		if (byId("labels").dataset.key === key) return;
		byId("labels").dataset.key = key;
		byId("labels").replaceChildren(...views.map((shown, i) => {
			const box = this.boxOf(i), span = make("span");
			for (const index of shown) {
				span.append(this.mark(index), ` ${this.intro.engines[index].name}${this.ended.has(index) ? " (ended)" : ""} `);
			}
			span.style.left = `${box.x}px`;
			span.style.top = `${box.top}px`;
			return span;
		}));
	}

	// An engine's colour, beside its name.
	mark(index) {
		const mark = make("span", { className: "mark" });
		mark.style.background = this.colors[index];
		return mark;
	}

	makeTable() {
		byId("table").replaceChildren(...this.intro.engines.map((engine, i) => {
			const name = make("th", { scope: "row", title: engine.about }, this.mark(i), ` ${engine.name}`);
			return make("tr", {}, name, ...Array.from({ length: 5 }, () => make("td", { className: "number" })));
		}));
		this.plots = [new Plot("sag / size", short, this.colors), new Plot("largest strain", percentOf, this.colors),
			new Plot("distance to the first / size", short, this.colors), new Plot("ms a frame", short, this.colors)];
		byId("plots").replaceChildren(...this.plots.map((plot) => plot.figure));
	}

	// Ten times a second, and the plots as often: nobody reads faster, and the cloths have the time.
	showNumbers() {
		const { time, engines } = this.frame, step = 1e3 * this.intro.step;
		if (this.plottedFrame !== this.frame.number) {
			this.plots[0].add(time, engines.map((one) => one.sag));
			this.plots[1].add(time, engines.map((one) => one.strain));
			this.plots[2].add(time, engines.map((one) => one.apart));
			this.plots[3].add(time, engines.map((one) => one.cpu));
		}
		this.plottedFrame = this.frame.number;
		const now = performance.now();
		if (this.isPlaying && now - (this.shownAt ?? 0) < 100) return;
		this.shownAt = now;
		byId("time").textContent = `${time.toFixed(2)} s`;
		engines.forEach((one, i) => {
			const cells = byId("table").rows[i].cells, ratio = one.wall > 0 ? step / one.wall : NaN;
			const values = [one.cpu.toFixed(2), one.hasEnded ? "ended" : `${short(ratio)}${ratio < 1 ? ", behind" : ""}`, short(one.sag),
				percentOf(one.strain), i ? percentOf(one.apart) : "–"];
			values.forEach((text, k) => (cells[k + 1].textContent = text));
			cells[2].classList.toggle("bad", one.hasEnded || ratio < 1);
		});
		for (const plot of this.plots) plot.draw();
	}

	// A field that sets a key when it is changed.
	field(label, key, value, properties = {}) {
		const input = make("input", { type: "number", step: "any", value, ...properties });
		input.dataset.key = key;
		input.addEventListener("change", () => input.value !== "" && this.send({ do: "set", key, value: input.value }));
		return make("label", {}, label, input);
	}

	setVector(key, values) {
		this.send({ do: "set", key, value: `[${values.join(", ")}]` });
		this.arrows.find((arrow) => arrow.key === key).show(values);
		document.querySelectorAll(`input[data-key="${key}"]`).forEach((input, axis) => (input.value = values[axis]));
		this.redraw();
	}

	// Three numbers, as one list.
	vector(label, key, values) {
		const inputs = values.map((value, axis) => make("input", { type: "number", step: "any", value, ariaLabel: `${label} ${"xyz"[axis]}` }));
		const send = () => this.setVector(key, inputs.map((input) => Number(input.value) || 0));
		for (const input of inputs) {
			input.addEventListener("change", send);
			input.dataset.key = key;
		}
		return make("div", {}, make("div", { textContent: label }), make("div", { className: "vector" }, ...inputs));
	}

	makeFields() {
		this.fillFields();
		byId("engines").replaceChildren(make("legend", { textContent: "Engines" }), ...this.intro.engines.map((engine) => {
			const rows = engine.settings.map((setting) => {
				const row = this.field(setting.name, `settings.${engine.name}.${setting.name}`, "", { placeholder: "automatic",
					step: setting.whole ? "1" : "any", min: setting.least, max: setting.most });
				row.title = `${setting.help}; where it is not set: ${setting.rule}`;
				return row;
			});
			return make("details", {}, make("summary", { textContent: engine.name }), ...rows);
		}));
		byId("particle").max = this.scene.cloth - 1;
		const named = this.intro.pins.slice(0, 9).map((particle, i) => `${i + 1}: ${particle}`);
		byId("pin-names").textContent = named.length ? `Keys lock and let go: ${named.join(", ")}` : "";
	}

	fillFields() {
		if (this.isAimed) for (const arrow of this.arrows) arrow.show(this.intro[arrow.key]);
		const { gravity, force, drag, stiffness, damping } = this.intro;
		byId("forces").replaceChildren(make("legend", { textContent: "Forces" }), this.vector("Gravity, m/s²", "gravity", gravity),
			this.vector("Force on each, N", "force", force), this.field("Drag, 1/s", "drag", drag, { min: 0 }));
		byId("cloth").replaceChildren(make("legend", { textContent: "Cloth" }));
		byId("cloth").hidden = stiffness === null;
		if (stiffness === null) return;
		byId("cloth").append(this.field("Stiffness, N/m", "springs.stiffness", stiffness, { min: 0 }),
			this.field("Damping, N·s/m", "springs.damping", damping, { min: 0 }));
	}

	lockOrFree(particle) {
		const locks = !this.pins.has(particle);
		if (locks) this.pins.add(particle);
		else this.pins.delete(particle);
		this.send({ do: locks ? "lock" : "free", particle });
		this.say(`particle ${particle} is ${locks ? "locked" : "let go"}`);
		this.redraw();
	}

	// The view and the particle nearest to a place of the canvas: {view, particle, point}, or null.
	pick(event) {
		const canvas = byId("canvas"), rect = canvas.getBoundingClientRect();
		const px = event.clientX - rect.left, py = event.clientY - rect.top;
		const isOver = byId("layout").value === "over", count = isOver ? 1 : this.bodies.length;
		for (let i = 0; i < count; i++) {
			const box = this.boxOf(i);
			if (px < box.x || px >= box.x + box.width || py < box.top || py >= box.top + box.height) continue;
			this.camera.aspect = box.width / box.height;
			this.camera.updateProjectionMatrix();
			const arrow = pickArrow(this.arrows, this.camera, box, px, py);
			if (arrow) return arrow;
			let best = null, nearest = 16;
			const array = this.bodies[i].positions.array, point = new THREE.Vector3();
			for (let k = 0; k < this.scene.cloth; k++) {
				point.set(array[3 * k], array[3 * k + 1], array[3 * k + 2]).project(this.camera);
				const distance = Math.hypot((point.x + 1) / 2 * box.width + box.x - px, (1 - point.y) / 2 * box.height + box.top - py);
				if (distance < nearest) [nearest, best] = [distance, { box, particle: k, depth: point.z }];
			}
			return best;
		}
		return null;
	}

	// Where in space a place of the canvas is, at the depth of what is held.
	placeOf(event, { box, depth }) {
		const rect = byId("canvas").getBoundingClientRect();
		const x = (event.clientX - rect.left - box.x) / box.width * 2 - 1, y = 1 - (event.clientY - rect.top - box.top) / box.height * 2;
		this.camera.aspect = box.width / box.height;
		this.camera.updateProjectionMatrix();
		return new THREE.Vector3(x, y, depth).unproject(this.camera).toArray();
	}

	bindMouse() {
		const canvas = byId("canvas");
		let down = null;
		canvas.addEventListener("pointerdown", (event) => {
			down = this.frame && event.button === 0 ? this.pick(event) : null;
			if (!down) return;
			this.controls.enabled = false;
			canvas.setPointerCapture(event.pointerId);
			down.from = [event.clientX, event.clientY];
			down.isDrag = false;
		}, true);
		canvas.addEventListener("pointermove", (event) => {
			if (!down) return;
			down.isDrag ||= Math.hypot(event.clientX - down.from[0], event.clientY - down.from[1]) > 4;
			if (!down.isDrag) return;
			const to = this.placeOf(event, down);
			if (down.arrow) {
				down.arrow.show(down.arrow.valueAt(to));
				this.say(`${down.arrow.key}: ${down.arrow.value.join(", ")}`);
			} else {
				this.grabbed = down.particle;
				this.say(`pulling particle ${down.particle}`);
				this.send({ do: "drag", particle: down.particle, to });
				this.pull = { particle: down.particle, to };
				this.foretell();
			}
			this.redraw();
		});
		const up = () => {
			if (!down) return;
			if (down.arrow) {
				if (down.isDrag) this.setVector(down.arrow.key, down.arrow.value);
			} else if (down.isDrag) this.send({ do: "drop" });
			else this.lockOrFree(down.particle);
			this.pull = null;
			down = null;
			this.controls.enabled = true;
		};
		canvas.addEventListener("pointerup", up);
		canvas.addEventListener("pointercancel", up);
	}

	bindKeys() {
		const press = (id, act) => byId(id).addEventListener("click", act);
		const play = () => this.send({ do: this.isPlaying ? "pause" : "play" });
		press("play", play);
		press("step", () => this.send({ do: "step" }));
		press("reset", () => this.send({ do: "reset" }));
		press("save", () => this.send({ do: "save", name: byId("name").value }));
		press("lock", () => !this.pins.has(Number(byId("particle").value)) && this.lockOrFree(Number(byId("particle").value)));
		press("free", () => this.pins.has(Number(byId("particle").value)) && this.lockOrFree(Number(byId("particle").value)));
		byId("pace").addEventListener("change", () => this.send({ do: "pace", times: Number(byId("pace").value) }));
		byId("rate").addEventListener("change", () => this.send({ do: "rate", rate: Number(byId("rate").value) }));
		document.addEventListener("keydown", (event) => {
			if (/INPUT|SELECT|BUTTON|SUMMARY/.test(event.target.tagName)) return;
			if (event.key === " ") play();
			else if (event.key === ".") this.send({ do: "step" });
			else if (event.key === "r") this.send({ do: "reset" });
			else if (this.pressPin(event.key)) return;
			else if (this.turn(event.key)) this.redraw();
			else return;
			event.preventDefault();
		});
	}

	// The pins that the scene begins with, by the keys 1 to 9.
	pressPin(key) {
		const particle = /^[1-9]$/.test(key) ? this.intro?.pins[Number(key) - 1] : undefined;
		if (particle !== undefined) this.lockOrFree(particle);
		return particle !== undefined;
	}

	turn(key) {
		if (!this.camera || !turnCamera(this.camera, this.controls.target, key)) return false;
		this.controls.update();
		return true;
	}
}

globalThis.THREE ??= THREE;
globalThis.live = new Live();
