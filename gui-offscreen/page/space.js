// The run in space: three.js, vehicle in the origin, x ahead, z up.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import * as colors from "./colors.js";
import { corners, EDGES, FACES } from "./boxes.js";
import { blockOf } from "./decode.js";

THREE.ColorManagement.enabled = false;  // colors are meant as they are written

export class Space {
  constructor(host, layers) {
    Object.assign(this, { layers, host, size: [0, 0] });
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    host.append(this.renderer.domElement);
    this.labels = document.createElement("canvas");
    this.labels.className = "labels";
    host.append(this.labels);
    this.scene = new THREE.Scene();
    this.world = new THREE.Group();
    this.turned = new THREE.Group();
    this.turned.add(this.world);
    this.scene.add(this.turned);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.5, 800);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.controls.addEventListener("change", () => this.draw());
    this.scene.add((this.fixed = new THREE.Group()));
    this.addFixed();
    this.material = new THREE.PointsMaterial({ size: 2.2, sizeAttenuation: false, vertexColors: true });
    this.lineMaterials = [];
    this.look("behind");
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  // Paper, rings and the vehicle in the page's look.
  addFixed() {
    const { look } = colors, plain = (color, Kind = THREE.MeshBasicMaterial) => new Kind({ color: new THREE.Color(colors.css(color)) });
    this.renderer.setClearColor(new THREE.Color(colors.css(look.paper)));
    const ring = [];
    for (let r = 10; r <= 80; r += 10) {
      for (let i = 0; i < 96; ++i) {
        for (const a of [i, i + 1]) ring.push(r * Math.cos(a * Math.PI / 48), r * Math.sin(a * Math.PI / 48), 0);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(ring, 3));
    const rings = new THREE.LineSegments(geometry, plain(look.ring, THREE.LineBasicMaterial));
    const ego = new THREE.Mesh(new THREE.BoxGeometry(4.4, 1.8, 1.0), plain(look.vehicle));
    ego.position.set(0.8, 0, 0.5);
    const roof = new THREE.Mesh(new THREE.BoxGeometry(2.2, 1.5, 0.5), plain(look.roof));
    roof.position.set(0.5, 0, 1.25);
    this.fixed.add(rings, ego, roof);
  }

  recolor() {
    for (const { geometry, material } of this.fixed.children) geometry.dispose(), material.dispose();
    this.fixed.clear();
    this.addFixed();
  }

  look(from) {
    const narrow = this.host.clientWidth < 600;
    const views = { top: [[16, 0, narrow ? 95 : 62], [16.01, 0, 0]], behind: [[-15, 0, 9.5], [14, 0, 0]] };
    const [eye, at] = views[from] ?? views.behind;
    this.camera.up.set(...(from === "top" ? [1, 0, 0] : [0, 0, 1]));
    this.camera.position.set(...eye);
    this.controls.target.set(...at);
    // Orbiting needs its axis upward: seen from above, a hair behind the middle.
    if (from === "top") {
      this.camera.up.set(0, 0, 1);
      this.camera.position.x -= 0.05;
    }
    this.controls.update();
    this.draw();
  }

  resize() {
    const w = this.host.clientWidth, h = this.host.clientHeight;
    if (!w || !h || (w === this.size[0] && h === this.size[1])) return;
    this.size = [w, h];
    this.renderer.setSize(w, h);
    const ratio = Math.min(window.devicePixelRatio, 2);
    this.labels.width = w * ratio;
    this.labels.height = h * ratio;
    this.camera.aspect = w / h;
    this.camera.fov = w < 600 ? 60 : 45;
    this.camera.updateProjectionMatrix();
    this.lineMaterials.forEach((m) => m.resolution.set(w, h));
    this.draw();
  }

  clear() {
    for (const child of [...this.world.children]) {
      this.world.remove(child);
      child.geometry.dispose();
      if (child.material !== this.material) child.material.dispose();
    }
    this.lineMaterials = [];
  }

  lines(positions, shades, width, extra = {}) {
    if (positions.length === 0) return;
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(positions);
    geometry.setColors(shades);
    const material = new LineMaterial({ linewidth: width, vertexColors: true, ...extra });
    material.resolution.set(this.host.clientWidth, this.host.clientHeight);
    this.lineMaterials.push(material);
    const lines = new LineSegments2(geometry, material);
    lines.frustumCulled = false;
    if (extra.dashed) lines.computeLineDistances();
    this.world.add(lines);
  }

  // Shows scene k of a run, the objects of the runs `tracked`; id: the object of run `of` that is chosen, or null.
  show(run, k, tracked, id, of) {
    Object.assign(this, { id, of });
    this.clear();
    const s = run.at(k), ego = s.ego, on = this.layers, sensed = run.sensed(k), block = blockOf(sensed);
    this.world.position.set(-ego[0], -ego[1], -ego[2]);
    this.turned.rotation.z = -ego[3];
    this.names = [];
    if (block && on.points) this.addPoints(block.points, sensed.ego);
    if (block && on.grid) this.addCells(block.cells, sensed.ego);
    if (on.free && sensed?.corridor) this.addCorridor(sensed, sensed.ego);
    if (on.truth) this.addTruth(s.truth ?? []);
    if (on.measurements) this.addMeasurements(sensed ?? s);
    if (on.radar) this.addRadar(sensed?.radar ?? []);
    this.addTracks(tracked);
    this.draw();
  }

  addPoints(p, ego) {
    const phantom = colors.line(colors.PHANTOM), place = new Float32Array(3 * p.n), shade = new Uint8Array(3 * p.n);
    for (let i = 0; i < p.n; ++i) {
      place[3 * i] = ego[0] + p.x[i] / 100;
      place[3 * i + 1] = ego[1] + p.y[i] / 100;
      place[3 * i + 2] = ego[2] + p.z[i] / 100;
      const c = this.layers.trust && p.b[i] < 128 ? phantom : colors.HEIGHTS[p.a[i]];
      shade.set(c, 3 * i);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(shade, 3, true));
    const points = new THREE.Points(geometry, this.material);
    points.frustumCulled = false;
    this.world.add(points);
  }

  addCells(p, ego) {
    if (p.n === 0) return;
    const mesh = new THREE.InstancedMesh(new THREE.BoxGeometry(1, 1, 1),
      new THREE.MeshBasicMaterial({ color: 0xf0b43c, transparent: true, opacity: 0.28, depthWrite: false }), p.n);
    const m = new THREE.Matrix4();
    for (let i = 0; i < p.n; ++i) {
      const edge = p.a[i] / 100, tall = Math.max(p.b[i] * 0.02, 0.05);
      m.makeScale(edge, edge, tall).setPosition(ego[0] + p.x[i] / 100, ego[1] + p.y[i] / 100, ego[2] + p.z[i] / 100);
      mesh.setMatrixAt(i, m);
    }
    mesh.frustumCulled = false;
    this.world.add(mesh);
  }

  addCorridor(s, ego) {
    const [curvature, width, from, to, blocked] = s.corridor;
    const c = this.shade(colors.line(s.path?.[3] ? colors.STOP : colors.FREE));
    const at = (u, d) => {
      const a = curvature * u, r = Math.abs(curvature) < 1e-6;
      const x = r ? u : Math.sin(a) / curvature, y = r ? 0 : (1 - Math.cos(a)) / curvature;
      const px = x - d * Math.sin(a), py = y + d * Math.cos(a), h = ego[3];
      return [ego[0] + px * Math.cos(h) - py * Math.sin(h), ego[1] + px * Math.sin(h) + py * Math.cos(h), ego[2] + 0.06];
    };
    const place = [], n = 24;
    for (let i = 0; i < n; ++i) {
      const u = from + (to - from) * i / n, v = from + (to - from) * (i + 1) / n;
      for (const d of [-width / 2, width / 2]) place.push(...at(u, d), ...at(v, d));
    }
    if (blocked) place.push(...at(to, -width / 2), ...at(to, width / 2));
    this.lines(place, this.repeat(c, place.length), 2.5);
  }

  shade(color) { return color.map((v) => v / 255); }
  repeat(color, length) {
    const shades = new Float32Array(length);
    for (let i = 0; i < length; ++i) shades[i] = color[i % 3];
    return shades;
  }

  addTruth(truth) {
    const place = [];
    for (const [x, y, z, l, w, h, yaw] of truth) {
      const c = corners(x, y, z, l, w, h, yaw);
      for (const e of EDGES) place.push(...c[e]);
    }
    this.lines(place, this.repeat(this.shade(colors.look.ink), place.length), 1.1);
  }

  addMeasurements(s) {
    const place = [], z = s.ego[2] + 0.1;
    for (const [, [x, y], outline] of s.measurements ?? []) {
      place.push(x - 0.35, y, z, x + 0.35, y, z, x, y - 0.35, z, x, y + 0.35, z);
      outline.forEach((p, i) => {
        const q = outline[(i + 1) % outline.length];
        place.push(p[0], p[1], z, q[0], q[1], z);
      });
    }
    this.lines(place, this.repeat(this.shade(colors.line(colors.MEASUREMENT)), place.length), 1.5);
  }

  addRadar(radar) {
    const place = [];
    for (const [x, y, z, vx, vy] of radar) {
      place.push(x, y, z - 0.3, x, y, z + 0.3, x, y - 0.3, z, x, y + 0.3, z, x, y, z, x + vx, y + vy, z);
    }
    this.lines(place, this.repeat(this.shade(colors.line(colors.RADAR)), place.length), 1.8);
  }

  addTracks(tracked) {
    const on = this.layers, edges = [[], []], shades = [[], []], chosen = [], faces = [], tint = [], trail = [], hue = [];
    this.boxes = [];
    for (const [run, k, of] of tracked) {
      for (const [o, i] of run.here(k)) {
        const kind = run.classes[o.c[i]];
        const selected = o.id === this.id && of === this.of;
        if (!selected && !(kind.muted ? on.standing : on.tracks)) continue;
        const [x, y, z, l, w, h, vx, vy, yaw] = o.row[i], color = colors.parse(kind.color), c = this.shade(colors.line(color));
        const box = corners(x, y, z, l, w, Math.max(h, 0.3), yaw);
        const lines = selected ? chosen : edges[of];
        for (const e of EDGES) lines.push(...box[e]);
        if (!selected) for (let e = 0; e < EDGES.length; ++e) shades[of].push(...c);
        for (const f of FACES) faces.push(...box[f]);
        const alpha = selected ? 0.4 : o.sure[i] ? 0.22 : 0.07;
        for (let f = 0; f < FACES.length; ++f) tint.push(...c, alpha);
        if (Math.hypot(vx, vy) > 0.5 && !kind.muted) {
          trail.push(x, y, z + 0.1, x + vx, y + vy, z + 0.1);
          hue.push(...c, ...c);
        }
        if (on.trails && !kind.muted) this.addTrail(run.trail(o, i, 2), c, trail, hue);
        this.boxes.push([o.id, of]);
        const name = `${tracked.length > 1 ? "AB"[of] + " " : ""}${o.id} ${kind.name}${o.sure[i] ? "" : "?"}`;
        if (!kind.muted || selected) this.names.push([x, y, z + h, name, colors.css(colors.text(color)), selected]);
      }
    }
    this.lines(edges[0], shades[0], 2);
    this.lines(edges[1], shades[1], 2, { dashed: true, dashSize: 0.3, gapSize: 0.2 });
    this.lines(trail, hue, 2.5);
    this.lines(chosen, this.repeat(this.shade(colors.look.ink), chosen.length), 4);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(faces, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(tint, 4));
    this.faces = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({
      vertexColors: true, transparent: true, depthWrite: false, side: THREE.DoubleSide }));
    this.faces.frustumCulled = false;
    this.world.add(this.faces);
  }

