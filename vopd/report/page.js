"use strict";
document.documentElement.classList.add("js"); // before the first row is laid out

// Sorting: a button in every column's heading; what is empty or infinite stays at the end.
function key(row, column, words) {
  const cell = row.cells[column];
  const text = cell.dataset.text ?? cell.textContent.trim();
  if (text === "") return null;
  const value = words ? text : Number(text);
  return Number.isNaN(value) ? null : value;
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

// Filtering the frames by flag and by number or name. A screen has some rows at a time, paper all.
function frames(table, form, flag, number, count, more) {
  const rows = table.tBodies[0].rows;
  const box = table.parentNode;
  const atOnce = table.querySelectorAll("tbody tr:not(.later)").length;
  let limit = atOnce;
  let found = rows.length;

  function wanted(row) {
    const raised = row.dataset.flags.split(" ").filter(Boolean);
    const asked = number.value.trim();
    if (asked !== "" && row.dataset.frame !== asked) return false;
    if (flag.value === "") return true;
    if (flag.value === "*") return raised.length > 0;
    if (flag.value === "-") return raised.length === 0;
    return raised.includes(flag.value);
  }

  function show(upTo) {
    limit = upTo;
    let shown = 0;
    for (const row of rows) {
      if (!row.hidden) row.classList.toggle("later", ++shown > limit);
    }
    more.hidden = found <= limit;
    more.textContent = `Show all ${found} rows`;
  }

  function filter() {
    found = 0;
    for (const row of rows) {
      row.hidden = !wanted(row);
      found += !row.hidden;
    }
    count.textContent = `${found} of ${rows.length} frames`;
    show(atOnce);
  }

  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  flag.addEventListener("change", filter);
  number.addEventListener("input", filter);
  table.addEventListener("sorted", () => { box.scrollTop = 0; show(atOnce); });
  box.addEventListener("scroll", () => {
    const below = box.scrollHeight - box.scrollTop - box.clientHeight;
    if (below < box.clientHeight && limit < found) show(limit + atOnce);
  });
  more.addEventListener("click", () => { show(found); box.focus(); });
  filter();
}

document.addEventListener("DOMContentLoaded", () => {
  for (const table of document.querySelectorAll("table.sortable")) {
    for (const button of table.querySelectorAll("thead button")) {
      button.addEventListener("click", () => {
        sort(table, button.parentNode);
        table.dispatchEvent(new Event("sorted"));
      });
    }
  }
  const of = (id) => document.getElementById(id);
  if (of("frames-table")) frames(of("frames-table"), document.querySelector("form.controls"), of("flag"), of("number"), of("count"), of("more"));
});
