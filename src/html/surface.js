// What is drawn of a surface: its facets, their edges, and the marks where it is broken.

const COLORS = ['#1f4fa3', '#6ba5d9', '#dcdcda', '#ec9a63', '#b01c26'];  // of signed distances, as style.css has them

// Facets are lit flat, by the light of the one who looks; backs have a colour of their own, so that holes and flipped facets are seen.
const VERTEX_SHADER = `
attribute float deviation, border;
varying vec3 place;
varying float value, beyond;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  place = p.xyz;
  value = deviation;
  beyond = border;
  gl_Position = projectionMatrix * p;
}`;

const FRAGMENT_SHADER = `
uniform vec3 stops[5];
uniform vec3 front, back;
uniform float gain;
uniform bool colored;
varying vec3 place;
varying float value, beyond;
vec3 mapped(float v) {
  float t = clamp(v * gain, -1.0, 1.0) * 2.0 + 2.0;
  vec3 c = mix(stops[0], stops[1], clamp(t, 0.0, 1.0));
  c = mix(c, stops[2], clamp(t - 1.0, 0.0, 1.0));
  c = mix(c, stops[3], clamp(t - 2.0, 0.0, 1.0));
  return mix(c, stops[4], clamp(t - 3.0, 0.0, 1.0));
}
void main() {
  vec3 n = cross(dFdx(place), dFdy(place));
  float length2 = dot(n, n);
  n = length2 > 0.0 ? n * inversesqrt(length2) : vec3(0.0, 0.0, 1.0);
  float key = max(dot(n, normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.7, -0.2, 0.55))), 0.0);
  float light = 0.34 + 0.56 * key + 0.16 * fill;
  vec3 base = gl_FrontFacing ? (colored ? mix(mapped(value), vec3(0.286, 0.702, 0.518), smoothstep(0.4, 0.6, beyond)) : front) : back;
  gl_FragColor = vec4(base * light, 1.0);
}`;

// Dots are drawn a little towards the eye, so that the facets they lie on do not hide them.
const DOT_VERTEX_SHADER = `
uniform float size;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  p.xyz *= 0.995;
  gl_Position = projectionMatrix * p;
  gl_PointSize = size;
}`;

const DOT_FRAGMENT_SHADER = `
uniform vec3 color;
uniform float opacity;
void main() {
  float r = 2.0 * length(gl_PointCoord - 0.5);
  if (r > 1.0) discard;
  gl_FragColor = vec4(mix(color, vec3(1.0), smoothstep(0.62, 0.72, r)), opacity);
}`;

function plainColor(css) {
  const c = new THREE.Color();
  c.setStyle(css, THREE.LinearSRGBColorSpace);
  return new THREE.Vector3(c.r, c.g, c.b);
}

class Surface {
  // `frame` takes model coordinates to the normalised scene.
  constructor(mesh, decoded, frame) {
    this.group = new THREE.Group();
    this.mesh = mesh;
    this.frame = frame;
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute('position', new THREE.BufferAttribute(decoded.positions, 3));
    this.geometry.setIndex(new THREE.BufferAttribute(decoded.indices, 1));
    this.material = new THREE.ShaderMaterial({
      vertexShader: VERTEX_SHADER, fragmentShader: FRAGMENT_SHADER, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      uniforms: {stops: {value: COLORS.map(plainColor)}, front: {value: plainColor('#b9c2ca')}, back: {value: plainColor('#9a6a55')}, gain: {value: 1}, colored: {value: false}},
    });
    this.add(new THREE.Mesh(this.geometry, this.material), this.group);
    this.marks = new THREE.Group();
    this.group.add(this.marks);
  }

  // Quantised coordinates go to the graphics processor as they are; the object's matrix places them.
  add(object, group) {
    const {lower, step} = this.mesh;
    object.scale.set(...step.map(s => s / this.frame.radius || 1e-9));
    object.position.copy(this.frame.toScene(lower));
    object.frustumCulled = false;
    group.add(object);
    return object;
  }

  // Shares of the largest distance; of `borders`, if given, 1 where the input has an open edge only.
  setDeviation(values, borders) {
    this.geometry.setAttribute('deviation', new THREE.BufferAttribute(values, 1, true));
    if (borders) this.geometry.setAttribute('border', new THREE.BufferAttribute(borders, 1));
  }

  showDeviation(on, gain) {
    this.material.uniforms.colored.value = on;
    this.material.uniforms.gain.value = gain;
  }

  showWireframe(on) {
    if (on && !this.wires) {
      const material = new THREE.MeshBasicMaterial({color: 0x10202c, wireframe: true, transparent: true, opacity: 0.28});
      this.wires = this.add(new THREE.Mesh(this.geometry, material), this.group);
    }
    if (this.wires) this.wires.visible = on;
  }

  // Edges as lines, facets as triangles of the kind's colour.
  async addMarks(kind, found) {
    const color = new THREE.Color(KINDS[kind].color);
    const geometryOf = async packed => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(unpackedTuples(await inflated(packed.corners), 3), 3));
      return geometry;
    };
    if (found.lines) this.add(new THREE.LineSegments(await geometryOf(found.lines), new THREE.LineBasicMaterial({color})), this.marks);
    if (!found.triangles) return;
    const geometry = await geometryOf(found.triangles);
    this.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({color, side: THREE.DoubleSide, transparent: true, opacity: 0.75})), this.marks);
    this.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({color, wireframe: true})), this.marks);
  }

  // A dot at each listed place, as large on the screen from near and from far; faint where it is hidden.
  addDots(positions, color) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions.flatMap(p => this.frame.toScene(p).toArray())), 3));
    for (const hidden of [true, false]) {
      const material = new THREE.ShaderMaterial({
        vertexShader: DOT_VERTEX_SHADER, fragmentShader: DOT_FRAGMENT_SHADER, transparent: true, depthTest: !hidden, depthWrite: false,
        uniforms: {color: {value: plainColor(color)}, opacity: {value: hidden ? 0.22 : 0.95}, size: {value: 9 * Math.min(devicePixelRatio || 1, 2)}},
      });
      const dots = new THREE.Points(geometry, material);
      dots.frustumCulled = false;
      dots.renderOrder = 2;
      this.marks.add(dots);
    }
  }
}
