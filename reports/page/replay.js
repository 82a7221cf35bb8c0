// The replay: engines side by side or overlaid, one camera and one time for all.

// True where there is no graphics processor: smooth edges would halve the speed.
function drawsInSoftware() {
	const context = document.createElement("canvas").getContext("webgl");
	const info = context && context.getExtension("WEBGL_debug_renderer_info");
	return !info || /swiftshader|llvmpipe|software/i.test(context.getParameter(info.UNMASKED_RENDERER_WEBGL));
}

// Colours reach to the largest strain of the truth, or where it tells of none of the engine in the middle.
async function strainRange(scene) {
	const metrics = await table("metrics.csv");
	const rows = (metrics ? metrics.rows : []).filter((row) => row.scene === scene && row.metric === "stretch_max");
	const values = rows.map((row) => Math.abs(number(row.value))).filter((value) => value > 0).sort((a, b) => a - b);
	const truth = rows.map((row) => number(row.truth)).find((value) => value > 0);
	return truth || values[Math.floor(values.length / 2)] || 0.01;
}

class Replay {
	constructor() {
		this.canvas = document.getElementById("replay-canvas");
		this.slider = document.getElementById("replay-time");
		this.renderer = null;
		this.isPlaying = false;
		this.isDirty = false;
		for (const id of ["replay-layout", "replay-truth"])
			document.getElementById(id).addEventListener("change", () => this.redraw());
		document.getElementById("replay-color").addEventListener("change", () => this.recolor());
		this.slider.addEventListener("input", () => this.redraw());
		this.slider.addEventListener("change", () => keepState("t", this.slider.value));
		document.getElementById("replay-play").addEventListener("click", () => this.play(!this.isPlaying));
		this.canvas.addEventListener("keydown", (event) => this.turn(event));
		window.addEventListener("resize", () => this.redraw());
		window.addEventListener("beforeprint", () => this.print());
	}

