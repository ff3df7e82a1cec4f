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
    this.radius = some ? Math.hypot(...low.map((v, a) => (high[a] - v) / 2)) || 1 : 1;
  }
  toScene(p) { return new THREE.Vector3(...p.map((v, a) => (v - this.center[a]) / this.radius)); }
  toModel(v) { return v.toArray().map((x, a) => x * this.radius + this.center[a]); }
}

class TwinView {
  constructor(canvas, frame) {
    this.canvas = canvas;
    this.frame = frame;
    // What was drawn is kept, so that a printer finds it.
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.renderer.autoClear = false;
    this.renderer.setScissorTest(true);
    this.scenes = [new THREE.Scene(), new THREE.Scene()];
    this.surfaces = [null, null];
    this.waiting = false;
    this.camera = new OrbitCamera(() => this.redraw());
    this.rings = this.scenes.map(scene => this.ring(scene));
    steer(canvas, this.camera);
    new ResizeObserver(() => this.fit()).observe(canvas);
    this.fit();
  }

  ring(scene) {
    const material = new THREE.MeshBasicMaterial({color: 0xffc400, wireframe: true, transparent: true, opacity: 0.55, depthTest: false});
    const ring = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 12), material);
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
    this.renderer.setSize(width, height, false);
    this.draw();
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
    this.scenes.forEach((scene, side) => {
      const area = [side * half, 0, side ? width - half : half, height];
      this.renderer.setViewport(...area);
      this.renderer.setScissor(...area);
      this.renderer.clear();
      this.renderer.render(scene, this.camera.eye);
    });
  }

  // A ball about a place, in model coordinates, and the camera in front of it.
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
