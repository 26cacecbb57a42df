// A run that goes on: its scenes come over a WebSocket; the last minute is kept.
import { Course, unpacked } from "./decode.js";
import { Viewer } from "./viewer.js";
import { Weather } from "./weather.js";

const KEPT = 60, KEPT_IN_PAUSE = 120, OFTEN = 1, MOST_EVENTS = 200;  // [s], [s], [s] between charts, rows

// The scenes that are kept, each with its own block of returns.
class LiveRun extends Course {
  constructor() {
    super();
    Object.assign(this, { classes: [], eventCount: 0, layers: [] });
  }
  at(k) { return this.scenes[k]; }
  here(k) { return this.present[k]; }
  has(id) { return this.byId.has(id); }
  life(id) { return this.byId.get(id) ?? null; }
  middleOf(id) {
    const { k } = this.byId.get(id);
    return k[k.length >> 1];
  }
}

export class LiveViewer extends Viewer {
  constructor(host) {
    super(host);
    Object.assign(this, { live: true, playing: true, left: 0, latencies: [], arrivals: [], drawn: 0, wait: 1000 });
    this.status = document.getElementById("live");
    this.clear();
  }

  // Until the first scene is there.
  start() {
    return new Promise((ready) => {
      this.ready = ready;
      this.connect();
    });
  }

  clear() {
    Object.assign(this.run ??= new LiveRun(), { scenes: [], objects: [], times: [], present: [], byId: new Map(), weather: [] });
    this.k = 0;
  }

