// What is known of one object: class over time, speed, existence, sensors, changes.
import uPlot from "uplot";
import * as colors from "./colors.js";

const SENSOR = { L: "lidar", C: "camera", R: "radar" };
const el = (tag, text, name) => {
  const e = document.createElement(tag);
  if (text !== undefined) e.textContent = text;
  if (name) e.className = name;
  return e;
};

// Born, changes of class, lost: [time, text].
export function changesOf(run, o) {
  const t = (i) => run.times[o.k[i]], name = (i) => run.classes[o.c[i]].name;
  const list = [[t(0), `first seen, ${o.sure[0] ? "" : "probably "}${name(0)}`]];
  for (let i = 1; i < o.k.length; ++i) {
    if (t(i) - t(i - 1) > 0.5) list.push([t(i), `seen again after ${(t(i) - t(i - 1)).toFixed(1)} s`]);
    if (o.c[i] !== o.c[i - 1]) list.push([t(i), `now ${o.sure[i] ? "" : "probably "}${name(i)}`]);
    else if (o.sure[i] !== o.sure[i - 1]) list.push([t(i), o.sure[i] ? `sure: ${name(i)}` : `no longer sure of ${name(i)}`]);
  }
  const last = o.k.length - 1;
  if (o.k[last] < run.times.length - 1) list.push([t(last), "seen last"]);
  return list;
}

// A line at time t in a chart.
export function markAt(u, t) {
  const x = u.valToPos(t, "x", true);
  u.ctx.fillStyle = colors.css(colors.look.ink);
  if (x >= u.bbox.left && x <= u.bbox.left + u.bbox.width) u.ctx.fillRect(x - 1, u.bbox.top, 2, u.bbox.height);
}

export class Panel {
  constructor(host, seek) {
    Object.assign(this, { host, seek, object: null });
  }

  // Object `id` of a run around scene k; name: of the run, if there are two.
  show(run, id, k, name) {
    Object.assign(this, { run, name, object: id === null ? null : run.life(id, k) });
    this.host.replaceChildren();
    this.charts = [];
    if (!this.object) {
      this.host.append(el("h3", "No object chosen"),
        el("p", "Click a box in the picture, a row of the timeline or of the table.", "hint"));
      return;
    }
    this.title = el("h3");
    this.facts = el("dl");
    this.bars = el("canvas", undefined, "bars");
    this.host.append(this.title, this.facts);
    this.addErrors();
    if (this.object.cut) this.host.append(el("p", `The charts show ${this.from().toFixed(0)} to ${(this.from() + this.span()).toFixed(0)} s; there is more of it.`, "hint"));
    this.host.append(el("h4", "Class over time"), this.bars, this.sensorKey());
    this.bars.addEventListener("click", (e) => this.seek(this.from() + e.offsetX / this.bars.clientWidth * this.span()));
    this.addChart("Speed [km/h]", this.object.row.map((r) => Math.hypot(r[6], r[7]) * 3.6), "#0072b2");
    this.addChart("Existence", this.object.row.map((r) => r[9]), "#009e73", [0, 1.02]);
    this.host.append(el("h4", "What changed"));
    const list = el("ul", undefined, "changes");
    for (const [t, text] of changesOf(this.run, this.object)) {
      const item = el("li"), link = el("button", `${t.toFixed(1)} s`);
      link.addEventListener("click", () => this.seek(t));
      item.append(link, " " + text);
      list.append(item);
    }
    this.host.append(list);
  }

  // Whether scene k is in another part of the object's course than is shown.
  beyond(k) {
    if (!this.object?.cut) return false;
    const [first, last] = this.object.span, n = Math.min(Math.max(this.run.partOf(k), first), last);
    return n < this.object.parts[0] || n > this.object.parts[1];
  }

