'use strict';

// One clock for all searches: time runs from 0 to 1. Until SEARCHED it unfolds the searches, on a
// logarithmic scale, so that the first samples can be followed and the last ones still come; after
// that it shows what became of the paths.
const SEARCHED = 0.85;

const byId = (id) => document.getElementById(id);
const data = JSON.parse(byId('data').textContent);
let searches = [];

let seconds = 14;  // that time takes from 0 to 1
let time = 0;
let playing = null;  // when it began, and the time it began at

function inWords(count, thing) {
  return `${count.toLocaleString('en')} ${thing}${count === 1 ? '' : 's'}`;
}

const shown = () => searches.filter((search) => search.on);
const most = () => Math.max(1, ...shown().map((search) => search.parents.length));

function samplesAt() {
  return Math.max(1, Math.round(Math.expm1(Math.min(time / SEARCHED, 1) * Math.log1p(most()))));
}

const samplesShown = (search) => Math.min(samplesAt(), search.parents.length);
const shortened = () => Math.max(0, (time - SEARCHED) / (1 - SEARCHED));
const isDone = (search) => samplesShown(search) === search.parents.length;

function setTime(value) {
  time = Math.min(Math.max(value, 0), 1);
  const stage = time === 1 ? 'done' : data.simplify ? 'shortening' : 'found';
  byId('now').value = time > SEARCHED ? stage : inWords(samplesAt(), 'sample');
  byId('time').value = Math.round(1000 * time);
  byId('time').setAttribute('aria-valuetext', byId('now').value);
  byId('caption').textContent = caption();
  redraw();
}

// Return what the page shows at this time, as a sentence.
function caption() {
  const on = shown();
  if (!on.length) return 'Switch an algorithm on to see its search.';
  const [only] = on;
  const isFound = on.some((search) => search.path.length);
  if (time <= SEARCHED) {
    if (on.length === 1) return only.about;
    return 'Each colour is one search: its samples, and a line from each to where it came from.';
  }
  if (on.length === 1 && !isFound) return only.message;
  if (!isFound) return 'None of these searches has found a path.';
  if (time === 1 && on.length === 1) return `The path: ${outcome(only)}.`;
  if (time === 1) return 'The thick lines are the paths.';
  if (!data.simplify) return 'A path is found, and returned as it is.';
  if (data.footprint.length) return 'A path is found. Parts of it give way to shorter motions.';
  return 'A path is found. Points of it that see each other are joined by a straight line.';
}

// Go forwards or backwards by one sample, or by a fiftieth of those that are shown.
function step(way) {
  play(false);
  const n = samplesAt();
  const next = n + way * Math.max(1, Math.round(n / 50));
  if (time > SEARCHED || next > most()) setTime(time + 0.01 * way);
  else setTime(next <= 1 ? 0 : SEARCHED * Math.log1p(next) / Math.log1p(most()));
}

function play(start) {
  playing = start ? {since: performance.now(), from: time >= 1 ? 0 : time} : null;
  byId('play').textContent = start ? '\u275A\u275A' : '\u25B6';
  byId('play').setAttribute('aria-label', start ? 'Pause' : 'Play');
  if (start) requestAnimationFrame(tick);
}

function tick(now) {
  if (!playing) return;
  setTime(playing.from + Math.max(0, now - playing.since) / (1000 * seconds));
  if (time >= 1) play(false);
  else requestAnimationFrame(tick);
}
