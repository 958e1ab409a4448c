// A mesh of JavaScript, as it is given to simplify(): what is wrong with its arrays is said before they are copied.

const rowsOf = (name, array, width, vertices) => {
  if (!Number.isInteger(array?.length)) throw new Error(`mesh: ${name} is no array`);
  const rows = array.length / width;
  if (!Number.isInteger(rows)) throw new Error(`mesh: ${name} has ${array.length} values, must be ${width} each`);
  if (rows !== (vertices ?? rows)) throw new Error(`mesh: ${name} has ${rows} rows for ${vertices} vertices`);
  return rows;
};

function checkIndices(indices, vertices) {
  for (let i = 0; i < indices.length; ++i) {
    const vertex = indices[i];
    if (!(Number.isInteger(vertex) && vertex >= 0 && vertex < vertices))
      throw new Error(`mesh: triangle ${Math.floor(i / 3)}: vertex ${vertex}, must be below ${vertices}`);
  }
}

/** Counts, and how many values a color has. */
export function checkMesh(mesh) {
  if (typeof mesh !== 'object') throw new Error("mesh: neither arrays, nor a file's name, nor null");
  const {positions, indices, normals, colors, attributes = []} = mesh;
  const vertices = rowsOf('positions', positions, 3),
    triangles = rowsOf('indices', indices, 3);
  checkIndices(indices, vertices);
  const channels = colors && colors.length === 4 * vertices ? 4 : 3;
  if (normals) rowsOf('normals', normals, 3, vertices);
  if (colors) rowsOf('colors', colors, channels, vertices);
  for (const {name, values} of attributes) rowsOf(`attribute ${name}`, values, 1, vertices);
  return {vertices, triangles, channels};
}

/** One of tolerance and triangles: [tolerance, triangles], the other 0. */
export function checkTarget({tolerance = null, triangles = null} = {}) {
  if ((tolerance === null) === (triangles === null)) throw new Error('simplify: give a tolerance, or triangles: N');
  if (tolerance !== null && !(tolerance > 0 && tolerance < Infinity))
    throw new Error(`tolerance = ${tolerance}, must be > 0 and finite`);
  if (triangles !== null && !(Number.isInteger(triangles) && triangles >= 1))
    throw new Error(`triangles = ${triangles}, must be a whole number >= 1`);
  return [tolerance ?? 0, Math.min(triangles ?? 0, 2 ** 32 - 1)];
}
