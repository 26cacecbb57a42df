// The interactive page of a run (perception-report); bundled by bundle.sh.
import { Viewer } from "./viewer.js";
import { LiveViewer } from "./live.js";
import { events, objectRows, sortable, timeline } from "./tables.js";
import { Weather } from "./weather.js";

async function start() {
  const viewers = [...document.querySelectorAll("[data-run]")].map((host) => ("live" in host.dataset ? new LiveViewer(host) : new Viewer(host)));
  document.querySelectorAll("table").forEach(sortable);
  window.perceptionViewers = viewers;
  for (const viewer of viewers) await viewer.start();
  const first = viewers[0];
  if (!first?.run?.scenes.length) return;
  timeline(first);
  objectRows(first);
  const weather = document.getElementById("weather");
  if (weather && !first.live) first.weather = new Weather(weather, first);
  events(first, document.getElementById("events") ?? first.host.parentNode);
  for (const viewer of viewers) {  // two runs of one log go in step
    viewer.onTime.push((t) => viewers.forEach((other) => {
      if (other !== viewer && Math.abs(other.t - t) > 0.06 && !other.moving) {
        viewer.moving = true;
        other.seek(t);
        viewer.moving = false;
      }
    }));
  }
  first.seek(first.t);
  document.addEventListener("keydown", (event) => {
    if (/INPUT|SELECT|TEXTAREA/.test(event.target.tagName) && event.target.type !== "checkbox" && event.key !== "Escape") return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (first.key(event)) event.preventDefault();
  });
}
start();