  // Errors against the truth: those of perception-evaluate, over the instants at which the object was matched.
  addErrors() {
    if (!this.run.judged) return;
    const { err } = this.object, matched = err.filter(Boolean), of = (i) => matched.map((e) => e[i]).filter((v) => v !== null);
    this.host.append(el("h4", "Against the truth"));
    if (!matched.length) {
      this.host.append(el("p", "No object of the truth was matched to it at an instant that is judged.", "hint"));
      return;
    }
    const rms = (i) => Math.sqrt(of(i).reduce((sum, v) => sum + v * v, 0) / of(i).length), right = of(4).filter(Boolean).length;
    const ids = [...new Set(of(0))], facts = [["truth", `${ids.length > 1 ? "objects" : "object"} ${ids.join(", ")}; ${matched.length} of ${err.length} instants`],
      ["position", `${rms(1).toFixed(2)} m rms`], ["speed", of(2).length ? `${(rms(2) * 3.6).toFixed(1)} km/h rms` : "not in the truth"],
      ["heading", of(3).length ? `${(rms(3) * 180 / Math.PI).toFixed(0)}° rms` : "not known of both"], ["class", `right at ${Math.round(100 * right / matched.length)} % of them`]];
    const table = el("dl");
    table.append(...facts.flatMap(([a, b]) => [el("dt", a), el("dd", b)]));
    this.host.append(table);
    this.addChart("Error of position [m]", err.map((e) => e?.[1] ?? null), "#d55e00", (u, low, high) => [0, Math.max(high * 1.1, 0.5)]);
  }

  errorAt(i) {
    const e = this.object.err[i];
    if (!e) return "not matched at this instant";
    const signed = (v, places) => (v < 0 ? "−" : "+") + Math.abs(v).toFixed(places);
    return [`${e[1].toFixed(2)} m off`, e[2] === null ? "" : `speed ${signed(e[2] * 3.6, 1)} km/h`, e[3] === null ? "" : `heading ${signed(e[3] * 180 / Math.PI, 0)}°`,
      e[4] ? "class right" : "class wrong"].filter(Boolean).join(", ");
  }

  from() { return this.run.times[this.object.k[0]]; }
  span() { return Math.max(this.run.times[this.object.k.at(-1)] - this.from(), 0.1); }

  sensorKey() {
    const p = el("p", undefined, "key");
    for (const c of this.run.classes) {
      const span = el("span"), mark = el("i");
      mark.style.background = c.color;
      span.append(mark, c.name.replaceAll("_", " "));
      p.append(span);
    }
    return p;
  }

  addChart(title, values, color, range) {
    const times = this.object.k.map((k) => this.run.times[k]), host = el("div", undefined, "chart");
    this.host.append(el("h4", title), host);
    const chart = new uPlot({
      width: Math.max(this.host.clientWidth - 4, 200), height: 88, legend: { show: false }, cursor: { y: false, drag: { x: false } },
      scales: { x: { time: false }, y: range ? { range } : { range: (u, a, b) => [Math.min(0, a), Math.max(b * 1.1, 5)] } },
      axes: colors.axes(40),
      series: [{}, { stroke: colors.css(colors.line(colors.parse(color))), width: 2, spanGaps: false, points: { show: times.length < 3 } }],
      hooks: { draw: [(u) => this.t !== undefined && markAt(u, this.t)] },
    }, [times, values], host);
    chart.over.addEventListener("click", (e) => this.seek(chart.posToVal(e.offsetX, "x")));
    this.charts.push(chart);
  }

