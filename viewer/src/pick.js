// What is under the pointer: rays against all triangles and samples, in double precision.
import {Vector3} from 'three';

/** The ray through a place of a view, CSS pixels from its upper left corner. */
export function rayThrough(view, x, y) {
  const {camera} = view;
  camera.updateMatrixWorld(); // it may have moved since it was drawn
  const far = new Vector3((2 * x) / view.width - 1, 1 - (2 * y) / view.height, 0.5).unproject(camera);
  const from = camera.position;
  const direction = far.sub(from).normalize();
  return {from: [from.x, from.y, from.z], direction: [direction.x, direction.y, direction.z]};
}

const isCut = (section, x, y, z) => section.x * x + section.y * y + section.z * z > section.w;

/** The first triangle on the ray that the section leaves (Moeller and Trumbore 1997): {t, point, corners}. */
export function firstTriangle(positions, indices, ray, section) {
  const [ox, oy, oz] = ray.from,
    [dx, dy, dz] = ray.direction;
  let best = Infinity,
    at = -1;
  for (let i = 0; i < indices.length; i += 3) {
    const a = 3 * indices[i],
      b = 3 * indices[i + 1],
      c = 3 * indices[i + 2];
    const ax = positions[a],
      ay = positions[a + 1],
      az = positions[a + 2];
    const ux = positions[b] - ax,
      uy = positions[b + 1] - ay,
      uz = positions[b + 2] - az;
    const vx = positions[c] - ax,
      vy = positions[c + 1] - ay,
      vz = positions[c + 2] - az;
    const px = dy * vz - dz * vy,
      py = dz * vx - dx * vz,
      pz = dx * vy - dy * vx;
    const volume = ux * px + uy * py + uz * pz;
    if (volume === 0) continue;
    const sx = ox - ax,
      sy = oy - ay,
      sz = oz - az;
    const u = (sx * px + sy * py + sz * pz) / volume;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy,
      qy = sz * ux - sx * uz,
      qz = sx * uy - sy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / volume;
    if (v < 0 || u + v > 1) continue;
    const t = (vx * qx + vy * qy + vz * qz) / volume;
    if (t <= 0 || t >= best || isCut(section, ox + t * dx, oy + t * dy, oz + t * dz)) continue;
    best = t;
    at = i;
  }
  if (at < 0) return null;
  return {t: best, point: [ox + best * dx, oy + best * dy, oz + best * dz], corners: indices.subarray(at, at + 3)};
}

/** The nearest of the samples that lie within `slope` of the ray, relative to their distance: {t, point, sample}. */
export function firstSample(positions, ray, slope, section) {
  const [ox, oy, oz] = ray.from,
    [dx, dy, dz] = ray.direction;
  let best = Infinity,
    at = -1;
  for (let i = 0; i < positions.length; i += 3) {
    const x = positions[i] - ox,
      y = positions[i + 1] - oy,
      z = positions[i + 2] - oz;
    const t = x * dx + y * dy + z * dz;
    if (t <= 0) continue;
    const aside = Math.max(x * x + y * y + z * z - t * t, 0) / (t * t);
    if (aside > slope * slope) continue;
    // Among samples at about the same distance the one nearest to the ray.
    const score = t * (1 + 4 * Math.sqrt(aside));
    if (score >= best || isCut(section, positions[i], positions[i + 1], positions[i + 2])) continue;
    best = score;
    at = i;
  }
  if (at < 0) return null;
  return {t: best, point: [positions[at], positions[at + 1], positions[at + 2]], sample: at / 3};
}

/** The corner of the triangle nearest to the point on it. */
export function nearestCorner(positions, hit) {
  let best = null,
    least = Infinity;
  for (const corner of hit.corners) {
    const point = [0, 1, 2].map((k) => positions[3 * corner + k]);
    const distance = Math.hypot(...point.map((v, k) => v - hit.point[k]));
    if (distance < least) [least, best] = [distance, {vertex: corner, point}];
  }
  return best;
}

/** What is seen at a place of a view: {point, item, vertex, sample}; `toVertex`: the triangle's nearest corner. */
export function pick(data, view, place, section, toVertex) {
  const ray = rayThrough(view, place.x, place.y);
  const slope = (7 * 2 * Math.tan(((view.camera.fov / 2) * Math.PI) / 180)) / view.height;
  let found = null;
  for (const item of data.items) {
    if (!item.views[view.index]) continue;
    const hit = item.indices
      ? firstTriangle(item.positions, item.indices, ray, section)
      : firstSample(item.positions, ray, slope, section);
    if (!hit || (found && hit.t >= found.t)) continue;
    found = {...hit, item};
  }
  if (!found) return null;
  if (found.item.indices) {
    const corner = nearestCorner(found.item.positions, found);
    found.vertex = corner.vertex;
    if (toVertex) found.point = corner.point;
  } else {
    found.vertex = found.sample;
  }
  return found;
}
