// Charts with one line per detector, drawn by uPlot from the data in the page.
"use strict";

/** The cells of the record as objects, words in place of their numbers. */
const report = JSON.parse(document.getElementById("data").textContent);
report.cells = report.rows.map((row) => {
  const cell = {};
  report.columns.forEach((column, k) => {
    cell[column.name] = column.text && row[k] !== null ? report.texts[row[k]] : row[k];
  });
  return cell;
});

/** An element with properties and children; text is only ever text. */
function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** A number as people read it, four digits. */
function short(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-3)) return value.toExponential(3).replace(/\.?0+e/, "e").replace("e+", "e");
  return size >= 1000 ? Math.round(value).toLocaleString("en") : value.toLocaleString("en", { maximumSignificantDigits: 4 });
}

/** The values of a field in cells, each once, numbers in order. */
function values(cells, field) {
  const found = [...new Set(cells.map((cell) => cell[field]))].filter((value) => value !== null);
  return found.every((value) => typeof value === "number") ? found.sort((a, b) => a - b) : found;
}

/** The picture of a detector beside its name; with the dashes of a line, its line, too. */
function chip(name, dash = null) {
  const k = report.detectors.findIndex((detector) => detector.name === name);
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "chip");
  svg.setAttribute("viewBox", "-7 -7 14 14");
  svg.setAttribute("aria-hidden", "true");
  svg.style.setProperty("--c", `var(--d${k})`);
  const draw = (attributes) => {
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    Object.entries(attributes).forEach(([key, value]) => path.setAttribute(key, value));
    svg.append(path);
  };
  if (dash) {
    svg.setAttribute("viewBox", "-17 -7 34 14");
    svg.classList.add("wide");
    draw({ class: "mark line bar", d: "M-17 0H17", "stroke-dasharray": dash.join(" ") });
  }
  draw({ class: report.detectors[k].filled ? "mark" : "mark line", d: report.detectors[k].mark, transform: "scale(4)" });
  return svg;
}

/** A labelled choice; calls back with the value chosen. */
function choice(label, name, options, chosen, changed) {
  const select = element("select", { id: name });
  options.forEach(([value, text], k) => select.append(element("option", { value: String(k), selected: value === chosen }, String(text))));
  select.addEventListener("change", () => changed(options[select.selectedIndex][0]));
  return element("label", {}, label, select);
}