  addTrail(rows, c, trail, hue) {
    for (let j = 1; j < rows.length; ++j) {
      const a = rows[j - 1], b = rows[j];
      trail.push(a[0], a[1], a[2] + 0.1, b[0], b[1], b[2] + 0.1);
      hue.push(...c, ...c);
    }
  }

  // The object under a place of the page as [id, place of its run], or null; nearby ones too, for fingers.
  pick(clientX, clientY) {
    if (!this.faces || this.boxes.length === 0) return null;
    const box = this.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
    for (const [dx, dy] of [[0, 0], [6, 0], [-6, 0], [0, 6], [0, -6], [12, 0], [-12, 0], [0, 12], [0, -12]]) {
      const at = new THREE.Vector2((clientX + dx - box.left) / box.width * 2 - 1, 1 - (clientY + dy - box.top) / box.height * 2);
      ray.setFromCamera(at, this.camera);
      const hit = ray.intersectObject(this.faces)[0];
      if (hit) return this.boxes[Math.floor(hit.faceIndex / 12)];
    }
    return null;
  }

  // Place of a world point on the page's canvas [px], or null behind the camera.
  toScreen(x, y, z) {
    const p = this.world.localToWorld(new THREE.Vector3(x, y, z)).project(this.camera);
    if (p.z > 1 || p.z < -1) return null;
    return [(p.x + 1) / 2 * this.host.clientWidth, (1 - p.y) / 2 * this.host.clientHeight];
  }

