"use strict";
// Picks of landmarks in frames. u counts to the right and v down from the centre of the first pixel.
const data = JSON.parse(document.getElementById("data").textContent);
const part = id => document.getElementById(id);
const canvas = part("view"), loupe = part("loupe");
const DEEPEST = 16, LOUPE = 8, LOUPE_SIZE = 168, DRAG = 4, NEAR_KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const READINGS = data.deck ? 3 : Infinity;  // of a point, at most
const place = "vopd pick " + data.key;
let names = data.landmarks.slice(), picks = data.picks, hidden = data.hidden, undone = [], frame = -1, landmark = 0;
let view = { scale: 1, x: 0, y: 0 };  // device pixels a pixel, and of the frame's corner
let cross = [0, 0], picture = null, dragged = null, seen = null, exchange = null;

// What is kept: in the browser's own storage after each change, so that closing the page loses nothing

const isText = one => typeof one === "string";
const isFrame = one => Number.isInteger(one) && one in data.frames;
const arePoints = (list, ...axes) => list.every(one => (isFrame(one.frame) || isText(one.frame)) && isText(one.landmark) && axes.every(axis => Number.isFinite(one[axis])));

function restore() {
  try {
    const kept = JSON.parse(localStorage.getItem(place));
    if (!kept) return data.places.length ? data.places[0].frame : 0;
    if (!(kept.names.every(isText) && arePoints(kept.picks, "u", "v") && arePoints(kept.hidden) && isFrame(kept.frame))) return 0;
    names = [...new Set([...names, ...kept.names])];
    ({ picks, hidden } = kept);
    landmark = Math.max(names.indexOf(kept.names[kept.landmark]), 0);
    part("kept").textContent = picks.length + (picks.length === 1 ? " pick" : " picks") + " restored";
    return kept.frame;
  } catch { return 0; /* no storage, or not of this page */ }
}

function keep() {
  try {
    localStorage.setItem(place, JSON.stringify({ names, picks, hidden, frame, landmark }));
    part("kept").textContent = "kept in this browser; save the file when done";
  } catch {
    part("kept").textContent = "this browser keeps nothing: save the file before you close the page";
  }
}

function change(next, marks = hidden) {
  undone.push([picks, hidden]);
  [picks, hidden] = [next, marks];
  keep();
  show();
}

const same = (one, at, name) => one.frame === at && one.landmark === name;
const readings = (at, name) => picks.filter(one => same(one, at, name));
const isHidden = (at, name) => hidden.some(one => same(one, at, name));

function mean(at, name) {  // of the readings of a point, with how far one of them is off
  const own = readings(at, name), n = own.length;
  if (!n) return null;
  const [u, v] = ["u", "v"].map(axis => own.reduce((sum, one) => sum + one[axis], 0) / n);
  const spread = n > 1 ? Math.sqrt(own.reduce((sum, one) => sum + (one.u - u) ** 2 + (one.v - v) ** 2, 0) / (2 * n - 2)) : NaN;
  return { u, v, n, spread, name };
}

function put(u, v, again = false) {  // again: one more reading of the point
  if (!names.length) return part("name").focus();
  if (!picture) return void (part("kept").textContent = "the image is not shown yet: nothing is picked");
  const { width, height } = data.frames[frame], name = names[landmark], own = readings(frame, name);
  if (again && own.length >= READINGS) return void (part("kept").textContent = name + " has its three readings: N is the next one, Delete removes one");
  const next = { frame, landmark: name, u: Math.min(Math.max(u, -.5), width - .5), v: Math.min(Math.max(v, -.5), height - .5) };
  cross = [next.u, next.v];
  change([...picks.filter(one => again || one !== own.at(-1)), next], hidden.filter(one => !same(one, frame, name)));
}

// The files: picks as a CSV, or readings of a film on cards

