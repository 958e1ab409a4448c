// Soapfilm compiled for browsers, as functions of JavaScript. Runs in a worker, and in node for tests.

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

    /** Copies: the memory of the engine moves when it grows. */
    mesh(origin) {
      const vertices = size('web_vertices'),
        triangles = size('web_triangles');
      const {buffer} = module.HEAPU8;
      const world = new Float64Array(buffer, size('web_vertex_data'), 3 * vertices);
      const positions = new Float32Array(3 * vertices);
      for (let i = 0; i < positions.length; ++i) positions[i] = world[i] - origin[i % 3];
      const colorsAt = size('web_color_data');
      let colors = null;
      if (colorsAt) {
        const rgb = new Uint8Array(buffer, colorsAt, 3 * vertices);
        colors = new Uint8Array(4 * vertices).fill(255);
        for (let i = 0; i < vertices; ++i) colors.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
      }
      const attributes = [];
      for (let k = 0, name; (name = call('web_attribute_name', 'string', ['number'], [k])); ++k) {
        const values = new Float32Array(buffer, size('web_attribute_data', ['number'], [k]), vertices).slice();
        attributes.push({name, values});
      }
      return {
        positions,
        colors,
        attributes,
        indices: new Uint32Array(buffer, size('web_triangle_data'), 3 * triangles).slice(),
      };
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
