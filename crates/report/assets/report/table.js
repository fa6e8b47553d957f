// The table of all results: filters, sorting by any column, and the rows shown as CSV.
"use strict";

(() => {
  const FIRST = 100; // rows shown before somebody asks for all
  const per = (read) => (cell) => (read(cell) === null ? null : read(cell) / Math.max(cell.n, 1));
  const LABELS = { n: "N", dim: "dimension" };
  const keys = report.columns.filter((column) => column.key && values(report.cells, column.name).length > 1);
  const measured = [
    ["outcome", (c) => c.outcome],
    ["ns / N", per((c) => c.time_ns)],
    ["low", per((c) => c.time_low)],
    ["high", per((c) => c.time_high)],
    ["blocks", (c) => c.blocks],
    ["peak bytes / N", per((c) => c.peak_bytes)],
    ["bytes by formula / N", per((c) => c.formula_bytes)],
    ["contact tests / N", per((c) => c.contact_test)],
    ["operations / N", per((c) => c.operations)],
    ["contacts", (c) => c.contacts],
    ["missed", (c) => c.missed],
    ["spurious", (c) => c.spurious],
    ["wrong pairs / contact", (c) => c.error_rate],
    ["reason", (c) => c.reason || null],
  ].filter(([, read]) => report.cells.some((cell) => read(cell) !== null));
  const columns = [...keys.map((column) => [LABELS[column.name] ?? column.name.replaceAll("_", " "), (cell) => cell[column.name]]), ...measured]
    .map(([label, read]) => ({ label, read, number: report.cells.some((cell) => typeof read(cell) === "number") }));

  // On a phone the detector stays in view, and its time stands beside it.
  const narrow = matchMedia("(max-width: 46rem)");
  const first = (column) => ["detector", "ns / N", "N"].indexOf(column.label);
  const inView = () => (narrow.matches ? [...columns].sort((a, b) => (first(b) >= 0) - (first(a) >= 0) || first(a) - first(b)) : columns);
  narrow.addEventListener("change", () => show());

  const [filters, count, table, more] = ["filters", "count", "cells", "more"].map((id) => document.getElementById(id));
  const state = { sort: null, down: false, chosen: {}, words: "", all: false };

  /** Numbers by size, words by letters; what is missing comes last either way. */
  function compare(a, b) {
    const [x, y] = [state.sort.read(a), state.sort.read(b)];
    if (x === null || y === null) return (x === null) - (y === null);
    const order = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en");
    return state.down ? -order : order;
  }

  function chosen() {
    const words = state.words.toLowerCase().split(/\s+/).filter(Boolean);
    const text = (cell) => columns.filter((column) => !column.number).map(({ read }) => read(cell) ?? "").join(" ").toLowerCase();
    const fits = (cell) => Object.entries(state.chosen).every(([field, value]) => value === null || cell[field] === value)
      && (words.length === 0 || words.every((word) => text(cell).includes(word)));
    const cells = report.cells.filter(fits);
    return state.sort ? cells.sort(compare) : cells;
  }

  function show() {
    const [cells, order] = [chosen(), inView()];
    const heads = order.map((column) => {
      const sorted = column === state.sort;
      const button = element("button", { type: "button" }, column.label, sorted ? (state.down ? " ▼" : " ▲") : "");
      button.addEventListener("click", () => {
        state.down = sorted && !state.down;
        state.sort = column;
        show();
        table.tHead.querySelectorAll("button")[order.indexOf(column)].focus();
      });
      const sort = sorted ? (state.down ? "descending" : "ascending") : "none";
      return element("th", { scope: "col", className: column.number ? "number" : "", "aria-sort": sort }, button);
    });
    table.tHead.replaceChildren(element("tr", {}, ...heads));
    const entry = (cell) => ({ label, read, number }) => {
      const value = read(cell);
      const node = element("td", { className: number ? "number" : label === "reason" ? "reason" : "" });
      if (label === "detector") node.append(chip(value));
      node.append(typeof value === "number" ? short(value) : (value ?? "–"));
      return node;
    };
    const shown = state.all ? cells : cells.slice(0, FIRST);
    table.tBodies[0].replaceChildren(...shown.map((cell) => element("tr", {}, ...order.map(entry(cell)))));
    count.textContent = `${cells.length} of ${report.cells.length} rows${shown.length < cells.length ? `, the first ${shown.length} shown` : ""}`;
    const button = element("button", { type: "button" }, `Show all ${cells.length} rows`);
    button.addEventListener("click", () => { state.all = true; show(); });
    more.replaceChildren(...(shown.length < cells.length ? [button] : []));
  }

  /** All rows that pass the filters, in the order of the table, numbers in full. */
  function csv() {
    const quote = (value) => {
      const text = value === null ? "" : String(value);
      return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
    };
    const line = (fields) => `${fields.map(quote).join(",")}\n`;
    return line(columns.map((column) => column.label)) + chosen().map((cell) => line(columns.map(({ read }) => read(cell)))).join("");
  }

  function download() {
    const address = URL.createObjectURL(new Blob([csv()], { type: "text/csv;charset=utf-8" }));
    const link = element("a", { href: address, download: "results.csv" });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(address), 10000);
  }

  for (const field of ["experiment", "scene", "dim", "n", "detector", "arithmetic", "threads", "outcome"]) {
    const options = values(report.cells, field);
    if (options.length < 2) continue;
    const named = (value) => (field === "dim" ? `${value}D` : field === "n" ? short(value) : value);
    filters.append(choice(LABELS[field] ?? field, `only-${field}`, [[null, "all"], ...options.map((v) => [v, named(v)])], null, (value) => {
      state.chosen[field] = value;
      show();
    }));
  }
  const words = element("input", { id: "words", type: "search", placeholder: "e.g. nbs clustered" });
  words.addEventListener("input", () => { state.words = words.value; show(); });
  const save = element("button", { id: "csv", type: "button" }, "Download as CSV");
  save.addEventListener("click", download);
  filters.append(element("label", {}, "contains", words), save);
  show();
})();