const cell = text => /[",\n\r]|^\s|\s$|^#/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
const label = at => typeof at === "number" ? data.frames[at].name : at;  // of a frame that is not on the page its name

function table() {
  const rank = at => typeof at === "number" ? at : data.frames.length;
  const order = [...picks].sort((a, b) => rank(a.frame) - rank(b.frame) || (rank(a.frame) < data.frames.length ? names.indexOf(a.landmark) - names.indexOf(b.landmark) : 0));
  const rows = order.map(one => [cell(label(one.frame)), cell(one.landmark), one.u.toFixed(2), one.v.toFixed(2)].join(","));
  const marks = hidden.map(one => data.hiddenHead + cell(label(one.frame)) + "," + cell(one.landmark));
  return [data.head, ...marks, data.column + ",landmark,u_px,v_px", ...rows, ""].join("\n");
}

const digits = (number, width) => String(number).padStart(width, "0");
const blanks = numbers => numbers.map(one => String(one).padStart(5)).join("");

function cards() {  // FORMATs 80 and 86 of the deck; x grows to the left and y upward
  const { before, counts, after, behind, inch } = data.deck, film = [], perFrame = [], missing = [];
  const reading = inches => (inches < 0 ? "-" : " ") + digits(Math.round(1000 * Math.abs(inches)), 6);
  for (const [at, { number, name, width, height }] of data.frames.entries()) {
    const own = names.map(one => readings(at, one)), points = own.slice(4).filter(one => one.length).length;
    if (!own.some(one => one.length)) continue;
    names.forEach((one, k) => {
      if (own[k].length !== READINGS && (k < 4 || own[k].length)) missing.push(`${name}: ${one} has ${own[k].length} of 3 readings`);
    });
    if (!points) missing.push(`${name}: no landmark is read`);
    perFrame.push(points);
    let point = 0;
    names.forEach((one, k) => {
      if (own[k].length) point += 1;
      own[k].forEach(({ u, v }, m) => {
        const start = `${k < 4 ? 1 : 4}0000 1 ${k < 4 ? "00" : digits(one, 2)}1 ${digits(m + 1, 2)}${digits(point, 5)}`;
        film.push(`${start.padEnd(40)}${reading((width - 1 - u) * inch)}   ${reading((height - 1 - v) * inch)}      ${digits(number, 4)}`);
      });
    });
  }
  const list = [counts[0], perFrame.length, counts[1], ...perFrame], group5 = [];
  while (list.length) group5.push(blanks(list.splice(0, 16)));
  return { text: [...before, ...group5, ...after, ...film, ...behind, ""].join("\n"), missing };
}

// Where landmarks are, by the picks of the frame: the rotation alone, position and lens are held

const DOUBTED = 5, BETTER = 5;  // sigmas of a residual that is marked; how much smaller an exchange makes residuals
const MOST_STARTS = 12, MOST_EXCHANGED = 8;  // points of which all pairs are tried
const px = value => value.toFixed(value < 9.995 ? 2 : 1).replace(/^0/, "") + " px";

function distort({ kind, k }, x, y) {
  const r2 = x * x + y * y, r = Math.sqrt(r2);
  if (kind === "brown") {
    const [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = k;
    const factor = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    return [x * factor + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (s1 + s2 * r2), y * factor + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (s3 + s4 * r2)];
  }
  let factor;
  if (kind === "fisheye") {
    const angle = Math.atan(r), t = angle * angle;
    factor = r ? angle / r * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3])))) : 1;
  } else {  // rows of measured and ideal radius
    const n = Math.max(k.findLastIndex(row => row[1] <= r), 0), [a, b] = [k[Math.min(n, k.length - 2)], k[Math.min(n, k.length - 2) + 1]];
    const slope = (b[0] - a[0]) / (b[1] - a[1]);
    factor = r ? (a[0] + slope * (r - a[1])) / r : slope;
  }
  return [x * factor, y * factor];
}

function project(lens, [x, y, z]) {  // to u and v, or null where the lens shows nothing
  if (!(z > 0) || Math.hypot(x, y) > (lens.field ?? Infinity) * z) return null;
  const [a, b] = distort(lens, x / z, y / z);
  return [lens.focal[0] * a + lens.skew * b + lens.centre[0], lens.focal[1] * b + lens.centre[1]];
}

