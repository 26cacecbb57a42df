// What the page remembers: layers that were switched, light or dark.
const KEY = "perception.page";

// Pages that are opened as files have no storage in some browsers: then the name of the window keeps it until the window is closed.
function read() {
  let text = null;
  try {
    text = localStorage.getItem(KEY);
  } catch {
    text = window.name.startsWith(KEY) ? window.name.slice(KEY.length) : null;
  }
  try {
    const kept = JSON.parse(text ?? "{}");
    return kept && typeof kept === "object" ? kept : {};
  } catch {
    return {};
  }
}

export function remember(change) {
  const text = JSON.stringify({ ...read(), ...change });
  try {
    localStorage.setItem(KEY, text);
  } catch {
    window.name = KEY + text;
  }
}
export const remembered = read;
