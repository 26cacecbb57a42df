// Reads the data of a run from the page's own elements: gzip as base64.
import { gunzipSync } from "fflate";

async function bytesOf(id) {
  const element = document.getElementById(id);
  if (!element) return null;
  const text = atob(element.textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  if (!("DecompressionStream" in window)) return gunzipSync(bytes);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function readRun(prefix) {
  const run = JSON.parse(new TextDecoder().decode(await bytesOf(prefix + "-data")));
  run.block = null;
  run.pictures = null;
  run.byId = new Map(run.objects.map((o) => [o.id, o]));
  run.times = run.scenes.map((s) => s.t);
  run.present = run.scenes.map(() => []);
  for (const o of run.objects) o.k.forEach((k, i) => run.present[k].push([o, i]));
  return run;
}

// The large part, after the first picture.
export async function readSensors(run, prefix) {
  const block = await bytesOf(prefix + "-points");
  run.block = block && block.buffer.slice(block.byteOffset, block.byteOffset + block.byteLength);
  const images = document.getElementById(prefix + "-images");
  run.pictures = images ? JSON.parse(images.textContent) : [];
}

// Columns of the returns and cells of scene k: 16-bit centimeters from the vehicle, two bytes.
export function blockOf(run, k) {
  const { block: at, buffer = run.block } = run.scenes[k];  // scenes of a live run have their own
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

export const sceneAt = (run, t) => {
  let best = 0;
  run.times.forEach((time, k) => {
    if (Math.abs(time - t) < Math.abs(run.times[best] - t)) best = k;
  });
  return best;
};
