// The frames of a film, one above the other, as many as a sheet has. All is drawn before the page has loaded.

const film = JSON.parse(document.getElementById("film").textContent);
const margins = { top: 52, bottom: 44 }; // px, for captions

class Film {
	constructor() {
		const packed = atob(document.getElementById("replay").textContent);
		this.data = parseReplay(Uint8Array.from(packed, (letter) => letter.charCodeAt(0)).buffer);
		this.names = [...this.data.paths.keys()].filter((name) => name !== "truth");
		this.end = this.data.times[this.data.times.length - 1];
		this.values = new Float32Array(this.data.particles);
		this.coloring = colorings[film.color]?.isThere(this.data) ? colorings[film.color] : null;
		this.range = this.coloring ? middleOfMost(this, this.coloring, this.end) : 1;
		this.buildWorld();
	}

	shownEngines() {
		return this.names;
	}

	buildWorld() {
		this.world = new THREE.Scene();
		const box = boundsOf(this.data, this.data.paths.has("truth") ? ["truth", this.names[0]] : this.names.slice(0, 1));
		this.colliders = makeColliders(this.data, box.getSize(new THREE.Vector3()).length());
		this.world.add(this.colliders);
		this.bodies = new Map([...this.data.paths.keys()].map((name) => [name, makeBody(this.data, name === "truth")]));
		for (const body of this.bodies.values()) this.world.add(body.group);
		this.columns = columnsFor(this.names.length, film.width, film.height - margins.top - margins.bottom);
		this.rows = Math.ceil(this.names.length / this.columns);
		this.size = { width: film.width / this.columns, height: (film.height - margins.top - margins.bottom) / this.rows };
		const aspect = this.size.width / this.size.height, away = new THREE.Vector3(0.55, 0.35, 1).normalize();
		const distance = fitDistance(box, away, 35, aspect), middle = box.getCenter(new THREE.Vector3());
		this.camera = new THREE.PerspectiveCamera(35, aspect, distance / 100, distance * 100);
		this.camera.position.copy(middle).addScaledVector(away, distance);
		this.camera.lookAt(middle);
		this.renderer = new THREE.WebGLRenderer({ antialias: true });
		this.renderer.setSize(film.width, film.height, false);
		this.renderer.setClearColor(0xffffff);
		this.renderer.autoClear = false;
	}

	// At a time, into a canvas of its own.
	frame(time) {
		const canvas = Object.assign(document.createElement("canvas"), { width: film.width, height: film.height });
		const paper = canvas.getContext("2d");
		moveColliders(this.colliders, time);
		for (const [name, body] of this.bodies) this.show(name, body, time);
		this.renderer.setScissorTest(false);
		this.renderer.clear();
		this.renderer.setScissorTest(true);
		this.names.forEach((name, i) => this.drawView(name, i));
		paper.drawImage(this.renderer.domElement, 0, 0);
		this.names.forEach((name, i) => this.label(paper, name, i));
		this.caption(paper, time);
		return canvas;
	}

	show(name, body, time) {
		const path = this.data.paths.get(name);
		body.isThere = showBody(this.data, body, path, time);
		if (name === "truth") return;
		this.coloring?.values(this, body.positions.array, path, time, this.values);
		paintBody(this.data, body, this.values, this.range, this.coloring ? null : film.colors[this.names.indexOf(name)]);
	}

	place(i) {
		return { x: (i % this.columns) * this.size.width, y: margins.top + Math.floor(i / this.columns) * this.size.height };
	}

	drawView(name, i) {
		const { x, y } = this.place(i), { width, height } = this.size;
		for (const [other, body] of this.bodies) body.group.visible = body.isThere && (other === name || other === "truth");
		this.renderer.setViewport(x, film.height - y - height, width, height);
		this.renderer.setScissor(x, film.height - y - height, width, height);
		this.renderer.render(this.world, this.camera);
	}

	label(paper, name, i) {
		const { x, y } = this.place(i);
		paper.font = "18px 'DejaVu Sans', sans-serif";
		paper.fillStyle = film.colors[i];
		paper.fillRect(x + 12, y + 8, 14, 14);
		paper.fillStyle = "#1c1c1c";
		paper.fillText(this.bodies.get(name).isThere ? name : `${name} (ended)`, x + 34, y + 22);
	}

	caption(paper, time) {
		paper.fillStyle = "#1c1c1c";
		paper.font = "bold 22px 'DejaVu Sans', sans-serif";
		paper.fillText(film.scene, 12, 32);
		const from = 28 + paper.measureText(film.scene).width;
		paper.font = "17px 'DejaVu Sans', sans-serif";
		paper.fillText(this.data.about || "", from, 32, film.width - from - 120);
		paper.textAlign = "right";
		paper.fillText(`${time.toFixed(2)} s`, film.width - 12, 32);
		paper.textAlign = "left";
		if (this.coloring) this.scale(paper);
	}

	scale(paper) {
		const y = film.height - 16, digits = Number(this.range.toPrecision(2));
		const most = this.coloring.unit ? `${digits}${this.coloring.unit}` : `${Number((100 * this.range).toPrecision(2))} %`;
		const title = `${this.coloring.title(this.data)}: 0`, width = paper.measureText(title).width;
		const ramp = paper.createLinearGradient(24 + width, 0, 184 + width, 0);
		for (let stop = 0; stop <= 4; stop++) {
			const color = [];
			strainColor(stop / 4, color, 0);
			ramp.addColorStop(stop / 4, `rgb(${color.map((part) => Math.round(255 * part)).join()})`);
		}
		paper.fillText(title, 12, y);
		paper.fillStyle = ramp;
		paper.fillRect(24 + width, y - 13, 160, 15);
		paper.fillStyle = "#1c1c1c";
		paper.fillText(`${most} and more${this.data.paths.has("truth") ? "; grey lines: the truth" : ""}`, 196 + width, y);
	}
}

const drawn = new Film(), first = Number(location.hash.slice(1)) * film.onSheet;
for (let i = first; i < Math.min(first + film.onSheet, film.frames); i++)
	document.body.append(drawn.frame(Math.min(drawn.end, i / film.fps)));