function ray(lens, u, v) {  // of a pixel, by Newton's method
  const b = (v - lens.centre[1]) / lens.focal[1], a = (u - lens.centre[0] - lens.skew * b) / lens.focal[0], h = 1e-6;
  let [x, y] = [a, b];
  for (let pass = 0; pass < 60; pass += 1) {
    const [c, d] = distort(lens, x, y), [ca, da] = distort(lens, x + h, y), [cb, db] = distort(lens, x, y + h);
    const [ea, fa, eb, fb] = [ca - c, da - d, cb - c, db - d], by = (ea * fb - eb * fa) / h;
    [x, y] = [x + (fb * (a - c) - eb * (b - d)) / by, y + (ea * (b - d) - fa * (a - c)) / by];
  }
  const size = Math.hypot(x, y, 1);
  return [x / size, y / size, 1 / size];
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const times = (m, v) => m.map(row => dot(row, v));
const product = (m, n) => m.map(row => [0, 1, 2].map(k => row[0] * n[0][k] + row[1] * n[1][k] + row[2] * n[2][k]));
const across = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = v => v.map(one => one / Math.hypot(...v));

function turn([x, y, z]) {  // the matrix of a rotation vector
  const angle = Math.hypot(x, y, z), s = angle ? Math.sin(angle) / angle : 1, c = angle ? (1 - Math.cos(angle)) / angle ** 2 : .5;
  return [[1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y], [c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x], [c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)]];
}

function byTwo(a, b) {  // the rotation by which the directions of two points become their rays
  const axes = (one, other) => { const n = unit(across(one, other)); return [one, n, across(one, n)]; };
  const camera = axes(a.ray, b.ray), local = axes(a.to, b.to);
  return [0, 1, 2].map(i => [0, 1, 2].map(k => camera[0][i] * local[0][k] + camera[1][i] * local[1][k] + camera[2][i] * local[2][k]));
}

function offsets(lens, points, rotation) {  // picked less computed, each by the root of its readings
  const out = [];
  for (const { u, v, n, to } of points) {
    const at = project(lens, times(rotation, to));
    if (!at) return null;
    out.push(Math.sqrt(n) * (u - at[0]), Math.sqrt(n) * (v - at[1]));
  }
  return out;
}

const pairs = list => list.flatMap((a, k) => list.slice(k + 1).map(b => [a, b]));
const squares = values => values ? values.reduce((sum, one) => sum + one * one, 0) : Infinity;

function solve(lens, points) {  // least squares of the pixels by Gauss and Newton, from the best two points
  let best = null, cost = Infinity;
  for (const [a, b] of pairs(points.slice(0, MOST_STARTS))) {
    const tried = byTwo(a, b), own = squares(offsets(lens, points, tried));
    if (own < cost) [best, cost] = [tried, own];
  }
  for (let pass = 0, damping = 1e-6; best && pass < 100 && damping < 1e12; pass += 1) {
    const now = offsets(lens, points, best), h = 1e-5;
    const by = [0, 1, 2].map(axis => [h, -h].map(step => offsets(lens, points, product(turn([0, 1, 2].map(one => one === axis ? step : 0)), best))));
    if (by.flat().includes(null)) break;
    const slope = by.map(([more, less]) => more.map((one, k) => (one - less[k]) / (2 * h)));
    const normal = slope.map((a, i) => slope.map((b, k) => a.reduce((sum, one, m) => sum + one * b[m], 0) * (i === k ? 1 + damping : 1)));
    const right = slope.map(a => -a.reduce((sum, one, m) => sum + one * now[m], 0));
    const [p, q, r] = normal, size = dot(p, across(q, r));
    const step = [dot(right, across(q, r)) / size, dot(right, across(r, p)) / size, dot(right, across(p, q)) / size];
    const tried = product(turn(step), best), own = squares(offsets(lens, points, tried)), small = Math.hypot(...step) < 1e-8;
    if (own <= cost || small) [best, cost, damping] = [tried, own, damping / 10]; else damping *= 10;
    if (small) break;
  }
  return best && Number.isFinite(cost) ? { rotation: best, off: Math.sqrt(cost / Math.max(2 * points.length - 3, 1)) } : null;
}

