// Charts that answer when pointed at. gnuplot drew them and says in NAME.axes where its axes lie: what is pointed at is
// told in their numbers. A series is hidden by its name in the key; a double click comes closer.

const svgSpace = "http://www.w3.org/2000/svg";
let chartsMade = 0;

// Of each panel {x, y}: {low, high, from, to, isLog}, from and to in the drawing's units; none where there is no such file.
function parseAxes(text) {
	return (text || "").trim().split("\n").map(parsePanel).filter((panel) => panel);
}

function parsePanel(line) {
	const numbers = line.trim().split(/\s+/).map(Number);
	if (numbers.length !== 10 || numbers.some(Number.isNaN)) return null;
	const [xLow, xHigh, xFrom, xTo, xLog, yLow, yHigh, yFrom, yTo, yLog] = numbers;
	return { x: { low: xLow, high: xHigh, from: xFrom, to: xTo, isLog: xLog > 0 },
		y: { low: yLow, high: yHigh, from: yFrom, to: yTo, isLog: yLog > 0 } };
}

// A place on an axis as its number; NaN beside it.
function axisValue(axis, place) {
	const share = (place - axis.from) / (axis.to - axis.from);
	if (share < -1e-3 || share > 1 + 1e-3) return NaN;
	return axis.isLog ? axis.low * (axis.high / axis.low) ** share : axis.low + share * (axis.high - axis.low);
}

// Where a series has marks or corners of its lines.
function seriesPoints(group) {
	const points = [...group.querySelectorAll("use")].map((use) => /translate\(([-\d.]+),([-\d.]+)\)/.exec(use.getAttribute("transform")));
	for (const path of group.querySelectorAll("path"))
		points.push(...path.getAttribute("d").matchAll(/[ML]?\s*(-?[\d.]+),(-?[\d.]+)/g));
	return points.filter((found) => found).map((found) => ({ x: Number(found[1]), y: Number(found[2]) }));
}

// What gnuplot drew, with names of its own on a page that has several.
function chartDrawing(text, title) {
	const prefix = `chart${++chartsMade}-`;
	const named = text.replace(/(id=['"]|href=['"]#)(gp|gnuplot)/g, `$1${prefix}$2`);
	const svg = document.importNode(new DOMParser().parseFromString(named, "image/svg+xml").documentElement, true);
	svg.setAttribute("role", "group");
	svg.setAttribute("aria-label", title);
	for (const words of svg.querySelectorAll(":scope > title, :scope > desc")) words.remove();
	return svg;
}

// The numbers of a place in the panel that it is in: [x, y]; null beside all.
function numbersAt({ x, y }, panels) {
	const all = panels.map((panel) => [axisValue(panel.x, x), axisValue(panel.y, y)]);
	return all.find((numbers) => !numbers.some(Number.isNaN)) || null;
}

// The series of a drawing that have a name: {name, group, key, points}, points where the axes are, and beside them only
// the sample in the key.
function chartSeries(svg, panels) {
	const isInside = (point) => !panels.length || numbersAt(point, panels);
	return [...svg.querySelectorAll("g[id*=gnuplot_plot_]")].map((group) => {
		const title = group.querySelector(":scope > title"), name = title ? title.textContent : "";
		if (title) title.remove();
		const key = [...group.querySelectorAll("text")].find((words) => words.textContent.trim() === name);
		return { name, group, key, points: seriesPoints(group).filter(isInside), isHidden: false };
	}).filter((series) => series.name && series.name !== "Gnuplot");
}

// A click on a name in the key, or a key on it, takes the series away and back, in all panels.
function makeKey(series, all) {
	if (!series.key) return;
	const box = series.key.parentElement;
	box.setAttribute("tabindex", "0");
	box.setAttribute("role", "button");
	box.setAttribute("aria-pressed", "true");
	box.setAttribute("aria-label", `show ${series.name}`);
	const turn = () => {
		const isHidden = !series.isHidden;
		box.setAttribute("aria-pressed", String(!isHidden));
		for (const one of all.filter((other) => other.name === series.name)) {
			one.isHidden = isHidden;
			one.group.classList.toggle("is-hidden", isHidden);
		}
	};
	box.classList.add("chart-key");
	box.addEventListener("click", turn);
	box.addEventListener("keydown", (event) => {
		if (event.key !== "Enter" && event.key !== " ") return;
		event.preventDefault();
		turn();
	});
}

function chartPlace(svg, event) {
	const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
	return { x: at.x, y: at.y };
}

// How near the pointer must be, in the drawing's units.
const chartReach = 30;

// The nearest point of what is shown; null where none is near.
function nearestPoint(all, place) {
	let nearest = null, least = chartReach ** 2;
	for (const series of all)
		for (const point of series.isHidden ? [] : series.points) {
			const distance = (point.x - place.x) ** 2 + (point.y - place.y) ** 2;
			if (distance >= least) continue;
			least = distance;
			nearest = { series, point };
		}
	return nearest;
}

function pointText({ series, point }, panels) {
	const numbers = numbersAt(point, panels);
	return numbers ? `${series.name}: ${numbers[1].toPrecision(3)} at ${numbers[0].toPrecision(3)}` : series.name;
}

function makePointing(svg, all, panels, tip) {
	const mark = document.createElementNS(svgSpace, "circle");
	mark.setAttribute("r", "7");
	mark.setAttribute("class", "chart-mark");
	svg.append(mark);
	const show = (event) => {
		const found = nearestPoint(all, chartPlace(svg, event));
		mark.style.display = found ? "" : "none";
		tip.hidden = !found;
		tip.textContent = found ? pointText(found, panels) : "";
		if (!found) return;
		mark.setAttribute("cx", found.point.x);
		mark.setAttribute("cy", found.point.y);
	};
	mark.style.display = "none";
	svg.addEventListener("pointermove", show);
	svg.addEventListener("pointerleave", () => {
		tip.hidden = true;
		mark.style.display = "none";
	});
}

// A double click, + and - come closer and go away, 0 shows the whole.
function makeZoom(svg) {
	const whole = svg.getAttribute("viewBox").split(/\s+/).map(Number);
	let view = whole;
	const zoom = (factor, at) => {
		const size = [Math.min(whole[2], view[2] * factor), Math.min(whole[3], view[3] * factor)];
		const corner = [0, 1].map((axis) => {
			const place = at[axis] - (at[axis] - view[axis]) * (size[axis] / view[axis + 2]);
			return Math.max(whole[axis], Math.min(place, whole[axis] + whole[axis + 2] - size[axis]));
		});
		view = [...corner, ...size];
		svg.setAttribute("viewBox", view.join(" "));
	};
	const middle = () => [view[0] + view[2] / 2, view[1] + view[3] / 2];
	svg.setAttribute("tabindex", "0");
	svg.addEventListener("dblclick", (event) => {
		const { x, y } = chartPlace(svg, event);
		zoom(event.shiftKey ? 2 : 0.5, [x, y]);
	});
	svg.addEventListener("keydown", (event) => {
		const factor = { "+": 0.5, "-": 2, 0: Infinity }[event.key];
		if (factor) zoom(factor, middle());
	});
}

async function chartElement(name, title) {
	const svg = chartDrawing(await fileText(name + ".svg"), title), panels = parseAxes(await fileText(name + ".axes"));
	const all = chartSeries(svg, panels), tip = element("output", { className: "chart-tip", hidden: true });
	all.forEach((series) => makeKey(series, all));
	makePointing(svg, all, panels, tip);
	makeZoom(svg);
	return element("div", { className: "chart" }, svg, tip);
}
