// Draw the canvas: the map, the searches up to the time shown, and the paths.

const MANY = 4000;
const LAYERS = {
  footprint: true, samples: true, tree: true, chord: true, detours: true, path: true,
};
const MOST_OUTLINES = 40;
const NICE_LENGTHS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

const canvas = byId('view');
const context = canvas.getContext('2d');
let image = new Image();
let drawing = false;

function redraw() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => { drawing = false; draw(); });
}

function draw() {
  const dots = window.devicePixelRatio || 1;
  const {clientWidth: width, clientHeight: height} = canvas;
  const [columns, rows] = [Math.round(width * dots), Math.round(height * dots)];
  if (canvas.width !== columns || canvas.height !== rows) {
    canvas.width = columns;
    canvas.height = rows;
  }
  context.setTransform(dots, 0, 0, dots, 0, 0);
  context.clearRect(0, 0, width, height);
  // From here on the unit is the metre, and y points up.
  context.translate(width / 2, height / 2);
  context.scale(view.scale, -view.scale);
  context.translate(-view.x, -view.y);
  context.lineJoin = context.lineCap = 'round';

  drawMap();
  const on = shown();
  if (LAYERS.footprint) for (const search of on) drawSweep(search);
  for (const search of on) {
    if (LAYERS.tree) drawTree(search);
    if (LAYERS.samples) drawSamples(search);
  }
  for (const search of on) if (LAYERS.detours) drawDetours(search);
  for (const search of on) {
    if (LAYERS.chord) drawChord(search);
    if (LAYERS.path) drawPath(search);
    if (LAYERS.footprint) drawRobot(search);
  }
  drawEnds();
  drawScale();
}

function drawMap() {
  if (!data.map) return;
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
  const part = partShown();
  if (search.path.length < 2 || part === 0) return;
  const colour = search.path_colour ?? search.colour;
  for (const path of search.others) {
    line(firstPart(path, part));
    stroke('#FFFFFF', 5, 1);
    context.setLineDash([9 / view.scale, 6 / view.scale]);
    stroke(colour, 2.5, 1);
    context.setLineDash([]);
  }
  line(firstPart(search.path, part));
  stroke('#FFFFFF', 7, 1);
  stroke(colour, 4, 1);
}

// The part of a path that is shown now: it is drawn from its start on. The path of a running node
// is shown at once, whatever is still to be seen of its search.
const partShown = () => (data.live ? 1 : Math.min(1, 1.4 * shortened()));

// Add the outline of the footprint at a pose to the path of the context.
function addOutline([x, y, yaw]) {
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
  data.footprint.forEach(([a, b], k) => {
    const to = k ? 'lineTo' : 'moveTo';
    context[to](x + cos * a - sin * b, y + sin * a + cos * b);
  });
  context.closePath();
}

// What the footprint has swept so far, and some of its outlines.
function drawSweep(search) {
  if (!data.footprint.length || search.path.length < 2 || partShown() === 0) return;
  const poses = firstPart(search.path, partShown());
  context.beginPath();
  poses.forEach(addOutline);
  context.fillStyle = search.colour;
  context.globalAlpha = 0.13;
  context.fill('nonzero');
  context.globalAlpha = 1;
  const every = Math.ceil(search.path.length / MOST_OUTLINES);
  context.beginPath();
  poses.filter((_, k) => k % every === 0).forEach(addOutline);
  stroke(search.colour, 1, 0.5);
}

// The robot on its way along the path.
function drawRobot(search) {
  if (!data.footprint.length || search.path.length < 2 || partShown() === 0) return;
  context.beginPath();
  addOutline(firstPart(search.path, partShown()).at(-1));
  context.fillStyle = '#FFFFFF';
  context.globalAlpha = 0.75;
  context.fill();
  stroke(search.colour, 3, 1);
}

function drawEnds() {
  const {start, goal, goal_radius: radius} = data;
  if (radius > 0) {
    context.beginPath();
    context.arc(goal[0], goal[1], radius, 0, 2 * Math.PI);
    stroke('#22262B', 1.5, 0.7);
  }
  if (data.footprint.length) {
    context.beginPath();
    [start, goal].forEach(addOutline);
    stroke('#22262B', 1.5, 0.7);
  }
  if (start) dot(start[0], start[1], 7, '#22262B');
  if (goal) star(goal[0], goal[1], 11);
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

// The first part of a path, by length; in a path of poses a turn by 1 rad counts as 1 m.
function firstPart(path, part) {
  const steps = path.slice(1).map((p, k) => Math.hypot(...p.map((a, axis) => a - path[k][axis])));
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