function predict(at) {  // all landmarks of a frame from two picks on, and the exchange of two that explains residuals
  const { to, lens: which } = data.frames[at];
  if (!to) return [null, null];
  const lens = data.lenses[which], directions = new Map(data.sighted.map((name, k) => [name, to[k]]));
  const points = names.map(name => mean(at, name)).filter(one => one && directions.get(one.name)).map(one => ({ ...one, to: directions.get(one.name), ray: ray(lens, one.u, one.v) })).filter(one => one.ray.every(Number.isFinite));
  if (points.length < 2) return [null, null];
  const solved = solve(lens, points);
  let better = null;
  if (points.length > 2 && !(solved && solved.off < DOUBTED * data.sigma)) {
    const off = one => { const at = solved && project(lens, times(solved.rotation, one.to)); return at ? Math.hypot(one.u - at[0], one.v - at[1]) : Infinity; };
    const worst = points.toSorted((a, b) => off(b) === off(a) ? 0 : off(b) - off(a)).slice(0, MOST_EXCHANGED);
    for (const [a, b] of pairs(worst)) {
      const tried = solve(lens, points.map(one => one === a ? { ...one, to: b.to } : one === b ? { ...one, to: a.to } : one));
      if (tried && tried.off * BETTER < (solved ? solved.off : Infinity) && !(better && better.off <= tried.off)) better = { pair: [a.name, b.name], off: tried.off };
    }
  }
  if (!solved) return [null, better];
  const places = new Map([...directions].filter(([, one]) => one).map(([name, one]) => [name, project(lens, times(solved.rotation, one))]).filter(([, one]) => one));
  const residuals = new Map(points.map(one => [one.name, Math.hypot(one.u - places.get(one.name)[0], one.v - places.get(one.name)[1])]));
  return [{ ...solved, count: points.length, places, residuals }, better];
}

function told() {
  if (!data.sighted.length) return data.unpredicted ? "nothing is predicted: " + data.unpredicted : "";
  if (!data.frames[frame].to.some(Boolean)) return "the track has no position for this frame: nothing is predicted";
  if (!seen && !exchange) return "two picks predict the other landmarks";
  const held = `camera position and lens held${data.leftOut ? ", " + data.leftOut + " left out" : ""}`;
  const start = seen ? `rotation alone fitted to ${seen.count} landmarks, ${held}` : "no rotation shows all these landmarks";
  const rest = seen && seen.count > 2 ? `; residuals are ${px(seen.off)} in u and in v` : "";
  return start + rest + (exchange ? `, and ${px(exchange.off)} with ${exchange.pair.join(" and ")} exchanged` : "");
}

// The frame and what is drawn on it

function choose(next) {
  if (next < 0 || next >= data.frames.length || next === frame) return;
  frame = next;
  if (picture) picture.close();  // one frame is decoded at a time
  picture = null;
  const bytes = Uint8Array.from(atob(part("image" + next).textContent), one => one.charCodeAt(0));
  createImageBitmap(new Blob([bytes], { type: "image/jpeg" })).then(made => {
    if (frame !== next || picture) return made.close();  // too late, or once more
    picture = made;
    fit();
  }, () => { part("where").textContent = "the image cannot be shown"; });
  show();
}

function resize() {
  const box = canvas.parentElement.getBoundingClientRect(), dense = devicePixelRatio;
  for (const [one, width, height] of [[canvas, box.width, box.height], [loupe, LOUPE_SIZE, LOUPE_SIZE]]) {
    one.width = Math.floor(width * dense);
    one.height = Math.floor(height * dense);
    one.style.width = one.width / dense + "px";
    one.style.height = one.height / dense + "px";
  }
}

function fit() {
  resize();
  const { width, height } = data.frames[frame];
  const scale = Math.min(canvas.width / width, canvas.height / height, DEEPEST);
  view = { scale, x: Math.round((canvas.width - width * scale) / 2), y: Math.round((canvas.height - height * scale) / 2) };
  cross = [(width - 1) / 2, (height - 1) / 2];
  aim();
  draw();
}

function zoom(times, [u, v] = cross) {
  const whole = Math.min(canvas.width / data.frames[frame].width, canvas.height / data.frames[frame].height, 1);
  const levels = [whole, ...[1, 2, 4, 8, DEEPEST].filter(one => one > whole)];
  const scale = times > 0 ? levels.find(one => one > view.scale * 1.001) ?? levels.at(-1) : levels.findLast(one => one < view.scale * .999) ?? whole;
  const [x, y] = on(u, v);
  view = { scale, x: Math.round(x - (u + .5) * scale), y: Math.round(y - (v + .5) * scale) };
  draw();
}

