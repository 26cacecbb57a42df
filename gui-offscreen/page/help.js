// The keys, in a window of their own.
export const KEYS = [["space", "play, pause"], ["← →", "one scene back, on"], ["page up, down", "ten scenes back, on"], ["N, P", "next, previous object"],
  ["Esc", "no object chosen"], ["B, T", "seen from behind, from above"], ["C", "of two runs: one, the other, both"], ["?", "these keys"]];

export function toggleHelp() {
  let box = document.querySelector("dialog.help");
  if (box?.open) return box.close();
  if (!box) {
    box = document.createElement("dialog");
    box.className = "help";
    box.setAttribute("aria-label", "keys");
    box.innerHTML = "<h2>Keys</h2><dl></dl><p>Drag turns the view, wheel or two fingers zoom, right button or two fingers move it.</p><form method=\"dialog\"><button autofocus>close</button></form>";
    for (const row of KEYS) row.forEach((text, i) => box.querySelector("dl").append(Object.assign(document.createElement(i ? "dd" : "dt"), { textContent: text })));
    box.addEventListener("click", (e) => e.target === box && box.close());
    document.body.append(box);
  }
  box.showModal();
}
