// Boxes on the ground by their eight corners.
export const EDGES = [0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4, 0, 4, 1, 5, 2, 6, 3, 7];
export const FACES = [0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6, 0, 5, 1, 0, 4, 5, 1, 6, 2, 1, 5, 6, 2, 7, 3, 2, 6, 7, 3, 4, 0, 3, 7, 4];

export function corners(x, y, z, l, w, h, yaw) {
  const c = Math.cos(yaw), s = Math.sin(yaw);
  return (
    [0, 1].flatMap((up) => [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a, b]) => [
      x + c * a * l / 2 - s * b * w / 2, y + s * a * l / 2 + c * b * w / 2, z + up * h])));
}
