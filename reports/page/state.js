// What the page's address holds, so that a link shows the same: #scene=…&error=…&engines=…&metric=…&t=…

let state = new URLSearchParams(location.hash.slice(1));
const inputsOf = new Map();

function keepState(key, value) {
	if (value) state.set(key, value);
	else state.delete(key);
	history.replaceState(null, "", state.size ? `#${state}` : location.pathname + location.search);
}

// A value that the input does not offer leaves it as it was. True where it changed.
function setInput(input, value) {
	const before = input.value;
	if (value === null || value === before) return false;
	input.value = value;
	if (input.value === value) return true;
	input.value = before;
	return false;
}

// Inputs of one key go together: a change of one is a change of all, and of the address.
function bindState(key, input) {
	inputsOf.set(key, [...(inputsOf.get(key) || []), input]);
	setInput(input, state.get(key));
	input.addEventListener("change", () => {
		if (state.get(key) === input.value) return;
		// a time is of its scene
		if (key === "scene") state.delete("t");
		keepState(key, input.value);
		tellInputs(key, input.value);
	});
}

function tellInputs(key, value) {
	for (const input of inputsOf.get(key) || [])
		if (setInput(input, value)) input.dispatchEvent(new Event("change"));
}

addEventListener("hashchange", () => {
	state = new URLSearchParams(location.hash.slice(1));
	for (const [key, value] of state) tellInputs(key, value);
	if (state.has("scene") && document.activeElement?.matches("#summary a")) document.getElementById("scene").scrollIntoView();
});
