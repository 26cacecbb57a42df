// One run, or two of one log: space, camera, object, slider, layers, keys.
import { CameraView } from "./camera.js";
import { Run, sceneAt } from "./decode.js";
import { toggleHelp } from "./help.js";
import { remember, remembered } from "./memory.js";
import { Panel } from "./panel.js";
import { Space } from "./space.js";

const LAYERS = [["points", "lidar returns", true], ["trust", "not trusted: rain, snow", true], ["tracks", "tracked road users", true],
  ["standing", "things that stand", false], ["names", "names", true], ["trails", "past 2 s", true], ["truth", "truth", true],
  ["measurements", "measurements", false], ["radar", "radar returns", true], ["grid", "safety grid", false], ["free", "free distance", true]];
const IN_RUN = { trust: "points", free: "corridor" };  // names of layers in the run, where they differ
const SAME_INSTANT = 0.06;  // [s] between scenes of two runs
const PAGE = `
<p class="say" role="status" hidden></p>
<div class="stage"><div class="space" tabindex="0" role="img" aria-label="the run in space"></div>
<div class="clock"></div><p class="webgl" hidden></p></div>
<aside><div class="object"></div></aside>
<div class="transport"><button class="play" title="play or pause: space">&#9654;</button>
<input type="range" min="0" value="0" step="1" aria-label="time"><output></output>
<select class="rate" aria-label="speed"><option value="0.25">¼ ×</option><option value="1" selected>1 ×</option><option value="4">4 ×</option></select>
<select class="shown" aria-label="run shown" title="key C" hidden><option value="a">A</option><option value="b">B</option><option value="both" selected>A and B</option></select>
<button data-look="behind" title="key B">from behind</button><button data-look="top" title="key T">from above</button>
<button class="keys" title="the keys: ?" aria-label="keys">?</button></div>
<div class="layers"></div>
<figure class="camera"></figure>
<p class="note"></p>`;

export class Viewer {
  constructor(host) {
    Object.assign(this, { host, onTime: [], onChoice: [], t: 0, k: 0, id: null, of: 0, shown: "a", shows: false });
  }

  // From now on every change is drawn; before, nothing is: drawing is what takes longest when the page opens.
  begin() {
    this.shows = true;
    this.seek(this.t);
  }

  async start() {
    const { run, other } = this.host.dataset;
    this.run = new Run(run);
    this.runs = other ? [this.run, new Run(other)] : [this.run];
    if (other) this.shown = "both";
    if (!this.run.times.length) return;
    this.build();
    this.camera = new CameraView(this.host.querySelector(".camera"), this.run);
    this.note(this.host.querySelector(".note"));
    this.t = this.run.times[0];
  }

  build() {
    const { host } = this, find = (s) => host.querySelector(s);
    this.runs ??= [this.run];
    host.innerHTML = PAGE;
    this.layers = {};
    this.slider = find("input[type=range]");
    this.slider.max = this.run.times.length - 1;
    this.panel = new Panel(find(".object"), (t) => this.seek(t));
    this.addLayers(find(".layers"));
    try {
      this.space = new Space(find(".space"), this.layers);
    } catch (error) {
      find(".webgl").hidden = false;
      find(".webgl").textContent = "This browser shows no WebGL; timeline, tables and pictures below hold the same run.";
    }
    this.addInput(find);
    this.choose(null);
  }

  has(layer) {
    if (layer === "standing") return this.run.classes.some((c) => c.muted);
    return ["tracks", "names", "trails"].includes(layer) || this.run.layers.includes(IN_RUN[layer] ?? layer);
  }

  addLayers(host) {
    const kept = remembered().layers ?? {};
    for (const [key, name, on] of LAYERS) {
      this.layers[key] = typeof kept[key] === "boolean" ? kept[key] : on;
      if (!this.has(key)) continue;
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = this.layers[key];
      box.name = key;
      box.addEventListener("change", () => {
        this.layers[key] = box.checked;
        remember({ layers: { ...remembered().layers, [key]: box.checked } });
        this.refresh();
      });
      label.append(box, " " + name);
      label.classList.add("layer-" + key);
      host.append(label);
    }
  }

