// The data in the page: JSON that says what there is, and arrays as text (base64) in elements of their own.
import {MeshoptDecoder} from 'meshoptimizer/decoder';
import {breathe, byId} from './dom.js';

const piece = 1 << 20; // characters decoded at once; a multiple of 4

/** Decodes base64 without blocking the page; `done(characters)` is called after each piece. */
async function fromBase64(text, done) {
  const padding = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
  const bytes = new Uint8Array((text.length / 4) * 3 - padding);
  for (let at = 0, to = 0; at < text.length; at += piece) {
    const part = text.slice(at, at + piece);
    if (bytes.setFromBase64) {
      to += bytes.subarray(to).setFromBase64(part).written;
    } else {
      const binary = atob(part);
      for (let i = 0; i < binary.length; ++i) bytes[to++] = binary.charCodeAt(i);
    }
    done(part.length);
    await breathe();
  }
  return bytes;
}

/** The array that `entry` of the JSON describes, as raw bytes. */
async function readArray(entry, done) {
  const holder = byId(`data${entry.id}`);
  const coded = await fromBase64(holder.textContent.trim(), done);
  holder.remove(); // the text is not needed any more
  const bytes = new Uint8Array(entry.count * entry.stride);
  if (entry.coding === 'triangles') MeshoptDecoder.decodeIndexBuffer(bytes, entry.count, entry.stride, coded);
  else MeshoptDecoder.decodeVertexBuffer(bytes, entry.count, entry.stride, coded);
  return bytes;
}

const floats = (bytes) => new Float32Array(bytes.buffer);

/** Unit vectors from two 16-bit numbers each (octahedral map, Meyer et al. 2010). (0, 0, 0) is coded as -32768. */
export function unpackNormals(bytes) {
  const coded = new Int16Array(bytes.buffer);
  const normals = new Float32Array((coded.length / 2) * 3);
  for (let i = 0, to = 0; i < coded.length; i += 2, to += 3) {
    if (coded[i] === -32768) continue;
    let x = coded[i] / 32767,
      y = coded[i + 1] / 32767;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) {
      const fold = x;
      x = (1 - Math.abs(y)) * (x >= 0 ? 1 : -1);
      y = (1 - Math.abs(fold)) * (y >= 0 ? 1 : -1);
    }
    const length = Math.hypot(x, y, z);
    normals[to] = x / length;
    normals[to + 1] = y / length;
    normals[to + 2] = z / length;
  }
  return normals;
}

async function readItem(item, done) {
  const array = (entry) => readArray(entry, done);
  item.positions = floats(await array(item.positions));
  if (item.indices) item.indices = new Uint32Array((await array(item.indices)).buffer);
  if (item.normals) item.normals = unpackNormals(await array(item.normals));
  if (item.colors) item.colors = await array(item.colors);
  for (const attribute of item.attributes) attribute.values = floats(await array(attribute.data));
}

/** The scene with all its arrays; `progress(share)` is told how much is read. */
export async function readScene(progress) {
  const scene = JSON.parse(byId('scene').textContent);
  await MeshoptDecoder.ready;
  const total = scene.characters || 1;
  let read = 0;
  const done = (characters) => progress(Math.min(1, (read += characters) / total));
  for (const item of scene.items) await readItem(item, done);
  return scene;
}
