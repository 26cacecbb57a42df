// Data of a run from the page's own elements, gzip as base64: an index, and parts of some seconds that are read when they are shown.
import { gunzipSync } from "fflate";

const PARTS_KEPT = 6;    // decoded at a time
const PARTS_OF_LIFE = 12;  // of an object's course around the scene that is shown
const SENSED = 3;        // [s] returns are shown at most after their scene

function bytesOf(id) {
  const element = document.getElementById(id);
  if (!element) return null;
  const text = atob(element.textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return gunzipSync(bytes);
}

// Length of the text, text, block of returns and cells: also what a live scene is.
export function unpacked(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  return [JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))), buffer.slice(4 + length)];
}

// Objects of every scene: [object, place in its columns].
export function presentIn(scenes, objects) {
  const present = Array.from({ length: scenes }, () => []);
  for (const o of objects) o.k.forEach((k, i) => present[k].push([o, i]));
  return present;
}

// The scene of the times nearest to t.
export function sceneAt(run, t) {
  const { times } = run;
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < t) low = middle + 1;
    else high = middle;
  }
  return low > 0 && t - times[low - 1] <= times[low] - t ? low - 1 : low;
}

// A run by its scenes: times, at(k), here(k), life(id, k), has(id).
export class Course {
  // Rows of an object from place i of its columns back to `seconds` before.
  trail(o, i, seconds) {
    const rows = [], now = this.times[o.k[i]];
    let of = o, n = this.kept ? this.partOf(o.k[i]) : 0;
    for (let j = i; ; --j) {
      if (j < 0) {
        of = n > 0 ? this.part(--n).byId.get(o.id) : null;
        if (!of) return rows;
        j = of.k.length - 1;
      }
      if (now - this.times[of.k[j]] > seconds) return rows;
      rows.push(of.row[j]);
    }
  }

  // The scene whose sensor data are shown at scene k, or null: not every one has some.
  sensed(k) {
    for (let j = k; j >= 0 && this.times[k] - this.times[j] <= SENSED; --j) if (this.at(j).block) return this.at(j);
    return null;
  }
}

export class Run extends Course {
  constructor(prefix) {
    super();
    Object.assign(this, JSON.parse(new TextDecoder().decode(bytesOf(prefix + "-data"))), { prefix, kept: new Map() });
    this.spans = new Map(this.objects.map(([id, ...span]) => [id, span]));
  }

  // All events of the run: read when they are asked for.
  events() {
    const all = [];
    for (let n = 0, bytes; (bytes = bytesOf(`${this.prefix}-events-${n}`)); ++n)
      for (const event of JSON.parse(new TextDecoder().decode(bytes))) all.push(event);
    return all;
  }

  // The JPEG of scene k, as base64, or nothing.
  imageAt(k) {
    const n = this.partOf(k), part = this.part(n), element = document.getElementById(`${this.prefix}-${n}-images`);
    part.images ??= element ? JSON.parse(element.textContent) : [];
    return part.images[this.at(k).image?.jpeg];
  }

  partOf(k) {
    let n = this.parts.length - 1;
    while (n > 0 && this.parts[n] > k) --n;
    return n;
  }

  part(n) {
    let part = this.kept.get(n);
    if (!part) {
      const bytes = bytesOf(`${this.prefix}-${n}`), [content, block] = unpacked(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
      part = { ...content, present: presentIn(content.scenes.length, content.objects), byId: new Map(content.objects.map((o) => [o.id, o])) };
      for (const scene of part.scenes) scene.buffer = block;
      for (const o of part.objects) o.k = o.k.map((k) => k + this.parts[n]);
    }
    this.kept.delete(n);
    this.kept.set(n, part);
    if (this.kept.size > PARTS_KEPT) this.kept.delete(this.kept.keys().next().value);
    return part;
  }

  at(k) {
    const n = this.partOf(k);
    return this.part(n).scenes[k - this.parts[n]];
  }

  here(k) {
    const n = this.partOf(k);
    return this.part(n).present[k - this.parts[n]];
  }

  has(id) { return this.spans.has(id); }

  // A scene in which the object is: the middle one of the part amid its course.
  middleOf(id) {
    const [first, last] = this.spans.get(id), o = this.part((first + last) >> 1).byId.get(id) ?? this.part(first).byId.get(id);
    return o.k[o.k.length >> 1];
  }

  // Columns of an object over the parts around scene k; cut: the run has more of it.
  life(id, k) {
    const span = this.spans.get(id);
    if (!span) return null;
    const middle = Math.min(Math.max(this.partOf(k), span[0]), span[1]);
    const from = Math.max(span[0], middle - PARTS_OF_LIFE / 2), to = Math.min(span[1], from + PARTS_OF_LIFE - 1);
    const life = { id, k: [], row: [], c: [], sure: [], p: [], err: [], hits: {}, cut: from > span[0] || to < span[1], parts: [from, to], span };
    for (let n = from; n <= to; ++n) {
      const o = this.part(n).byId.get(id);
      if (!o) continue;
      for (const key of ["k", "row", "c", "sure", "p"]) for (const value of o[key]) life[key].push(value);
      for (let i = 0; i < o.k.length; ++i) life.err.push(o.err?.[i] ?? null);
      for (const [sensor, times] of Object.entries(o.hits ?? {})) {
        const all = (life.hits[sensor] ??= []);
        for (const t of times) if (!(t <= all.at(-1))) all.push(t);
      }
    }
    return life;
  }
}

// Columns of the returns and cells of a scene: 16-bit centimeters from the vehicle, two bytes.
export function blockOf(scene) {
  const { block: at, buffer } = scene ?? {};
  if (!buffer || !at) return null;
  const columns = (from, n) => ({
    n,
    x: new Int16Array(buffer, from, n),
    y: new Int16Array(buffer, from + 2 * n, n),
    z: new Int16Array(buffer, from + 4 * n, n),
    a: new Uint8Array(buffer, from + 6 * n, n),
    b: new Uint8Array(buffer, from + 7 * n, n),
  });
  return { points: columns(at[0], at[1]), cells: columns(at[0] + 8 * at[1], at[2]) };
}
