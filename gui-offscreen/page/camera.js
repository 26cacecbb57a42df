// The camera's image of a scene, with the detector's boxes and the tracks in it.
import * as colors from "./colors.js";
import { blockOf } from "./decode.js";
import { corners } from "./space.js";

const EDGES = [0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4, 0, 4, 1, 5, 2, 6, 3, 7];

export class CameraView {
  constructor(host, run) {
    this.run = run;
    this.host = host;
    this.canvas = document.createElement("canvas");
    this.note = document.createElement("figcaption");
    host.append(this.canvas, this.note);
    this.pictures = new Map();
    host.hidden = !run.scenes.some((s) => s.image);
  }

  show(k, id) {
    let at = k;
    while (at >= 0 && !this.run.scenes[at].image) --at;
    const scene = this.run.scenes[at];
    if (!scene || this.run.times[k] - scene.t > 1) return;
    this.wanted = [k, id];
    const image = scene.image;
    const jpeg = image.jpeg !== undefined && this.run.pictures?.[image.jpeg];
    if (!jpeg) return this.paint(null, scene, at, id);
    let picture = this.pictures.get(image.jpeg);
    if (!picture) {
      picture = new Image();
      picture.src = "data:image/jpeg;base64," + jpeg;
      picture.onload = () => this.show(...this.wanted);
      this.pictures.set(image.jpeg, picture);
    }
    if (picture.complete) this.paint(picture, scene, at, id);
  }

  paint(picture, scene, k, id) {
    const { size: [w, h], boxes, sensor } = scene.image, width = 720, height = Math.max(Math.round(width * h / w), 60);
    const scale = width / w;
    this.canvas.width = width;
    this.canvas.height = height;
    const pen = this.canvas.getContext("2d");
    pen.fillStyle = "#f2f2f2";
    pen.fillRect(0, 0, width, height);
    if (picture) pen.drawImage(picture, 0, 0, width, height);
    const to = this.projection(scene.image);
    if (!picture && to) this.paintPoints(pen, to, scale, k);
    if (to) this.paintTracks(pen, to, scale, k, id);
    pen.lineWidth = 2;
    pen.setLineDash([5, 3]);
    pen.strokeStyle = picture ? "#ebc800" : "#806c00";
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

  paintPoints(pen, to, scale, k) {
    const p = blockOf(this.run, k)?.points, ego = this.run.scenes[k].ego;
    for (let i = 0; p && i < p.n; ++i) {
      const at = to(ego[0] + p.x[i] / 100, ego[1] + p.y[i] / 100, ego[2] + p.z[i] / 100);
      if (!at) continue;
      pen.fillStyle = colors.css(colors.HEIGHTS[p.a[i]]);
      pen.fillRect(at[0] * scale, at[1] * scale, 2, 2);
    }
  }

  paintTracks(pen, to, scale, k, id) {
    for (const [o, i] of this.run.present[k]) {
      const kind = this.run.classes[o.c[i]];
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
