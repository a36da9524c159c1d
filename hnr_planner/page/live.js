// The start of a page that shows a running node: it gets all it shows by a WebSocket.
//
// A message is the length of its header in four bytes, the header as JSON, and arrays, each of
// which begins at a multiple of eight bytes. `blobs` of the header has type and length of each.

const ARRAYS = {float32: Float32Array, int32: Int32Array, uint8: Uint8Array};
const COLOUR = '#0072B2';
const PATH_COLOUR = '#D55E00';  // another one, since the path lies among samples that unfold
const RETRY = 1000;  // milliseconds from the end of a connection to the next attempt
const STILL = 5;  // a press that moves by no more pixels is a click
const TOOLS = {start: 'set-start', goal: 'set-goal', nothing: 'set-nothing'};
const TOOL_KEYS = {s: 'start', g: 'goal', Escape: 'nothing'};

let socket = null;
let tool = 'nothing';
let from = null;  // the start that was clicked
let pressedAt = null;
let isAwaited = false;  // whether the outcome of a request from a page is still to come
let mapTurn = 0;
let calmAt = -Infinity;  // when the last search will have been there long enough to unfold another

function connect() {
  const address = new URL('live', location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  socket = new WebSocket(address);
  socket.binaryType = 'arraybuffer';
  socket.addEventListener('message', ({data: buffer}) => receive(buffer));
  socket.addEventListener('close', () => {
    showState(false, 'no connection; trying again');
    setTimeout(connect, RETRY);
  });
}

function receive(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const message = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  let at = 4 + size;
  const arrays = message.blobs.map(([type, length]) => {
    const array = new ARRAYS[type](buffer, at, length);
    at += 8 * Math.ceil(array.byteLength / 8);
    return array;
  });
  RECEIVERS[message.kind](message, arrays);
}

const RECEIVERS = {
  node({name, runs}) {
    const can = data.requests ? 'clicks plan' : 'to look at only';
    showState(runs, runs ? `${name} runs; ${can}` : `${name} does not run`);
    if (!runs && isAwaited) RECEIVERS.refused({why: `${name} has ended`});
  },

  async map({map}, [png]) {
    const turn = ++mapTurn;
    const next = await createImageBitmap(new Blob([png], {type: 'image/png'}));
    if (turn !== mapTurn) return;  // a newer map has come
    image = next;
    data.map = map;
    byId('kinds').replaceChildren();
    map.kinds.forEach(addKind);
    if (fitted) fit();
    redraw();
  },

  search(message, paths) {
    if (!searches.length || searches[0].stamp !== message.stamp) showSearch(message, paths);
    byId('notice').textContent = message.notice;
  },

  samples({stamp, notes}, [samples, parents]) {
    const [search] = searches;
    if (!search || search.stamp !== stamp) return;
    Object.assign(search, {samples, parents, notes});
    listSearch();
    // Searches that follow each other quickly would all be seen at their beginning only.
    const unfolds = byId('unfold').checked && parents.length > 1 && performance.now() > calmAt;
    calmAt = performance.now() + 1000 * seconds;
    setTime(unfolds ? 0 : 1);
    play(unfolds);
  },

  request({start, goal}) {
    Object.assign(data, {start, goal});
    isAwaited = true;
    reply('planning');
    redraw();
  },

  refused({why}) {
    isAwaited = false;
    reply(why);
  },
};

function showState(runs, words) {
  byId('state').className = runs ? 'runs' : '';
  document.querySelector('#state span').textContent = words;
}

function reply(words) {
  byId('reply').textContent = words;
}

function showSearch({stamp, status, caller, why, values}, arrays) {
  const [path = [], ...others] = arrays.map(pairs);
  searches = [{
    stamp, status, path, others,
    name: values.algorithm,
    about: why,
    message: why,
    notes: [],
    colour: COLOUR,
    path_colour: PATH_COLOUR,
    on: true,
    iterations: finite(values.iterations) ?? 0,
    elapsed: finite(values.elapsed) ?? 0,
    samples: new Float32Array(),
    parents: new Int32Array(),
    chords: [],
    found: [],
    found_length: finite(values.first_solution_length),
    length: finite(values.length),
  }];
  if (path.length) Object.assign(data, {start: path[0], goal: path.at(-1)});
  else if (!isAwaited) Object.assign(data, {start: null, goal: null});
  isAwaited = false;
  reply('');
  byId('outcome').hidden = false;
  document.querySelector('#outcome b').textContent = status;
  document.querySelector('#outcome small').textContent = `${caller}, ${clock(stamp)}`;
  byId('why').textContent = why;
  byId('values').replaceChildren(...Object.entries(values).flatMap(([name, value]) => [
    Object.assign(document.createElement('dt'), {textContent: name.replaceAll('_', ' ')}),
    Object.assign(document.createElement('dd'), {textContent: value}),
  ]));
  listSearch();
  play(false);
  setTime(1);
}

function listSearch() {
  byId('algorithms').replaceChildren();
  searches.forEach(addAlgorithm);
}

function pairs(flat) {
  return Array.from({length: flat.length / 2}, (_, k) => [flat[2 * k], flat[2 * k + 1]]);
}

function finite(text) {
  const value = Number(text ?? NaN);
  return Number.isFinite(value) ? value : null;
}

// The stamp of a message as a time of day, or in seconds where a simulation begins at 0.
function clock(stamp) {
  const at = Number(stamp);
  return at > 1e9 ? new Date(1000 * at).toLocaleTimeString() : `${at.toFixed(2)} s`;
}

function take(name) {
  tool = name;
  for (const [other, id] of Object.entries(TOOLS)) {
    byId(id).setAttribute('aria-pressed', other === name);
  }
  canvas.classList.toggle('sets', name !== 'nothing');
}

function click(event) {
  const [x, y] = pressedAt ?? [Infinity, Infinity];
  pressedAt = null;
  if (tool === 'nothing' || Math.hypot(event.offsetX - x, event.offsetY - y) > STILL) return;
  const point = toMap(event.offsetX, event.offsetY);
  if (tool === 'start') {
    from = point;
    Object.assign(data, {start: point, goal: null});
    take('goal');
    reply('Click the goal.');
    redraw();
  } else if (!(from ?? data.start)) {
    reply('Click a start first.');
    take('start');
  } else if (socket.readyState === WebSocket.OPEN) {
    socket.send(JSON.stringify({kind: 'plan', start: from ?? data.start, goal: point}));
  }
}

function addRequests() {
  byId('request').hidden = false;
  for (const [name, id] of Object.entries(TOOLS)) {
    byId(id).addEventListener('click', () => take(name));
  }
  canvas.addEventListener('pointerdown', (event) => {
    pressedAt = fingers.size > 1 ? null : [event.offsetX, event.offsetY];
  });
  canvas.addEventListener('pointerup', click);
  addEventListener('dblclick', (event) => {
    if (tool !== 'nothing') event.stopPropagation();  // two clicks are no wish for the whole map
  }, {capture: true});
  addEventListener('keydown', (event) => {
    if (TOOL_KEYS[event.key] && !event.ctrlKey && !event.altKey && !event.metaKey) {
      take(TOOL_KEYS[event.key]);
    }
  });
  take('start');
}

delete LAYERS.detours;  // the path as found is not published
LAYER_NAMES.chord = 'newest step';
seconds = 5;
byId('unfold').checked = wantsMotion();
if (data.requests) addRequests();
addControls();
setTime(1);
connect();
