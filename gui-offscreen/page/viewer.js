// One run: space, camera, object, slider, layers, keys.
import { readRun, readSensors, sceneAt } from "./decode.js";
import { CameraView } from "./camera.js";
import { Panel } from "./panel.js";
import { Space } from "./space.js";

const LAYERS = [["points", "lidar returns", true], ["trust", "not trusted: rain, snow", true], ["tracks", "tracked road users", true],
  ["standing", "things that stand", false], ["names", "names", true], ["trails", "past 2 s", true], ["truth", "truth", true],
  ["measurements", "measurements", false], ["radar", "radar returns", true], ["grid", "safety grid", false], ["free", "free distance", true]];
const PAGE = `
<div class="stage"><div class="space" tabindex="0" role="img" aria-label="the run in space"></div>
<div class="clock"></div><p class="webgl" hidden></p></div>
<aside><div class="object"></div></aside>
<div class="transport"><button class="play" title="play or pause: space">&#9654;</button>
<input type="range" min="0" value="0" step="1" aria-label="time"><output></output>
<select class="rate" aria-label="speed"><option value="0.25">¼ ×</option><option value="1" selected>1 ×</option><option value="4">4 ×</option></select>
<button data-look="behind" title="key B">from behind</button><button data-look="top" title="key T">from above</button></div>
<div class="layers"></div>
<figure class="camera"></figure>
<p class="note"></p>`;

export class Viewer {
  constructor(host) {
    this.host = host;
    this.onTime = [];
    this.onChoice = [];
    this.t = 0;
    this.k = 0;
    this.id = null;
  }

  async start() {
    const { host } = this, prefix = host.dataset.run;
    this.run = await readRun(prefix);
    if (!this.run.scenes.length) return;
    this.build();
    this.seek(this.run.times[0]);
    await readSensors(this.run, prefix);
    this.camera = new CameraView(host.querySelector(".camera"), this.run);
    this.note(host.querySelector(".note"));
    this.refresh();
    host.dataset.ready = "yes";
  }

  build() {
    const { host } = this, find = (s) => host.querySelector(s);
    host.innerHTML = PAGE;
    this.layers = {};
    this.slider = find("input[type=range]");
    this.slider.max = this.run.scenes.length - 1;
    this.panel = new Panel(find(".object"), this.run, (t) => this.seek(t), (id) => this.choose(id));
    this.addLayers(find(".layers"));
    try {
      this.space = new Space(find(".space"), this.run, this.layers);
    } catch (error) {
      find(".webgl").hidden = false;
      find(".webgl").textContent = "This browser shows no WebGL; timeline, tables and pictures below hold the same run.";
    }
    this.addInput(find);
    this.choose(null);
  }

  has(layer) {
    const any = (key) => this.run.scenes.some((s) => s[key]?.length);
    const block = (i) => this.run.scenes.some((s) => s.block?.[i] > 0);
    const rule = { points: () => block(1), trust: () => block(1), grid: () => block(2), truth: () => any("truth"), free: () => any("corridor"),
      measurements: () => any("measurements"), radar: () => any("radar"),
      standing: () => this.run.classes.some((c) => c.muted) };
    return rule[layer]?.() ?? true;
  }

  addLayers(host) {
    for (const [key, name, on] of LAYERS) {
      this.layers[key] = on;
      if (!this.has(key)) continue;
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = on;
      box.name = key;
      box.addEventListener("change", () => {
        this.layers[key] = box.checked;
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
    this.host.querySelectorAll("[data-look]").forEach((b) => b.addEventListener("click", () => this.space?.look(b.dataset.look)));
    const space = find(".space");
    let down = null;
    space.addEventListener("pointerdown", (e) => (down = [e.clientX, e.clientY]));
    space.addEventListener("pointerup", (e) => {
      if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 6) return;
      this.choose(this.space?.pick(e.clientX, e.clientY) ?? null);
    });
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10 }[event.key];
    if (step) this.seek(this.run.times[Math.min(Math.max(this.k + step, 0), this.run.times.length - 1)]);
    else if (event.key === " ") this.play(!this.playing);
    else if (event.key === "t") this.space?.look("top");
    else if (event.key === "b") this.space?.look("behind");
    else if (event.key === "Escape") this.choose(null);
    else if (event.key === "n" || event.key === "p") this.chooseNext(event.key === "n" ? 1 : -1);
    else return false;
    return true;
  }

  chooseNext(step) {
    const ids = this.run.present[this.k].filter(([o, i]) => !this.run.classes[o.c[i]].muted).map(([o]) => o.id);
    if (ids.length) this.choose(ids[(ids.indexOf(this.id) + step + ids.length) % ids.length]);
  }

  play(on) {
    this.playing = on;
    this.host.querySelector(".play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
    if (!on) return;
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

  seek(t) {
    this.k = sceneAt(this.run, t);
    this.t = this.run.times[this.k];
    this.slider.value = this.k;
    this.host.querySelector("output").textContent = `${this.t.toFixed(1)} s of ${this.run.times.at(-1).toFixed(1)}`;
    this.refresh();
    this.onTime.forEach((f) => f(this.t));
  }

  choose(id, go) {
    this.id = id;
    this.panel.show(id);
    const o = this.run.byId.get(id);
    if (go && o && !o.k.includes(this.k)) return this.seek(this.run.times[o.k[Math.floor(o.k.length / 2)]]);
    this.refresh();
    this.onChoice.forEach((f) => f(id));
  }

  refresh() {
    const s = this.run.scenes[this.k];
    this.space?.show(this.k, this.id);
    this.panel.at(this.k, this.t);
    this.camera?.show(this.k, this.id);
    const users = this.run.present[this.k].filter(([o, i]) => !this.run.classes[o.c[i]].muted).length;
    const free = s.path ? `, free ahead ${s.path[2] ? s.path[0].toFixed(0) + " m" : "for " + s.path[0].toFixed(0) + " m and more"}${s.path[3] ? ": STOP" : ""}` : "";
    this.host.querySelector(".clock").textContent = `${this.run.simulated ? "simulated, " : ""}own speed ${(s.speed * 3.6).toFixed(0)} km/h, ${users} road users${free}`;
  }

  note(host) {
    const { seen, kept } = this.run.points ?? {};
    const points = !seen ? "Without the log (option -i) the page has tracks alone, no sensor data."
      : kept < seen ? `Lidar returns are thinned to ${Math.round(100 * kept / seen)} % (${kept.toLocaleString("en")} of ${seen.toLocaleString("en")}) so that the page stays small.`
      : `All ${seen.toLocaleString("en")} lidar returns that the tracker used are in the page.`;
    host.textContent = points + this.help();
  }

  help() {
    return " Color of returns: gray ground, violet low, green 3 m and higher. Drag turns the view, wheel or two fingers zoom, right button or two fingers move it. " +
      "Keys: space plays, arrows step, N and P next and previous object, T from above, B from behind, Esc nothing chosen.";
  }
}
