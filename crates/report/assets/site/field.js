// The table of all measurements: filters and sorting, kept in the address of the page.
"use strict";

(() => {
  const FILTERS = ["scene", "detector", "kind", "answer", "threads", "arithmetic", "machine"];
  const table = document.querySelector("table.field");
  const heads = [...table.tHead.rows[0].cells];
  const names = heads.map((head) => head.textContent.replace(/ \(.*/, ""));
  const titles = heads.map((head) => head.textContent);
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row) => ({ row, texts: [...row.cells].map((cell) => cell.textContent) }));
  const number = (text) => (/^-?[\d.]+(e[+-]?\d+)?$/.test(text) ? Number(text) : null);
  const [filters, count] = ["filters", "count"].map((id) => document.getElementById(id));
  const state = new URLSearchParams(location.hash.slice(1));

  function element(name, properties, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  }

  function set(name, value) {
    if (value) state.set(name, value);
    else state.delete(name);
    history.replaceState(null, "", `#${state}`);
    show();
  }

  /** The rows that pass all filters; a missing value comes last in either order. */
  function chosen() {
    const wanted = FILTERS.filter((name) => state.has(name)).map((name) => [names.indexOf(name), state.get(name)]);
    const words = (state.get("words") ?? "").toLowerCase().split(/\s+/).filter(Boolean);
    const found = rows.filter(({ texts }) => wanted.every(([k, value]) => texts[k] === value)
      && words.every((word) => texts.some((text) => text.toLowerCase().includes(word))));
    const k = names.indexOf(state.get("sort"));
    if (k < 0) return found;
    const sign = state.has("down") ? -1 : 1;
    return found.sort((a, b) => {
      const [x, y] = [a.texts[k], b.texts[k]];
      const [i, j] = [number(x), number(y)];
      if (i !== null && j !== null) return sign * (i - j);
      if (i !== null || j !== null) return i === null ? 1 : -1;
      return sign * x.localeCompare(y, "en");
    });
  }

  function show() {
    const found = chosen();
    body.replaceChildren(...found.map(({ row }) => row));
    count.textContent = `${found.length} of ${rows.length} rows`;
    heads.forEach((head, k) => {
      const sorted = state.get("sort") === names[k];
      head.setAttribute("aria-sort", sorted ? (state.has("down") ? "descending" : "ascending") : "none");
      head.firstChild.lastChild.textContent = sorted ? (state.has("down") ? " ▼" : " ▲") : "";
    });
  }

  function csv() {
    const quote = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const plain = (text) => (text === "–" ? "" : text.replace(/^wrong \((.*)\)$/, "$1"));
    const line = (texts) => `${texts.map((text) => quote(plain(text))).join(",")}\n`;
    return line(titles) + chosen().map(({ texts }) => line(texts)).join("");
  }

  heads.forEach((head, k) => {
    const button = element("button", { type: "button" }, head.textContent, element("span", {}));
    button.addEventListener("click", () => {
      const again = state.get("sort") === names[k];
      if (again && !state.has("down")) state.set("down", "1");
      else state.delete("down");
      set("sort", names[k]);
    });
    head.replaceChildren(button);
  });
  for (const name of FILTERS) {
    const k = names.indexOf(name);
    const values = [...new Set([...rows.map(({ texts }) => texts[k]), ...state.getAll(name)])];
    values.sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
    if (values.length < 2) continue;
    const options = ["", ...values].map((value) => element("option", { value, selected: state.get(name) === value }, value || "all"));
    const select = element("select", { id: `only-${name}` }, ...options);
    select.addEventListener("change", () => set(name, select.value));
    filters.append(element("label", {}, name, select));
  }
  const words = element("input", { id: "words", type: "search", value: state.get("words") ?? "" });
  words.addEventListener("input", () => set("words", words.value));
  const save = element("a", { id: "csv", href: "#", download: "contactbench.csv" }, "Download as CSV");
  save.addEventListener("click", () => {
    save.href = URL.createObjectURL(new Blob([csv()], { type: "text/csv;charset=utf-8" }));
  });
  filters.append(element("label", {}, "contains", words), save);
  const help = "Choose a filter, or sort by a column; the address of the page keeps your choice.";
  filters.before(element("p", { className: "note" }, help));
  window.addEventListener("hashchange", () => location.reload());
  show();
})();
