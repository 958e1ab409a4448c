// The items of the scene as three.js objects, and what they can be colored by.
import {BufferAttribute, BufferGeometry, Mesh, Points, Scene} from 'three';
import {coarseIndices} from './coarse.js';
import {forEachFace} from './faces.js';
import {edgesMaterial, modes, pointsMaterial, surfaceMaterial} from './material.js';

const clay = [
  [222, 204, 180],
  [176, 196, 214],
  [196, 208, 176],
  [214, 186, 198],
  [204, 196, 220],
];
const slate = [
  [96, 125, 153],
  [150, 118, 92],
  [110, 140, 104],
  [150, 104, 128],
  [116, 112, 156],
];
const inside = [196, 88, 68];
const unit = (rgb) => rgb.map((v) => v / 255);
export const missing = 3e38; // stands for not-a-number in shaders

/** Normals of vertices: the triangles' ones, weighted by area. In pieces, so that the page stays alive. */
async function vertexNormals(positions, indices) {
  const normals = new Float32Array(positions.length);
  await forEachFace(positions, indices, (a, b, c, x, y, z) => {
    for (const corner of [a, b, c]) {
      normals[corner] += x;
      normals[corner + 1] += y;
      normals[corner + 2] += z;
    }
  });
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]);
    if (length > 0) for (let k = 0; k < 3; ++k) normals[i + k] /= length;
  }
  return normals;
}

function withoutNan(values) {
  const shown = new Float32Array(values.length);
  for (let i = 0; i < values.length; ++i) shown[i] = Number.isNaN(values[i]) ? missing : values[i];
  return shown;
}

/** Makes the objects of an item: in layer k of the cameras it is shown by view k. */
async function build(item, index) {
  const palette = item.indices ? clay : slate;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(item.positions, 3));
  const normals = item.normals ?? (item.indices ? await vertexNormals(item.positions, item.indices) : null);
  if (normals) geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  if (item.colors) geometry.setAttribute('rgb', new BufferAttribute(item.colors, 4, true));
  if (item.indices) {
    geometry.setIndex(new BufferAttribute(item.indices, 1));
    item.object = new Mesh(geometry, surfaceMaterial(unit(palette[index % palette.length]), unit(inside)));
  } else {
    item.object = new Points(geometry, pointsMaterial(unit(palette[index % palette.length]), item.radius));
  }
  item.base = palette[index % palette.length];
  item.object.frustumCulled = false;
  item.object.matrixAutoUpdate = false;
  item.hasNormals = Boolean(normals);
  return item.object;
}

export async function buildScene(data) {
  const scene = new Scene();
  const counts = {mesh: 0, samples: 0}; // each kind has colors of its own
  for (const item of data.items) scene.add(await build(item, counts[item.kind]++));
  return scene;
}

/** Shows the item in the views whose number is set in `views`. */
export function showIn(item, views) {
  item.views = views;
  for (const object of [item.object, item.edges, item.coarse]) {
    if (!object) continue;
    object.layers.disableAll();
    views.forEach((on, view) => on && object.layers.enable(view));
  }
}

/** Meshes of so many triangles together get coarse pictures, for while the camera moves. */
export async function makeCoarse(data, limit) {
  const meshes = data.items.filter((item) => item.indices);
  const triangles = meshes.reduce((sum, item) => sum + item.triangles, 0);
  if (triangles <= limit) return false;
  for (const item of meshes) {
    const indices = await coarseIndices(item.positions, item.indices, (limit / 4) * (item.triangles / triangles));
    const geometry = new BufferGeometry();
    geometry.attributes = item.object.geometry.attributes; // the same ones, now and later
    geometry.setIndex(new BufferAttribute(indices, 1));
    item.coarse = new Mesh(geometry, item.object.material);
    Object.assign(item.coarse, {frustumCulled: false, matrixAutoUpdate: false, visible: false});
    item.object.parent.add(item.coarse);
    showIn(item, item.views);
  }
  return true;
}

export function showCoarse(data, on) {
  for (const item of data.items) {
    if (!item.coarse) continue;
    item.coarse.visible = on;
    item.object.visible = !on;
    if (item.edges) item.edges.visible = !on && item.edgesOn;
  }
}

/** The edges of the triangles, made when they are first asked for. */
export function showEdges(data, on) {
  for (const item of data.items) {
    if (!item.indices) continue;
    if (on && !item.edges) {
      item.edges = new Mesh(item.object.geometry, edgesMaterial());
      item.edges.frustumCulled = false;
      item.object.parent.add(item.edges);
      showIn(item, item.views);
    }
    item.edgesOn = on;
    if (item.edges) item.edges.visible = on && item.object.visible;
  }
}

/** What some item can be colored by: {key, text, kind, ...}, scalars with their range over all items. */
export function colorings(data) {
  const found = [{key: 'plain', text: 'Nothing', kind: 'plain'}];
  if (data.items.some((item) => item.colors)) found.push({key: 'color', text: 'Its own colors', kind: 'color'});
  const scalars = new Map();
  for (const item of data.items) {
    for (const attribute of item.attributes) {
      const known = scalars.get(attribute.name);
      if (!known) {
        scalars.set(attribute.name, {
          ...attribute,
          values: null,
          offset: 0,
          key: `value ${attribute.name}`,
          text: attribute.name,
          kind: attribute.labels ? 'labels' : 'scalar',
        });
      } else {
        for (const end of ['lo', 'low']) known[end] = Math.min(known[end], attribute[end]);
        for (const end of ['hi', 'high']) known[end] = Math.max(known[end], attribute[end]);
      }
    }
  }
  found.push(...scalars.values());
  found.push({key: 'height', text: 'Height', kind: 'scalar', length: true});
  if (data.items.some((item) => item.hasNormals)) found.push({key: 'normal', text: 'Normals', kind: 'normal'});
  return found;
}

/** Heights along the axis `up`, relative to the origin of the page; sets the coloring's range. */
function heights(data, coloring, up) {
  const axis = up.axis;
  coloring.lo = Math.min(...data.items.map((item) => item.box.lo[axis])) - data.origin[axis];
  coloring.hi = Math.max(...data.items.map((item) => item.box.hi[axis])) - data.origin[axis];
  [coloring.low, coloring.high] = [coloring.lo, coloring.hi];
  coloring.offset = data.origin[axis];
  return (item) => {
    const values = new Float32Array(item.positions.length / 3);
    for (let i = 0; i < values.length; ++i) values[i] = item.positions[3 * i + axis];
    return values;
  };
}

/** Colors all items by `coloring`; those that do not have it are plain. */
export function colorBy(data, coloring, up) {
  const height = coloring.key === 'height' ? heights(data, coloring, up) : null;
  coloring.shown = [];
  for (const item of data.items) {
    const uniforms = item.object.material.uniforms;
    const attribute = item.attributes.find((one) => `value ${one.name}` === coloring.key);
    const values = height ? height(item) : attribute ? withoutNan(attribute.values) : null;
    const geometry = item.object.geometry;
    geometry.deleteAttribute('value');
    if (values) geometry.setAttribute('value', new BufferAttribute(values, 1));
    if (values) coloring.shown.push({item, values});
    const has = coloring.kind === 'color' ? item.colors : coloring.kind === 'normal' ? item.hasNormals : values;
    const mode = coloring.kind === 'labels' ? 'scalar' : coloring.kind;
    uniforms.mode.value = has ? modes[mode] : modes.plain;
  }
}
