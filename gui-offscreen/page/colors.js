// Colors of the pictures (gui-offscreen/drawing/Palette.h); those of classes come with the run. Both looks of the page, and contrast as WCAG 2.1 has it.
export const PHANTOM = [225, 20, 150], CELL = [240, 180, 60], MEASUREMENT = [125, 60, 190], RADAR = [150, 90, 20], FREE = [0, 158, 115], STOP = [213, 94, 0];
const RAMP = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81]];
const LOOKS = {
  light: { paper: [255, 255, 255], ink: [20, 20, 20], ring: [218, 218, 218], ground: [205, 205, 205], grid: [238, 238, 238], vehicle: [60, 60, 60], roof: [108, 108, 108] },
  dark: { paper: [22, 24, 28], ink: [236, 236, 236], ring: [60, 64, 70], ground: [84, 88, 94], grid: [44, 47, 52], vehicle: [170, 174, 180], roof: [206, 210, 216] },
};
const LINE = 3, TEXT = 4.5;  // least contrast

export const css = (c) => `rgb(${c.map(Math.round).join(",")})`;
export const parse = (hex) => (hex.startsWith("rgb") ? hex.match(/\d+/g).map(Number) : [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)));
export const hex = (c) => "#" + c.map((v) => Math.round(v).toString(16).padStart(2, "0")).join("");
const luminance = (c) => [0.2126, 0.7152, 0.0722].reduce((sum, weight, i) => {
  const v = c[i] / 255;
  return sum + weight * (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
}, 0);
export function contrast(a, b) {
  const [x, y] = [luminance(a), luminance(b)];
  return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05);
}

let shades = new Map();
export const HEIGHTS = [];
export let look = LOOKS.light;
export function setLook(name) {
  look = LOOKS[name];
  shades = new Map();
  HEIGHTS.splice(0, HEIGHTS.length, ...Array.from({ length: 256 }, (_, i) => ofHeight(i * 0.02)));
}

// The color, mixed with that of the ink until it stands out from the paper.
function readable(color, ratio) {
  const key = color + ":" + ratio;
  if (!shades.has(key)) {
    let shade = color;
    for (let f = 0; contrast(shade, look.paper) < ratio && f <= 1; f += 0.05) shade = color.map((v, i) => v + f * (look.ink[i] - v));
    shades.set(key, shade);
  }
  return shades.get(key);
}
export const line = (color) => readable(color, LINE);
export const text = (color) => readable(color, TEXT);

export function ofHeight(meters, low = 0.3, high = 3) {
  if (meters < 0.15) return look.ground;
  const place = Math.min(Math.max((meters - low) / (high - low), 0), 1) * (RAMP.length - 1);
  const i = Math.min(Math.floor(place), RAMP.length - 2), f = place - i, color = RAMP[i].map((v, c) => v + f * (RAMP[i + 1][c] - v));
  return look === LOOKS.light ? color : line(color);
}
setLook("light");

// Axes of a chart in the page's look.
export const axes = (left) => [{ size: 24, values: (u, v) => v.map((t) => t + " s") }, { size: left }].map((axis) => ({
  stroke: css(look.ink), grid: { stroke: css(look.grid) }, ticks: { stroke: css(look.grid) }, ...axis }));
