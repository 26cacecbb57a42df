// The camera's image of a scene, with the detector's boxes and the tracks in it.
import * as colors from "./colors.js";
import { blockOf } from "./decode.js";
import { corners, EDGES } from "./boxes.js";

const KEPT = 4;  // images, decoded

export class CameraView {
  constructor(host, run) {
    this.run = run;
    this.host = host;
    this.canvas = document.createElement("canvas");
    this.note = document.createElement("figcaption");
    host.append(this.canvas, this.note);
    this.pictures = new Map();
    host.hidden = !run.layers.includes("images");
  }

  show(k, tracked, id) {
    if (this.host.hidden) return;
    const { times } = this.run;
    let at = k;
    while (at >= 0 && times[k] - times[at] <= 1 && !this.run.at(at).image) --at;
    const scene = at >= 0 && this.run.at(at);
    if (!scene?.image) return;
    this.wanted = [k, tracked, id];
    const jpeg = this.run.imageAt(at);
    if (!jpeg) return this.paint(null, scene, tracked, id);
    let picture = this.pictures.get(at);
    if (!picture) {
      picture = new Image();
      picture.src = "data:image/jpeg;base64," + jpeg;
      picture.onload = () => this.show(...this.wanted);
      this.pictures.set(at, picture);
      if (this.pictures.size > KEPT) this.pictures.delete(this.pictures.keys().next().value);
    }
    if (picture.complete) this.paint(picture, scene, tracked, id);
  }

  paint(picture, scene, tracked, id) {
    const { size: [w, h], boxes, sensor } = scene.image, width = 720, height = Math.max(Math.round(width * h / w), 60);
    const scale = width / w;
    this.canvas.width = width;
    this.canvas.height = height;
    const pen = this.canvas.getContext("2d");
    pen.fillStyle = colors.css(colors.look.grid);
    pen.fillRect(0, 0, width, height);
    if (picture) pen.drawImage(picture, 0, 0, width, height);
    const to = this.projection(scene.image);
    if (!picture && to) this.paintPoints(pen, to, scale, scene);
    if (to) for (const t of tracked) this.paintTracks(pen, to, scale, t, id);
    pen.lineWidth = 2;
    pen.setLineDash([5, 3]);
    pen.strokeStyle = picture ? "#ebc800" : colors.css(colors.line([128, 108, 0]));
    for (const [x1, y1, x2, y2] of boxes) pen.strokeRect(x1 * scale, y1 * scale, (x2 - x1) * scale, (y2 - y1) * scale);
    pen.setLineDash([]);
    this.note.textContent = `${sensor}, ${scene.t.toFixed(1)} s. ${picture ? "" : "The log has no image: lidar returns in its place. "}` +
      (boxes.length ? "Dashed: boxes of the image detector." : "");
  }

  projection(image) {
    const [fx, fy, cx, cy] = image.k, T = image.T;
    if (image.panorama || !(fx > 0)) return null;
    return (x, y, z) => {
      const d = [x - T[3], y - T[7], z - T[11]];
      const c = [0, 1, 2].map((j) => T[j] * d[0] + T[4 + j] * d[1] + T[8 + j] * d[2]);
      return c[2] > 0.5 ? [cx + fx * c[0] / c[2], cy + fy * c[1] / c[2]] : null;
    };
  }

  paintPoints(pen, to, scale, scene) {
    const p = blockOf(scene)?.points, { ego } = scene;
    for (let i = 0; p && i < p.n; ++i) {
      const at = to(ego[0] + p.x[i] / 100, ego[1] + p.y[i] / 100, ego[2] + p.z[i] / 100);
      if (!at) continue;
      pen.fillStyle = colors.css(colors.HEIGHTS[p.a[i]]);
      pen.fillRect(at[0] * scale, at[1] * scale, 2, 2);
    }
  }

  paintTracks(pen, to, scale, [run, k, of], id) {
    pen.setLineDash(of ? [6, 4] : []);
    for (const [o, i] of run.here(k)) {
      const kind = run.classes[o.c[i]];
      if (kind.muted && o.id !== id) continue;
      const [x, y, z, l, w, h, , , yaw] = o.row[i];
      const c = corners(x, y, z, l, w, h, yaw).map((p) => to(...p));
      if (c.some((p) => !p)) continue;
      pen.strokeStyle = kind.color;
      pen.lineWidth = o.id === id ? 4 : 2;
      pen.beginPath();
      for (let e = 0; e < EDGES.length; e += 2) {
        pen.moveTo(c[EDGES[e]][0] * scale, c[EDGES[e]][1] * scale);
        pen.lineTo(c[EDGES[e + 1]][0] * scale, c[EDGES[e + 1]][1] * scale);
      }
      pen.stroke();
    }
  }
}
