// Plots that grow while a scene is stepped: the last so many frames of a number, a line an engine.

const plotFrames = 600;

class Plot {
	constructor(title, format, colors) {
		this.format = format;
		this.colors = colors;
		this.times = [];
		this.lines = colors.map(() => []);
		this.canvas = document.createElement("canvas");
		this.caption = document.createElement("figcaption");
		this.title = title;
		this.caption.textContent = title;
		this.figure = document.createElement("figure");
		this.figure.append(this.canvas, this.caption);
	}

	clear() {
		this.times.length = 0;
		for (const line of this.lines) line.length = 0;
	}

	add(time, values) {
		// back at the start, another story begins
		if (this.times.length && time < this.times[this.times.length - 1]) this.clear();
		this.times.push(time);
		this.lines.forEach((line, i) => line.push(values[i]));
		if (this.times.length <= plotFrames) return;
		this.times.shift();
		for (const line of this.lines) line.shift();
	}

	draw() {
		const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
		if (!width || !this.times.length) return;
		if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
		const values = this.lines.flat().filter(Number.isFinite);
		const low = Math.min(...values), high = Math.max(...values), span = high - low || 1;
		const from = this.times[0], length = this.times[this.times.length - 1] - from || 1;
		const context = this.canvas.getContext("2d");
		context.clearRect(0, 0, width, height);
		this.lines.forEach((line, i) => {
			context.strokeStyle = this.colors[i];
			context.lineWidth = 1.5;
			context.beginPath();
			let isDown = false;
			line.forEach((value, k) => {
				if (!Number.isFinite(value)) return (isDown = false);
				const x = (this.times[k] - from) / length * (width - 4) + 2, y = height - 4 - (value - low) / span * (height - 8);
				if (isDown) context.lineTo(x, y);
				else context.moveTo(x, y);
				isDown = true;
			});
			context.stroke();
		});
		this.caption.textContent = values.length ? `${this.title}: ${this.format(low)} to ${this.format(high)}` : this.title;
	}
}
