// Colors of the pictures (gui-offscreen/drawing/Palette.h); those of classes come with the run.
export const PHANTOM = [225, 20, 150], CELL = [240, 180, 60], INK = [20, 20, 20],
  MEASUREMENT = [125, 60, 190], RADAR = [150, 90, 20], FREE = [0, 158, 115], STOP = [213, 94, 0];
const RAMP = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81]];
const GROUND = [205, 205, 205];

export function ofHeight(meters, low = 0.3, high = 3) {
  if (meters < 0.15) return GROUND;
  const place = Math.min(Math.max((meters - low) / (high - low), 0), 1) * (RAMP.length - 1);
  const i = Math.min(Math.floor(place), RAMP.length - 2), f = place - i;
  return RAMP[i].map((v, c) => v + f * (RAMP[i + 1][c] - v));
}
export const css = (c) => `rgb(${c.map(Math.round).join(",")})`;
export const parse = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
export const HEIGHTS = Array.from({ length: 256 }, (_, i) => ofHeight(i * 0.02));