(() => {
  const ALL = Symbol("all");
  // The time of a wrong answer means nothing, as in the figures.
  const right = (read) => (c) => (c.outcome === "wrong" ? null : read(c));
  const METRICS = {
    time: { label: "Time", unit: "ns", per: true, value: (c) => c.time_ns, low: (c) => c.time_low, high: (c) => c.time_high },
    memory: { label: "Memory (peak)", unit: "bytes", per: true, value: right((c) => c.peak_bytes) },
    operations: { label: "Operations (all)", unit: "operations", per: true, value: right((c) => c.operations) },
    tests: { label: "Contact tests", unit: "contact tests", per: true, value: right((c) => c.contact_test) },
    error: { label: "Error", unit: "wrong pairs per true contact", per: false, value: (c) => c.error_rate },
  };
  const NAMES = { n: "N", dim: "dimension", experiment: "experiment" };
  const [box, tip, controls, legend, note] = ["chart", "tip", "controls", "legend", "chart-note"].map((id) => document.getElementById(id));
  const state = { experiment: report.experiments[0]?.[0], fields: {}, x: null, metric: null, per: true, logX: true, logY: true };
  const hiddenNow = new Set(); // labels of lines that are switched off
  const met = new Set(); // labels seen before: controls begin switched off
  let chart = null;

  const metrics = (cells) => Object.entries(METRICS).filter(([, metric]) => cells.some((cell) => metric.value(cell) !== null));
  const varying = (cells, fields) => fields.filter((field) => values(cells, field).length > 1);
  const keys = report.columns.filter((column) => column.key).map((column) => column.name);

  /** What is taken of a field if nothing was chosen: the most telling value. */
  function first(field, options, cells) {
    if (field === "dim" || field === "n") return options.at(-1);
    for (const usual of ["shuffled", "packed"]) if (options.includes(usual)) return usual;
    if (field === "threads") return ALL;
    if (field !== "arithmetic") return options[0];
    const exact = new Set(cells.filter((cell) => cell.arithmetic === "exact").map((cell) => cell.detector));
    return cells.every((cell) => exact.has(cell.detector)) ? "exact" : ALL;
  }

  /** Makes the controls anew, each with the values that those before it leave; gives the cells that are left. */
  function choose() {
    let cells = report.cells.filter((cell) => cell.experiment === state.experiment);
    const made = [];
    if (report.experiments.length > 1) made.push(choice("experiment", "by-experiment", report.experiments, state.experiment, (v) => change({ experiment: v, fields: {}, x: null })));
    const narrow = (field) => {
      const options = values(cells, field);
      if (options.length < 2) return;
      const free = field === "arithmetic" || field === "threads";
      let chosen = state.fields[field];
      if (!(options.includes(chosen) || (free && chosen === ALL))) chosen = first(field, options, cells);
      const shown = options.map((value) => [value, field === "dim" ? `${value}D` : value]);
      if (free) shown.unshift([ALL, "all"]);
      made.push(choice(NAMES[field] ?? field.replaceAll("_", " "), `by-${field}`, shown, chosen, (value) => change({ fields: { ...state.fields, [field]: value } })));
      state.fields[field] = chosen;
      if (chosen !== ALL) cells = cells.filter((cell) => cell[field] === chosen);
    };
    narrow("scene");
    narrow("dim");
    const rest = keys.filter((key) => !["experiment", "scene", "dim", "detector"].includes(key));
    const numbers = varying(cells, rest.filter((key) => key !== "seed" && key !== "threads" && cells.every((c) => typeof c[key] === "number")));
    if (!numbers.includes(state.x)) state.x = numbers.includes("n") ? "n" : (numbers[0] ?? "n");
    if (numbers.length > 1) made.push(choice("against", "by-x", numbers.map((key) => [key, NAMES[key] ?? key]), state.x, (v) => change({ x: v })));
    rest.filter((key) => key !== state.x).forEach(narrow);
    const measured = metrics(cells);
    if (!measured.some(([name]) => name === state.metric)) state.metric = measured[0]?.[0] ?? "time";
    made.push(choice("value", "metric", measured.map(([name, metric]) => [name, metric.label]), state.metric, (v) => change({ metric: v })));
    const toggle = (id, text, key) => {
      const button = element("button", { id, type: "button", "aria-pressed": String(state[key]) }, text);
      button.addEventListener("click", () => change({ [key]: !state[key] }));
      return button;
    };
    if (METRICS[state.metric].per) made.push(toggle("per-particle", "per particle", "per"));
    made.push(toggle("log-x", "log x", "logX"), toggle("log-y", "log y", "logY"));
    const focus = document.activeElement?.id;
    controls.replaceChildren(...made);
    if (focus) controls.querySelector(`#${CSS.escape(focus)}`)?.focus();
    return cells;
  }

  /** The lines: one per detector, and per arithmetic or number of threads where all are shown. */
  function lines(cells) {
    const split = ["arithmetic", "threads"].filter((field) => state.fields[field] === ALL && values(cells, field).length > 1);
    const found = new Map();
    for (const cell of cells) {
      const variant = split.map((field) => (field === "threads" ? (cell.threads > 1 ? `${cell.threads} threads` : "") : cell[field])).filter(Boolean).join(", ");
      const label = variant ? `${cell.detector} (${variant})` : cell.detector;
      if (!found.has(label)) found.set(label, { label, detector: cell.detector, variant, at: new Map() });
      found.get(label).at.set(cell[state.x], cell);
    }
    const rank = new Map(report.detectors.map((detector, k) => [detector.name, k]));
    return [...found.values()].sort((a, b) => rank.get(a.detector) - rank.get(b.detector));
  }

  function change(what) {
    Object.assign(state, what);
    draw();
  }

  const known = (name) => report.detectors.find((detector) => detector.name === name);
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** Ticks of a logarithmic axis: of every power as few as give four in all, or three on a narrow screen. */
  function ticks(min, max) {
    const every = (step) => Array.from({ length: Math.round(9 / step) }, (_, k) => Number((1 + k * step).toFixed(1)));
    let found = [];
    for (const steps of [[1], [1, 3], [1, 2, 5], every(1), every(0.5), every(0.1)]) {
      found = [];
      for (let power = Math.floor(Math.log10(min)); power <= Math.ceil(Math.log10(max)); power++) {
        found.push(...steps.map((step) => Number(`${step}e${power}`)).filter((tick) => tick >= min * 0.999 && tick <= max * 1.001));
      }
      if (found.length >= (box.clientWidth < 500 ? 3 : 4)) break;
    }
    return found;
  }

  function draw() {
    const cells = choose();
    const metric = METRICS[state.metric];
    const scale = (cell) => (metric.per && state.per ? 1 / Math.max(cell.n, 1) : 1);
    const scaled = (cell, read) => (cell && read && read(cell) !== null ? read(cell) * scale(cell) : null);
    const all = lines(cells).filter((line) => [...line.at.values()].some((cell) => metric.value(cell) !== null));
    for (const line of all.filter(({ label }) => !met.has(label))) {
      met.add(line.label);
      if (known(line.detector).control) hiddenNow.add(line.label);
    }
    const xs = values(all.flatMap((line) => [...line.at.values()]), state.x);
    const logX = state.logX && xs[0] > 0;
    let hidden = 0;
    const column = (line, read) => xs.map((x) => {
      const value = scaled(line.at.get(x), read);
      if (value === null || !state.logY || value > 0) return value;
      hidden += 1;
      return null;
    });
    const data = [xs, ...all.map((line) => column(line, metric.value))];
    const bars = all.map((line) => (metric.low ? xs.map((x) => [scaled(line.at.get(x), metric.low), scaled(line.at.get(x), metric.high)]) : null));
    const [ink, faint, grid] = ["--ink", "--faint", "--line"].map(css);
    const colours = all.map((line) => css(`--d${report.detectors.findIndex((d) => d.name === line.detector)}`));
    const variants = [...new Set(all.map((line) => line.variant))];

    /** The ends of an axis, and room beyond them. */
    const range = (log) => (u, min, max) => {
      if (min === null || max === null) return log ? [1, 10] : [0, 1];
      if (log) return [min / 1.3, max * 1.3];
      return [Math.min(0, min), max > 0 ? max * 1.06 : 1];
    };
    const axis = (log, label) => ({
      stroke: ink, label, labelGap: 2, font: "13px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif",
      grid: { stroke: grid, width: 1 }, ticks: { stroke: faint, width: 1 },
      values: (u, splits) => splits.map(short),
      ...(log && { splits: (u, k, min, max) => ticks(min, max), filter: (u, splits) => splits }),
    });
    const unit = metric.per && state.per ? `${metric.unit} per particle` : metric.unit;
    const place = (u) => ({ width: Math.max(box.clientWidth, 240), height: Math.round(Math.min(Math.max(box.clientWidth * 0.5, 300), 520)) });

    /** Markers, and the interval of each value. */
    function marks(u, k) {
      const line = all[k - 1];
      if (!u.series[k].show) return;
      const { ctx } = u;
      const mark = known(line.detector);
      const [shape, size] = [new Path2D(mark.mark), 4 * devicePixelRatio];
      ctx.save();
      ctx.beginPath();
      ctx.rect(u.bbox.left - size * 2, u.bbox.top - size * 2, u.bbox.width + size * 4, u.bbox.height + size * 4);
      ctx.clip();
      ctx.strokeStyle = ctx.fillStyle = colours[k - 1];
      data[k].forEach((value, i) => {
        if (value === null) return;
        const [x, y] = [u.valToPos(xs[i], "x", true), u.valToPos(value, "y", true)];
        const [low, high] = bars[k - 1]?.[i] ?? [null, null];
        if (low !== null && (low > 0 || !state.logY)) {
          ctx.lineWidth = 1.5 * devicePixelRatio;
          ctx.beginPath();
          ctx.moveTo(x, u.valToPos(low, "y", true));
          ctx.lineTo(x, u.valToPos(high, "y", true));
          ctx.stroke();
        }
        ctx.save();
        ctx.translate(x, y);
        ctx.scale(size, size);
        ctx.lineWidth = 0.55;
        if (mark.filled) ctx.fill(shape);
        else ctx.stroke(shape);
        ctx.restore();
      });
      ctx.restore();
    }

    /** The values at the cursor, largest first, the nearest line in bold. */
    function hover(u) {
      const i = u.cursor.idx;
      if (i === null || i === undefined || u.cursor.left < 0) {
        tip.hidden = true;
        return;
      }
      const shown = all.map((line, k) => ({ line, k: k + 1, value: data[k + 1][i], bar: bars[k]?.[i] })).filter((s) => s.value !== null && u.series[s.k].show);
      shown.sort((a, b) => b.value - a.value);
      const away = (s) => Math.abs(u.valToPos(s.value, "y") - u.cursor.top);
      const near = shown.reduce((best, s) => (best && away(best) <= away(s) ? best : s), null);
      const row = (s) => element("tr", { className: s === near ? "near" : "" }, element("td", {}, chip(s.line.detector), s.line.label),
        element("td", { className: "number" }, short(s.value)), element("td", {}, s.bar && s.bar[0] !== null ? `${short(s.bar[0])} to ${short(s.bar[1])}` : ""));
      tip.replaceChildren(element("div", {}, `${NAMES[state.x] ?? state.x} = ${short(xs[i])}, ${unit}`), element("table", {}, element("tbody", {}, ...shown.map(row))));
      tip.hidden = shown.length === 0;
      const over = u.over.getBoundingClientRect();
      const left = over.left + u.valToPos(xs[i], "x") + 14;
      const width = tip.offsetWidth;
      const fits = left + width < document.documentElement.clientWidth - 4 ? left : Math.max(4, left - width - 28);
      tip.style.left = `${fits + scrollX}px`;
      tip.style.top = `${over.top + scrollY + 8}px`;
    }

    const dash = (line) => {
      if (known(line.detector).control) return [5, 4];
      return [[], [8, 4], [3, 4], [12, 3, 3, 3], [2, 2], [6, 6]][Math.max(variants.indexOf(line.variant), 0) % 6];
    };
    const series = all.map((line, k) => ({
      label: line.label, stroke: colours[k], width: 2, dash: dash(line), spanGaps: true, points: { show: false }, show: !hiddenNow.has(line.label),
    }));
    chart?.destroy();
    tip.hidden = true;
    chart = new uPlot({
      ...place(), series: [{}, ...series], legend: { show: false }, cursor: { drag: { x: false, y: false }, y: false, points: { show: false } },
      scales: { x: { time: false, distr: logX ? 3 : 1, range: range(logX) }, y: { distr: state.logY ? 3 : 1, range: range(state.logY) } },
      axes: [axis(logX, NAMES[state.x] ?? state.x.replaceAll("_", " ")), { ...axis(state.logY, unit), size: 66 }],
      hooks: { drawSeries: [marks], setCursor: [hover] },
    }, data, box);
    box.chart = chart;
    box.resize = () => chart.setSize(place());

    const without = lines(cells).map((line) => line.label).filter((label) => !all.some((line) => line.label === label));
    note.textContent = [
      metric.low ? "Bars are intervals of the median." : "",
      hidden > 0 ? `${hidden} value${hidden > 1 ? "s" : ""} of 0 cannot be shown on a logarithmic axis: press “log y”.` : "",
      without.length > 0 ? `Without a value here: ${without.join(", ")}.` : "",
    ].filter(Boolean).join(" ");

    legend.replaceChildren(...all.map((line, k) => {
      const button = element("button", { type: "button", "aria-pressed": String(!hiddenNow.has(line.label)) }, chip(line.detector, dash(line)), line.label);
      button.addEventListener("click", () => {
        const show = hiddenNow.delete(line.label);
        if (!show) hiddenNow.add(line.label);
        button.setAttribute("aria-pressed", String(show));
        chart.setSeries(k + 1, { show });
      });
      return button;
    }));
  }

  // A page that was moved from its folder still has the figures; pixels are made here.
  for (const figure of document.querySelectorAll("figure")) {
    const [image, link] = [figure.querySelector("img"), figure.querySelector("a[download]")];
    if (!image || !link) continue;
    link.href = image.src;
    const png = element("a", { href: "#", download: link.download.replace(/svg$/, "png"), "data-kind": "PNG" }, "PNG");
    png.addEventListener("click", (event) => {
      event.preventDefault();
      if (!image.naturalWidth) return;
      const canvas = element("canvas", { width: 2 * image.naturalWidth, height: 2 * image.naturalHeight });
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      element("a", { href: canvas.toDataURL("image/png"), download: png.download }).click();
    });
    link.after(" ", png);
  }
  box.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step || !chart) return;
    event.preventDefault();
    const xs = chart.data[0];
    const i = Math.min(Math.max((chart.cursor.idx ?? (step > 0 ? -1 : xs.length)) + step, 0), xs.length - 1);
    chart.setCursor({ left: chart.valToPos(xs[i], "x"), top: 10 });
  });
  box.addEventListener("blur", () => { tip.hidden = true; });
  new ResizeObserver(() => box.resize?.()).observe(document.body);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  if (report.cells.length > 0) draw();
})();