const on = (u, v) => [view.x + (u + .5) * view.scale, view.y + (v + .5) * view.scale];

function at(event) {  // a pointer stands on a device pixel, whose centre is meant
  const box = canvas.getBoundingClientRect(), dense = devicePixelRatio;
  const device = edge => Math.floor(edge * dense + 1e-3) + .5;
  return [(device(event.clientX - box.left) - view.x) / view.scale - .5, (device(event.clientY - box.top) - view.y) / view.scale - .5];
}

function draw() {
  const pen = canvas.getContext("2d"), { width, height } = data.frames[frame];
  pen.clearRect(0, 0, canvas.width, canvas.height);
  if (picture) {
    pen.imageSmoothingEnabled = view.scale < 1;
    pen.imageSmoothingQuality = "high";
    pen.drawImage(picture, view.x, view.y, width * view.scale, height * view.scale);
  }
  const unit = devicePixelRatio;
  pen.font = 12 * unit + "px system-ui, sans-serif";
  for (const [k, name] of names.entries()) {
    const at = expected(name), own = mean(frame, name), chosen = k === landmark;
    if (!own && (!at || isHidden(frame, name))) continue;
    const [x, y] = own ? on(own.u, own.v) : on(...at), off = own ? residual(name) : undefined, doubted = off > DOUBTED * data.sigma;
    const colour = chosen ? "#ff0" : doubted ? "#fa0" : own ? "#0ff" : "#fff";
    if (own) {
      for (const one of readings(frame, name)) mark(pen, ...on(one.u, one.v), 9 * unit, colour);
      if (off !== undefined) line(pen, [x, y], on(...at));
    } else {
      pen.fillStyle = pen.strokeStyle = colour;
      pen.setLineDash([3 * unit, 3 * unit]);
      pen.beginPath();
      pen.arc(x, y, 9 * unit, 0, 2 * Math.PI);
      pen.stroke();
      pen.setLineDash([]);
    }
    const text = off !== undefined ? `${name}  ${px(off)}` : own ? name : name + "?";
    const right = x + 15 * unit + pen.measureText(text).width < canvas.width, beside = [x + (right ? 11 : -11) * unit, y - 6 * unit];
    pen.textAlign = right ? "left" : "right";
    pen.lineWidth = 3 * unit;
    pen.strokeStyle = "#000a";
    pen.strokeText(text, ...beside);
    pen.fillText(text, ...beside);
  }
  mark(pen, ...on(...cross), Math.max(canvas.width, canvas.height), "#fff8");
  const [x, y] = on(...cross), room = (LOUPE_SIZE + 16) * unit;
  loupe.classList.toggle("left", x > canvas.width - room && y < room);
  const glass = loupe.getContext("2d"), size = loupe.width, times = LOUPE * unit;
  glass.fillStyle = "#333";
  glass.fillRect(0, 0, size, size);
  glass.imageSmoothingEnabled = false;
  if (picture) glass.drawImage(picture, size / 2 - (cross[0] + .5) * times, size / 2 - (cross[1] + .5) * times, width * times, height * times);
  mark(glass, size / 2, size / 2, size, "#ff08");
  part("where").textContent = `u ${cross[0].toFixed(2)}  v ${cross[1].toFixed(2)}  zoom ${+view.scale.toFixed(3)}`;
}

function mark(pen, x, y, length, colour) {
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = Math.max(1, Math.round(devicePixelRatio));
  pen.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    pen.moveTo(x + 2 * dx, y + 2 * dy);
    pen.lineTo(x + length * dx, y + length * dy);
  }
  pen.stroke();
}

function line(pen, from, to) {
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
}

const residual = name => seen && seen.count > 2 ? seen.residuals.get(name) : undefined;

function status(name) {  // what is known of a landmark in this frame, in words and signs
  const own = mean(frame, name), at = seen && seen.places.get(name);
  if (!own) return isHidden(frame, name) ? "hidden" : !seen || !data.sighted.includes(name) ? "" : !at ? "not in view" : inside(at) ? "?" : "outside";
  const off = residual(name);
  return [data.deck ? own.n + " of 3" : "●".repeat(Math.min(own.n, 3)) + (own.n > 3 ? own.n : ""), own.n > 1 ? "± " + px(own.spread) : "",
    off === undefined ? "" : (off > DOUBTED * data.sigma ? "! " : "") + px(off)].filter(Boolean).join(" ");
}

