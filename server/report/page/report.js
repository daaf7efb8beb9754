"use strict";
// The plots of a report, by Chart.js if the page has it. Every figure of them is in the page's tables too.
(() => {
	if (typeof Chart === "undefined")
		return;
	const data = JSON.parse(document.getElementById("data").textContent);
	const dark = matchMedia("(prefers-color-scheme: dark)"), narrow = matchMedia("(max-width: 40rem)");
	// Okabe and Ito's colours, which colour-blind people tell apart; on dark paper lighter ones. Shapes and dashes say it once more.
	const COLOURS = {light: ["#0072b2", "#d55e00", "#007a5a", "#a8457f", "#8a6d00", "#2f7fb5"],
		dark: ["#5ab4f0", "#ff9a4d", "#3fd0a4", "#f0a3d0", "#f0e442", "#9ad0f5"]};
	const SHAPES = ["circle", "rect", "triangle", "rectRot", "crossRot", "star"];
	const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 5], [1, 4]];
	const METRICS = {
		relmse: {label: "relMSE", low: "relmse_low", high: "relmse_high", slope: -1, floor: true},
		rmse: {label: "RMSE", slope: -.5},
		mean_difference: {label: "signed mean, without its sign", value: (p) => Math.abs(p.mean_difference)},
		flip: {label: "FLIP"},
		efficiency: {label: "efficiency, 1/(relMSE·s)", low: "efficiency_low", high: "efficiency_high", slope: 0},
	};
	const charts = [];
	let printing = false;

	function css(name) {
		return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
	}
	function colour(i) {
		return COLOURS[dark.matches && !printing ? "dark" : "light"][i % 6];
	}
	function faded(hex, alpha) {
		return hex + Math.round(255 * alpha).toString(16).padStart(2, "0");
	}
	function seconds(s) {
		return s < .0095 ? `${+(1000 * s).toPrecision(2)} ms` : s < .9995 ? `${Math.round(1000 * s)} ms` : `${+s.toPrecision(2)} s`;
	}
	function figure(x) {
		if (x === null || x === undefined || !isFinite(x))
			return "unknown";
		if (x === 0 || (Math.abs(x) >= .000995 && Math.abs(x) < 1e5))
			return Math.abs(x) < 99.5 && x !== 0 ? x.toPrecision(2) : String(+x.toPrecision(2));
		const [digits, exponent] = x.toExponential(1).split("e");
		return `${digits}·10${[...String(+exponent)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] || "⁻").join("")}`;
	}
	function power(x) {
		const exponent = Math.round(Math.log10(x));
		return exponent >= -3 && exponent <= 4 ? String(+x.toPrecision(3)) : figure(x).replace(/^1\.0·/, "");
	}
	function settings(p) {
		const keys = Object.keys(p.settings).sort((a, b) => (b === "samples") - (a === "samples"));
		return keys.map((k) => `${k} ${p.settings[k]}`).join(", ") + (p.effects && p.effects !== "auto" ? `, effects ${p.effects}` : "");
	}
	// A logarithmic axis: its decades are told, and where there are few of them also twos and fives.
	function axis(title, values, text) {
		const known = values.filter((v) => v > 0 && isFinite(v));
		const min = Math.min(...known) / 1.35, max = Math.max(...known) * 1.35, few = Math.log10(max / min) < (narrow.matches ? 1.2 : 2.5);
		return {type: "logarithmic", min, max, title: {display: true, text: title, color: css("--soft"), font: {size: 13}}, border: {color: css("--line")},
			grid: {color: (context) => /^1(\.0+)?e/.test(context.tick.value.toExponential()) ? css("--line") : faded(css("--line"), .35)},
			ticks: {color: css("--soft"), autoSkip: false, maxRotation: 0, font: {size: narrow.matches ? 10 : 12}, callback: (value) => {
				const digit = +value.toExponential()[0], whole = /^[125]e/.test((+value.toPrecision(3)).toExponential());
				return whole && (digit === 1 || (few && !(narrow.matches && digit === 5))) ? text(value) : "";
			}}};
	}
	// Vertical bars from low to high at points that have `bar`, and texts at lines that have `level`.
	const marks = {id: "marks", afterDatasetsDraw(chart) {
		const {ctx, chartArea: area, scales: {x, y}} = chart;
		ctx.save();
		ctx.beginPath();
		ctx.rect(area.left, area.top, area.width, area.height);
		ctx.clip();
		const taken = [];
		chart.data.datasets.forEach((set, i) => {
			if (!chart.isDatasetVisible(i))
				return;
			ctx.strokeStyle = set.borderColor;
			ctx.lineWidth = 1;
			for (const p of set.data.filter((d) => d.bar)) {
				ctx.beginPath();
				ctx.moveTo(x.getPixelForValue(p.x), y.getPixelForValue(p.bar[0]));
				ctx.lineTo(x.getPixelForValue(p.x), y.getPixelForValue(p.bar[1]));
				ctx.stroke();
			}
			if (set.level) {
				let at = y.getPixelForValue(set.data[0].y) - 5;
				while (taken.some((other) => Math.abs(other - at) < 15))
					at += at < area.top + area.height / 2 ? 15 : -15;
				taken.push(at);
				ctx.font = `12px ${getComputedStyle(document.body).fontFamily}`;
				ctx.textAlign = "right";
				ctx.lineWidth = 3;
				ctx.strokeStyle = css("--paper");
				ctx.strokeText(set.level, area.right - 8, at);
				ctx.fillStyle = set.borderColor;
				ctx.fillText(set.level, area.right - 8, at);
			}
		});
		ctx.restore();
	}};
	// Draw into a box, anew whenever the colours change. `configuration()` is Chart.js's.
	function draw(box, configuration, label, low) {
		const canvas = element("canvas", {role: "img", "aria-label": label});
		box.append(element("div", {class: low ? "canvas low" : "canvas"}, canvas));
		const kept = {make() {
			if (kept.chart)
				kept.chart.destroy();
			const c = configuration();
			c.options = {responsive: true, maintainAspectRatio: false, animation: false, devicePixelRatio: printing ? 3 : Math.max(devicePixelRatio, 2), ...c.options};
			kept.chart = new Chart(canvas, c);
		}};
		kept.make();
		charts.push(kept);
		return kept;
	}
	function legend(position = "top") {
		return {position, labels: {color: css("--ink"), usePointStyle: true, boxHeight: 7, padding: 14, font: {size: 13},
			filter: (item, chart) => !chart.datasets[item.datasetIndex].hides}};
	}

	// ---- error against time ----

	// The points of a technique that nothing of its own beats: its curve.
	function front(points, value) {
		let best = Infinity;
		return points.filter((p) => value(p) < best && ((best = value(p)), true));
	}
	function errors(box) {
		const views = data.views.map((v) => v.name);
		const metric = element("select", {"aria-label": "figure"});
		for (const [key, m] of Object.entries(METRICS))
			metric.append(element("option", {value: key}, m.label));
		const view = element("select", {"aria-label": "view"});
		views.forEach((name, i) => view.append(element("option", {value: i}, name)));
		const bands = element("input", {type: "checkbox"});
		bands.checked = true;
		const controls = element("div", {class: "controls"}, element("label", {}, "figure ", metric));
		if (views.length > 1)
			controls.append(element("label", {}, "view ", view));
		controls.append(element("label", {}, bands, "95 % bands"));
		const chosen = element("p", {class: "chosen soft", "aria-live": "polite"});
		box.append(controls);
		let shown = [];

		function configuration() {
			const m = METRICS[metric.value], value = m.value || ((p) => p[metric.value]), sets = [];
			shown = [];
			data.techniques.forEach((t, i) => {
				const c = colour(i);
				const points = t.points.filter((p) => p.view === +view.value && p.seconds > 0 && value(p) > 0).sort((a, b) => a.seconds - b.seconds);
				const curve = metric.value === "efficiency" ? points.filter((p) => front(points, (q) => q.relmse).includes(p)) : front(points, value);
				const at = (p, y) => ({x: p.seconds, y, point: p, technique: t.name});
				const banded = curve.filter((p) => p[m.low] > 0 && p[m.high] > 0);
				shown.push(...points.map((p) => at(p, value(p))));
				if (bands.checked && m.low && banded.some((p) => p[m.low] < p[m.high])) {
					sets.push({data: banded.map((p) => at(p, p[m.low])), hides: true, showLine: true, pointRadius: 0, pointHitRadius: 0, borderWidth: 0, fill: false});
					sets.push({data: banded.map((p) => at(p, p[m.high])), hides: true, showLine: true, pointRadius: 0, pointHitRadius: 0, borderWidth: 0,
						fill: "-1", backgroundColor: faded(c, .22)});
				}
				// A front point of the view is ringed with the ink.
				sets.push({label: t.name, data: curve.map((p) => at(p, value(p))), showLine: true, borderColor: c, borderWidth: 2, borderDash: DASHES[i % 6],
					backgroundColor: c, pointStyle: SHAPES[i % 6], pointRadius: curve.map((p) => p.pareto ? 7 : 5), pointHoverRadius: 9,
					pointBorderColor: curve.map((p) => p.pareto ? css("--ink") : c), pointBorderWidth: curve.map((p) => p.pareto ? 2 : 1)});
				sets.push({hides: true, data: points.filter((p) => !curve.includes(p)).map((p) => at(p, value(p))), borderColor: faded(c, .7),
					backgroundColor: faded(c, .25), pointStyle: SHAPES[i % 6], pointRadius: 4, pointHoverRadius: 8});
				const floor = t.floors[+view.value];
				if (m.floor && floor > 0)
					sets.push({hides: true, level: `floor of ${t.name}: ${figure(floor)}`, showLine: true, pointRadius: 0, pointHitRadius: 0, borderColor: c, borderWidth: 1.3,
						borderDash: [3, 3], fill: false, data: [{x: 1e-9, y: floor}, {x: 1e9, y: floor}]});
			});
			const own = data.views[+view.value].reference?.relmse;
			const ys = shown.map((p) => p.y), xs = shown.map((p) => p.x);
			if (m.slope !== undefined && m.slope !== 0 && xs.length) {
				// Through the middle of the noisiest curve: what N times the time would do.
				const anchor = shown.filter((p) => data.techniques.some((t) => t.noise && t.name === p.technique)).pop() || shown[0];
				const line = [Math.min(...xs) / 2, Math.max(...xs) * 2].map((x) => ({x, y: .6 * anchor.y * (x / anchor.x) ** m.slope}));
				sets.push({label: `slope ${m.slope === -1 ? "−1" : "−½"}`, pointStyle: "line", data: line, showLine: true, pointRadius: 0, pointHitRadius: 0,
					borderColor: faded(css("--soft"), .8), borderWidth: 1.2, borderDash: [1, 4], fill: false});
			}
			if (m.floor && own > Math.min(...ys) / 4)
				sets.push({hides: true, level: `the reference's own: ${figure(own)}`, showLine: true, pointRadius: 0, pointHitRadius: 0, borderColor: css("--soft"),
					borderWidth: 1, data: [{x: 1e-9, y: own}, {x: 1e9, y: own}]});
			const floors = m.floor ? data.techniques.map((t) => t.floors[+view.value]) : [];
			return {type: "scatter", data: {datasets: sets}, plugins: [marks], options: {
				interaction: {mode: "nearest", intersect: false, axis: "xy"},
				scales: {x: axis("time of a warm request", xs.length ? xs : [1], seconds), y: axis(m.label, ys.length ? [...ys, ...floors] : [1], power)},
				plugins: {legend: legend(), tooltip: {filter: (item) => !!item.raw.point, displayColors: false, callbacks: {
					title: (items) => items.length ? `${items[0].raw.technique}, ${settings(items[0].raw.point)}` : "",
					label: ({raw: {point: p}}) => [`${seconds(p.seconds)}`, `relMSE ${figure(p.relmse)}${p.relmse_low < p.relmse_high ?
						` (${figure(p.relmse_low)} … ${figure(p.relmse_high)})` : ""}`, `FLIP ${figure(p.flip)}`, ...(p.pareto ? ["on the Pareto front"] : [])],
				}}},
				onHover: (event, items, chart) => tell(chart, items), onClick: (event, items, chart) => tell(chart, items),
			}};
		}
		function say() {
			chosen.textContent = shown.length ? "Point at a point, or tap it: its settings and the command that renders it again."
				: "There is nothing to draw: no point has a warm time and a figure above 0.";
		}
		function tell(chart, items) {
			const item = items.map((i) => chart.data.datasets[i.datasetIndex].data[i.index]).find((d) => d.point);
			if (item)
				chosen.replaceChildren(element("b", {}, `${item.technique}, ${settings(item.point)}`), ` ${seconds(item.point.seconds)}, relMSE ${figure(item.point.relmse)}`,
					item.point.command ? element("code", {class: "command"}, item.point.command) : "");
		}
		const kept = draw(box, configuration, "Error against time of every technique, both axes logarithmic; the table below has the figures");
		box.append(chosen);
		say();
		for (const e of [metric, view, bands])
			e.addEventListener("change", () => {
				kept.make();
				say();
			});
		box.append(element("p", {class: "soft"}, "Ringed: the Pareto front. Faint: settings that another of the same technique beats. Dotted: the slope of noise that falls as time grows."));
	}

	// ---- stages ----

	function stages(box) {
		const bars = [], copy = (list) => list.map((s) => ({...s}));
		for (const t of data.techniques) {
			const known = t.points.filter((p) => p.view === 0 && p.relmse > 0 && p.stages?.length);
			const best = known.sort((a, b) => a.relmse - b.relmse)[0] || t.points.find((p) => p.stages?.length);
			const cold = t.cold.find((p) => p.cold_stages?.length) || t.points.find((p) => p.cold_stages?.length);
			const first = t.cold.filter((p) => p.stages?.length).pop(); // the slowest
			if (best)
				bars.push({name: `${t.name}, ${settings(best)}`, what: "warm", stages: copy(best.stages)});
			if (cold)
				bars.push({name: `${t.name}, ${settings(cold)}`, what: "cold", stages: copy(cold.cold_stages)});
			if (first)
				bars.push({name: `${t.name}, ${settings(first)}`, what: "first of its settings", stages: copy(first.stages)});
		}
		const names = [...new Set(bars.flatMap((b) => b.stages.map((s) => s.name)))];
		const total = (name) => bars.reduce((sum, b) => sum + (b.stages.find((s) => s.name === name)?.seconds || 0) / b.stages.reduce((a, s) => a + s.seconds, 0), 0);
		names.sort((a, b) => total(b) - total(a));
		// As many as there are colours; the small rest is one.
		const small = names.splice(6);
		if (small.length) {
			names.push("the rest");
			bars.forEach((b) => b.stages.push({name: "the rest", seconds: b.stages.reduce((sum, s) => sum + (small.includes(s.name) ? s.seconds : 0), 0)}));
		}
		for (const what of ["warm", "cold", "first of its settings"]) {
			const some = bars.filter((b) => b.what === what);
			if (!some.length)
				continue;
			draw(box, () => ({type: "bar", data: {labels: some.map((b) => narrow.matches ? b.name.split(", ").slice(0, 2) : b.name),
				datasets: names.map((name, i) => ({label: name, backgroundColor: i < 6 ? faded(colour(i), .95) : faded(css("--soft"), .6), borderColor: css("--paper"), borderWidth: 1, maxBarThickness: 34,
					data: some.map((b) => b.stages.find((s) => s.name === name)?.seconds || 0)})).filter((set) => set.data.some((v) => v > 0))},
			options: {indexAxis: "y", scales: {
				x: {stacked: true, title: {display: true, text: `seconds, ${what}`, color: css("--soft"), font: {size: 13}}, ticks: {color: css("--soft"), maxTicksLimit: narrow.matches ? 5 : 10},
					grid: {color: css("--line")}},
				y: {stacked: true, ticks: {color: css("--ink"), font: {size: narrow.matches ? 10 : 12}}, grid: {display: false}}},
			plugins: {legend: legend("bottom"), tooltip: {callbacks: {label: (item) => `${item.dataset.label} ${seconds(item.raw)}`}}}}}),
			`Time by stage, ${what}; the table below has the figures`, true);
		}
	}

	// ---- predictions ----

	function predictions(box) {
		const runs = data.predictions?.runs || [];
		for (const [of, title, text] of [["relmse", "relMSE", power], ["seconds", "time", seconds]]) {
			const some = runs.filter((r) => r.of === of && r.predicted > 0 && r.true > 0);
			if (!some.length)
				continue;
			draw(box, () => {
				const sets = [], values = some.flatMap((r) => [r.predicted, r.true]);
				data.techniques.forEach((t, i) => {
					for (const quoted of [false, true]) {
						const of = some.filter((r) => r.technique === t.name && (r.from === "model" || r.from === "pilot") === quoted);
						if (of.length)
							sets.push({label: `${t.name}, ${quoted ? "quote" : "reply"}`, borderColor: colour(i), backgroundColor: quoted ? "transparent" : faded(colour(i), .5),
								pointStyle: SHAPES[i % 6], pointRadius: 4, data: of.map((r) => ({x: r.true, y: r.predicted, run: r,
									bar: r.low > 0 ? [r.low, r.high > 0 ? r.high : 1e9] : null}))});
					}
				});
				const ends = [Math.min(...values) / 4, Math.max(...values) * 4];
				sets.push({label: "said is true", pointStyle: "line", showLine: true, pointRadius: 0, pointHitRadius: 0, borderColor: css("--soft"), borderWidth: 1.2, borderDash: [4, 4],
					data: ends.map((v) => ({x: v, y: v}))});
				return {type: "scatter", data: {datasets: sets}, plugins: [marks], options: {
					scales: {x: axis(`true ${title}`, values, text), y: axis(`${title} that was said`, values, text)},
					plugins: {legend: legend(), tooltip: {filter: (item) => !!item.raw.run, displayColors: false, callbacks: {
						label: ({raw: {run: r}}) => [r.run, `said ${text === seconds ? seconds(r.predicted) : figure(r.predicted)}, true ${text === seconds ? seconds(r.true) : figure(r.true)}`],
					}}}}};
			}, `${title} that was said against the true one; the table below has the figures`);
		}
	}

	Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
	const kinds = {errors, stages, predictions};
	document.querySelectorAll("[data-chart]").forEach((box) => kinds[box.dataset.chart](box));
	const again = () => charts.forEach((kept) => kept.make());
	dark.addEventListener("change", again);
	narrow.addEventListener("change", again);
	const opened = [];
	addEventListener("beforeprint", () => {
		printing = true;
		document.querySelectorAll("details[data-print]:not([open])").forEach((d) => {
			d.open = true;
			opened.push(d);
		});
		again();
	});
	addEventListener("afterprint", () => {
		printing = false;
		opened.splice(0).forEach((d) => {
			d.open = false;
		});
		again();
	});
})();
