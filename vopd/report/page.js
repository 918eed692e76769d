"use strict";
document.documentElement.classList.add("js"); // before anything is laid out
const of = (id) => document.getElementById(id);

// Sorting: a button in every column's heading; what is empty or no number stays at the end.
function ordered(keys, descending) {
  return keys.map((_, k) => k).sort((a, b) => {
    const [one, other] = [keys[a], keys[b]];
    if (one === null || other === null) return (one === null) - (other === null);
    const order = one < other ? -1 : one > other ? 1 : 0;
    return descending ? -order : order;
  });
}

function headings(table, sort) {
  for (const button of table.querySelectorAll("thead button")) {
    button.addEventListener("click", () => {
      const heading = button.parentNode;
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of heading.parentNode.cells) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sort(heading.cellIndex, "words" in heading.dataset, descending);
    });
  }
}

const number = (text) => (text === "" || Number.isNaN(Number(text)) ? null : Number(text));

function sortable(table) {
  const body = table.tBodies[0];
  headings(table, (column, words, descending) => {
    const rows = [...body.rows];
    const texts = rows.map((row) => row.cells[column].textContent.trim());
    const keys = texts.map((text) => (words ? text || null : number(text)));
    body.append(...ordered(keys, descending).map((k) => rows[k]));
  });
}

// Elements of drawings
function node(name, attributes = {}, ...inside) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...inside);
  return made;
}
const round = (x) => Math.round(x * 10) / 10;
const line = (x1, y1, x2, y2, look) => node("line", { x1: round(x1), y1: round(y1), x2: round(x2), y2: round(y2), class: look });
const label = (x, y, text, look = "", anchor = "start") => node("text", { x: round(x), y: round(y), class: look, "text-anchor": anchor }, text);
const path = (d, look) => node("path", { d, class: look });
const along = (points) => points.map(([x, y], k) => `${k ? "L" : "M"}${round(x)} ${round(y)}`).join("");

function canvas(box, width, height, text) {
  const svg = node("svg", { viewBox: `0 0 ${round(width)} ${round(height)}`, width: round(width), height: round(height), role: "img", "aria-label": text });
  box.replaceChildren(svg);
  return svg;
}

function arrow(x1, y1, x2, y2, look) {
  const length = Math.hypot(x2 - x1, y2 - y1);
  if (!(length > 0.5)) return node("g");
  const [a, b] = [(x2 - x1) / length, (y2 - y1) / length];
  const head = Math.min(7, length / 2);
  const side = (way) => `${round(x2 - head * a - way * 0.5 * head * b)} ${round(y2 - head * b + way * 0.5 * head * a)}`;
  return path(`M${round(x1)} ${round(y1)}L${round(x2)} ${round(y2)}M${side(1)}L${round(x2)} ${round(y2)}L${side(-1)}`, look);
}

function roundNumber(value) { // down to 1, 2, 5, 10 ...
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((step) => step * power <= value * (1 + 1e-9)) * power;
}

function ticks(low, high, most) {
  const least = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].find((one) => one * power >= least * (1 - 1e-9)) * power;
  const made = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) made.push(k * step);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return [made, decimals];
}

const quantile = (values, part) => {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] : NaN;
};
const extent = (values) => {
  let [low, high] = [Infinity, -Infinity];
  for (const one of values) {
    if (one === null || !Number.isFinite(one)) continue;
    if (one < low) low = one;
    if (one > high) high = one;
  }
  return [low, high];
};

const pen = document.createElement("canvas").getContext("2d");
function widthOf(text) { // of a bold name, pixels
  pen.font = "600 11px system-ui, sans-serif";
  return pen.measureText(text).width + 4;
}

// Names beside their points, none over another; those that have no room are left out.
function names(svg, points, width, height, arrows = []) { // clear of arrows if there is room
  const boxes = points.map(([x, y]) => [x - 4, y - 4, x + 4, y + 4]);
  const apart = (one, other) => one[2] < other[0] || other[2] < one[0] || one[3] < other[1] || other[3] < one[1];
  let left = 0;
  points.forEach(([x, y, text, look], k) => {
    const [a, b] = [widthOf(text), 12];
    const tries = [[8, -6], [-8 - a, -6], [-a / 2, -20], [-a / 2, 8], [7, -18], [-7 - a, -18], [7, 6], [-7 - a, 6]];
    const free = tries.map(([u, v]) => [x + u, y + v, x + u + a, y + v + b]).filter((box) =>
      box[0] >= 0 && box[1] >= 0 && box[2] <= width && box[3] <= height && boxes.every((other, n) => n === k || apart(box, other)));
    const crossed = (box) => arrows.filter(([u, v]) => u > box[0] && u < box[2] && v > box[1] && v < box[3]).length;
    const place = free.find((box) => !crossed(box)) ?? free[0];
    if (!place) { left++; return; }
    boxes.push(place);
    svg.append(label(place[0], place[3] - 2.5, text, `name ${look}`));
  });
  return left;
}

// The place that is farthest from all marks, the first of those that are far enough.
function freest(places, marks) {
  const away = ([a, b]) => Math.min(80, ...marks.map(([c, d]) => Math.hypot(a - c, b - d)));
  return places.reduce((one, other) => (away(one) < away(other) ? other : one));
}

// Frames: one is chosen, and curves, image, map and table follow it.
const PAGE = 100; // rows of the table at a time
const STATES = ["", "not used", "does not fit"];
const SHOWN = 24; // letters of a landmark's name in drawings and below them; the tables have all of it

function short(name) {
  const letters = [...name];
  return letters.length <= SHOWN ? name : `${letters.slice(0, SHOWN - 1).join("")}…`;
}

