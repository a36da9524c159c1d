// Controls of the page: buttons, layers, keys.

const LAYER_NAMES = {
  footprint: 'footprint', samples: 'samples', tree: 'tree', chord: 'chord',
  detours: 'path as found', path: 'path',
};
const LAYER_MARKS = {
  footprint: '<path d="M4 3H18V9H4Z" stroke-width="1.5"/>',
  samples: '<path d="M5 8h0M16 4h0" stroke-width="5"/>',
  tree: '<path d="M1 10 11 3 21 9" stroke-width="1" opacity=".6"/>',
  chord: '<path d="M0 6H22" opacity=".55"/><path d="M7 6H15" stroke-width="3.5"/>',
  detours: '<path d="M1 10 7 2 14 10 21 2" stroke-width="1.6" opacity=".75"/>',
  path: '<path d="M1 9 21 3" stroke-width="4"/>',
};

const metres = (a) => `${a.toLocaleString('en', {maximumFractionDigits: a < 100 ? 1 : 0})} m`;
const milliseconds = (s) => `${(1000 * s).toLocaleString('en', {maximumSignificantDigits: 2})} ms`;

function outcome(search) {
  if (!search.path.length) return search.status.toLowerCase().replaceAll('_', ' ');
  if (search.found_length === null || !data.simplify) return metres(search.length);
  return `${metres(search.found_length)} as found, ${metres(search.length)} now`;
}

function addAlgorithm(search) {
  const button = document.createElement('button');
  button.style.setProperty('--colour', search.colour);
  button.dataset.name = search.name;
  button.title = search.message;
  const effort = `${inWords(search.iterations, 'transition')}, ${milliseconds(search.elapsed)}`;
  const lines = [effort, outcome(search), ...search.notes];
  if (search.others.length) lines.push(inWords(search.others.length, 'further path'));
  button.append(
    document.createElement('i'),
    Object.assign(document.createElement('b'), {textContent: search.name}),
    ...lines.map((text) => Object.assign(document.createElement('small'), {textContent: text})),
  );
  button.setAttribute('aria-pressed', search.on);
  button.addEventListener('click', () => {
    search.on = !search.on;
    button.setAttribute('aria-pressed', search.on);
    setTime(time);
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
  box.insertAdjacentHTML('afterend', '<svg viewBox="0 0 22 12" fill="none" stroke="currentColor" '
    + `stroke-linecap="round" aria-hidden="true">${LAYER_MARKS[name]}</svg>`);
  byId('layers').append(label);
}

function addKind([name, colour]) {
  const item = document.createElement('li');
  const mark = document.createElement('i');
  mark.style.background = colour;
  item.append(mark, name);
  byId('kinds').append(item);
}

const wantsMotion = () => !matchMedia('(prefers-reduced-motion: reduce)').matches;

const KEYS = {
  ' ': () => play(!playing),
  ArrowRight: () => step(1),
  ArrowLeft: () => step(-1),
  '+': () => zoom(1.3),
  '-': () => zoom(1 / 1.3),
  0: fit,
};
const MAP_KEYS = {
  ArrowRight: () => pan(STEP, 0),
  ArrowLeft: () => pan(-STEP, 0),
  ArrowUp: () => pan(0, -STEP),
  ArrowDown: () => pan(0, STEP),
};

function pressKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const {key, target} = event;
  // An element with the focus keeps the keys that operate it.
  if (key === ' ' && target.matches('button, summary, [type="checkbox"]')) return;
  if (key.startsWith('Arrow') && target.matches('[type="range"]')) return;
  const act = (target === canvas && MAP_KEYS[key]) || KEYS[key];
  if (!act) return;
  event.preventDefault();
  act();
}

function addControls() {
  const without = data.footprint.length ? 'detours' : 'footprint';
  Object.keys(LAYERS).filter((name) => name !== without).forEach(addLayer);
  byId('panel').open = !NARROW.matches;
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
  addEventListener('keydown', pressKey);
  addEventListener('resize', () => (fitted ? fit() : redraw()));
}
