// Moving the view: by pointers, wheel and keys.

const NARROW = matchMedia('(max-width: 720px)');
const STEP = 60;  // pixels that an arrow moves the map
let view = {x: 0, y: 0, scale: 1};  // the point in the middle [m], and pixels for each metre
let fitted = true;  // whether nobody has moved the view

// Show the whole map in the area that the panel and the caption leave free.
function fit() {
  if (!data.map) return;
  const [[left, low], [right, high]] = data.map.box;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const panel = byId('panel');
  const beside = NARROW.matches ? 0 : panel.offsetWidth + 24;
  const above = NARROW.matches ? panel.querySelector('summary').offsetHeight + 30 : 8;
  const below = NARROW.matches ? 84 : 56;
  const [roomX, roomY] = [width - beside, height - above - below];
  const scale = 0.97 * Math.min(roomX / (right - left), roomY / (high - low));
  view = {
    x: (left + right + beside / scale) / 2,
    y: (low + high + (above - below) / scale) / 2,
    scale,
  };
  fitted = true;
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
  fitted = false;
  redraw();
}

// Move the view by pixels, y down.
function pan(x, y) {
  view.x += x / view.scale;
  view.y -= y / view.scale;
  fitted = false;
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
    pan(before[0] - x, before[1] - y);
  } else {
    const [otherX, otherY] = [...fingers].find(([id]) => id !== event.pointerId)[1];
    const apart = Math.hypot(before[0] - otherX, before[1] - otherY);
    if (apart > 0) zoom(Math.hypot(x - otherX, y - otherY) / apart, otherX, otherY);
  }
}
