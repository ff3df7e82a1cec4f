// The one camera of both views: where it looks, from where, and how the pointer moves it. Lengths are those of the normalised
// scene, in which both models fit into a ball of radius 1 about the origin.

const HOME = {azimuth: -0.95, elevation: 0.42};
const FARTHEST = 12;
const MARGIN = 1.1;        // around the models
const FIELD_OF_VIEW = 35;  // degrees, of the shorter side of a view

class OrbitCamera {
  // `corners` are those of a box about both models.
  constructor(corners, changed) {
    this.corners = corners;
    this.aspect = 1;
    this.changed = changed;
    this.eye = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 20);
    this.up = 'z';
    this.reset();
  }

  // Between axes with z upwards and those of the model, where its y may be what is upwards.
  turned({x, y, z}) { return this.up === 'z' ? new THREE.Vector3(x, y, z) : new THREE.Vector3(x, z, -y); }
  unturned({x, y, z}) { return this.up === 'z' ? new THREE.Vector3(x, y, z) : new THREE.Vector3(x, -z, y); }

  setUp(axis) {
    this.up = axis;
    this.reset();
  }

  reset() {
    Object.assign(this, HOME);
    this.fit();
  }

  // The slopes of the view's upper and right side: the shorter of its sides has the field of view.
  slopes() {
    const up = Math.tan(FIELD_OF_VIEW * Math.PI / 360) / Math.min(this.aspect, 1);
    return {up, right: up * this.aspect};
  }

  // As near as all of the box is seen from, about its middle.
  fit() {
    const back = this.direction(), right = this.turned(new THREE.Vector3(-Math.sin(this.azimuth), Math.cos(this.azimuth), 0)), up = back.clone().cross(right);
    const slope = this.slopes();
    this.target = new THREE.Vector3();
    this.distance = 0.1;
    for (const corner of this.corners) {
      const across = Math.max(Math.abs(corner.dot(right)) / slope.right, Math.abs(corner.dot(up)) / slope.up);
      this.distance = Math.max(this.distance, MARGIN * across + corner.dot(back));
    }
    this.flight = null;
    this.changed();
  }

  // From the camera's target to the camera.
  direction() {
    const c = Math.cos(this.elevation);
    return this.turned(new THREE.Vector3(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation)));
  }

  place(aspect) {
    const eye = this.eye;
    this.aspect = aspect;
    eye.position.copy(this.target).addScaledVector(this.direction(), this.distance);
    eye.up.copy(this.turned({x: 0, y: 0, z: 1}));
    eye.lookAt(this.target);
    eye.fov = 2 * Math.atan(this.slopes().up) * 180 / Math.PI;
    eye.aspect = aspect;
    eye.near = Math.max(this.distance * 0.02, 1e-5);
    eye.far = this.distance + this.target.length() + 2.5;
    eye.updateProjectionMatrix();
    eye.updateMatrixWorld();
  }

  turn(right, up) {
    this.flight = null;
    this.azimuth -= right;
    this.elevation = Math.max(-1.55, Math.min(1.55, this.elevation + up));
    this.changed();
  }

  // By shares of the view's height.
  pan(right, up) {
    this.flight = null;
    const size = 2 * this.distance * Math.tan(this.eye.fov * Math.PI / 360);
    const axis = new THREE.Vector3();
    this.target.addScaledVector(axis.setFromMatrixColumn(this.eye.matrixWorld, 0), -right * size);
    this.target.addScaledVector(axis.setFromMatrixColumn(this.eye.matrixWorld, 1), -up * size);
    this.changed();
  }

  zoom(factor) {
    this.flight = null;
    this.distance = Math.max(1e-3, Math.min(FARTHEST, this.distance * factor));
    this.changed();
  }

  lookFrom(direction) {
    Object.assign(this, this.angles(direction));
    this.fit();
  }

  // Of a direction of length 1. Straight up and down are kept a little off.
  angles(direction) {
    const d = this.unturned(direction);
    const azimuth = Math.hypot(d.x, d.y) > 1e-6 ? Math.atan2(d.y, d.x) : Math.PI / -2;
    return {azimuth, elevation: Math.max(-1.55, Math.min(1.55, Math.asin(Math.max(-1, Math.min(1, d.z)))))};
  }

  // Goes to a view in a third of a second, or at once for those who want no motion.
  flyTo(target, direction, distance) {
    const {azimuth, elevation} = this.angles(direction);
    const turn = Math.atan2(Math.sin(azimuth - this.azimuth), Math.cos(azimuth - this.azimuth));
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.flight = {start: performance.now(), time: still ? 0 : 350,
                   from: {target: this.target.clone(), azimuth: this.azimuth, elevation: this.elevation, distance: this.distance},
                   to: {target: target.clone(), azimuth: this.azimuth + turn, elevation, distance}};
    this.changed();
  }

  // One step of a flight.
  advance(now) {
    const f = this.flight;
    if (!f) return;
    const share = f.time > 0 ? Math.max(0, Math.min(1, (now - f.start) / f.time)) : 1;
    const s = share * share * (3 - 2 * share);
    this.target.lerpVectors(f.from.target, f.to.target, s);
    this.azimuth = f.from.azimuth + s * (f.to.azimuth - f.from.azimuth);
    this.elevation = f.from.elevation + s * (f.to.elevation - f.from.elevation);
    this.distance = f.from.distance * Math.pow(f.to.distance / f.from.distance, s);
    if (share === 1) this.flight = null;
    this.changed();
  }
}

// Mouse, pen, fingers and keys on the canvas.
function steer(canvas, camera) {
  const pointers = new Map();
  const gap = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => pointers.delete(event.pointerId));
  canvas.addEventListener('pointermove', event => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const dx = (event.clientX - last.x) / canvas.clientHeight, dy = (event.clientY - last.y) / canvas.clientHeight;
    const before = pointers.size === 2 ? gap() : 0;
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (pointers.size === 2) {
      camera.pan(dx / 2, -dy / 2);
      if (before > 0 && gap() > 0) camera.zoom(before / gap());
    } else if (event.shiftKey || event.buttons & 6) {
      camera.pan(dx, -dy);
    } else {
      camera.turn(Math.PI * dx, Math.PI * dy);
    }
  });
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    camera.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY * (event.deltaMode ? 0.05 : 0.0015)))));
  }, {passive: false});
  const keys = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]};
  canvas.addEventListener('keydown', event => {
    if (keys[event.key]) camera.turn(...keys[event.key]);
    else if (event.key === '+') camera.zoom(0.85);
    else if (event.key === '-') camera.zoom(1 / 0.85);
    else return;
    event.preventDefault();
  });
}
