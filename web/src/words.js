// Messages of the engine in the words of the page: no folders of the engine, no options of a command line.

const fields = {
  voxel: 'Voxel',
  resolution: 'Resolution',
  sensor: 'Scanner position',
  up: 'Up',
  outside: 'Beyond the samples lies',
  simplify: 'Simplify',
  triangles: 'Triangles',
};
const values = {air: 'air', solid: 'solid matter', open: 'neither'};

function ofOption(name, value) {
  if (name === 'memory') return `the page's memory${value ? ` ${value}` : ''}`;
  const given = value && value !== 'X,Y,Z' ? value : '';
  if (!fields[name]) return `“${name.replaceAll('-', ' ')}${given ? ` ${given}` : ''}” (an option of the program)`;
  if (name === 'outside' && given) return `“${fields.outside}: ${values[given] ?? given}”`;
  return `“${fields[name]}”${given ? ` ${given}` : ''}`;
}

/** "/in/a.ply: ..., try --voxel 0.1" becomes "a.ply: ..., try “Voxel” 0.1". */
export const inWords = (message) =>
  withoutFolders(message).replace(
    /--([a-z][a-z-]*)(?:[ =](X,Y,Z|off|on|auto|air|solid|open|tv|estimate|normals|[a-z-]+(?:,[a-z.-]+)+))?(?![a-z])/g,
    (_, name, value) => ofOption(name, value),
  );

/** Where files lie in the engine is of no use to anybody. */
export const withoutFolders = (text) => text.replace(/(^|[\s"'(:;,])\/(?:in|out)\//g, '$1');
