// The address names instant and object: #t=4.2&id=83, and run=b of two runs.
const OFTEN = 250;  // [ms] at least between changes

// What the address says, and what of it cannot be.
export function readAddress(viewer) {
  const said = {}, faults = [], { runs } = viewer, { times } = viewer.run;
  for (const part of location.hash.slice(1).split("&").filter(Boolean)) {
    const [key, value = ""] = part.split("=").map((x) => {
      try {
        return decodeURIComponent(x);
      } catch {
        return x;
      }
    });
    if (!["t", "id", "run"].includes(key)) faults.push(`${key} is not known here (t, id${runs.length > 1 ? ", run" : ""})`);
    else said[key] = value;
  }
  const at = { t: undefined, id: null, of: 0 };
  if (said.t !== undefined) {
    at.t = /^-?\d+(\.\d+)?$/.test(said.t) ? +said.t : NaN;
    if (!(at.t >= times[0] - 0.5 && at.t <= times.at(-1) + 0.5)) faults.push(`t=${said.t} is not a time from ${times[0].toFixed(1)} to ${times.at(-1).toFixed(1)} s`);
  }
  if (said.run !== undefined) {
    at.of = ["a", "b"].indexOf(said.run);
    if (!(at.of >= 0 && at.of < runs.length)) faults.push(`run=${said.run} is not a run of this page`);
  }
  if (said.id !== undefined) {
    at.id = /^\d+$/.test(said.id) ? +said.id : NaN;
    if (!faults.length && !runs[at.of].has(at.id)) faults.push(`id=${said.id} is no object of this run`);
  }
  return { ...at, faults };
}

export class Address {
  constructor(viewer) {
    this.viewer = viewer;
    viewer.onTime.push(() => this.write());
    viewer.onChoice.push(() => this.write());
    window.addEventListener("hashchange", () => this.go());
    this.go();
  }

  go() {
    if (location.hash === this.known) return;
    this.known = location.hash;
    const { viewer } = this, { t, id, of, faults } = readAddress(viewer);
    viewer.say(faults.length ? `The address cannot be followed: ${faults.join("; ")}. Shown from the start.` : "");
    if (faults.length) {
      viewer.choose(null);
      return viewer.seek(viewer.run.times[0]);
    }
    if (t !== undefined) viewer.seek(t);
    if (id !== null || location.hash) viewer.choose(id, t === undefined, of);
  }

  // Not while it plays, since browsers count the changes, and not over an address that was typed and is yet to be followed.
  write() {
    this.due ??= setTimeout(() => {
      this.due = null;
      const { viewer } = this;
      if (viewer.playing || location.hash !== this.known) return;
      const parts = [`t=${+viewer.t.toFixed(2)}`];
      if (viewer.id !== null) parts.push(`id=${viewer.id}`);
      if (viewer.id !== null && viewer.of) parts.push("run=b");
      this.known = "#" + parts.join("&");
      if (location.hash !== this.known) history.replaceState(null, "", this.known);
    }, OFTEN);
  }
}
