// A coarse picture of a mesh, for while it is turned: some of its vertices, by the cells of a grid (Rossignac and
// Borrel 1993).
import {forEachFace, inPieces} from './faces.js';

/** The area of a mesh, and the low end of its box. */
async function extent(positions, indices) {
  const lo = [Infinity, Infinity, Infinity];
  for (let i = 0; i < positions.length; ++i) if (positions[i] < lo[i % 3]) lo[i % 3] = positions[i];
  let area = 0;
  await forEachFace(positions, indices, (a, b, c, x, y, z) => {
    area += Math.hypot(x, y, z) / 2;
  });
  return {lo, area};
}

/** Indices of about `wanted` triangles over the same vertices: those whose corners are in three cells of a grid. */
export async function coarseIndices(positions, indices, wanted) {
  const {lo, area} = await extent(positions, indices);
  // A surface meets some 1.5 cells per area of a cell's face, and has twice as many triangles as vertices.
  const side = Math.sqrt((3 * area) / Math.max(wanted, 1)) || 1;
  const stands = new Uint32Array(positions.length / 3); // for each vertex the one that stands for its cell
  const first = new Map();
  await inPieces(stands.length, (begin, end) => {
    for (let v = begin; v < end; ++v) {
      const x = Math.floor((positions[3 * v] - lo[0]) / side),
        y = Math.floor((positions[3 * v + 1] - lo[1]) / side),
        z = Math.floor((positions[3 * v + 2] - lo[2]) / side);
      const cell = (x * 0x20000 + y) * 0x20000 + z; // exact to 2^17 cells a side
      const known = first.get(cell);
      if (known === undefined) first.set(cell, v);
      stands[v] = known ?? v;
    }
  });
  const kept = new Uint32Array(indices.length);
  let count = 0;
  await inPieces(indices.length, (begin, end) => {
    for (let t = begin; t < end; t += 3) {
      const a = stands[indices[t]],
        b = stands[indices[t + 1]],
        c = stands[indices[t + 2]];
      if (a === b || b === c || c === a) continue;
      kept[count++] = a;
      kept[count++] = b;
      kept[count++] = c;
    }
  });
  return kept.slice(0, count);
}
