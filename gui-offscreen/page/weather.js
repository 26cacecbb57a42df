// The weather over time: probabilities, rates, visibility, what was doubted; a lidar at a time.
import uPlot from "uplot";
import * as colors from "./colors.js";
import { markAt } from "./panel.js";

const TYPES = [["clear", "#f3e6a8"], ["rain", "#0072b2"], ["snow", "#8fd0f2"], ["fog", "#9a9a9a"]];
const PHANTOM = () => colors.hex(colors.line([192, 32, 144]));
const tag = (name, text) => Object.assign(document.createElement(name), text === undefined ? {} : { textContent: text });

// What a chart shows of a lidar: its columns, series; null where there is nothing to see.
const CHARTS = [
  { title: "Probability of each weather", of: (w) => {
    const sums = w.t.map(() => 0), series = [], columns = [];
    TYPES.forEach(([, color], i) => {
      w.p[i].forEach((p, k) => (sums[k] += p ?? 0));
      columns.unshift([...sums]);
      series.unshift({ stroke: color, fill: color, width: 0 });
    });
    return { t: w.t, columns, series, range: [0, 1] };
  } },
  { title: "Rate of rain and snow [mm/h], with its interval", none: "Neither rain nor snow was likelier than not.", of: (w) => {
    const parts = [];
    [["rain", 1], ["snow", 2]].forEach(([name, i]) => {
      const likely = w.p[i].map((p) => p >= 0.5);
      if (likely.some(Boolean)) parts.push([colors.hex(colors.line(colors.parse(TYPES[i][1]))), w[name].map((column) => column.map((v, k) => (likely[k] ? v : null)))]);
    });
    return parts.length ? interval(w.t, parts, (u, low, high) => [0, Math.max(high, 0.5) * 1.1]) : null;
  } },
  { title: "Visibility [m], with its interval", log: true, of: (w) => interval(w.t, [[colors.hex(colors.line([68, 68, 68])), w.visibility]]) },
  { title: "Returns doubted [%]", of: (w) => ({ t: w.t, columns: [w.doubted.map((d) => 100 * d)], series: [{ stroke: PHANTOM(), width: 1.5 }],
    range: (u, low, high) => [0, Math.max(high, 1) * 1.1] }) },
  { title: "Clusters a scan, and those judged phantoms (spray, snow, rain)", of: (w) => w.ledger?.clusters.some((n) => n !== null)
    ? { t: w.ledger.t, columns: [w.ledger.clusters, w.ledger.phantoms], series: [{ stroke: "#808080", width: 1 }, { stroke: PHANTOM(), fill: "#c0209040", width: 1.5 }],
      range: (u, low, high) => [0, Math.max(high, 5) * 1.1] } : null },
];

function interval(t, parts, range) {
  const columns = [], series = [], bands = [];
  for (const [color, [value, low, high]] of parts) {
    const first = columns.length + 1;
    columns.push(high, low, value);
    series.push({ stroke: "transparent", width: 0 }, { stroke: "transparent", width: 0 }, { stroke: color, width: 2 });
    bands.push({ series: [first, first + 1], fill: color + "38" });
  }
  return { t, columns, series, bands, range };
}

export class Weather {
  constructor(host, viewer) {
    Object.assign(this, { host, viewer, charts: [] });
    const all = viewer.run.weather ?? [];
    if (!all.length) return;
    this.choice = tag("select");
    this.choice.setAttribute("aria-label", "lidar");
    all.forEach((w, i) => this.choice.append(new Option(w.sensor, i)));
    this.choice.addEventListener("change", () => this.draw(all[this.choice.value]));
    const lead = tag("p", "As each lidar sees it by its own returns; a click goes to that time. ");
    if (all.length > 1) lead.append(this.choice);
    const key = tag("p");
    key.className = "key";
    for (const [name, color] of TYPES) {
      const span = tag("span"), mark = tag("i");
      mark.style.background = color;
      span.append(mark, name);
      key.append(span);
    }
    this.body = tag("div");
    host.append(tag("h2", "The weather over time"), lead, key, this.body);
    this.draw(all[0]);
    viewer.onTime.push(() => this.charts.forEach((chart) => chart.redraw(false)));
  }

  draw(weather) {
    this.charts.forEach((chart) => chart.destroy());
    this.charts = [];
    this.body.replaceChildren();
    this.shown = weather;
    const { times } = this.viewer.run, end = times.at(-1), begin = this.viewer.live ? times[0] : 0;
    for (const chart of CHARTS) {
      const shown = chart.of(weather);
      if (!shown && !chart.none) continue;
      this.body.append(tag("h4", chart.title));
      if (!shown) {
        this.body.append(tag("p", chart.none));
        continue;
      }
      const host = tag("div");
      host.className = "chart";
      this.body.append(host);
      const plot = new uPlot({
        width: Math.max(this.host.clientWidth - 4, 240), height: 130, legend: { show: false }, cursor: { y: false, drag: { x: false } },
        scales: { x: { time: false, range: [begin, end] }, y: chart.log ? { distr: 3 } : { range: shown.range } },
        axes: colors.axes(62),
        series: [{}, ...shown.series.map((s) => ({ points: { show: false }, spanGaps: false, ...s }))],
        bands: shown.bands ?? [],
        hooks: { draw: [(u) => markAt(u, this.viewer.t)] },
      }, [shown.t, ...shown.columns], host);
      plot.over.addEventListener("click", (e) => this.viewer.seek(Math.max(0, plot.posToVal(e.offsetX, "x"))));
      this.charts.push(plot);
    }
  }
}
