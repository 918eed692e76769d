"use strict";
// Picks of landmarks in frames. u counts to the right and v down from the centre of the first pixel.
const data = JSON.parse(document.getElementById("data").textContent);
const part = id => document.getElementById(id);
const canvas = part("view"), loupe = part("loupe"), picture = new Image();
const DEEPEST = 16, LOUPE = 8, LOUPE_SIZE = 168, DRAG = 4, NEAR_KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const place = "vopd pick " + data.key;
let names = data.landmarks.slice(), picks = data.picks, undone = [], frame = -1, landmark = 0;
let view = { scale: 1, x: 0, y: 0 };  // device pixels a pixel, and of the frame's corner
let cross = [0, 0], ready = false, dragged = null;

// What is kept: in the browser's own storage after each change, so that closing the page loses nothing

function restore() {
  try {
    const kept = JSON.parse(localStorage.getItem(place));
    if (!kept || !kept.picks.length) return;
    ({ names, picks } = kept);
    part("kept").textContent = picks.length + (picks.length === 1 ? " pick" : " picks") + " restored";
  } catch { /* no storage, or not of this page */ }
}

function keep() {
  try {
    localStorage.setItem(place, JSON.stringify({ names, picks }));
    part("kept").textContent = "kept in this browser; save the file when done";
  } catch {
    part("kept").textContent = "this browser keeps nothing: save the file before you close the page";
  }
}

function change(next) {
  undone.push(picks);
  picks = next;
  keep();
  show();
}

const found = (at, name) => picks.find(one => one.frame === at && one.landmark === name);

function put(u, v) {
  if (!names.length) return part("name").focus();
  const { width, height } = data.frames[frame];
  const own = { frame, landmark: names[landmark], u: Math.min(Math.max(u, -.5), width - .5), v: Math.min(Math.max(v, -.5), height - .5) };
  cross = [own.u, own.v];
  change([...picks.filter(one => one.frame !== frame || one.landmark !== own.landmark), own]);
}

// The file

const cell = text => /[",\n\r]|^\s|\s$|^#/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;

function table() {
  const order = [...picks].sort((a, b) => a.frame - b.frame || names.indexOf(a.landmark) - names.indexOf(b.landmark));
  const rows = order.map(one => [cell(data.frames[one.frame].name), cell(one.landmark), one.u.toFixed(2), one.v.toFixed(2)].join(","));
  return [data.head, data.column + ",landmark,u_px,v_px", ...rows, ""].join("\n");
}

// The frame and what is drawn on it

function choose(next) {
  if (next < 0 || next >= data.frames.length || next === frame) return;
  frame = next;
  ready = false;
  picture.src = "data:image/jpeg;base64," + part("image" + frame).textContent;
  picture.decode().then(() => { ready = true; fit(); }, () => { part("where").textContent = "the image cannot be shown"; });
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
  const own = names.length && found(frame, names[landmark]);
  cross = own ? [own.u, own.v] : [(width - 1) / 2, (height - 1) / 2];
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
  if (ready) {
    pen.imageSmoothingEnabled = view.scale < 1;
    pen.drawImage(picture, view.x, view.y, width * view.scale, height * view.scale);
  }
  const unit = devicePixelRatio;
  pen.font = 12 * unit + "px system-ui, sans-serif";
  for (const one of picks.filter(one => one.frame === frame)) {
    mark(pen, ...on(one.u, one.v), 9 * unit, one.landmark === names[landmark] ? "#ff0" : "#0ff");
    pen.fillText(one.landmark, on(one.u, one.v)[0] + 11 * unit, on(one.u, one.v)[1] - 6 * unit);
  }
  mark(pen, ...on(...cross), Math.max(canvas.width, canvas.height), "#fff8");
  const glass = loupe.getContext("2d"), size = loupe.width, times = LOUPE * unit;
  glass.fillStyle = "#333";
  glass.fillRect(0, 0, size, size);
  glass.imageSmoothingEnabled = false;
  if (ready) glass.drawImage(picture, size / 2 - (cross[0] + .5) * times, size / 2 - (cross[1] + .5) * times, width * times, height * times);
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

function show() {
  const list = part("landmarks");
  list.replaceChildren(...names.map((name, k) => {
    const row = document.createElement("li"), button = document.createElement("button"), count = document.createElement("span");
    button.textContent = name;
    button.setAttribute("aria-pressed", k === landmark);
    button.addEventListener("click", () => select(k));
    count.textContent = found(frame, name) ? "●" : "";
    count.title = "picked in this frame";
    button.append(count);
    row.append(button);
    return row;
  }));
  for (const [k, row] of [...part("frame").options].entries()) {
    const own = picks.filter(one => one.frame === k).length;
    row.textContent = data.frames[k].title + (own ? `  (${own})` : "");
  }
  part("frame").value = frame;
  part("csv").value = table();
  const address = part("save");
  URL.revokeObjectURL(address.href);
  address.href = URL.createObjectURL(new Blob([table()], { type: "text/csv" }));
  draw();
}

function select(next) {
  if (!names.length) return;
  landmark = (next + names.length) % names.length;
  const own = found(frame, names[landmark]);
  if (own) cross = [own.u, own.v];
  show();
}

// What a person does

canvas.addEventListener("pointerdown", event => {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  dragged = { x: event.clientX, y: event.clientY, view: { ...view }, moved: event.button !== 0 };
});
canvas.addEventListener("pointermove", event => {
  if (dragged) {
    const away = [event.clientX - dragged.x, event.clientY - dragged.y].map(one => Math.round(one * devicePixelRatio));
    dragged.moved ||= Math.hypot(...away) > DRAG * devicePixelRatio;
    if (dragged.moved) view = { ...view, x: dragged.view.x + away[0], y: dragged.view.y + away[1] };
  }
  cross = at(event);
  draw();
});
canvas.addEventListener("pointerup", event => {
  const pressed = dragged;
  dragged = null;
  if (pressed && !pressed.moved) put(...at(event));
});
canvas.addEventListener("contextmenu", event => event.preventDefault());
canvas.addEventListener("wheel", event => { event.preventDefault(); zoom(-event.deltaY, at(event)); }, { passive: false });

function undo() {
  if (!undone.length) return;
  picks = undone.pop();
  keep();
  show();
}

const remove = () => found(frame, names[landmark]) && change(picks.filter(one => one.frame !== frame || one.landmark !== names[landmark]));

document.addEventListener("keydown", event => {
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.key !== "PageUp" && event.key !== "PageDown") return;
  if (event.key === "Enter" && event.target !== canvas) return;
  const away = NEAR_KEYS[event.key];
  if (away) {
    const step = event.ctrlKey ? 10 : event.shiftKey ? 1 : .1, own = names.length && found(frame, names[landmark]);
    const [u, v] = own ? [own.u, own.v] : cross;
    cross = [u + step * away[0], v + step * away[1]];
    if (own) put(...cross); else draw();
  } else if (event.key === "Enter") put(...cross);
  else if (event.key === "+" || event.key === "=") zoom(1);
  else if (event.key === "-") zoom(-1);
  else if (event.key === "0") fit();
  else if (event.key === "PageUp") choose(frame - 1);
  else if (event.key === "PageDown") choose(frame + 1);
  else if (event.key === "n") select(landmark + 1);
  else if (event.key === "p") select(landmark - 1);
  else if (event.key === "Delete") remove();
  else if (event.key === "z" && (event.ctrlKey || event.metaKey)) undo();
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
addEventListener("resize", () => { resize(); draw(); });

part("frame").append(...data.frames.map((one, k) => new Option(one.title, k)));
restore();
choose(0);
