'use strict';

// One clock for all searches: time runs from 0 to 1. Until SEARCHED it unfolds the searches, on a
// logarithmic scale, so that the first samples can be followed and the last ones still come; after
// that it shortens the paths.
const SEARCHED = 0.85;
const SECONDS = 14;
const MANY = 4000;
const LAYERS = {samples: true, tree: true, chord: true, detours: true, path: true};
const LAYER_NAMES = {
  samples: 'samples', tree: 'tree', chord: 'chord of the newest',
  detours: 'path as found', path: 'path',
};
const NICE_LENGTHS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

const byId = (id) => document.getElementById(id);
const data = JSON.parse(byId('data').textContent);
const searches = data.searches.map((search) => ({
  ...search,
  samples: unpack(search.samples, Float32Array),
  parents: unpack(search.parents, Int32Array),
  chords: unpack(search.chords, Float32Array),
  on: search.asked || data.searches.length === 1,
}));
const most = Math.max(...searches.map((search) => search.parents.length));

const canvas = byId('view');
const context = canvas.getContext('2d');
const image = new Image();
let time = 0;
let playing = null;  // when it began, and the time it began at
let drawing = false;
let view = {x: 0, y: 0, scale: 1};  // the point in the middle [m], and pixels for each metre

function unpack(text, Kind) {
  return new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

// -- what is shown at a time

function samplesShown(search) {
  const n = Math.round(Math.expm1(Math.min(time / SEARCHED, 1) * Math.log1p(most)));
  return Math.min(Math.max(n, 1), search.parents.length);
}

const shortened = () => Math.max(0, (time - SEARCHED) / (1 - SEARCHED));
const isDone = (search) => samplesShown(search) === search.parents.length;

function setTime(value) {
  time = Math.min(Math.max(value, 0), 1);
  byId('time').value = Math.round(1000 * time);
  const n = Math.max(...searches.map(samplesShown));
  const stage = time === 1 ? 'done' : 'shortening';
  byId('now').value = time > SEARCHED ? stage : `${n.toLocaleString('en')} samples`;
  redraw();
}

function play(start) {
  playing = start ? {since: performance.now(), from: time >= 1 ? 0 : time} : null;
  byId('play').textContent = start ? '\u275A\u275A' : '\u25B6';
  byId('play').setAttribute('aria-label', start ? 'Pause' : 'Play');
  if (start) requestAnimationFrame(tick);
}

function tick(now) {
  if (!playing) return;
  setTime(playing.from + Math.max(0, now - playing.since) / (1000 * SECONDS));
  if (time >= 1) play(false);
  else requestAnimationFrame(tick);
}

// -- drawing

function redraw() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => { drawing = false; draw(); });
}

function draw() {
  const dots = window.devicePixelRatio || 1;
  const {clientWidth: width, clientHeight: height} = canvas;
  if (canvas.width !== width * dots || canvas.height !== height * dots) {
    canvas.width = width * dots;
    canvas.height = height * dots;
  }
  context.setTransform(dots, 0, 0, dots, 0, 0);
  context.clearRect(0, 0, width, height);
  // From here on the unit is the metre, and y points up.
  context.translate(width / 2, height / 2);
  context.scale(view.scale, -view.scale);
  context.translate(-view.x, -view.y);
  context.lineJoin = context.lineCap = 'round';

  drawMap();
  const shown = searches.filter((search) => search.on);
  for (const search of shown) {
    if (LAYERS.tree) drawTree(search);
    if (LAYERS.samples) drawSamples(search);
  }
  for (const search of shown) if (LAYERS.detours) drawDetours(search);
  for (const search of shown) {
    if (LAYERS.chord) drawChord(search);
    if (LAYERS.path) drawPath(search);
  }
  drawEnds();
  drawScale();
}

function drawMap() {
  const {origin: [x, y, yaw], resolution} = data.map;
  context.save();
  context.translate(x, y);
  context.rotate(yaw);
  context.scale(resolution, resolution);
  context.imageSmoothingEnabled = view.scale * resolution < 1;
  context.drawImage(image, 0, 0);
  context.restore();
}

function drawTree(search) {
  const {samples, parents, colour} = search;
  const n = samplesShown(search);
  context.beginPath();
  for (let k = 1; k < n; k++) {
    const parent = parents[k];
    if (parent < 0) continue;
    context.moveTo(samples[2 * parent], samples[2 * parent + 1]);
    context.lineTo(samples[2 * k], samples[2 * k + 1]);
  }
  context.strokeStyle = colour;
  context.globalAlpha = Math.min(0.5, Math.max(0.06, 160 / n));
  context.lineWidth = 0.8 / view.scale;
  context.stroke();
  context.globalAlpha = 1;
}