  draw() {
    if (!this.labels.width || !this.names) return;  // not before the first scene
    this.renderer.render(this.scene, this.camera);
    const pen = this.labels.getContext("2d"), ratio = Math.min(window.devicePixelRatio, 2);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, this.host.clientWidth, this.host.clientHeight);
    if (!this.layers.names) return;
    this.scene.updateMatrixWorld();
    pen.textAlign = "center";
    pen.lineJoin = "round";
    pen.strokeStyle = colors.css(colors.look.paper);
    const taken = [];
    const order = [...this.names].sort((a, b) => b[5] - a[5]);
    for (const [x, y, z, text, color, selected] of order) {
      const at = this.toScreen(x, y, z);
      if (!at) continue;
      pen.font = `${selected ? "700 14" : "600 12"}px system-ui, sans-serif`;
      const half = pen.measureText(text).width / 2, spot = [at[0] - half, at[1] - 18, at[0] + half, at[1] - 3];
      if (taken.some((t) => spot[0] < t[2] && spot[2] > t[0] && spot[1] < t[3] && spot[3] > t[1])) continue;
      taken.push(spot);
      pen.lineWidth = 4;
      pen.strokeText(text, at[0], at[1] - 6);
      pen.fillStyle = selected ? colors.css(colors.look.ink) : color;
      pen.fillText(text, at[0], at[1] - 6);
    }
  }
}
