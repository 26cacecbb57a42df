// Light or dark: as the system has it, or as it was switched.
import * as colors from "./colors.js";
import { remember, remembered } from "./memory.js";

const system = matchMedia("(prefers-color-scheme: dark)");
const NAMES = { light: "light", dark: "dark" };
export const lookNow = () => NAMES[remembered().look] ?? (system.matches ? "dark" : "light");

function apply() {
  const look = lookNow();
  document.documentElement.dataset.look = look;
  colors.setLook(look);
  for (const e of document.querySelectorAll("td[style^=color], td span[style^=color]")) {
    e.dataset.color ??= e.style.color;
    e.style.color = colors.css(colors.text(colors.parse(e.dataset.color)));
  }
}

export function startLook(changed) {
  apply();
  const button = document.createElement("button");
  button.className = "look";
  const name = () => {
    button.textContent = lookNow() === "dark" ? "light" : "dark";
    button.title = `show the page ${button.textContent}`;
  };
  const change = () => {
    apply();
    name();
    changed();
  };
  button.addEventListener("click", () => {
    remember({ look: lookNow() === "dark" ? "light" : "dark" });
    change();
  });
  system.addEventListener("change", change);
  name();
  document.body.append(button);
}
