// The one camera of both views: where it looks, from where, and how the pointer moves it. Lengths are those of the normalised
// scene, in which both models fit into a ball of radius 1 about the origin.

const HOME = {azimuth: -0.95, elevation: 0.42, distance: 3.6};
const FIELD_OF_VIEW = 35;  // degrees, of the shorter side of a view

class OrbitCamera {
  constructor(changed) {
    this.changed = changed;
    this.eye = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 20);
    this.eye.up.set(0, 0, 1);
    this.reset();
  }

  reset() {
    this.target = new THREE.Vector3();
    Object.assign(this, HOME);
    this.flight = null;
    this.changed();
  }

  // From the camera's target to the camera.
  direction() {
    const c = Math.cos(this.elevation);
    return new THREE.Vector3(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation));
  }

  place(aspect) {
    const eye = this.eye;
    eye.position.copy(this.target).addScaledVector(this.direction(), this.distance);
    eye.lookAt(this.target);
    const half = Math.tan(FIELD_OF_VIEW * Math.PI / 360);
    eye.fov = 2 * Math.atan(half / Math.min(aspect, 1)) * 180 / Math.PI;
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
    this.distance = Math.max(1e-3, Math.min(12, this.distance * factor));
    this.changed();
  }

  lookFrom(azimuth, elevation) {
    this.flight = null;
    Object.assign(this, {azimuth, elevation});
    this.changed();
  }

  // Goes to a view in a third of a second, or at once for those who want no motion.
  flyTo(target, direction, distance) {
    const azimuth = Math.hypot(direction.x, direction.y) > 1e-6 ? Math.atan2(direction.y, direction.x) : this.azimuth;
    const turn = Math.atan2(Math.sin(azimuth - this.azimuth), Math.cos(azimuth - this.azimuth));
    const elevation = Math.max(-1.4, Math.min(1.4, Math.asin(Math.max(-1, Math.min(1, direction.z)))));
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
