// The interactive page of a run, or of two of one log (perception-report); bundled by bundle.sh.
import * as colors from "./colors.js";
import { Address } from "./address.js";
import { toggleHelp } from "./help.js";
import { LiveViewer } from "./live.js";
import { startLook } from "./look.js";
import { events, objectRows, sortable, timeline } from "./tables.js";
import { Viewer } from "./viewer.js";
import { Weather } from "./weather.js";

async function start() {
  const host = document.querySelector("[data-run]");
  const viewer = host && ("live" in host.dataset ? new LiveViewer(host) : new Viewer(host));
  window.perceptionViewers = viewer ? [viewer] : [];
  window.perceptionColors = colors;
  startLook(() => viewer?.recolor());
  document.querySelectorAll("table").forEach(sortable);
  if (!viewer) return;
  await viewer.start();
  if (!viewer.run?.times.length) return;
  timeline(viewer);
  objectRows(viewer);
  const weather = document.getElementById("weather");
  if (weather && !viewer.live) viewer.weather = new Weather(weather, viewer);
  events(viewer, document.getElementById("events") ?? host.parentNode);
  if (!viewer.live) viewer.address = new Address(viewer);
  viewer.begin();
  document.addEventListener("keydown", (event) => {
    if (/INPUT|SELECT|TEXTAREA/.test(event.target.tagName) && event.target.type !== "checkbox" && !["Escape", "?"].includes(event.key)) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "?") toggleHelp();
    else if (document.querySelector("dialog[open]") || !viewer.key(event)) return;
    event.preventDefault();
  });
  host.dataset.ready = "yes";
}
start();