  addInput(find) {
    this.slider.addEventListener("input", () => this.seek(this.run.times[+this.slider.value]));
    find(".play").addEventListener("click", () => this.play(!this.playing));
    find(".keys").addEventListener("click", toggleHelp);
    const shown = find(".shown");
    shown.hidden = this.runs.length < 2;
    shown.addEventListener("change", () => this.show(shown.value));
    this.host.querySelectorAll("[data-look]").forEach((b) => b.addEventListener("click", () => this.space?.look(b.dataset.look)));
    const space = find(".space");
    let down = null;
    space.addEventListener("pointerdown", (e) => (down = [e.clientX, e.clientY]));
    space.addEventListener("pointerup", (e) => {
      if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 6) return;
      const [id, of] = this.space?.pick(e.clientX, e.clientY) ?? [null, 0];
      this.choose(id, false, of);
    });
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10 }[event.key];
    if (step) this.seek(this.run.times[Math.min(Math.max(this.k + step, 0), this.run.times.length - 1)]);
    else if (event.key === " ") this.play(!this.playing);
    else if (event.key === "t") this.space?.look("top");
    else if (event.key === "b") this.space?.look("behind");
    else if (event.key === "c" && this.runs.length > 1) this.show({ a: "b", b: "both", both: "a" }[this.shown]);
    else if (event.key === "Escape") this.choose(null);
    else if (event.key === "n" || event.key === "p") this.chooseNext(event.key === "n" ? 1 : -1);
    else return false;
    return true;
  }

  // The run that is shown alone, or both.
  show(shown) {
    this.shown = shown;
    this.host.querySelector(".shown").value = shown;
    const of = "ab".indexOf(shown);
    if (of >= 0 && this.id !== null && this.of !== of) this.choose(null);
    else this.refresh();
  }

  // Scene of run `of` at this instant, or null.
  sceneOf(of) {
    if (of === 0) return this.k;
    const run = this.runs[of], k = sceneAt(run, this.t);
    return Math.abs(run.times[k] - this.t) <= SAME_INSTANT ? k : null;
  }

  // Runs whose objects are shown: [run, its scene, its place].
  tracked() {
    return this.runs.map((run, of) => [run, this.sceneOf(of), of]).filter(([, k, of]) => k !== null && (this.shown === "both" || "ab"[of] === this.shown));
  }

  usersOf([run, k]) { return run.here(k).filter(([o, i]) => !run.classes[o.c[i]].muted).map(([o]) => o.id); }

  chooseNext(step) {
    const all = this.tracked().flatMap((t) => this.usersOf(t).map((id) => [id, t[2]]));
    const now = all.findIndex(([id, of]) => id === this.id && of === this.of);
    if (!all.length) return;
    const [id, of] = all[now < 0 ? (step > 0 ? 0 : all.length - 1) : (now + step + all.length) % all.length];
    this.choose(id, false, of);
  }

  play(on) {
    this.playing = on;
    this.host.querySelector(".play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
    if (!on) return this.onChoice.forEach((f) => f(this.id));
    if (this.k === this.run.times.length - 1) this.seek(this.run.times[0]);
    let last = performance.now(), t = this.t;
    const tick = (now) => {
      if (!this.playing) return;
      t += (now - last) / 1000 * this.host.querySelector(".rate").value;
      last = now;
      if (Math.abs(t - this.t) > 1 / 60) {
        const k = sceneAt(this.run, t);
        if (k !== this.k) this.seek(this.run.times[k]);
      }
      if (t >= this.run.times.at(-1)) return this.play(false);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  seek(t, choosing) {
    this.k = sceneAt(this.run, t);
    this.t = this.run.times[this.k];
    this.slider.value = this.k;
    this.host.querySelector("output").textContent = `${this.t.toFixed(1)} s of ${this.run.times.at(-1).toFixed(1)}`;
    if (choosing) this.choose(this.id, false, this.of);
    else this.refresh();
    this.onTime.forEach((f) => f(this.t));
  }

  // An object of run `of`, or null; go: to an instant at which it is there.
  choose(id, go, of = 0) {
    const run = this.runs[of];
    Object.assign(this, { id: id !== null && run.has(id) ? id : null, of });
    if (go && this.id !== null) {
      if (!this.tracked().some((t) => t[2] === of)) this.show("ab"[of]);
      const k = sceneAt(run, this.t);
      if (!run.here(k).some(([o]) => o.id === id)) return this.seek(run.times[run.middleOf(id)], true);
    }
    this.panel.show(run, this.id, sceneAt(run, this.t), this.name(of));
    this.refresh();
    this.onChoice.forEach((f) => f(id));
  }

  name(of) { return this.runs.length > 1 ? "AB"[of] + " " : ""; }

  refresh() {
    if (!this.shows) return;
    const s = this.run.at(this.k), tracked = this.tracked(), run = this.runs[this.of];
    this.space?.show(this.run, this.k, tracked, this.id, this.of);
    const k = sceneAt(run, this.t);
    if (this.panel.beyond(k)) this.panel.show(run, this.id, k, this.name(this.of));
    this.panel.at(k, this.t);
    this.camera?.show(this.k, tracked, this.id);
    const users = tracked.map((t) => `${this.name(t[2])}${this.usersOf(t).length}`).join(", ");
    const free = s.path ? `, free ahead ${s.path[2] ? s.path[0].toFixed(0) + " m" : "for " + s.path[0].toFixed(0) + " m and more"}${s.path[3] ? ": STOP" : ""}` : "";
    this.host.querySelector(".clock").textContent = `${this.run.simulated ? "simulated, " : ""}own speed ${(s.speed * 3.6).toFixed(0)} km/h, ${users} road users${free}`;
  }

  // Light or dark has changed.
  recolor() {
    if (!this.panel) return;
    this.space?.recolor();
    this.panel.show(this.runs[this.of], this.id, sceneAt(this.runs[this.of], this.t), this.name(this.of));
    if (this.weather?.shown) this.weather.draw(this.weather.shown);
    this.refresh();
  }

  say(text) {
    const host = this.host.querySelector(".say");
    host.textContent = text;
    host.hidden = !text;
  }

  note(host) {
    const { seen, kept, every } = this.run.points ?? {};
    const points = !seen ? "Without the log (option -i) the page has tracks alone, no sensor data."
      : kept < seen ? `Lidar returns are thinned to ${(100 * kept / seen).toPrecision(2)} % (${kept.toLocaleString("en")} of ${seen.toLocaleString("en")}) so that the page stays small${every > 1 ? `; sensor data are those of every ${every}th scene, shown until the next` : ""}.`
      : `All ${seen.toLocaleString("en")} lidar returns that the tracker used are in the page.`;
    host.textContent = points + (this.runs.length > 1 ? " Boxes of B are dashed. Sensor data and truth are those of the log that both runs have." : "") + this.help() + " The address of the page leads to this instant and object.";
  }

  help() { return " Color of returns: gray ground, violet low, green 3 m and higher. The key ? shows all keys."; }
}