function show() {
  [seen, exchange] = predict(frame);
  part("fit").textContent = told();
  part("exchange").hidden = !exchange;
  if (exchange) part("exchange").textContent = `exchange ${exchange.pair.join(" and ")}`;
  const list = part("landmarks");
  list.replaceChildren(...names.map((name, k) => {
    const row = document.createElement("li"), button = document.createElement("button"), count = document.createElement("span");
    button.textContent = name;
    button.setAttribute("aria-pressed", k === landmark);
    button.addEventListener("click", () => select(k));
    count.textContent = status(name);
    button.append(count);
    row.append(button);
    return row;
  }));
  for (const [k, row] of [...part("frame").options].entries()) {
    const own = new Set(picks.filter(one => one.frame === k).map(one => one.landmark)).size;
    row.textContent = data.frames[k].title + (own ? `  (${own})` : "");
  }
  part("frame").value = frame;
  const film = data.deck && cards(), text = film ? film.text : table();
  if (film) part("fit").textContent = film.missing.length ? `${film.missing[0]}${film.missing.length > 1 ? `, and ${film.missing.length - 1} more to be read` : ""}` : "all that is read has its three readings";
  part("csv").value = text;
  const address = part("save");
  URL.revokeObjectURL(address.href);
  address.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  draw();
}

function select(next) {
  if (!names.length) return;
  landmark = (next + names.length) % names.length;
  aim();
  show();
}

function aim() {  // the cross at the landmark's pick, or where it is predicted
  const name = names[landmark], own = readings(frame, name).at(-1), at = expected(name);
  if (own) cross = [own.u, own.v];
  else if (at && inside(at)) cross = at;
}

function expected(name) {  // where a landmark should be: by the frame's picks, or as the solve of all frames has it
  const place = data.places.find(one => same(one, frame, name));
  return seen && seen.places.get(name) || place && place.near;
}

const inside = ([u, v]) => u > -.5 && v > -.5 && u < data.frames[frame].width - .5 && v < data.frames[frame].height - .5;

function ask() {  // for the next landmark that has no pick and could be seen, or else the next
  const lacks = name => readings(frame, name).length < (data.deck ? READINGS : 1) && !isHidden(frame, name) && !["outside", "not in view"].includes(status(name));
  const order = names.map((_, k) => (landmark + 1 + k) % names.length);
  select(order.find(k => k !== landmark && lacks(names[k])) ?? landmark + 1);
}

// What a person does

const fingers = new Map();  // that touch the frame; two zoom by their distance

function apart() {  // how far two fingers are
  const [[x, y], [p, q]] = [...fingers.values()];
  return Math.hypot(p - x, q - y);
}

function pinch() {
  const [[x, y], [p, q]] = [...fingers.values()], ratio = apart() / dragged.apart;
  if (ratio > .67 && ratio < 1.5) return;
  zoom(ratio > 1 ? 1 : -1, at({ clientX: (x + p) / 2, clientY: (y + q) / 2 }));
  dragged.apart = apart();
}

canvas.addEventListener("pointerdown", event => {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  if (fingers.size > 1) {
    dragged = { ...dragged, apart: apart(), moved: true };
    return;
  }
  dragged = { x: event.clientX, y: event.clientY, view: { ...view }, moved: event.button !== 0 };
});
canvas.addEventListener("pointermove", event => {
  if (fingers.has(event.pointerId)) fingers.set(event.pointerId, [event.clientX, event.clientY]);
  if (fingers.size > 1) return pinch();
  if (dragged && !dragged.apart) {
    const away = [event.clientX - dragged.x, event.clientY - dragged.y].map(one => Math.round(one * devicePixelRatio));
    dragged.moved ||= Math.hypot(...away) > DRAG * devicePixelRatio;
    if (dragged.moved) view = { ...view, x: dragged.view.x + away[0], y: dragged.view.y + away[1] };
  }
  cross = at(event);
  draw();
});
function lift(event) {  // one finger less; the last ends the drag
  const pressed = dragged;
  fingers.delete(event.pointerId);
  if (!fingers.size) dragged = null;
  return pressed;
}

