// Names, colours and numbers as the page shows them.

// What is listed and marked. `side`: 0 before, 1 after.
const KINDS = {
  open_loop: {name: 'Open loops', color: '#e11d2e', unit: 'edges'},
  non_manifold_edge: {name: 'Non-manifold edges', color: '#d63fd0', unit: 'edges'},
  non_manifold_point: {name: 'Non-manifold points', color: '#8b3fd6', unit: 'facets'},
  misoriented_edge: {name: 'Misoriented edges', color: '#e08a00', unit: 'edges'},
  degenerate_facet: {name: 'Degenerate facets', color: '#0b8f8f', unit: 'facet'},
  duplicate_facet: {name: 'Duplicate facets', color: '#2f9e44', unit: 'facet'},
  self_intersection: {name: 'Self-intersections', color: '#ff6a00', unit: 'pairs'},
  hole: {name: 'Holes', color: '#1d9d62', unit: 'edges'},
  loss: {name: 'Parts of the input that were lost', color: '#b5179e', unit: 'samples'},
  component: {name: 'Components that changed', color: '#3f6fd6', unit: 'facets'},
  change: {name: 'Places where facets changed', color: '#2a7fb8', unit: ''},
};

const COUNT_ROWS = [
  ['facets', 'facets'], ['points', 'points'], ['components', 'components'], ['open edges', 'open_edges', true], ['open loops', 'open_loops', true],
  ['non-manifold edges', 'non_manifold_edges', true], ['non-manifold points', 'non_manifold_points', true], ['misoriented edges', 'misoriented_edges', true],
  ['misnested shells', 'misnested_shells', true], ['degenerate facets', 'degenerate_facets', true], ['duplicate facets', 'duplicate_facets', true],
  ['self-intersections', 'self_intersecting_pairs', true], ['volume', 'volume', false, 3], ['area', 'area', false, 2], ['mean edge', 'mean_edge', false, 1],
];

// Six digits as the terminal prints them, whole numbers as they are, '-' for what there is not.
function figure(value, digits = 6) {
  if (value === null || value === undefined || value === '') return '-';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value !== 'number') return String(value);
  if (!Number.isFinite(value)) return '-';
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return String(value);
  const size = Math.abs(value);
  if (size >= 10 ** digits || size < 1e-4) return value.toExponential(digits - 1).replace(/\.?0+e/, 'e');
  return String(Number(value.toPrecision(digits)));
}

// ', mm^3' behind what is measured, as the terminal has it; nothing where the report knows no unit.
const unitText = (report, power = 1) => report.units ? ', ' + report.units + (power > 1 ? '^' + power : '') : '';

const spoken = key => key.replaceAll('_', ' ');
const placeText = (p, size) => '(' + p.map(v => figure(Math.abs(v) < 1e-9 * size ? 0 : v, 5)).join(', ') + ')';

function verdictText(report) {
  const {written, verified, is_sheet} = report.output;
  if (written && verified) return is_sheet ? 'a valid open sheet' : 'a valid solid';
  return written ? 'written, but not verified' : 'not written';
}
