// Both views in one canvas, the input in its left half and the result in its right one, by one camera.

// From model coordinates to a scene in which everything is within 1 of the origin.
class SceneFrame {
  constructor(meshes) {
    const low = [Infinity, Infinity, Infinity], high = low.map(v => -v);
    for (const mesh of meshes) {
      if (!mesh.facets) continue;
      for (let a = 0; a < 3; ++a) {
        low[a] = Math.min(low[a], mesh.lower[a]);
        high[a] = Math.max(high[a], mesh.lower[a] + 65535 * mesh.step[a]);
      }
    }
    const some = low[0] <= high[0];
    this.center = low.map((v, a) => some ? v / 2 + high[a] / 2 : 0);
    this.half = low.map((v, a) => some ? high[a] / 2 - v / 2 : 0);
    this.radius = Math.hypot(...this.half) || 1;
  }
  toScene(p) { return new THREE.Vector3(...p.map((v, a) => (v - this.center[a]) / this.radius)); }
  corners() {
    return [...Array(8).keys()].map(i => new THREE.Vector3(...this.half.map((h, a) => (i >> a & 1 ? h : -h) / this.radius)));
  }
  toModel(v) { return v.toArray().map((x, a) => x * this.radius + this.center[a]); }
}

// Whether a processor has to draw that is made for other things.
function drawsSlowly() {
  const context = document.createElement('canvas').getContext('webgl2', {failIfMajorPerformanceCaveat: true});
  if (!context) return true;
  const loss = context.getExtension('WEBGL_lose_context');
  if (loss) loss.loseContext();
  return false;
}

const MOST_SLOW_FACETS = 50000;  // drawn with smooth edges, which takes four times as long, where that is slow

class TwinView {
  constructor(canvas, frame, facets) {
    this.canvas = canvas;
    this.frame = frame;
    // What was drawn is kept, so that a printer finds it.
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: facets <= MOST_SLOW_FACETS || !drawsSlowly(), alpha: true, preserveDrawingBuffer: true});
    this.renderer.setClearColor(0, 0);  // three.js begins with opaque black
    this.renderer.autoClear = false;
    this.renderer.setScissorTest(true);
    this.scenes = [new THREE.Scene(), new THREE.Scene()];
    this.surfaces = [null, null];
    this.waiting = true;  // for the surfaces
    this.camera = new OrbitCamera(frame.corners(), () => this.redraw());
    this.rings = this.scenes.map(scene => this.ring(scene));
    steer(canvas, this.camera);
    new ResizeObserver(() => this.fit()).observe(canvas);
  }

  // Once the surfaces are there.
  begin() {
    this.fit();
    this.camera.fit();
    this.waiting = false;
    this.draw();
  }

  // A circle that always faces the eye, seen through everything.
  ring(scene) {
    const sides = 64, corners = [], facets = [];
    for (let i = 0; i <= sides; ++i) {
      const c = Math.cos(2 * Math.PI * i / sides), s = Math.sin(2 * Math.PI * i / sides);
      corners.push(c, s, 0, 1.022 * c, 1.022 * s, 0);
      if (i < sides) facets.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(corners), 3));
    geometry.setIndex(facets);
    const material = new THREE.MeshBasicMaterial({color: 0xffb000, side: THREE.DoubleSide, depthTest: false, transparent: true});
    const ring = new THREE.Mesh(geometry, material);
    ring.frustumCulled = false;
    ring.visible = false;
    ring.renderOrder = 1;
    scene.add(ring);
    return ring;
  }

  setSurface(side, surface) {
    this.surfaces[side] = surface;
    this.scenes[side].add(surface.group);
  }

  each(action) {
    this.surfaces.forEach((surface, side) => surface && action(surface, side));
    this.redraw();
  }

  fit() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    if (width === this.width && height === this.height) return;
    Object.assign(this, {width, height});
    this.renderer.setSize(width, height, false);
    this.camera.aspect = Math.floor(width / 2) / height;
    if (!this.waiting) this.draw();
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(now => {
      this.waiting = false;
      this.camera.advance(now);
      this.draw();
    });
  }

  draw() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const half = Math.floor(width / 2);
    this.camera.place(half / height);
    for (const ring of this.rings) ring.quaternion.copy(this.camera.eye.quaternion);
    this.scenes.forEach((scene, side) => {
      const area = [side * half, 0, side ? width - half : half, height];
      this.renderer.setViewport(...area);
      this.renderer.setScissor(...area);
      this.renderer.clear();
      this.renderer.render(scene, this.camera.eye);
    });
  }

  // A circle about a place, in model coordinates, and the camera in front of it.
  goTo(position, radius, normal) {
    const at = this.frame.toScene(position), size = Math.max(radius / this.frame.radius, 0.012);
    for (const ring of this.rings) {
      ring.position.copy(at);
      ring.scale.setScalar(1.15 * size);
      ring.visible = true;
    }
    let direction = new THREE.Vector3(...(normal || [0, 0, 0]));
    if (direction.length() < 0.5) direction = at.clone();
    if (direction.length() < 1e-3) direction = this.camera.direction();
    this.camera.flyTo(at, direction.normalize(), Math.min(3.6, Math.max(6 * size, 0.15)));
  }

  reset() {
    for (const ring of this.rings) ring.visible = false;
    this.camera.reset();
  }
}
