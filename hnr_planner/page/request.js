// The start of a page that holds all data of one request.

function unpack(text, Kind) {
  return new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

function begin() {
  const [from, to] = [data.start, data.goal].map((p) => p.map((a) => +a.toFixed(2)).join(', '));
  byId('from').textContent += ` (${from})`;
  byId('to').textContent += ` (${to})`;
  byId('options').textContent = data.options.join(', ');
  searches = data.searches.map((search) => ({
    ...search,
    samples: unpack(search.samples, Float32Array),
    parents: unpack(search.parents, Int32Array),
    chords: unpack(search.chords, Float32Array),
    on: search.asked || data.searches.length === 1,
  }));
  searches.forEach(addAlgorithm);
  data.map.kinds.forEach(addKind);
  addControls();
  fit();
  setTime(0);
  play(wantsMotion());
}

image.addEventListener('load', begin);
image.src = data.map.image;
