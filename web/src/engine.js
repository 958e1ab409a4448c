// Soapfilm compiled for browsers, as functions of JavaScript. Runs in a worker, and in node for tests.
import {checkMesh, checkTarget} from './given.js';

/** `create` is what Emscripten makes; `onEvent(kind, fraction, text)` hears of stages, progress and warnings. */
export async function engine(create, onEvent) {
  const module = await create({onEvent});
  const {FS} = module;
  const call = (name, result, types = [], values = []) => module.ccall(name, result, types, values);
  /** An address or a count: of 32 bits without a sign. */
  const size = (...args) => call(args[0], 'number', ...args.slice(1)) >>> 0;
  /** Throws what was refused. */
  const must = (message) => {
    if (message) throw new Error(message);
  };
  for (const folder of ['/in', '/out']) FS.mkdir(folder);
  /** An array of the mesh that is given to the engine, or of the one that it has: null if it has none. */
  const array = (Type, name, length, given = false, ...index) => {
    const types = ['boolean', ...index.map(() => 'number')];
    const address = size(name, types, [given, ...index]);
    return address ? new Type(module.HEAPU8.buffer, address, length) : null;
  };

  /** Fills in the mesh in the engine. All rooms are made first: its memory moves when it grows. */
  function give(mesh) {
    const {vertices, triangles, channels} = checkMesh(mesh);
    const {positions, indices, normals, colors, attributes = []} = mesh;
    const types = ['number', 'number', 'boolean', 'boolean'];
    must(call('web_give', 'string', types, [vertices, triangles, !!normals, !!colors]));
    for (const {name} of attributes) must(call('web_give_attribute', 'string', ['string'], [name]));
    array(Float64Array, 'web_vertex_data', 3 * vertices, true)?.set(positions);
    array(Uint32Array, 'web_triangle_data', 3 * triangles, true)?.set(indices);
    array(Float32Array, 'web_normal_data', 3 * vertices, true)?.set(normals);
    const rgb = array(Uint8Array, 'web_color_data', 3 * vertices, true);
    for (let i = 0; rgb && i < rgb.length; ++i) rgb[i] = colors[channels * Math.floor(i / 3) + (i % 3)];
    attributes.forEach(({values}, k) => array(Float32Array, 'web_attribute_data', vertices, true, k)?.set(values));
  }

  /** Copies: the memory of the engine moves when it grows. `positionsOf(world)` makes the positions. */
  function meshBy(positionsOf) {
    const vertices = size('web_vertices'),
      triangles = size('web_triangles');
    const rgb = array(Uint8Array, 'web_color_data', 3 * vertices);
    const colors = rgb && new Uint8Array(4 * vertices).fill(255);
    for (let i = 0; rgb && i < rgb.length; ++i) colors[4 * Math.floor(i / 3) + (i % 3)] = rgb[i];
    const attributes = [];
    for (let k = 0, name; (name = call('web_attribute_name', 'string', ['number'], [k])); ++k)
      attributes.push({name, values: array(Float32Array, 'web_attribute_data', vertices, false, k).slice()});
    return {
      positions: positionsOf(array(Float64Array, 'web_vertex_data', 3 * vertices) ?? new Float64Array(0)),
      normals: array(Float32Array, 'web_normal_data', 3 * vertices)?.slice() ?? null,
      colors,
      attributes,
      indices: array(Uint32Array, 'web_triangle_data', 3 * triangles)?.slice() ?? new Uint32Array(0),
    };
  }

  return {
    version: () => call('web_version', 'string'),

    /** A file's bytes become part of the cloud, or lie there for a set that names them. */
    put: (name, bytes) => FS.writeFile(`/in/${name}`, bytes, {canOwn: true}),
    read(name) {
      must(call('web_read', 'string', ['string'], [`/in/${name}`]));
    },
    forget: (name) => FS.unlink(`/in/${name}`),
    /** What was read; `parameters` are those of the run, for the smallest voxel that fits into their memory. */
    summary(parameters = {}) {
      must(call('web_summary', 'string', ['string'], [JSON.stringify(parameters)]));
      return JSON.parse(call('web_summary_text', 'string'));
    },

    /** Samples for a first picture: {positions, colors or null} around the origin. */
    preview(most, origin) {
      const count = size('web_preview', ['number', 'number', 'number', 'number'], [most, ...origin]);
      const at = size('web_preview_data') / 4;
      const rows = new Float32Array(module.HEAPF32.buffer, 4 * at, 6 * count);
      const positions = new Float32Array(3 * count),
        colors = new Uint8Array(4 * count);
      for (let i = 0; i < count; ++i) {
        for (let k = 0; k < 3; ++k) {
          positions[3 * i + k] = rows[6 * i + k];
          colors[4 * i + k] = Math.round(255 * rows[6 * i + 3 + k]);
        }
        colors[4 * i + 3] = 255;
      }
      return {positions, colors: count && rows[3] >= 0 ? colors : null};
    },

    reconstruct(parameters) {
      must(call('web_reconstruct', 'string', ['string'], [JSON.stringify(parameters)]));
    },

    mesh(origin) {
      return meshBy((world) => {
        const positions = new Float32Array(world.length);
        for (let i = 0; i < positions.length; ++i) positions[i] = world[i] - origin[i % 3];
        return positions;
      });
    },

    /**
     * Fewer triangles, within a proved distance: {mesh, report}. `mesh`: arrays, the name of a file that was put, or
     * null for the engine's own. The engine has the smaller one afterwards: write() writes it.
     */
    simplify(mesh, target) {
      const [tolerance, triangles] = checkTarget(target);
      if (typeof mesh === 'string') must(call('web_give_file', 'string', ['string'], [`/in/${mesh}`]));
      else if (mesh !== null) give(mesh);
      const types = ['boolean', 'number', 'number'];
      must(call('web_simplify', 'string', types, [mesh !== null, tolerance, triangles]));
      const Type = mesh?.positions instanceof Float32Array ? Float32Array : Float64Array;
      return {mesh: meshBy((world) => new Type(world)), report: JSON.parse(call('web_report', 'string'))};
    },
    report: () => call('web_report', 'string'),

    /** The mesh as a file's bytes. */
    write(name) {
      must(call('web_write', 'string', ['string'], [`/out/${name}`]));
      const bytes = FS.readFile(`/out/${name}`);
      FS.unlink(`/out/${name}`);
      return bytes;
    },
    memory: () => module.HEAPU8.length,
  };
}