  connect() {
    const { protocol, host, search } = location;
    const socket = new WebSocket(`${protocol === "https:" ? "wss" : "ws"}://${host}/${search}`, "perception.live.v1");
    this.number = null;
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.take(JSON.parse(data)) : this.takeScene(data));
    socket.onclose = () => {
      this.tell(this.ended ? "The run has ended." : "No connection; trying again.");
      if (this.ended) return;
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, 10000);
    };
  }

  take(message) {
    if (message.hello) Object.assign(this.run, message.hello);
    if (message.event) this.addEvent(message.event);
    if (message.weather) this.addWeather(message.weather);
    if (message.end) this.ended = true;
  }

  takeScene(data) {
    const [message, block] = unpacked(data);
    message.scene.buffer = block;
    if (this.number !== null) this.left += message.n - this.number - 1;
    this.number = message.n;
    this.wait = 1000;
    this.arrivals.push(performance.now());
    if (this.arrivals.length > 20) this.arrivals.shift();
    this.latency = message.latency;
    if (message.scene.t < this.run.times.at(-1)) this.clear();  // the log's clock went back
    this.add(message);
    this.trim();
    if (this.ready) this.open();
    this.due ??= requestAnimationFrame(() => this.draw());
  }

  open() {
    this.build();
    this.play(true);
    this.note(this.host.querySelector(".note"));
    this.host.querySelector(".camera").hidden = true;
    this.slider.addEventListener("input", () => this.play(false));
    this.ready();
    this.ready = null;
  }

  add({ scene, objects }) {
    const { run } = this, k = run.scenes.length;
    run.scenes.push(scene);
    run.times.push(scene.t);
    run.present.push((objects ?? []).map((o) => {
      let known = run.byId.get(o.id);
      if (!known) {
        known = { id: o.id, k: [], row: [], c: [], sure: [], p: [], hits: {} };
        run.byId.set(o.id, known);
        run.objects.push(known);
      }
      known.k.push(k);
      for (const key of ["row", "c", "sure", "p"]) known[key].push(o[key][0]);
      for (const [sensor, [t]] of Object.entries(o.hits ?? {})) {
        const all = (known.hits[sensor] ??= []);
        if (all.at(-1) !== t) all.push(t);
      }
      return [known, known.k.length - 1];
    }));
  }

  // Forgets what is older than a minute, some seconds at a time.
  trim() {
    const { run } = this, old = run.times.at(-1) - (this.playing ? KEPT : KEPT_IN_PAUSE);
    if (run.times[0] > old - 5) return;
    const n = run.times.findIndex((t) => t > old), since = run.times[n];
    for (const list of [run.scenes, run.times]) list.splice(0, n);
    for (const o of run.objects) {
      const gone = o.k.filter((k) => k < n).length;
      for (const key of ["k", "row", "c", "sure", "p"]) o[key].splice(0, gone);
      o.k = o.k.map((k) => k - n);
      for (const key of Object.keys(o.hits)) o.hits[key] = o.hits[key].filter((t) => t >= since);
    }
    run.objects = run.objects.filter((o) => o.k.length);
    run.byId = new Map(run.objects.map((o) => [o.id, o]));
    run.present = run.scenes.map(() => []);
    for (const o of run.objects) o.k.forEach((k, i) => run.present[k].push([o, i]));
    for (const w of run.weather) {
      const gone = w.t.filter((t) => t < since).length;
      for (const column of [w.t, w.doubted, ...w.p, ...w.rain, ...w.snow, ...w.visibility]) column.splice(0, gone);
    }
    this.k = Math.max(this.k - n, 0);
    if (this.id !== null) this.choose(this.id);
  }

  draw() {
    this.due = null;
    const { run } = this;
    this.slider.max = run.times.length - 1;
    const often = performance.now() - this.drawn > OFTEN * 1000;
    if (often) this.drawn = performance.now();
    if (this.playing) {
      if (often && this.id !== null) this.panel.show(this.run, this.id, this.k, "");
      this.seek(run.times.at(-1));
      if (often && this.weather) this.weather.draw(this.weather.shown);
    } else {
      this.slider.value = this.k;
    }
    const span = this.arrivals.at(-1) - this.arrivals[0];
    this.tell([this.playing ? "Live" : "In pause", this.run.simulated ? "simulated" : "",
      span > 0 ? `${((this.arrivals.length - 1) / span * 1000).toFixed(1)} scenes a second` : "",
      this.latency === undefined ? "" : `${(this.latency * 1000).toFixed(0)} ms from the sensor to the scene`,
      this.left ? `${this.left} scenes left out: newer ones came before these were sent` : ""].filter(Boolean).join(", ") + ".");
  }

  tell(text) {
    if (this.status && this.status.textContent !== text) this.status.textContent = text;
  }

  // Plays what comes, or stays at a scene.
  play(on) {
    this.playing = on;
    this.host.querySelector(".play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
    if (on && this.run.times.length) this.seek(this.run.times.at(-1));
  }

  key(event) {
    if (/^(Arrow|Page)/.test(event.key)) this.play(false);
    return super.key(event);
  }

  has(layer) { return !["truth", "measurements"].includes(layer); }

  note(host) { host.textContent = "Lidar returns are thinned. The last minute is kept: the slider looks back, space goes on." + this.help(); }

  addWeather(row) {
    const { run } = this;
    let w = run.weather.find((x) => x.sensor === row.sensor);
    if (!w) {
      w = { sensor: row.sensor, t: [], p: [[], [], [], []], rain: [[], [], []], snow: [[], [], []], visibility: [[], [], []], doubted: [] };
      run.weather.push(w);
    }
    if (row.t < w.t.at(-1)) return;
    w.t.push(row.t);
    w.doubted.push(row.doubted);
    for (const key of ["p", "rain", "snow", "visibility"]) row[key].forEach((v, i) => w[key][i].push(v));
    const host = document.getElementById("weather");
    if (host && run.times.length && !this.weather) this.weather = new Weather(host, this);
  }

  addEvent(event) {
    const host = document.getElementById("events");
    if (!host) return;
    if (!this.rows) {
      host.innerHTML = "<details open><summary>Events, newest first</summary><table></table></details>";
      this.rows = host.querySelector("table");
    }
    const row = this.rows.insertRow(0);
    for (const text of [Number.isFinite(event.t) ? `${event.t.toFixed(2)} s` : "", event.kind.replaceAll("_", " "), event.message]) row.insertCell().textContent = text;
    if (event.severity === "warning") row.className = "warning";
    row.addEventListener("click", () => {
      if (!Number.isFinite(event.t) || !this.run.times.length) return;
      this.play(false);
      this.seek(event.t);
      if (this.run.byId.has(event.fields?.id)) this.choose(event.fields.id);
    });
    while (this.rows.rows.length > MOST_EVENTS) this.rows.deleteRow(-1);
  }
}