function drawSamples(search) {
  const {samples, colour} = search;
  const n = samplesShown(search);
  const radius = Math.min(3.2, Math.max(1, 60 / Math.sqrt(n))) / view.scale;
  context.beginPath();
  for (let k = 0; k < n; k++) {
    const [x, y] = [samples[2 * k], samples[2 * k + 1]];
    if (n > MANY) {
      context.rect(x - radius, y - radius, 2 * radius, 2 * radius);  // much faster than discs
    } else {
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
  }
  context.fillStyle = colour;
  context.globalAlpha = n > MANY ? 0.6 : 0.85;
  context.fill();
  context.globalAlpha = 1;
}

// The chord that the newest sample was drawn on, and the step to it.
function drawChord(search) {
  const {samples, parents, chords, colour} = search;
  const k = samplesShown(search) - 1;
  if (isDone(search) || parents[k] < 0) return;
  if (chords.length) {
    line([[chords[4 * k], chords[4 * k + 1]], [chords[4 * k + 2], chords[4 * k + 3]]]);
    stroke(colour, 1.5, 0.55);
  }
  const [x, y] = [samples[2 * k], samples[2 * k + 1]];
  line([[samples[2 * parents[k]], samples[2 * parents[k] + 1]], [x, y]]);
  stroke(colour, 3.5, 1);
  dot(x, y, 6, colour);
}

function drawDetours(search) {
  if (!isDone(search) || search.found.length < 2) return;
  line(search.found);
  stroke(search.colour, 1.6, 0.75 - 0.5 * shortened());
}

function drawPath(search) {
  if (search.path.length < 2 || shortened() === 0) return;
  line(firstPart(search.path, Math.min(1, 1.4 * shortened())));
  stroke('#FFFFFF', 7, 1);
  stroke(search.colour, 4, 1);
}

function drawEnds() {
  const {start, goal, goal_radius: radius} = data;
  if (radius > 0) {
    context.beginPath();
    context.arc(goal[0], goal[1], radius, 0, 2 * Math.PI);
    stroke('#22262B', 1.5, 0.7);
  }
  dot(start[0], start[1], 7, '#22262B');
  star(goal[0], goal[1], 11);
}

function line(points) {
  context.beginPath();
  points.forEach(([x, y]) => context.lineTo(x, y));
}

function stroke(colour, pixels, alpha) {
  context.strokeStyle = colour;
  context.lineWidth = pixels / view.scale;
  context.globalAlpha = alpha;
  context.stroke();
  context.globalAlpha = 1;
}

function dot(x, y, pixels, colour) {
  context.beginPath();
  context.arc(x, y, pixels / view.scale, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
  stroke('#FFFFFF', 2, 1);
}

function star(x, y, pixels) {
  context.beginPath();
  for (let k = 0; k < 10; k++) {
    const radius = (k % 2 ? 0.45 : 1) * pixels / view.scale;
    const angle = Math.PI / 2 + k * Math.PI / 5;
    context.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
  }
  context.closePath();
  context.fillStyle = '#22262B';
  context.fill();
  stroke('#FFFFFF', 2, 1);
}

// The first part of a path, by length.
function firstPart(path, part) {
  const steps = path.slice(1).map(([x, y], k) => Math.hypot(x - path[k][0], y - path[k][1]));
  let left = part * steps.reduce((sum, step) => sum + step, 0);
  const points = [path[0]];
  for (let k = 0; k < steps.length && left > 0; k++) {
    const s = Math.min(1, left / (steps[k] || 1));
    points.push(path[k].map((a, axis) => a + s * (path[k + 1][axis] - a)));
    left -= steps[k];
  }
  return points;
}

function drawScale() {
  const length = NICE_LENGTHS.find((metres) => metres * view.scale > 60) || 10000;
  document.querySelector('#scale i').style.width = `${length * view.scale}px`;
  document.querySelector('#scale b').textContent = `${length} m`;
}

// -- moving the view

function fit() {
  const [[left, low], [right, high]] = data.map.box;
  // Beside the panel where there is room for both.
  const panel = canvas.clientWidth > 900 ? byId('panel').offsetWidth + 24 : 0;
  const [width, height] = [canvas.clientWidth - panel, canvas.clientHeight];
  const scale = 0.95 * Math.min(width / (right - left), height / (high - low));
  view = {x: (left + right + panel / scale) / 2, y: (low + high) / 2, scale};
  redraw();
}

function toMap(x, y) {
  return [
    view.x + (x - canvas.clientWidth / 2) / view.scale,
    view.y - (y - canvas.clientHeight / 2) / view.scale,
  ];
}

// Zoom, and keep the point of the map below a point of the screen where it is.
function zoom(factor, x = canvas.clientWidth / 2, y = canvas.clientHeight / 2) {
  const [mapX, mapY] = toMap(x, y);
  const scale = Math.min(Math.max(view.scale * factor, 0.2), 20000);
  const ratio = view.scale / scale;
  view = {x: mapX + ratio * (view.x - mapX), y: mapY + ratio * (view.y - mapY), scale};
  redraw();
}

const fingers = new Map();

function press(event) {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
}

function drag(event) {
  const [x, y] = [event.offsetX, event.offsetY];
  byId('place').textContent = toMap(x, y).map((a) => a.toFixed(2)).join(', ') + ' m';
  const before = fingers.get(event.pointerId);
  if (!before) return;
  fingers.set(event.pointerId, [x, y]);
  if (fingers.size === 1) {
    view.x -= (x - before[0]) / view.scale;
    view.y += (y - before[1]) / view.scale;
  } else {
    const [otherX, otherY] = [...fingers].find(([id]) => id !== event.pointerId)[1];
    const apart = Math.hypot(before[0] - otherX, before[1] - otherY);
    if (apart > 0) zoom(Math.hypot(x - otherX, y - otherY) / apart, otherX, otherY);
  }
  redraw();
}

// -- what can be switched

const metres = (a) => `${a.toLocaleString('en', {maximumFractionDigits: a < 100 ? 1 : 0})} m`;

function outcome(search) {
  if (!search.path.length) return search.status.toLowerCase().replace('_', ' ');
  return `${metres(search.found_length ?? search.length)} found, ${metres(search.length)} shortened`;
}

function addAlgorithm(search) {
  const button = document.createElement('button');
  button.style.setProperty('--colour', search.colour);
  button.dataset.name = search.name;
  button.title = search.message;
  const lines = [`${search.iterations.toLocaleString('en')} transitions`, outcome(search)];
  if (search.left_out) {
    lines.push(`the first ${search.parents.length.toLocaleString('en')} samples are shown`);
  }
  button.append(
    document.createElement('i'),
    Object.assign(document.createElement('b'), {textContent: search.name}),
    ...lines.map((text) => Object.assign(document.createElement('small'), {textContent: text})),
  );
  button.setAttribute('aria-pressed', search.on);
  button.addEventListener('click', () => {
    search.on = !search.on;
    button.setAttribute('aria-pressed', search.on);
    redraw();
  });
  const item = document.createElement('li');
  item.append(button);
  byId('algorithms').append(item);
}

function addLayer(name) {
  const label = document.createElement('label');
  const box = Object.assign(document.createElement('input'), {type: 'checkbox', checked: true});
  box.name = name;
  box.addEventListener('change', () => { LAYERS[name] = box.checked; redraw(); });
  label.append(box, LAYER_NAMES[name]);
  byId('layers').append(label);
}

const KEYS = {
  ' ': () => play(!playing),
  ArrowRight: () => { play(false); setTime(time + 0.005); },
  ArrowLeft: () => { play(false); setTime(time - 0.005); },
  '+': () => zoom(1.3),
  '-': () => zoom(1 / 1.3),
  0: fit,
};

function begin() {
  const [from, to] = [data.start, data.goal].map((p) => p.map((a) => +a.toFixed(2)).join(', '));
  byId('request').textContent = `\u25CF (${from}) to \u2605 (${to}), robot radius ${data.robot_radius} m, `
    + `seed ${data.seed}`;
  searches.forEach(addAlgorithm);
  Object.keys(LAYERS).forEach(addLayer);
  byId('play').addEventListener('click', () => play(!playing));
  byId('time').addEventListener('input', (event) => {
    play(false);
    setTime(event.target.value / 1000);
  });
  byId('nearer').addEventListener('click', () => zoom(1.3));
  byId('farther').addEventListener('click', () => zoom(1 / 1.3));
  byId('fit').addEventListener('click', fit);
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
  }, {passive: false});
  canvas.addEventListener('pointerdown', press);
  canvas.addEventListener('pointermove', drag);
  canvas.addEventListener('pointerup', (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('pointercancel', (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('dblclick', fit);
  addEventListener('keydown', (event) => {
    const act = KEYS[event.key];
    if (!act || event.target.matches('input, button')) return;
    event.preventDefault();
    act();
  });
  addEventListener('resize', fit);
  fit();
  setTime(0);
  play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
}

image.addEventListener('load', begin);
image.src = data.map.image;
