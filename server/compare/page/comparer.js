"use strict";
// For the scripts behind this one, too.
function element(name, attributes = {}, ...children) {
	const e = document.createElement(name);
	for (const [key, value] of Object.entries(attributes))
		e.setAttribute(key, value);
	e.append(...children);
	return e;
}

// Before each strip of pictures stands one place that compares two of them, or their maps: a slider between both, and a button that
// flips from one to the other.
(() => {
	const KINDS = [["picture", "p", "picture"], ["error", "e", "relative error"], ["flip", "f", "FLIP"]];
	let count = 0;

	function choice(shots, chosen, label) {
		const select = element("select", {"aria-label": label});
		shots.forEach((shot, i) => select.append(element("option", {value: i}, shot.title)));
		select.value = chosen;
		return select;
	}

	function build(strip) {
		const shots = [...strip.querySelectorAll(".shot")].map((e) => ({
			number: e.dataset.shot, title: e.dataset.title, maps: e.dataset.maps === "1", style: e.getAttribute("style"),
		}));
		if (shots.length < 2)
			return;
		const id = `comparer${count++}`;
		const left = choice(shots, 0, "picture on the left"), right = choice(shots, shots.length - 1, "picture on the right");
		const kinds = element("fieldset", {}, element("legend", {}, "show"));
		for (const [value, , label] of KINDS) {
			const radio = element("input", {type: "radio", name: id, value});
			radio.checked = value === "picture";
			kinds.append(element("label", {}, radio, label));
		}
		const flip = element("button", {type: "button", "aria-pressed": "false"}, "flip");
		const run = element("input", {type: "checkbox"});
		const slider = element("input", {type: "range", min: 0, max: 100, step: .5, value: 50, "aria-label": "how much of the left picture"});
		const under = element("div", {role: "img"}), over = element("div", {role: "img"});
		const names = [element("span", {class: "name"}), element("span", {class: "name"})];
		const stage = element("div", {class: "stage", style: shots[0].style}, under, over, element("div", {class: "bar"}), ...names);
		const controls = element("div", {class: "controls"}, element("label", {}, "left ", left), element("label", {}, "right ", right), kinds,
			flip, element("label", {}, run, "alternate"));
		const comparer = element("div", {class: "comparer"}, controls, stage, slider);
		let kind = KINDS[0], flipping = false, timer = 0;

		function update() {
			const pair = [shots[left.value], shots[right.value]];
			[over, under].forEach((layer, i) => {
				const letter = pair[i].maps ? kind[1] : "p";
				layer.className = `pic ${letter}${pair[i].number}`;
				layer.setAttribute("aria-label", `${pair[i].title}, ${pair[i].maps ? kind[2] : "picture"}`);
				names[i].textContent = pair[i].title;
			});
			const pressed = flip.getAttribute("aria-pressed") === "true";
			comparer.classList.toggle("flips", flipping);
			names[0].classList.toggle("away", flipping && pressed);
			names[1].classList.toggle("away", flipping && !pressed);
			stage.style.setProperty("--at", flipping ? (pressed ? "0%" : "100%") : `${slider.value}%`);
			strip.className = `strip shows-${kind[0]}`;
		}
		function turn() {
			flipping = true;
			flip.setAttribute("aria-pressed", flip.getAttribute("aria-pressed") === "true" ? "false" : "true");
			update();
		}
		function slide() {
			flipping = run.checked = false;
			clearInterval(timer);
			flip.setAttribute("aria-pressed", "false");
			update();
		}
		function point(event) {
			const box = stage.getBoundingClientRect();
			slider.value = 100 * (event.clientX - box.left) / box.width;
			slide();
		}
		left.addEventListener("change", update);
		right.addEventListener("change", update);
		slider.addEventListener("input", slide);
		flip.addEventListener("click", turn);
		run.addEventListener("change", () => {
			clearInterval(timer);
			if (run.checked)
				timer = setInterval(turn, 700);
		});
		kinds.addEventListener("change", (event) => {
			kind = KINDS.find(([value]) => value === event.target.value);
			update();
		});
		stage.addEventListener("pointerdown", (event) => {
			stage.setPointerCapture(event.pointerId);
			point(event);
		});
		stage.addEventListener("pointermove", (event) => {
			if (event.buttons)
				point(event);
		});
		strip.before(comparer);
		update();
	}
	document.querySelectorAll("[data-strip]").forEach(build);
})();
