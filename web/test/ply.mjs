// PLY files, as the tests look at them.
import assert from 'node:assert/strict';

/** A PLY without the comments of its head: the program says there how it was called. */
export function withoutComments(bytes) {
  const text = bytes.toString('latin1');
  const end = text.indexOf('end_header\n');
  return text.slice(0, end).replace(/^comment.*\n/gm, '') + text.slice(end);
}

/** Vertices and triangles of a binary PLY with float coordinates alone. */
export function arraysOf(bytes) {
  const head = bytes.toString('latin1', 0, bytes.indexOf('end_header\n') + 11);
  assert.match(head, /little_endian[^]*element vertex \d+\nproperty float x\nproperty float y\nproperty float z\nelement/);
  const [vertices, triangles] = ['vertex', 'face'].map((name) => Number(head.match(`element ${name} (\\d+)`)[1]));
  const positions = Float32Array.from({length: 3 * vertices}, (_, i) => bytes.readFloatLE(head.length + 4 * i));
  const faces = head.length + 12 * vertices;
  const index = (i) => bytes.readUInt32LE(faces + 13 * Math.floor(i / 3) + 1 + 4 * (i % 3));
  return {positions, indices: Uint32Array.from({length: 3 * triangles}, (_, i) => index(i))};
}
