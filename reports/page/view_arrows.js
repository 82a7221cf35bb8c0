// Gravity and force as arrows that a person can turn, beside the body: as long as they are strong. They are drawn over the
// picture, and only when something about them changes: they cost a frame nothing.

// What an arrow as long as the body is large stands for: m/s², and weights of a particle.
const arrowUnits = { gravity: 20, force: 2 };
const arrowColors = { gravity: "#335577", force: "#aa4400" };
const arrowSpace = "http://www.w3.org/2000/svg";

class ForceArrow {
	//   unit  what an arrow of length 1 stands for;  length  of that arrow, m
	constructor(key, unit, length) {
		Object.assign(this, { key, unit, length, value: [0, 0, 0], foot: new THREE.Vector3(), tip: new THREE.Vector3() });
	}

	place(foot) {
		this.foot.copy(foot);
	}

	show(value) {
		this.value = value;
		const vector = new THREE.Vector3(...value), strength = vector.length();
		// no force at all is a stub, from which one can be pulled
		const long = Math.min(1.5, Math.max(0.08, strength / this.unit)) * this.length;
		const way = strength > 0 ? vector.divideScalar(strength) : new THREE.Vector3(1, 0, 0);
		this.tip.copy(this.foot).addScaledVector(way, long);
	}

	// The value of an arrow whose tip is there; near its foot there is none.
	valueAt(place) {
		const vector = new THREE.Vector3(...place).sub(this.foot).divideScalar(this.length);
		return (vector.length() < 0.1 ? [0, 0, 0] : vector.toArray()).map((value) => Number((value * this.unit).toPrecision(3)));
	}
}

// Where a point is in a view's box of the canvas, pixels.
function placeInBox(point, camera, box) {
	const at = point.clone().project(camera);
	return { x: (at.x + 1) / 2 * box.width + box.x, y: (1 - at.y) / 2 * box.height + box.top, depth: at.z };
}

// An arrow whose tip is within reach of a place of the canvas: {arrow, box, depth}; null: none.
function pickArrow(arrows, camera, box, px, py) {
	for (const arrow of arrows) {
		const { x, y, depth } = placeInBox(arrow.tip, camera, box);
		if (Math.hypot(x - px, y - py) < 14) return { arrow, box, depth };
	}
	return null;
}

function arrowPath(foot, tip) {
	const angle = Math.atan2(tip.y - foot.y, tip.x - foot.x);
	const barb = (turn) => `${tip.x - 10 * Math.cos(angle + turn)} ${tip.y - 10 * Math.sin(angle + turn)}`;
	return `M${foot.x} ${foot.y}L${tip.x} ${tip.y}M${barb(0.45)}L${tip.x} ${tip.y}L${barb(-0.45)}`;
}

// All arrows in all views, as paths of an svg over the canvas.
function drawArrows(svg, arrows, camera, boxes) {
	const paths = boxes.flatMap((box) => {
		camera.aspect = box.width / box.height;
		camera.updateProjectionMatrix();
		return arrows.map((arrow) => ({ key: arrow.key, d: arrowPath(placeInBox(arrow.foot, camera, box), placeInBox(arrow.tip, camera, box)) }));
	});
	const key = paths.map(({ d }) => d).join();
	if (svg.dataset.key === key) return;
	svg.dataset.key = key;
	svg.replaceChildren(...paths.map(({ key, d }) => {
		const path = document.createElementNS(arrowSpace, "path");
		path.setAttribute("d", d);
		path.setAttribute("stroke", arrowColors[key]);
		return path;
	}));
}