canvas.addEventListener("pointercancel", lift);
canvas.addEventListener("pointerup", event => {
  const pressed = lift(event);
  if (pressed && !pressed.moved) put(...at(event), event.shiftKey || !!data.deck);
});
canvas.addEventListener("contextmenu", event => event.preventDefault());
canvas.addEventListener("wheel", event => { event.preventDefault(); if (event.deltaY) zoom(-event.deltaY, at(event)); }, { passive: false });

function undo() {
  if (!undone.length) return;
  [picks, hidden] = undone.pop();
  keep();
  show();
}

function remove() {
  const last = readings(frame, names[landmark]).at(-1);
  if (last) change(picks.filter(one => one !== last));
}

function hide() {
  if (!names.length) return;
  const name = names[landmark], own = one => same(one, frame, name);
  change(picks.filter(one => !own(one)), isHidden(frame, name) ? hidden.filter(one => !own(one)) : [...hidden, { frame, landmark: name }]);
}

function repair() {
  if (!exchange) return;
  const [a, b] = exchange.pair, other = { [a]: b, [b]: a };
  change(picks.map(one => one.frame === frame && exchange.pair.includes(one.landmark) ? { ...one, landmark: other[one.landmark] } : one));
}

document.addEventListener("keydown", event => {
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.key !== "PageUp" && event.key !== "PageDown") return;
  if (event.key === "Enter" && event.target !== canvas) return;
  // the browser's own: Alt and Left is the page before, and Command and Left on a Mac
  if (event.altKey || event.metaKey && event.key.toLowerCase() !== "z") return;
  const away = NEAR_KEYS[event.key], held = event.ctrlKey || event.metaKey;
  const letter = held ? "" : event.key.toLowerCase();
  if (away) {
    const step = event.ctrlKey ? 10 : event.shiftKey ? 1 : .1, own = readings(frame, names[landmark]).at(-1);
    const [u, v] = own ? [own.u, own.v] : cross;
    cross = [u + step * away[0], v + step * away[1]];
    if (own) put(...cross); else draw();
  } else if (event.key === "Enter") put(...cross, event.shiftKey || !!data.deck);
  else if (letter === "+" || letter === "=") zoom(1);
  else if (letter === "-") zoom(-1);
  else if (letter === "0") fit();
  else if (event.key === "PageUp") choose(frame - 1);
  else if (event.key === "PageDown") choose(frame + 1);
  else if (letter === "n") ask();
  else if (letter === "h") hide();
  else if (letter === "p") select(landmark - 1);
  else if (event.key === "Delete") remove();
  else if (held && !event.shiftKey && event.key.toLowerCase() === "z") undo();
  else return;
  event.preventDefault();
});
part("add").addEventListener("submit", event => {
  event.preventDefault();
  const name = part("name").value.trim();
  part("name").value = "";
  if (!name) return;
  if (!names.includes(name)) names.push(name);
  keep();
  select(names.indexOf(name));
  canvas.focus();
});
part("frame").addEventListener("change", event => choose(+event.target.value));
part("before").addEventListener("click", () => choose(frame - 1));
part("after").addEventListener("click", () => choose(frame + 1));
part("undo").addEventListener("click", undo);
part("remove").addEventListener("click", remove);
part("hide").addEventListener("click", hide);
part("exchange").addEventListener("click", repair);
addEventListener("resize", () => { resize(); draw(); });

part("frame").append(...data.frames.map((one, k) => new Option(one.title, k)));
part("places").append(...data.places.map(one => {
  const button = document.createElement("button");
  button.textContent = "click here next: " + one.text;
  button.addEventListener("click", () => { choose(one.frame); if (one.landmark) select(names.indexOf(one.landmark)); });
  return button;
}));
if (data.deck) [part("add").hidden, part("save").textContent, part("save").download] = [true, "Save the deck", "read_" + data.deck.name.split("/").at(-1)];
const start = restore();
if (data.places.length && data.places[0].landmark && start === data.places[0].frame) landmark = Math.max(names.indexOf(data.places[0].landmark), 0);
choose(start);
