// The page's text: tables, lists and the places to go to. Everything from outside goes in as text, never as markup.

const element = id => document.getElementById(id);

function make(tag, text, className) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}

function fillTable(table, head, rows) {
  const line = (cells, tag) => {
    const tr = make('tr');
    cells.forEach((cell, i) => tr.append(cell instanceof Node ? cell : make(i ? tag : 'th', cell)));
    return tr;
  };
  const top = make('thead'), body = make('tbody');
  top.append(line(head, 'th'));
  rows.forEach(row => body.append(line(row, 'td')));
  table.replaceChildren(top, body);
}

function fillList(list, entries) {
  list.replaceChildren(...entries.flatMap(([key, value]) => [make('dt', key), make('dd', value)]));
}

function fillHeader(report) {
  const name = report.input.file.split('/').pop();
  document.title = name + ' - Burnish';
  element('title').textContent = name;
  element('subtitle').textContent = report.input.file + ' \u2192 ' + report.output.file;
  element('legend-title').textContent = 'signed distance from the input' + (unitText(report) || ', model units');
  element('verdict').textContent = verdictText(report);
  element('verdict').classList.toggle('good', report.output.written && report.output.verified);
  if (report.failure) {
    element('failure').hidden = false;
    element('failure').append(make('p', report.failure.message), make('p', report.failure.hint, 'how'));
  }
  element('warnings-section').hidden = !report.warnings.length;
  element('warnings').replaceChildren(...report.warnings.map(text => make('li', text)));
  element('footer').textContent = report.generator + '. Figures are of the whole surfaces, as the report has them.';
}

function fillCounts(report) {
  const cell = (defects, key, isDefect) => {
    const value = defects ? defects[key] : null;
    return make('td', defects ? figure(value) : '', isDefect && value > 0 ? 'bad' : undefined);
  };
  const valid = defects => make('td', defects ? figure(defects.valid_solid) : '', defects ? (defects.valid_solid ? 'good' : 'bad') : undefined);
  const rows = COUNT_ROWS.map(([label, key, isDefect, power]) => [label + (power ? unitText(report, power) : ''), cell(report.before, key, isDefect), cell(report.after, key, isDefect)]);
  rows.push(['valid solid', valid(report.before), valid(report.after)]);
  fillTable(element('counts'), ['', 'before', 'after'], rows);
}

function fillFigures(report) {
  const diagonal = report.before.box ? report.before.box.diagonal : 0;
  const share = length => diagonal > 0 ? figure(100 * length / diagonal, 2) + '%' : '';
  const cell = length => {
    const td = make('td', figure(length, 3));
    td.append(make('small', share(length)));
    return td;
  };
  // No facet of the one is missing in the other: nothing was measured, and nothing has to be.
  const same = report.output && report.output.verified ? '0' : '-';
  const row = (label, d) => [label, ...['max', 'mean', 'rms'].map(key => d ? cell(d[key]) : same)];
  const {input_to_output: there, output_to_input: back} = report.deviation;
  fillTable(element('distances'), ['distance' + unitText(report), 'max', 'mean', 'rms'], [row('input \u2192 output', there), row('output \u2192 input', back)]);
  element('method').className = 'prose';
  fillList(element('method'), [
    ['method', figure(report.method)], ['because', figure(report.method_reason)], ['smoothing', figure(report.smoothing.mode)],
    ['because', figure(report.smoothing.mode_reason)], ['surface', figure(report.surface.extractor)], ['because', figure(report.surface.reason)],
  ].filter(([, value]) => value !== '-'));
  const done = Object.entries(report.actions).filter(([, value]) => value);
  fillList(element('actions'), done.length ? done.map(([key, value]) => [spoken(key), figure(value)]) : [['nothing', '']]);
  fillList(element('options'), Object.entries(report.options).filter(([, value]) => value !== null).map(([key, value]) => [spoken(key), figure(value)]));
  const stages = report.stages.map(s => [s.name, s.wall_seconds.toFixed(2), s.cpu_seconds.toFixed(2), (s.peak_bytes / 1e6).toFixed(0)]);
  fillTable(element('stages'), ['stage', 'seconds', 'CPU s', 'peak MB'], stages);
}

// All places of the report and of both drawings: [{kind, side, position, radius, normal, text}], grouped, the largest first.
function collectPlaces(report, drawing) {
  const groups = [];
  const add = (kind, side, total, entries) => total && groups.push({kind, side, total, entries: entries.map(e => ({kind, side, ...e}))});
  const size = (label, value) => value > 0 ? label + ' ' + figure(value, 3) : '';
  const joined = parts => parts.filter(Boolean).join(', ');
  ['before', 'after'].forEach((name, side) => {
    for (const [kind, found] of Object.entries(drawing[name].marks))
      add(kind, side, found.total, found.listed.map(d => ({
        ...d, text: joined([d.count + ' ' + KINDS[kind].unit, size('length', d.length), size('area', d.area)])})));
  });
  const listOf = (list, entry) => list.largest.slice(0, 200).map(entry);
  add('hole', 1, report.holes.count, listOf(report.holes, h => ({
    position: h.position, radius: h.width / 2, text: joined([h.filled ? 'filled' : 'left open', h.edges + ' edges', size('width', h.width)])})));
  add('loss', 0, report.losses.count, listOf(report.losses, l => ({
    position: l.position, radius: Math.max(l.distance, Math.sqrt(l.area / Math.PI)), text: joined([size('distance', l.distance), size('area', l.area), l.reason])})));
  const changed = report.components.largest.filter(c => c.fate !== 'kept');
  add('component', 0, changed.length, changed.slice(0, 200).map(c => ({
    position: c.position, radius: Math.sqrt(c.area / (4 * Math.PI)), text: joined([c.fate, c.facets + ' facets', c.reason])})));
  add('change', 1, report.changes.count, listOf(report.changes, c => ({
    position: c.position, radius: c.extent / 2, text: c.facets_removed + ' facets removed, ' + c.facets_added + ' added'})));
  return groups;
}

// `size`: of the model, to tell what is as good as zero.
function fillPlaces(groups, size, go) {
  const list = element('places');
  if (!groups.length) return list.replaceChildren(make('p', 'Nothing was wrong.', 'nothing'));
  groups.forEach((group, g) => {
    const details = make('details');
    details.open = g === 0;
    const summary = make('summary'), dot = make('span', '', 'dot');
    dot.style.background = KINDS[group.kind].color;
    summary.append(dot, make('span', KINDS[group.kind].name + (group.side && group.kind in {open_loop: 1, self_intersection: 1, non_manifold_edge: 1,
      non_manifold_point: 1, misoriented_edge: 1, degenerate_facet: 1, duplicate_facet: 1} ? ', after' : '')), make('span', group.total, 'number'));
    details.append(summary);
    for (const entry of group.entries) {
      const button = make('button', entry.text);
      button.type = 'button';
      button.append(make('small', placeText(entry.position, size)));
      button.setAttribute('aria-pressed', 'false');
      button.addEventListener('click', () => go(entry));
      entry.button = button;
      details.append(button);
    }
    if (group.total > group.entries.length) details.append(make('p', 'the ' + group.entries.length + ' largest of ' + group.total, 'rest'));
    list.append(details);
  });
}