	// Without a context there is no replay, and the rest of the page goes on.
	start() {
		if (this.renderer) return true;
		try {
			this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !drawsInSoftware() });
		} catch {
			return false;
		}
		this.renderer.setClearColor(0xffffff);
		this.renderer.autoClear = false;
		this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
		this.controls = new THREE.OrbitControls(this.camera, this.canvas);
		this.controls.enableKeys = false;
		this.controls.addEventListener("change", () => this.redraw());
		return true;
	}

	async load(scene, isWanted) {
		this.play(false);
		const box = document.getElementById("replay");
		document.getElementById("scene-about").textContent = "";
		box.hidden = !report.scenes.some((one) => one.name === scene && one.has_replay) || !this.start();
		if (box.hidden) return;
		const [bytes, range] = await Promise.all([fileBytes(scene + ".replay"), strainRange(scene)]);
		if (!isWanted()) return;
		this.data = parseReplay(bytes);
		this.strainRange = range;
		document.getElementById("scene-about").textContent = this.data.about || "";
		this.world = new THREE.Scene();
		this.colliders = makeColliders(this.data, boundsOf(this.data, [...this.data.paths.keys()].slice(-1)).getSize(new THREE.Vector3()).length());
		this.world.add(this.colliders);
		this.bodies = new Map([...this.data.paths.keys()].map((name) => [name, makeBody(this.data, name === "truth")]));
		for (const body of this.bodies.values()) this.world.add(body.group);
		this.values = new Float32Array(this.data.particles);
		this.listEngines();
		this.slider.max = this.data.times[this.data.times.length - 1];
		const asked = state.get("scene") === scene ? state.get("t") : null;
		this.slider.value = asked ?? widestTime(this.data, this.shownEngines());
		this.aim();
		this.recolor();
	}

	// The coloring that is chosen; null where the colour is the engine's own.
	coloring() {
		const chosen = colorings[document.getElementById("replay-color").value];
		return chosen?.isThere(this.data) ? chosen : null;
	}

	// Colours reach to what the engine in the middle has at most; of strain, to the truth's.
	rangeOf(coloring) {
		if (coloring === colorings.strain) return this.strainRange;
		return middleOfMost(this, coloring, Number(this.slider.max));
	}

	recolor() {
		if (!this.data) return;
		const coloring = this.coloring(), scale = document.getElementById("replay-scale");
		scale.hidden = !coloring;
		this.range = coloring ? this.rangeOf(coloring) : 1;
		const ramp = element("span");
		ramp.style.background = "linear-gradient(90deg, rgb(219,214,204), rgb(128,10,26))";
		if (coloring) {
			const most = coloring.unit ? readable(this.range) + coloring.unit : percent(this.range);
			scale.replaceChildren(`${coloring.title(this.data)}: 0`, ramp, `${most} and more`);
		}
		this.redraw();
	}

	listEngines() {
		const box = document.getElementById("replay-engines");
		box.replaceChildren(element("legend", { textContent: "Engines" }));
		for (const name of this.bodies.keys()) {
			if (name === "truth" || !isShown(name)) continue;
			const input = element("input", { type: "checkbox", checked: name !== "still", value: name });
			input.addEventListener("change", () => this.recolor());
			box.append(element("label", {}, input, " ", engineName(name)));
		}
	}

	shownEngines() {
		return [...document.querySelectorAll("#replay-engines input:checked")].map((input) => input.value);
	}

	// How many views stand beside and above each other.
	grid(count) {
		const columns = Math.max(1, Math.ceil(Math.sqrt(count * this.canvas.clientWidth / this.canvas.clientHeight * 0.7)));
		return { columns, rows: Math.max(1, Math.ceil(count / columns)) };
	}

	// So near that all that moves still fits each view.
	aim() {
		const names = this.bodies.has("truth") ? ["truth", ...this.shownEngines().slice(0, 1)] : this.shownEngines().slice(0, 1);
		const box = boundsOf(this.data, names.length ? names : [...this.bodies.keys()]);
		const radius = Math.max(box.getBoundingSphere(new THREE.Sphere()).radius, 1e-3);
		const { columns, rows } = this.grid(document.getElementById("replay-layout").value === "over" ? 1 : this.shownEngines().length);
		const aspect = (this.canvas.clientWidth / columns) / (this.canvas.clientHeight / rows) || 1;
		const away = new THREE.Vector3(0.55, 0.35, 1).normalize();
		this.camera.near = radius / 100;
		this.camera.far = radius * 100;
		box.getCenter(this.controls.target);
		this.camera.position.copy(this.controls.target).addScaledVector(away, fitDistance(box, away, this.camera.fov, aspect));
		this.controls.update();
	}

	redraw() {
		if (!this.data || this.isDirty) return;
		this.isDirty = true;
		requestAnimationFrame(() => {
			this.isDirty = false;
			this.draw();
		});
	}

	// One view an engine, or one view of all.
	draw() {
		// on paper there is no canvas
		if (!this.canvas.clientWidth) return;
		const time = Number(this.slider.value), engines = this.shownEngines();
		const isOver = document.getElementById("replay-layout").value === "over";
		const coloring = this.coloring();
		document.getElementById("replay-now").textContent = time.toFixed(3) + " s";
		moveColliders(this.colliders, time);
		for (const [name, body] of this.bodies) {
			const path = this.data.paths.get(name);
			showBody(this.data, body, path, time);
			if (name === "truth") continue;
			coloring?.values(this, body.positions.array, path, time, this.values);
			paintBody(this.data, body, this.values, this.range, coloring ? null : looks.get(name).color);
		}
		const views = isOver ? [engines] : engines.map((engine) => [engine]);
		const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
		// a size that is set anew takes a new buffer, which costs more than the drawing
		const size = this.renderer.getSize(new THREE.Vector2());
		if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
		this.renderer.setScissorTest(false);
		this.renderer.clear();
		this.renderer.setScissorTest(true);
		const { columns, rows } = this.grid(views.length);
		views.forEach((names, i) => this.drawView(names, {
			x: (i % columns) * width / columns, y: height - (Math.floor(i / columns) + 1) * height / rows,
			width: width / columns, height: height / rows,
		}));
		this.label(views, columns, rows, isOver);
	}

	drawView(names, { x, y, width, height }) {
		const visible = new Map();
		for (const [name, body] of this.bodies) {
			visible.set(body, body.group.visible);
			const isWanted = name === "truth" ? document.getElementById("replay-truth").checked : names.includes(name);
			body.group.visible = body.group.visible && isWanted;
		}
		this.camera.aspect = width / height;
		this.camera.updateProjectionMatrix();
		this.renderer.setViewport(x, y, width, height);
		this.renderer.setScissor(x, y, width, height);
		this.renderer.render(this.world, this.camera);
		for (const [body, was] of visible) body.group.visible = was;
	}

	// On paper there is a picture in the canvas's place, whose own content is gone once it is shown.
	print() {
		if (!this.data) return;
		this.draw();
		document.getElementById("replay-print").src = this.canvas.toDataURL("image/png");
	}

	// Names stand over the views, as text that can be read and selected.
	label(views, columns, rows, isOver) {
		const layer = document.getElementById("replay-labels");
		const text = (name) => [engineName(name), this.bodies.get(name).group.visible ? "" : " (ended)"];
		const key = JSON.stringify([views, columns, rows, views.flat().map((name) => this.bodies.get(name).group.visible)]);
		if (layer.dataset.key === key) return;
		layer.dataset.key = key;
		layer.replaceChildren(...views.map((names, i) => {
			const label = element("span", {}, ...(isOver ? names.flatMap((name) => [...text(name), " "]) : text(names[0])));
			label.style.left = 100 * (i % columns) / columns + "%";
			label.style.top = 100 * Math.floor(i / columns) / rows + "%";
			return label;
		}));
	}

	play(isPlaying) {
		const wasPlaying = this.isPlaying;
		this.isPlaying = isPlaying;
		document.getElementById("replay-play").textContent = isPlaying ? "Pause" : "Play";
		if (!isPlaying) {
			if (wasPlaying) keepState("t", this.slider.value);
			return;
		}
		const end = Number(this.slider.max);
		if (Number(this.slider.value) >= end) this.slider.value = 0;
		let before = performance.now();
		const step = (now) => {
			if (!this.isPlaying) return;
			this.slider.value = Math.min(end, Number(this.slider.value) + (now - before) / 1000);
			before = now;
			this.draw();
			if (Number(this.slider.value) >= end) this.play(false);
			else requestAnimationFrame(step);
		};
		requestAnimationFrame(step);
	}

	turn(event) {
		if (!this.data || !turnCamera(this.camera, this.controls.target, event.key)) return;
		event.preventDefault();
		this.controls.update();
		this.redraw();
	}
}
