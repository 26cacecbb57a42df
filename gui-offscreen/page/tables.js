// Tables sort by a click on their head; the timeline and rows of objects lead to time and object.
export function sortable(table) {
  const head = table.querySelector("th");
  if (!head || table.classList.contains("sorts")) return;
  table.classList.add("sorts");
  const rows = () => [...table.querySelectorAll("tr")].filter((r) => r.querySelector("td"));
  const value = (row, i) => {
    const text = row.cells[i]?.textContent ?? "", number = parseFloat(text);
    return Number.isNaN(number) ? text : number;
  };
  [...head.parentNode.cells].forEach((cell, i) => {
    cell.tabIndex = 0;
    let up = false;
    const sort = () => {
      up = !up;
      rows().sort((a, b) => {
        const [x, y] = [value(a, i), value(b, i)];
        const order = typeof x === typeof y ? (x < y ? -1 : x > y ? 1 : 0) : typeof x === "number" ? -1 : 1;
        return up ? order : -order;
      }).forEach((row) => row.parentNode.append(row));
      [...head.parentNode.cells].forEach((c) => c.removeAttribute("aria-sort"));
      cell.setAttribute("aria-sort", up ? "ascending" : "descending");
    };
    cell.addEventListener("click", sort);
    cell.addEventListener("keydown", (e) => e.key === "Enter" && sort());
  });
}

export function timeline(viewer) {
  const chart = document.getElementById("timeline"), film = document.getElementById("film");
  if (!chart) return;
  const { left, width, end } = chart.dataset, now = document.getElementById("now");
  viewer.onTime.push((t) => {
    const x = +left + width * t / end;
    now.setAttribute("x1", x);
    now.setAttribute("x2", x);
  });
  chart.addEventListener("click", (event) => {
    const box = chart.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width * chart.viewBox.baseVal.width;
    viewer.seek(Math.max(0, (x - left) / width * end));
    const { id, of } = event.target.dataset;
    if (id) viewer.choose(+id, false, of === "b" ? 1 : 0);
    if (film) film.currentTime = Math.max(0, viewer.t - chart.dataset.start);
  });
}

export function objectRows(viewer) {
  for (const row of document.querySelectorAll("tr[data-id]")) {
    row.addEventListener("click", () => {
      viewer.choose(+row.dataset.id, true, row.dataset.of === "b" ? 1 : 0);
      viewer.host.scrollIntoView({ block: "nearest" });
    });
  }
}

export function events(viewer, host) {
  const count = viewer.run.eventCount;
  if (!count) return;
  let all;
  const details = document.createElement("details");
  details.innerHTML = "<summary></summary><select aria-label=\"kind of event\"><option value=\"\">all kinds</option></select><table></table>";
  details.firstChild.textContent = `${count} events: tracks born and lost, sensors, data dropped`;
  const choice = details.querySelector("select"), table = details.querySelector("table");
  const fill = () => {
    table.innerHTML = "<tr><th>time</th><th>event</th><th>what</th></tr>";
    table.classList.remove("sorts");
    for (const e of all.filter((x) => !choice.value || x.kind === choice.value).slice(0, 2000)) {
      const row = table.insertRow();
      for (const text of [Number.isFinite(e.t) ? `${e.t.toFixed(2)} s` : "", e.kind.replaceAll("_", " "), e.message]) row.insertCell().textContent = text;
      if (e.severity === "warning") row.className = "warning";
      row.addEventListener("click", () => {
        if (Number.isFinite(e.t)) viewer.seek(e.t);
        if (e.fields?.id && viewer.run.has(e.fields.id)) viewer.choose(e.fields.id);
      });
    }
    sortable(table);
  };
  choice.addEventListener("change", fill);
  details.addEventListener("toggle", () => {
    if (!details.open || all) return;
    all = viewer.run.events();
    for (const kind of [...new Set(all.map((e) => e.kind))].sort()) choice.append(new Option(kind.replaceAll("_", " "), kind));
    fill();
  });
  host.append(details);
}
