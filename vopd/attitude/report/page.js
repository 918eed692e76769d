"use strict";

// Sorting: a button in every column's heading; empty cells stay at the end.
function key(row, column, words) {
  const cell = row.cells[column];
  const text = cell.dataset.text ?? cell.textContent.trim();
  if (text === "") return null;
  return words ? text : Number(text);
}

function sort(table, heading) {
  const descending = heading.getAttribute("aria-sort") === "ascending";
  for (const other of heading.parentNode.cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
  const words = "words" in heading.dataset;
  const body = table.tBodies[0];
  const rows = Array.from(body.rows, (row) => [key(row, heading.cellIndex, words), row]);
  rows.sort(([one], [other]) => {
    if (one === null || other === null) return (one === null) - (other === null);
    const order = words ? (one < other ? -1 : one > other ? 1 : 0) : one - other;
    return descending ? -order : order;
  });
  body.append(...rows.map(([, row]) => row));
}

for (const table of document.querySelectorAll("table.sortable")) {
  for (const button of table.querySelectorAll("thead button")) {
    button.addEventListener("click", () => sort(table, button.parentNode));
  }
}

// Filtering the frames by flag and by number.
const frames = document.getElementById("frames-table");
const flag = document.getElementById("flag");
const number = document.getElementById("number");
const place = Array.from(frames.tHead.rows[0].cells).findIndex((cell) => cell.textContent === "frame");

function wanted(row) {
  const raised = row.dataset.flags.split(" ").filter(Boolean);
  const asked = number.value.trim();
  if (asked !== "" && row.cells[place].textContent.trim() !== asked) return false;
  if (flag.value === "") return true;
  if (flag.value === "*") return raised.length > 0;
  if (flag.value === "-") return raised.length === 0;
  return raised.includes(flag.value);
}

function filter() {
  let shown = 0;
  for (const row of frames.tBodies[0].rows) {
    row.hidden = !wanted(row);
    shown += !row.hidden;
  }
  document.getElementById("count").textContent = `${shown} of ${frames.tBodies[0].rows.length} frames`;
}

document.querySelector("form.controls").hidden = false;
document.querySelector("form.controls").addEventListener("submit", (event) => event.preventDefault());
flag.addEventListener("change", filter);
number.addEventListener("input", filter);
filter();