function work(data) {
  const columns = data.columns;
  const byName = Object.fromEntries(columns.map((one) => [one.name, one]));
  for (const one of columns) if (one.same) one.values = byName[one.same].values;
  const shown = columns.filter((one) => !one.hidden);
  const total = columns[0].values.length;
  const every = Array.from({ length: total }, (_, k) => k);
  const jobs = data.jobs;
  const jobAt = jobs.flatMap((job) => Array(job.count).fill(job));
  const value = (column, k) => (column.words ? column.words[column.values[k]] : column.values[k]);
  const flagsColumn = byName.flags;
  const flagsOf = flagsColumn.words.map((text) => text.split(";").filter(Boolean).map((one) => one.split(":")[0]));
  const raised = (k) => flagsOf[flagsColumn.values[k]];
  const nameColumn = byName.image ?? byName.frame;
  const nameOf = (k) => String(value(nameColumn, k) || value(byName.frame, k));
  const rms = columns.find((one) => one.name.startsWith("residual_rms_"));

  function text(column, k) { // as the CSV file has it
    const one = value(column, k);
    if (one === null) return "";
    if (typeof one === "string" || column.decimals === undefined) return String(one);
    if (column.decimals === "e") return one.toExponential(6).replace(/e([+-])(\d)$/, "e$10$2");
    return (Object.is(one, -0) ? "-" : "") + one.toFixed(column.decimals);
  }

  let now = 0;
  let found = every; // frames that the filters leave, in the order of the file
  let rows = every; // the same in the order of the table
  let sorting = null;
  let first = 0; // of the rows that are shown
  let count = PAGE;
  let drawn = null; // what the curves need to follow the frame

  const [slider, flag, jobChoice, column, low, high, asked, group] = ["slider", "flag", "job", "column", "low", "high", "number", "group"].map(of);
  const axisOf = (job) => (job.axis === "frame" ? byName.frame : byName.time_s);
  const described = (k) => {
    const time = value(byName.time_s, k);
    const job = jobs.length > 1 ? `${jobAt[k].label}, ` : "";
    return `${job}frame ${nameOf(k)}${time === null ? "" : `, ${time.toFixed(3)} s`}`;
  };

  // Filters
  function filter() {
    const range = columns.find((one) => one.name === column.value);
    const [from, to] = [low, high].map((box) => {
      const typed = number(box.value.trim().replace(",", "."));
      box.setAttribute("aria-invalid", String(box.value.trim() !== "" && typed === null));
      return typed;
    });
    found = every.filter((k) => {
      if (jobChoice && jobChoice.value !== "" && jobAt[k] !== jobs[jobChoice.value]) return false;
      const own = raised(k);
      if (flag.value === "*" ? !own.length : flag.value === "-" ? own.length : flag.value && !own.includes(flag.value)) return false;
      if (!range || (from === null && to === null)) return true;
      const one = number(text(range, k));
      return one !== null && (from === null || one >= from) && (to === null || one <= to);
    });
    of("count").textContent = `${found.length} of ${total} frames`;
    slider.max = Math.max(found.length - 1, 0);
    slider.disabled = of("before").disabled = of("after").disabled = found.length === 0;
    drawn = null;
    order();
    if (found.length && !found.includes(now)) choose(found.find((k) => k >= now) ?? found[found.length - 1]);
    else choose(now);
  }

  function order() {
    rows = found;
    if (sorting) {
      const [one, words, descending] = sorting;
      const keys = found.map((k) => (words ? text(one, k) || null : number(text(one, k))));
      rows = ordered(keys, descending).map((k) => found[k]);
    }
    first = 0;
    count = PAGE;
    fill();
  }

  // The table: some rows at a time, those with the chosen frame
  function cell(one, k) {
    const content = text(one, k);
    if (one === byName.frame) {
      const made = document.createElement("th");
      made.scope = "row";
      made.className = "n stays";
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = content;
      made.append(button);
      return made;
    }
    const made = document.createElement("td");
    if (one !== flagsColumn) {
      made.textContent = content;
      if (!one.words) made.className = "n";
      return made;
    }
    made.className = "flags";
    made.dataset.text = content;
    for (const part of content.split(";").filter(Boolean)) {
      const mark = document.createElement("span");
      mark.textContent = part;
      made.append(mark, " ");
    }
    return made;
  }

  function fill() {
    const body = of("frames-table").tBodies[0];
    body.replaceChildren(...rows.slice(first, first + count).map((k) => {
      const row = document.createElement("tr");
      row.dataset.k = k;
      row.append(...shown.map((one) => cell(one, k)));
      return row;
    }));
    const last = Math.min(first + count, rows.length);
    of("rows").textContent = rows.length ? `rows ${first + 1} to ${last} of ${rows.length}` : "no rows";
    for (const id of ["rows-before", "rows-after", "more"]) of(id).hidden = rows.length <= count;
    of("rows-before").disabled = first === 0;
    of("rows-after").disabled = last === rows.length;
    of("more").textContent = `Show all ${rows.length} rows`;
    mark();
  }

  function mark() {
    for (const row of of("frames-table").tBodies[0].rows) {
      const own = Number(row.dataset.k) === now;
      if (own) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
    }
  }

  function toRow(focused) {
    const place = rows.indexOf(now);
    if (place < 0) return mark();
    if (place < first || place >= first + count) {
      first = place - (place % count);
      fill();
    }
    mark();
    const row = of("frames-table").querySelector("[aria-current]");
    const box = of("frames-table").parentNode;
    const [top, height] = [row.offsetTop, of("frames-table").tHead.offsetHeight];
    if (top < box.scrollTop + height || top + row.offsetHeight > box.scrollTop + box.clientHeight) box.scrollTop = Math.max(top - height - 60, 0);
    if (focused) row.querySelector("button").focus({ preventScroll: true });
  }

  function turn(by) {
    const pressed = document.activeElement;  // some browsers take the focus off a disabled button
    first = Math.max(0, Math.min(first + by * PAGE, rows.length - (rows.length % PAGE || PAGE)));
    fill();
    of("frames-table").parentNode.scrollTop = 0;
    for (const [id, other] of [["rows-before", "rows-after"], ["rows-after", "rows-before"]]) {
      if (of(id) === pressed && pressed.disabled) of(other).focus();
    }
  }

  // The chosen frame
  function choose(k, focused = false) {
    const job = jobAt[now];
    now = k;
    if (jobAt[now] !== job) drawn = null;
    slider.value = Math.max(found.indexOf(now), 0);
    slider.setAttribute("aria-valuetext", described(now));
    of("now").textContent = described(now);
    toRow(focused);
    curves();
    image();
    map();
    picks();
  }

  const step = (by) => {
    if (!found.length) return;
    const place = found.indexOf(now);
    choose(found[Math.max(0, Math.min(found.length - 1, place + by))]);
  };

  // Curves: angles with bands of 95 %, residuals, and a row of marks for each flag
  const SETS = { vehicle: ["yaw", "pitch", "roll"].map((one) => `vehicle_${one}_deg`), camera: ["yaw", "pitch", "roll"].map((one) => `camera_${one}_deg`), attack: ["alpha_deg", "beta_deg", "eta_deg"] };

  function ends(one, k, at) {
    if (one.name === "eta_deg") return [byName.eta_low_95_deg, byName.eta_high_95_deg].map((c) => typeof c.values[k] === "number" ? c.values[k] - value(one, k) + at : NaN);
    const half = byName[`half_width_95_${one.name}`]?.values[k];
    return typeof half === "number" ? [at - half, at + half] : [NaN, NaN];
  }

  // In 0 to 360, or above -180 to 180 degrees, where a rounded angle stays.
  function inRange(angle, halfCircle, digits) {
    const turned = (v) => ((v % 360) + 360) % 360;
    const rounded = Number(angle.toFixed(digits));
    return (halfCircle ? 180 - turned(180 - rounded) : turned(rounded)).toFixed(digits);
  }

  // Yaw is from 0, and a roll on both sides of 180 too: it goes on to 181, as in the table.
  function inHalfCircle(one, least, most) {
    const parted = (at) => Math.floor((least - at) / 360) < Math.floor((most - at) / 360);
    return !(one.name.includes("yaw") || (one.name.includes("roll") && parted(180) && !parted(0)));
  }

  // Beside its curve: an angle to two digits of half its interval, in the range of its scale. The table has all digits.
  function asDrawn(one, halfCircle) {
    const written = text(one, now);
    if (written === "") return "none";
    if (one === rms) return Number(written).toPrecision(3);
    const [lowEnd, highEnd] = ends(one, now, 0);
    const half = (highEnd - lowEnd) / 2;
    if (!Number.isFinite(half)) return `${inRange(Number(written), halfCircle, 2)} ± ? °`;
    const digits = half > 0 ? Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(half)))) : 6;
    return `${inRange(Number(written), halfCircle, digits)} ± ${half.toFixed(digits)} °`;
  }

  function curves() {
    const box = of("curve-box");
    const job = jobAt[now];
    if (job.count < 2) { of("curves").hidden = true; return; }
    of("curves").hidden = false;
    if (!drawn) drawCurves(box, job);
    const { svg, x, panels, tops, tall, at } = drawn;
    svg.querySelector(".cursor")?.remove();
    const place = x(at[now - job.first]);
    const cursor = node("g", { class: "cursor" });
    if (Number.isFinite(place)) for (const top of tops) cursor.append(line(place, top + 14, place, top + tall, "chosen"));
    for (const { one, y, top, values, halfCircle } of panels) {
      const own = values[now - job.first];
      if (Number.isFinite(own) && Number.isFinite(place)) cursor.append(node("circle", { cx: round(place), cy: round(y(own)), r: 4, class: "chosen" }));
      cursor.append(label(svg.viewBox.baseVal.width - 6, top + 11, asDrawn(one, halfCircle), "value", "end"));
    }
    svg.append(cursor);
    svg.setAttribute("aria-label", `${drawn.said}; chosen: ${described(now)}, ${panels.map(({ one, halfCircle }) => `${one.name} ${asDrawn(one, halfCircle)}`).join(", ")}`);
  }

  function drawCurves(box, job) {
    const width = Math.max(box.clientWidth, 300);
    const [left, right, tall, gap] = [54, 8, width < 600 ? 84 : 100, 16];
    const at = axisOf(job).values.slice(job.first, job.first + job.count);
    const inJob = found.filter((k) => jobAt[k] === job).map((k) => at[k - job.first]);
    let [from, to] = extent(inJob);
    if (!(to > from)) [from, to] = extent(at);
    if (!(to > from)) [from, to] = Number.isFinite(from) ? [from - 0.5, from + 0.5] : [0, 1];
    const x = (t) => (t === null ? NaN : left + 6 + ((t - from) / (to - from)) * (width - left - right - 12));
    const order = ordered(at, false).filter((k) => at[k] !== null);
    const inside = order.filter((k) => at[k] >= from && at[k] <= to);
    const steps = inside.slice(1).map((k, n) => at[k] - at[inside[n]]).filter((one) => one > 0);
    const gapAt = 3 * (quantile(steps, 0.5) || Infinity);
    const list = [...SETS[group.value].map((name) => byName[name]), rms].filter(Boolean);
    const own = new Set(inside.flatMap((k) => raised(job.first + k).filter((name) => !raised(job.first + k).includes(data.told_by[name]))));
    const flagNames = Object.keys(data.flags).filter((name) => own.has(name));
    const widths = list.filter((one) => one !== rms);
    const height = (list.length + 1) * (tall + gap) + flagNames.length * 24 + 30;
    const svg = canvas(box, width, height, "");
    const bottom = height - 30;
    const [marks, decimals] = ticks(from, to, Math.max(3, width / 110));
    for (const one of marks) {
      svg.append(line(x(one), 0, x(one), bottom, "grid"), label(x(one), bottom + 13, one.toFixed(decimals), "tick", "middle"));
    }
    svg.append(label(width / 2, height - 4, job.axis, "tick", "middle"));
    const told = [];
    const panels = list.map((one, n) => {
      const top = n * (tall + gap) + gap;
      const raw = at.map((_, k) => value(one, job.first + k));
      const angle = one !== rms;
      let cut = 0;
      if (angle) {
        const known = raw.filter((v) => v !== null).map((v) => (v * Math.PI) / 180);
        cut = Math.round((Math.atan2(known.reduce((s, v) => s + Math.sin(v), 0), known.reduce((s, v) => s + Math.cos(v), 0)) * 180) / Math.PI) - 180;
      }
      const values = raw.map((v) => (v === null ? NaN : angle ? ((((v - cut) % 360) + 360) % 360) + cut : v));
      const bands = values.map((v, k) => (angle ? ends(one, job.first + k, v) : [NaN, NaN]));
      let [least, most] = extent(inside.map((k) => values[k]));
      let beyond = "";
      if (!angle && most > 6 * quantile(inside.map((k) => values[k]), 0.9)) {
        most = 3 * quantile(inside.map((k) => values[k]), 0.9);
        beyond = `; ${inside.filter((k) => values[k] > most).length} beyond, at the edge`;
      }
      const wide = quantile(inside.map((k) => bands[k][1] - bands[k][0]), 0.5) || 0;
      [least, most] = [angle ? least - 0.6 * wide : 0, most + 0.6 * wide];
      if (!(most > least)) [least, most] = Number.isFinite(most) ? [most - 1, most + 1] : [0, 1];
      const room = 0.06 * (most - least);
      [least, most] = [angle ? least - room : 0, most + room];
      const y = (v) => top + 14 + (1 - (Math.max(least, Math.min(most, v)) - least) / (most - least)) * (tall - 14);
      const halfCircle = inHalfCircle(one, least, most);
      const [levels, digits] = ticks(least, most, 4);
      for (const level of levels) {
        const shownLevel = angle ? inRange(level, halfCircle, digits) : level.toFixed(digits);
        svg.append(line(left, y(level), width - right, y(level), "grid"), label(left - 4, y(level) + 4, shownLevel, "tick", "end"));
      }
      svg.append(label(left, top + 11, one.name.replaceAll("_", " ").replace(/ deg$/, ", °") + beyond, "title"));
      let [d, before] = ["", null];
      const parts = [[]];
      const alone = [];
      for (const k of inside) {
        const v = values[k];
        const cutHere = before === null || at[k] - at[before] > gapAt || (angle && Math.abs(v - values[before]) > 180);
        if (!Number.isFinite(v)) { before = null; continue; }
        if (cutHere) parts.push([]);
        parts[parts.length - 1].push(k);
        d += `${cutHere ? "M" : "L"}${round(x(at[k]))} ${round(y(v))}`;
        before = k;
      }
      for (const part of parts) {
        const banded = part.filter((k) => Number.isFinite(bands[k][0]));
        if (banded.length > 1) svg.append(path(`${along([...banded.map((k) => [x(at[k]), y(bands[k][1])]), ...banded.reverse().map((k) => [x(at[k]), y(bands[k][0])])])}Z`, "band"));
        if (part.length === 1 || inside.length <= 60) alone.push(...part);
      }
      svg.append(path(d, "curve"), path(alone.map((k) => `M${round(x(at[k]) - 2.5)} ${round(y(values[k]))}h5m-2.5 -2.5v5`).join(""), "curve"));
      const [a, b] = extent(inside.map((k) => raw[k]));
      told.push(`${one.name} ${a} to ${b}`);
      return { one, y, top, values, halfCircle };
    });
    drawWidths(svg, list.length * (tall + gap) + gap, tall, left, width - right, x, widths, widths.map((one) => inside.map((k) => {
      const [lowEnd, highEnd] = ends(one, job.first + k, value(one, job.first + k) ?? NaN);
      return [at[k], (highEnd - lowEnd) / 2];
    })));
    flagNames.forEach((name, n) => {
      const top = (list.length + 1) * (tall + gap) + gap + n * 24;
      const here = inside.filter((k) => raised(job.first + k).includes(name));
      svg.append(label(left, top, `${name} (${here.length})`, "flagname"), path(here.map((k) => `M${round(x(at[k]))} ${top + 2}v8`).join(""), "flagged"));
    });
    const tops = [...panels.map(({ top }) => top), list.length * (tall + gap) + gap];
    drawn = { svg, x, panels, tops, tall, at, said: `Curves of ${inside.length} frames: ${told.join(", ")}` };
  }

  function drawWidths(svg, top, tall, left, right, x, angles, lines) { // half of the intervals, a line each
    const all = lines.flat().map(([, half]) => half);
    const most = 1.2 * Math.min(extent(all)[1], 3 * quantile(all, 0.9));
    if (!(most > 0)) return;
    const y = (half) => top + 14 + (1 - Math.min(half / most, 1)) * (tall - 14);
    const [levels, digits] = ticks(0, most, 3);
    for (const level of levels) svg.append(line(left, y(level), right, y(level), "grid"), label(left - 4, y(level) + 4, level.toFixed(digits), "tick", "end"));
    svg.append(label(left, top + 11, "± 95 %, °", "title"));
    lines.forEach((points, n) => {
      let d = "";
      let before = false;
      for (const [t, half] of points) {
        const known = Number.isFinite(half);
        if (known) d += `${before ? "L" : "M"}${round(x(t))} ${round(y(half))}${before ? "" : "h.1"}`;
        before = known;
      }
      svg.append(path(d, `curve dash${n}`));
      const at = right - (angles.length - n) * 62;
      svg.append(line(at, top + 7, at + 20, top + 7, `curve dash${n}`), label(at + 24, top + 11, angles[n].name.split("_").slice(-2)[0], "title"));
    });
  }

  function nearest(event) {
    if (!drawn) return;
    const box = drawn.svg.getBoundingClientRect();
    const place = ((event.clientX - box.left) / box.width) * drawn.svg.viewBox.baseVal.width;
    const job = jobAt[now];
    let [best, least] = [null, Infinity];
    for (const k of found) {
      if (jobAt[k] !== job) continue;
      const away = Math.abs(drawn.x(drawn.at[k - job.first]) - place);
      if (away < least) [best, least] = [k, away];
    }
    if (best !== null && best !== now) choose(best);
  }

  // Picks of the chosen frame, and their residuals
  function some(part, job) { // the rows of a list with counts that belong to the chosen frame
    if (!part) return [];
    if (!part.starts) {
      part.starts = [0];
      for (const n of part.count) part.starts.push(part.starts[part.starts.length - 1] + n);
    }
    const k = now - job.first;
    return Array.from({ length: part.count[k] }, (_, n) => part.starts[k] + n);
  }

  function picksOf(job) {
    const all = job.picks;
    return some(all, job).map((n) => ({ n, name: job.names[all.landmark[n]], landmark: all.landmark[n], u: all.u[n], v: all.v[n], du: all.du[n], dv: all.dv[n], state: all.state[n] }));
  }
  const length = (pick) => (pick.du === null || pick.dv === null ? NaN : Math.hypot(pick.du, pick.dv));

  function picks() {
    const job = jobAt[now];
    of("picks").hidden = !job.picks;
    if (!job.picks) return;
    const digits = job.sizes ? 3 : 2;
    const figures = (one) => (one === null || Number.isNaN(one) ? "" : one.toFixed(digits));
    const list = picksOf(job).sort((a, b) => (length(b) || 0) - (length(a) || 0));
    of("picks-table").tBodies[0].replaceChildren(...list.map((pick) => {
      const row = document.createElement("tr");
      if (pick.state === 2) row.className = "odd";
      [pick.name, figures(pick.du), figures(pick.dv), figures(length(pick)), STATES[pick.state]].forEach((content, n) => {
        const made = document.createElement(n ? "td" : "th");
        if (!n) made.scope = "row";
        else if (n < 4) made.className = "n";
        made.textContent = content;
        row.append(made);
      });
      return row;
    }));
  }

  // The image of the chosen frame: its photograph or its border, picks, computed places, residuals
  function arrowScale(job, across) { // of the whole job, so that frames can be compared
    if (job.arrows === undefined) {
      const all = job.picks.du.map((du, n) => (du === null ? NaN : Math.hypot(du, job.picks.dv[n]) / job.per));
      const usual = 2.5 * quantile(all, 0.5);
      job.arrows = usual > 0 ? Math.max(roundNumber((0.1 * across) / usual), 1) : 1;
      job.usual = usual * job.per;
    }
    return job.arrows;
  }

  function image() {
    const job = jobAt[now];
    of("image").hidden = !job.picks;
    if (!job.picks) return;
    const box = of("image-box");
    const list = picksOf(job);
    let width = Math.max(box.clientWidth, 240);
    let x, y, height, across, unit;
    if (job.sizes) {
      const [w, h] = job.sizes[job.size ? job.size[now - job.first] : 0];
      unit = Math.min(width / w, 600 / h);
      [width, height, across] = [w * unit, h * unit, w];
      [x, y] = [(u) => (u + 0.5) * unit, (v) => (v + 0.5) * unit];
    } else {
      job.far ??= ["u", "v"].map((one) => Math.max(1.3 * Math.max(...extent(job.picks[one]).map(Math.abs), 1e-3), ...extent(job.corners?.[one] ?? []).map((end) => (Number.isFinite(end) ? 1.03 * Math.abs(end) : 0))));
      unit = Math.min(width / (2 * job.far[0]), 300 / job.far[1]);
      [width, height, across] = [2 * job.far[0] * unit, 2 * job.far[1] * unit, 2 * job.far[0]];
      [x, y] = [(u) => width / 2 - u * unit, (v) => height / 2 - v * unit]; // x grows to the left
    }
    const worst = list.reduce((a, b) => ((length(b) || 0) > (length(a) || -1) ? b : a), list[0]);
    const largest = worst && length(worst) > 0 ? `, largest residual ${length(worst).toPrecision(3)} ${job.residual} of ${short(worst.name)}` : "";
    const odd = list.filter((pick) => pick.state === 2).map((pick) => short(pick.name));
    const said = `${described(now)}: ${list.length} picks${largest}${odd.length ? `; does not fit: ${odd.join(", ")}` : ""}`;
    const svg = canvas(box, width, height, `Image of ${said}`);
    const photograph = of(`photograph${now}`);
    const corners = some(job.corners, job).map((n) => [x(job.corners.u[n]), y(job.corners.v[n])]);
    svg.append(corners.length ? path(`${along(corners)}Z`, "border") : node("rect", { x: 0.5, y: 0.5, width: round(width - 1), height: round(height - 1), class: "border" }));
    if (photograph) svg.append(node("image", { href: `data:image/jpeg;base64,${photograph.textContent}`, width: round(width), height: round(height), preserveAspectRatio: "none" }));
    svg.classList.toggle("photo", Boolean(photograph));
    const scale = arrowScale(job, across);
    const points = [];
    const arrows = [];
    const toward = horizon(svg, job, x, y, width, height, list.map((pick) => [x(pick.u), y(pick.v)]), arrows);
    for (const n of some(job.others, job)) {
      const [u, v] = [x(job.others.u[n]), y(job.others.v[n])];
      svg.append(path(`M${round(u)} ${round(v - 5)}l5 9h-10z`, "other"));
      points.push([u, v, short(job.names[job.others.landmark[n]]), "faint"]);
    }
    for (const pick of list) {
      const [u, v] = [x(pick.u), y(pick.v)];
      if (pick.du !== null) {
        const [a, b] = [x(pick.u - pick.du / job.per), y(pick.v - pick.dv / job.per)];
        const [c, d] = [a + (u - a) * scale, b + (v - b) * scale];
        const long = Math.hypot(c - a, d - b) > 0.3 * width;
        for (let n = 1; n <= 8; n++) arrows.push([a + ((c - a) * n) / 8, b + ((d - b) * n) / 8]);
        svg.append(path(`M${round(a - 5)} ${round(b)}h10m-5 -5v10`, "computed"), long ? line(a, b, u, v, "far") : arrow(a, b, c, d, "residual"));
      }
      if (pick.state === 2) svg.append(node("rect", { x: round(u - 7), y: round(v - 7), width: 14, height: 14, class: "culprit" }));
      else if (pick.state === 1) svg.append(path(`M${round(u)} ${round(v - 6)}l6 6l-6 6l-6 -6z`, "unused"));
      else svg.append(node("circle", { cx: round(u), cy: round(v), r: 5.5, class: "picked" }));
      points.unshift([u, v, pick.state === 2 ? `${short(pick.name)}: does not fit` : short(pick.name), pick.state === 2 ? "odd" : ""]);
    }
    points.sort((a, b) => (b[3] === "odd") - (a[3] === "odd"));
    const inside = points.filter(([u, v]) => u >= 0 && v >= 0 && u <= width && v <= height);
    const outside = points.length - inside.length;
    if (job.usual > 0) {
      const key = roundNumber(1.5 * job.usual);
      const long = (key / job.per) * scale * unit;
      const [a, b] = freest([[width - 40, height - 14], [40, height - 14], [width - 40, 18], [40, 18]], [...inside, ...arrows]);
      const to = a > width / 2 ? width - 14 : 14 + long;
      if (long < 0.4 * width) {
        svg.append(arrow(to - long, b + 4, to, b + 4, "residual"), label(a > width / 2 ? to : 14, b - 3, `${key} ${job.residual}`, "name key", a > width / 2 ? "end" : "start"));
        for (let n = 0; n <= 8; n++) arrows.push([to - 5 - 6 * n, b - 6], [to - (n / 8) * long, b + 4]);
      }
    }
    const left = points.length <= 200 ? names(svg, inside, width, height, arrows) : points.length;
    const signs = ["○ picked", "+ computed", list.some((one) => one.state === 1) && "◇ picked, not used", odd.length && "□ does not fit", job.others?.count[now - job.first] && (job.sizes ? "△ not picked: computed place" : "△ not used: computed place")];
    const more = `${outside ? `; ${outside} outside the image` : ""}${left ? `; ${left} names left out for want of room` : ""}`;
    const plane = job.sizes ? "" : `; seen from behind the camera, ${job.surface}, corrected for distortion${corners.length ? "; the border joins the fiducials" : ""}`;
    of("image-text").textContent = `${said}. ${signs.filter(Boolean).join(", ")}; arrows: residuals, ${scale} times as long${scale > 1 ? ", dashed where that is too long" : ""}${toward}${plane}${more}.`;
  }

  const WINDS = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];

  function horizon(svg, job, x, y, width, height, marks, arrows) { // with azimuths, or the way north; says which
    if (!job.horizon) return "";
    const k = now - job.first;
    const own = some(job.horizon, job).map((n) => [job.horizon.u[n], job.horizon.v[n]]);
    const drawn = own.map(([u, v]) => (u === null ? null : [x(u), y(v)]));
    if (drawn.length) {
      let d = "";
      drawn.forEach((point, n) => { if (point) d += `${n && drawn[n - 1] ? "L" : "M"}${round(point[0])} ${round(point[1])}`; });
      svg.append(path(d, "horizon"));
      drawn.forEach((point, n) => {
        if (!point || n % 2 || point[0] < 12 || point[0] > width - 12 || point[1] < 0 || point[1] > height) return;
        const azimuth = Math.round(job.horizon.first[k] + (n / 2) * job.horizon.step[k]) % 360;
        const wind = azimuth % 45 ? "" : ` ${WINDS[azimuth / 45]}`;
        svg.append(line(point[0], point[1] - 4, point[0], point[1] + 4, "horizon tick"), label(point[0], point[1] < 20 ? point[1] + 15 : point[1] - 7, `${String(azimuth).padStart(3, "0")}°${wind}`, "name toward", "middle"));
      });
      return "; dashed line: horizon of a plain as high as the lowest landmark, azimuths from true north";
    }
    const [u, v] = [job.north.u[k], job.north.v[k]];
    if (u === null) return "";
    const [a, b] = freest([[width - 34, 34], [34, 34], [34, height - 34]], marks);
    for (let n = -16; n <= 28; n += 4) arrows.push([a + n * u, b + n * v]);
    svg.append(arrow(a - 16 * u, b - 16 * v, a + 16 * u, b + 16 * v, "toward"), label(a + 25 * u, b + 25 * v + 4, "N", "name toward", "middle"));
    return "; N: the way to true north in the picture's middle";
  }

  // The map: camera, landmarks, lines of sight and footprint from above, and from the side
  function map() {
    const job = jobAt[now];
    of("map").hidden = !job.places;
    if (!job.places) return;
    const k = now - job.first;
    const { places, camera } = job;
    const box = of("map-box");
    const width = Math.max(box.clientWidth, 240);
    const [left, right, side] = [52, 8, 110];
    if (!job.limits) {
      const across = extent([...places.east_m, ...camera.east_m]);
      const up = extent([...places.north_m, ...camera.north_m]);
      job.limits = [across, up, extent([...places.height_m, ...camera.height_m])];
    }
    const [across, up, heights] = job.limits;
    const room = 0.08 * Math.max(across[1] - across[0], up[1] - up[0], 1);
    const span = [across[1] - across[0] + 2 * room, up[1] - up[0] + 2 * room];
    const inner = width - left - right;
    const unit = Math.min(inner / span[0], (0.95 * inner) / span[1]);
    const tall = Math.max(span[1] * unit, 0.45 * inner);
    const middle = [(across[0] + across[1]) / 2, (up[0] + up[1]) / 2];
    const x = (e) => left + inner / 2 + (e - middle[0]) * unit;
    const y = (n) => tall / 2 - (n - middle[1]) * unit;
    const list = picksOf(job).filter((pick) => pick.landmark < places.east_m.length);
    const here = [camera.east_m[k], camera.north_m[k], camera.height_m[k]];
    const known = here[0] !== null;
    const far = Math.max(inner, tall) / unit > 20000 ? 1000 : 1;
    const name = far > 1 ? "km" : "m";
    const away = list.map((pick) => Math.hypot(places.east_m[pick.landmark] - here[0], places.north_m[pick.landmark] - here[1]));
    const [close, distant] = extent(list.map((pick, n) => Math.hypot(away[n], places.height_m[pick.landmark] - here[2])));
    const digits = (length, count = 3) => String(Number(length.toPrecision(count)));
    const nearFar = known && list.length ? `, landmarks ${digits(close / far)} to ${digits(distant / far)} ${name} away` : "";
    const svg = canvas(box, width, tall + side + 80, `Map of ${described(now)}: ${places.east_m.length} landmarks${nearFar}`);
    const [ex, nx] = job.origin;
    const clip = node("clipPath", { id: "plan" }, node("rect", { x: left, y: 0, width: round(inner), height: round(tall) }));
    const plan = node("g", { "clip-path": "url(#plan)" });
    svg.append(clip, node("rect", { x: left, y: 0.5, width: round(inner), height: round(tall), class: "border" }));
    const [easts, d] = ticks((middle[0] - inner / 2 / unit + ex) / far, (middle[0] + inner / 2 / unit + ex) / far, inner / 90);
    for (const e of easts) svg.append(line(x(e * far - ex), 0, x(e * far - ex), tall, "grid"), label(x(e * far - ex), tall + 13, e.toFixed(d), "tick", "middle"));
    const [norths, f] = ticks((middle[1] - tall / 2 / unit + nx) / far, (middle[1] + tall / 2 / unit + nx) / far, tall / 60);
    for (const n of norths.filter((one) => y(one * far - nx) > 5)) svg.append(line(left, y(n * far - nx), width - right, y(n * far - nx), "grid"), label(left - 3, y(n * far - nx) + 4, n.toFixed(f), "tick", "end"));
    svg.append(label(left + inner / 2, tall + 26, job.crs ? `easting and northing in ${job.crs}, ${name}` : `east and north of the camera's mean place, ${name}`, "tick", "middle"), plan);
    if (job.footprint) {
      const corners = some(job.footprint, job).map((n) => [x(job.footprint.east_m[n]), y(job.footprint.north_m[n])]);
      if (corners.length) plan.append(path(`${along(corners)}Z`, "footprint"));
    }
    const track = camera.east_m.map((e, n) => [e, n]).filter(([e]) => e !== null).map(([e, n]) => [x(e), y(camera.north_m[n])]);
    if (track.length > 1) plan.append(path(along(track), "track"));
    const azimuth = (() => {
      const [a, b] = list.reduce(([s, t], pick, n) => [s + (places.east_m[pick.landmark] - here[0]) / away[n], t + (places.north_m[pick.landmark] - here[1]) / away[n]], [0, 0]);
      return known && Math.hypot(a, b) > 0.1 * list.length ? Math.atan2(a, b) : Math.PI / 2;
    })();
    const beside = (e, n) => (e - (here[0] ?? 0)) * Math.sin(azimuth) + (n - (here[1] ?? 0)) * Math.cos(azimuth);
    const flat = list.map((pick) => beside(places.east_m[pick.landmark], places.north_m[pick.landmark]));
    let [start, end] = extent([0, ...flat]);
    if (!(end > start)) [start, end] = [-1, 1];
    const base = tall + 46;
    const sx = (s) => left + 10 + ((s - start) / (end - start)) * (inner - 20);
    const lift = heights[1] - heights[0] || 1;
    const wide = (lift * (inner - 20)) / (side - 12); // heights are never drawn smaller than distances
    if (end - start < wide) [start, end] = [(start + end - wide) / 2, (start + end + wide) / 2];
    const stretched = ((side - 12) / lift) * ((end - start) / (inner - 20));
    const sy = (h) => base + 6 + (1 - (h - heights[0]) / lift) * (side - 12);
    svg.append(node("rect", { x: left, y: base, width: round(inner), height: side, class: "border" }));
    for (const h of ticks(heights[0], heights[1] > heights[0] ? heights[1] : heights[0] + 1, 5)[0]) svg.append(line(left, sy(h), width - right, sy(h), "grid"), label(left - 3, sy(h) + 4, String(Math.round(h)), "tick", "end"));
    svg.append(label(left + inner / 2, base + side + 27, `distance toward ${Math.round((azimuth * 180) / Math.PI + job.convergence + 360) % 360}° from true north, ${name}`, "tick", "middle"), label(left, base - 3, "from the side: heights, m", "tick"));
    for (const s of ticks(start / far, end / far, inner / 90)[0]) svg.append(label(sx(s * far), base + side + 13, String(Number(s.toPrecision(6))), "tick", "middle"));
    const ended = new Map((job.missed?.pick ?? []).map((n, row) => [n, row]));
    if (known) {
      for (const pick of list) {
        const mark = [places.east_m[pick.landmark], places.north_m[pick.landmark], places.height_m[pick.landmark]];
        const row = ended.get(pick.n);
        const to = row === undefined ? mark : ["east_m", "north_m", "height_m"].map((one) => job.missed[one][row]);
        const look = row === undefined && pick.state !== 2 ? "sight" : "sight missing";
        plan.append(line(x(here[0]), y(here[1]), x(to[0]), y(to[1]), look), row === undefined ? "" : line(x(to[0]), y(to[1]), x(mark[0]), y(mark[1]), "miss"));
        svg.append(line(sx(0), sy(here[2]), sx(beside(to[0], to[1])), Math.max(base, Math.min(base + side, sy(to[2]))), look));
      }
    }
    const stateOf = new Map(list.map((pick) => [pick.landmark, pick.state]));
    const points = [];
    const sides = [];
    places.east_m.forEach((e, n) => {
      const state = stateOf.get(n);
      const look = state === undefined ? "other" : state === 2 ? "culprit" : "mark";
      const sign = (u, v) => (look === "culprit" ? node("rect", { x: round(u - 6), y: round(v - 6), width: 12, height: 12, class: look }) : path(`M${round(u)} ${round(v - 6)}l5.5 10h-11z`, look));
      const [u, v] = [x(e), y(places.north_m[n])];
      plan.append(sign(u, v));
      if (state !== undefined) {
        const [s, h] = [sx(beside(e, places.north_m[n])), sy(places.height_m[n])];
        svg.append(sign(s, h));
        sides.push([s, h - base, short(job.names[n]), state === 2 ? "odd" : ""]);
      }
      points.push([u, v, state === 2 ? `${short(job.names[n])}: does not fit` : short(job.names[n]), state === 2 ? "odd" : state === undefined ? "faint" : ""]);
    });
    if (known) {
      plan.append(node("circle", { cx: round(x(here[0])), cy: round(y(here[1])), r: 5.5, class: "camera" }));
      svg.append(node("circle", { cx: round(sx(0)), cy: round(sy(here[2])), r: 5.5, class: "camera" }));
    }
    points.sort((a, b) => ["odd", "", "faint"].indexOf(a[3]) - ["odd", "", "faint"].indexOf(b[3]));
    const bar = roundNumber((0.25 * inner) / unit);
    const taken = [...points, ...(known ? [[x(here[0]), y(here[1])]] : [])];
    const [a, b] = freest([[width - 26, 32], [left + 26, 32], [width - 26, tall - 32]], taken);
    const [p, q] = [Math.sin(job.convergence * Math.PI / 180) * -13, Math.cos(job.convergence * Math.PI / 180) * -13];
    svg.append(arrow(a - p, b - q, a + p, b + q, "north"), label(a + 1.6 * p, b + 1.6 * q + 4, "N", "name", "middle"));
    const [c, f0] = freest([[left + 10 + (bar * unit) / 2, tall - 14], [width - 20 - (bar * unit) / 2, tall - 14], [left + 10 + (bar * unit) / 2, 22]], [...taken, [a, b]]);
    const from = c - (bar * unit) / 2;
    svg.append(line(from, f0 + 5, from + bar * unit, f0 + 5, "bar"), label(from, f0 - 1, bar >= 1000 ? `${bar / 1000} km` : `${bar} m`, "name"));
    const signs = [-2, -1, 0, 1, 2].flatMap((n) => [[a + n * p, b + n * q], [c + (n * bar * unit) / 4, f0]]);
    const unnamed = points.length <= 200 ? names(svg, points, width, tall, signs) : points.length;
    const below = node("g", { transform: `translate(0 ${round(base)})` });
    svg.append(below);
    const unseen = names(below, sides, width, side);
    const more = unnamed + unseen ? `; ${unnamed + unseen} names left out for want of room` : "";
    const foot = job.footprint?.count[k] ? (job.up ? ", shaded: the azimuths in the image, which looks up" : ", shaded: what the image shows of the ground") : "";
    of("map-text").textContent = `Map of ${described(now)}${nearFar}. N: true north; ● camera, filled △ picked, open △ not picked, □ does not fit; lines: the camera's track, and lines of sight, dashed where one passes its landmark by more than 1 % of the distance${foot}${more}. Below, from the side, heights ${stretched > 1.05 ? `drawn ${digits(stretched, 2)} times as large as distances` : "to scale"}.`;
  }

  // What the user does
  const keys = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10, Home: -Infinity, End: Infinity };
  of("viewer").addEventListener("keydown", (event) => {
    const by = keys[event.key];
    if (by === undefined || event.ctrlKey || event.altKey || event.metaKey || event.target.localName === "select") return;
    event.preventDefault();
    step(by);
  });
  slider.addEventListener("input", () => choose(found[slider.value]));
  of("before").addEventListener("click", () => step(-1));
  of("after").addEventListener("click", () => step(1));
  const curveBox = of("curve-box");
  curveBox.addEventListener("pointerdown", nearest);
  curveBox.addEventListener("pointermove", (event) => { if (event.buttons & 1) nearest(event); });
  group.addEventListener("change", () => { drawn = null; curves(); });
  for (const box of [flag, jobChoice, column]) box?.addEventListener("change", filter);
  for (const box of [low, high]) box.addEventListener("input", filter);
  const form = of("filters");
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(() => { of("nowhere").textContent = ""; filter(); }));
  asked.addEventListener("input", () => {
    const wanted = asked.value.trim();
    const is = (k) => nameOf(k) === wanted || text(byName.frame, k) === wanted;
    const k = found.find(is);
    of("nowhere").textContent = wanted === "" || k !== undefined ? "" : every.some(is) ? `frame ${wanted} is left out by the filters` : `no frame ${wanted}`;
    if (k !== undefined) choose(k);
  });
  const table = of("frames-table");
  headings(table, (at, words, descending) => { sorting = [shown[at], words, descending]; order(); table.parentNode.scrollTop = 0; });
  table.addEventListener("click", (event) => {
    const row = event.target.closest("tbody tr");
    if (row) choose(Number(row.dataset.k), event.target.localName === "button");
  });
  table.addEventListener("keydown", (event) => {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (by === undefined || event.ctrlKey || event.altKey || event.metaKey || !event.target.closest("tbody")) return;
    event.preventDefault();
    choose(rows[Math.max(0, Math.min(rows.length - 1, rows.indexOf(now) + by))], true);
  });
  of("rows-before").addEventListener("click", () => turn(-1));
  of("rows-after").addEventListener("click", () => turn(1));
  of("more").addEventListener("click", () => { first = 0; count = rows.length; fill(); table.parentNode.focus(); });
  for (const link of document.querySelectorAll("[data-flag]")) {
    link.addEventListener("click", () => { flag.value = link.dataset.flag; filter(); });
  }
  for (const option of [...group.options]) {
    const any = (job) => ({ camera: job.turned, attack: job.attack })[option.value] ?? true;
    if (!jobs.some(any)) option.remove();
  }
  group.parentNode.hidden = group.options.length < 2;
  for (const one of document.querySelectorAll("#filters, #viewer > .controls")) one.hidden = total < 2;
  of("work").hidden = false;
  let width = 0;
  new ResizeObserver(() => {
    if (of("work").clientWidth === width) return;
    width = of("work").clientWidth;
    drawn = null;
    curves();
    image();
    map();
  }).observe(of("work"));
  const best = every.filter((k) => value(byName.vehicle_yaw_deg, k) !== null);
  now = best.find((k) => raised(k).length) ?? best[0] ?? 0;
  filter();
}

document.addEventListener("DOMContentLoaded", () => {
  for (const table of document.querySelectorAll("table.sortable")) sortable(table);
  if (of("data")) work(JSON.parse(of("data").textContent));
});