  // Marks time t of scene k.
  at(k, t) {
    this.t = t;
    const o = this.object;
    if (!o) return;
    let i = o.k.findIndex((n) => n > k) - 1;
    if (i === -2) i = o.k.length - 1;
    const here = i >= 0 && o.k[i] === k, j = Math.max(i, 0);
    const kind = this.run.classes[o.c[j]], p = o.p[j][o.c[j]] ?? 0, { ego } = this.run.at(o.k[j]);
    this.title.replaceChildren(el("i"), `${this.name}${o.id} ${o.sure[j] ? "" : "probably "}${kind.name}, ${Math.round(100 * p)} %`);
    this.title.firstChild.style.background = kind.color;
    const [x, y, , l, w, h, vx, vy, , existence, sd] = o.row[j];
    const dx = x - ego[0], dy = y - ego[1], c = Math.cos(ego[3]), s = Math.sin(ego[3]);
    const ahead = c * dx + s * dy, left = c * dy - s * dx;
    const facts = [
      ["now", here ? "tracked" : k < o.k[0] ? `comes at ${this.from().toFixed(1)} s` : "not tracked at this time"],
      ["where", `${Math.abs(ahead).toFixed(1)} m ${ahead < 0 ? "behind" : "ahead"}, ${Math.abs(left).toFixed(1)} m ${left < 0 ? "right" : "left"} (±${sd.toFixed(2)})`],
      ["speed", `${(Math.hypot(vx, vy) * 3.6).toFixed(0)} km/h`],
      ["size", `${l.toFixed(1)} × ${w.toFixed(1)} × ${h.toFixed(1)} m`],
      ["existence", existence.toFixed(3)],
      ["measured by", this.sensorsAt(t)],
    ];
    if (this.run.judged && here) facts.push(["against truth", this.errorAt(i)]);
    this.facts.replaceChildren(...facts.flatMap(([a, b]) => [el("dt", a), el("dd", b)]));
    this.drawBars(t);
    this.charts.forEach((chart) => chart.status && chart.redraw(false));
  }

  sensorsAt(t) {
    const parts = Object.entries(this.object.hits ?? {}).map(([m, times]) => {
      const past = times.filter((x) => x <= t + 1e-3);
      if (past.length === 0) return null;
      const ago = t - past.at(-1);
      return `${SENSOR[m] ?? m} ${ago < 0.06 ? "now" : ago.toFixed(1) + " s ago"}`;
    });
    return parts.filter(Boolean).join(", ") || "nothing yet";
  }

  // Stacked bars of class probability; below, a tick for every measurement by sensor.
  drawBars(t) {
    const o = this.object, modalities = Object.keys(o.hits ?? {}), stack = 64, row = 13, ratio = window.devicePixelRatio;
    const width = this.bars.clientWidth || 300, height = stack + 4 + row * modalities.length;
    this.bars.style.height = height + "px";
    this.bars.width = width * ratio;
    this.bars.height = height * ratio;
    const pen = this.bars.getContext("2d");
    pen.scale(ratio, ratio);
    const x = (time) => (time - this.from()) / this.span() * width;
    o.k.forEach((k, i) => {
      const at = x(this.run.times[k]);
      const next = i + 1 < o.k.length && o.k[i + 1] - k < 4 ? x(this.run.times[o.k[i + 1]]) : at + width / Math.max(o.k.length, 1);
      let y = stack;
      o.p[i].forEach((p, c) => {
        pen.fillStyle = this.run.classes[c].color;
        pen.globalAlpha = o.sure[i] ? 1 : 0.6;
        pen.fillRect(at, y - p * stack, Math.max(next - at + 0.4, 1), p * stack);
        y -= p * stack;
      });
    });
    pen.globalAlpha = 1;
    pen.font = "11px system-ui, sans-serif";
    modalities.forEach((m, j) => {
      const y = stack + 4 + j * row;
      pen.fillStyle = colors.css(colors.line([68, 68, 68]));
      for (const hit of o.hits[m]) if (hit >= this.from()) pen.fillRect(x(hit), y + 1, 1.5, row - 5);
      pen.fillStyle = colors.hex(colors.look.paper) + "d0";
      pen.fillRect(0, y, 44, row - 2);
      pen.fillStyle = colors.css(colors.look.ink);
      pen.fillText(SENSOR[m] ?? m, 1, y + 9);
    });
    pen.fillStyle = colors.css(colors.look.ink);
    pen.fillRect(x(t) - 1, 0, 2, height);
  }
}
