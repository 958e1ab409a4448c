// Loops over a mesh's triangles in pieces: the page stays alive.
import {breathe} from './dom.js';

const piece = 3 << 17; // of a count

/** Runs work(begin, end) over pieces of `count`; a piece begins at a multiple of 3. */
export async function inPieces(count, work) {
  for (let begin = 0; begin < count; begin += piece) {
    work(begin, Math.min(begin + piece, count));
    await breathe();
  }
}

/** visit(a, b, c, x, y, z) for each triangle: the places of its corners in `positions`, and the cross product of its edges. */
export const forEachFace = (positions, indices, visit) =>
  inPieces(indices.length, (begin, end) => {
    for (let t = begin; t < end; t += 3) {
      const a = 3 * indices[t],
        b = 3 * indices[t + 1],
        c = 3 * indices[t + 2];
      const ux = positions[b] - positions[a],
        uy = positions[b + 1] - positions[a + 1],
        uz = positions[b + 2] - positions[a + 2];
      const vx = positions[c] - positions[a],
        vy = positions[c + 1] - positions[a + 1],
        vz = positions[c + 2] - positions[a + 2];
      visit(a, b, c, uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    }
  });
