// Sorts and filters the table of results, and highlights a detector in figures and tables.
"use strict";

// Figures know a detector by its colour, which the legend names.
const legend = [...document.querySelectorAll(".who button")];
const colours = new Map(legend.map((button) => [button.textContent, button.dataset.colour]));
let chosen = null;

function highlight(name) {
  chosen = name === chosen ? null : name;
  for (const button of legend) button.ariaPressed = String(button.textContent === chosen);
  for (const shape of document.querySelectorAll("figure svg *")) {
    const own = [shape.getAttribute("fill"), shape.getAttribute("stroke")];
    const others = [...colours].some(([other, colour]) => other !== chosen && own.includes(colour));
    shape.classList.toggle("faded", chosen !== null && others && !own.includes(colours.get(chosen)));
  }
  for (const row of document.querySelectorAll("tbody tr")) {
    const names = [...row.cells].map((cell) => cell.textContent);
    row.classList.toggle("chosen", names.includes(chosen));
  }
}

document.addEventListener("click", ({ target }) => {
  const name = target.closest("td, text, .who button")?.textContent.trim();
  if (colours.has(name)) highlight(name);
});

// The address of the page keeps the order and the words of the filter.
for (const table of document.querySelectorAll("table.results")) {
  const rows = [...table.tBodies[0].rows];
  const heads = [...table.tHead.rows[0].cells];
  const state = new URLSearchParams(location.hash.slice(1));
  const input = Object.assign(document.createElement("input"), { type: "search", id: "words", placeholder: "only rows with …" });
  const count = Object.assign(document.createElement("output"), { id: "count" });

  // A long table opens on the scene with the most rows.
  if (rows.length > 1000 && state.size === 0) {
    const sizes = new Map();
    for (const { cells: [scene] } of rows) sizes.set(scene.textContent, (sizes.get(scene.textContent) ?? 0) + 1);
    state.set("words", [...sizes].reduce((most, it) => (it[1] > most[1] ? it : most))[0]);
  }

  /** Returns a number for a text that is one, so that numbers are sorted by size; else NaN. */
  const number = (text) => (text === "" ? NaN : Number(text));

  /** Orders two texts; missing values (dashes) are last in both orders. */
  function compare(a, b, sign) {
    const [x, y] = [number(a), number(b)];
    if (Number.isNaN(x) !== Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
    return sign * (Number.isNaN(x) ? a.localeCompare(b, "en", { numeric: true }) : x - y);
  }

  function show() {
    const words = (state.get("words") ?? "").toLowerCase().split(/\s+/);
    const k = heads.findIndex((head) => head.textContent === state.get("sort"));
    const shown = rows.filter((row) => words.every((word) => row.textContent.toLowerCase().includes(word)));
    const sign = state.has("down") ? -1 : 1;
    if (k >= 0) shown.sort((a, b) => compare(a.cells[k].textContent, b.cells[k].textContent, sign));
    heads.forEach((head, j) => { head.ariaSort = j !== k ? "none" : sign > 0 ? "ascending" : "descending"; });
    table.tBodies[0].replaceChildren(...shown);
    count.textContent = ` ${shown.length} of ${rows.length} rows`;
  }

  /** Changes the order or the filter, and the address. */
  function set(entries) {
    for (const [name, value] of Object.entries(entries)) {
      if (value) state.set(name, value);
      else state.delete(name);
    }
    history.replaceState(null, "", `#${state}`);
    show();
  }

  for (const head of heads) {
    const button = document.createElement("button");
    button.append(...head.childNodes);
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const again = state.get("sort") === head.textContent && !state.has("down");
      set({ sort: head.textContent, down: again && "yes" });
    });
  }
  input.value = state.get("words") ?? "";
  input.addEventListener("input", () => set({ words: input.value }));
  table.parentElement.before(input, count);
  show();
}
