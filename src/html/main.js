// Puts the page together: text first, then both surfaces.

const report = JSON.parse(element('report-data').textContent);
const drawing = JSON.parse(element('drawing-data').textContent);
const places = collectPlaces(report, drawing);
const state = {colored: false, scale: drawing.deviation ? drawing.deviation.scale : 0, selected: null, view: null};

// For tests and the curious: what the page shows, in model coordinates.
window.burnish = {
  report, ready: false, firstFrame: null,
  places: places.flatMap(group => group.entries),
  camera() {
    const {camera, frame} = state.view;
    return {target: frame.toModel(camera.target), position: frame.toModel(camera.eye.position), flying: camera.flight !== null};
  },
  select,
};

function select(entry) {
  if (state.selected) state.selected.button.setAttribute('aria-pressed', 'false');
  state.selected = entry;
  entry.button.setAttribute('aria-pressed', 'true');
  if (state.view) state.view.goTo(entry.position, entry.radius, entry.normal);
}

function showColors(on) {
  const {deviation} = drawing;
  state.colored = on && Boolean(deviation);
  element('plain').setAttribute('aria-pressed', String(!state.colored));
  element('deviation').setAttribute('aria-pressed', String(state.colored));
  element('deviation').disabled = !deviation;
  element('legend').hidden = !state.colored;
  if (!deviation) return;
  const scale = state.scale;
  element('tick-low').textContent = '\u2212' + figure(scale, 3);
  element('tick-high').textContent = '+' + figure(scale, 3);
  element('legend-note').textContent = deviation.largest > 0
    ? 'at the points: ' + figure(deviation.least, 3) + ' to ' + figure(deviation.most, 3) : 'no point is off the input';
  element('beyond').hidden = !(deviation.beyond_border > 0);
  if (state.view && state.view.surfaces[1]) {
    state.view.surfaces[1].showDeviation(state.colored, scale > 0 ? deviation.largest / scale : 0);
    state.view.redraw();
  }
}

function noteSimplified() {
  for (const side of ['before', 'after']) {
    const {facets, facets_of_whole: whole} = drawing[side];
    if (facets < whole) element(side + '-note').textContent = 'drawn simplified: ' + facets + ' of ' + whole + ' facets';
  }
  element('empty').hidden = drawing.after.facets > 0;
}

function toggleTheme() {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset.theme = dark ? 'light' : 'dark';
}

function connect() {
  const view = () => state.view;
  const press = (id, action) => element(id).addEventListener('click', action);
  press('plain', () => showColors(false));
  press('deviation', () => showColors(true));
  press('theme', toggleTheme);
  press('up', () => {
    if (!view()) return;
    view().camera.setUp(view().camera.up === 'z' ? 'y' : 'z');
    element('up').textContent = view().camera.up.toUpperCase() + ' up';
  });
  press('reset', () => view() && view().reset());
  element('wireframe').addEventListener('change', event => view() && view().each(s => s.showWireframe(event.target.checked)));
  element('marks').addEventListener('change', event => view() && view().each(s => { s.marks.visible = event.target.checked; }));
  element('range').addEventListener('input', event => {
    state.scale = drawing.deviation.scale * 10 ** Number(event.target.value);
    showColors(state.colored);
  });
  const from = {x: {x: 1, y: 0, z: 0}, y: {x: 0, y: 1, z: 0}, z: {x: 0, y: 0, z: 1}};
  for (const button of document.querySelectorAll('[data-from]')) button.addEventListener('click', () => view() && view().camera.lookFrom(from[button.dataset.from]));
}

async function addSurface(view, side, mesh, frame) {
  if (!mesh.facets) return;
  const surface = new Surface(mesh, await decodedMesh(mesh), frame);
  for (const [kind, found] of Object.entries(mesh.marks)) await surface.addMarks(kind, found);
  for (const group of places) if (group.side === side) surface.addDots(group.entries.map(e => e.position), KINDS[group.kind].color);
  view.setSurface(side, surface);
}

async function start() {
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser cannot unpack the surfaces; those since 2023 can');
  const frame = new SceneFrame([drawing.before, drawing.after]);
  const view = new TwinView(element('canvas'), frame, drawing.before.facets + drawing.after.facets);
  const values = drawing.deviation ? decodedValues(drawing.deviation.values) : null;
  const borders = drawing.deviation && drawing.deviation.beyond_border > 0 ? inflated(drawing.deviation.border) : null;
  await Promise.all([addSurface(view, 0, drawing.before, frame), addSurface(view, 1, drawing.after, frame)]);
  if (values && view.surfaces[1]) view.surfaces[1].setDeviation(await values, await borders);
  state.view = view;
  showColors(Boolean(drawing.deviation && drawing.deviation.differs));
  view.begin();
  // Reading a pixel waits until the frame is there.
  const gl = view.renderer.getContext();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  element('waiting').hidden = true;
  window.burnish.firstFrame = performance.now();
  window.burnish.ready = true;
}

fillHeader(report);
fillCounts(report);
fillFigures(report);
fillPlaces(places, report.before.box ? report.before.box.diagonal : 0, select);
noteSimplified();
connect();
showColors(false);
start().catch(error => {
  element('waiting').textContent = 'The surfaces cannot be drawn: ' + error.message;
  window.burnish.failed = error.message;
});
