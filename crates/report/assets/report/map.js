// Maps: the row of a place is told below its map, on hover, press and focus.
"use strict";
for (const map of document.querySelectorAll("figure.map")) {
  const said = map.querySelector(".said");
  const tell = (event) => {
    const place = event.target.closest("td[data-row]");
    if (place) said.textContent = place.dataset.row;
  };
  for (const kind of ["pointerover", "focusin", "click"]) map.addEventListener(kind, tell);
}
