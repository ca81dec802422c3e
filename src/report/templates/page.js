"use strict";
// What happens is told to those who do not see it.
const tell = (text) => {
  const place = document.getElementById("told");
  if (place) place.textContent = text;
};

// Tables marked `sortable` sort by the column whose heading is pressed; numbers as numbers.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  if (body.rows.length < 2) continue;
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      const text = (row) => row.cells[column].textContent.trim();
      const order = (a, b) => text(a).localeCompare(text(b), "en", { numeric: true });
      body.append(...[...body.rows].sort(descending ? (a, b) => order(b, a) : order));
      tell(`sorted by ${heading.textContent}, ${descending ? "descending" : "ascending"}`);
    });
  });
}
