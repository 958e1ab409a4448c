// How surfaces and samples look: one light with the viewer, colors by attribute, the section plane.
import {DataTexture, DoubleSide, LinearFilter, NearestFilter, ShaderMaterial, Vector2, Vector3, Vector4} from 'three';
import {maps} from './color.js';

function texture(map) {
  const made = new DataTexture(maps[map], 256, 1);
  made.magFilter = made.minFilter = map === 'labels' ? NearestFilter : LinearFilter;
  made.needsUpdate = true;
  return made;
}
const textures = Object.fromEntries(Object.keys(maps).map((map) => [map, texture(map)]));

export const modes = {plain: 0, color: 1, scalar: 2, normal: 3};

/** Uniforms that all materials share: objects, so that one change reaches all. */
export const shared = {
  range: {value: new Vector2(0, 1)},
  map: {value: textures.sequential},
  labels: {value: 0},
  section: {value: new Vector4(0, 0, 0, 0)}, // n, d: what has n.p > d is cut away; n = 0: no section
  smooth: {value: 1},
  pixels: {value: 1}, // height of the view in pixels over tan of half its angle
};

export const setMap = (map) => {
  shared.map.value = textures[map];
  shared.labels.value = map === 'labels' ? 1 : 0;
};

const colors = `
uniform vec3 base;
uniform vec2 range;
uniform sampler2D map;
uniform int mode;
uniform int labels;
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toScreen(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
vec3 ownColor(vec3 rgb, float value, vec3 direction) {
  if (mode == 1) return toLinear(rgb);
  if (mode == 3) return toLinear(0.5 + 0.46 * direction);
  if (mode == 2) {
    if (value > 1e37) return vec3(0.3);
    if (labels == 1) return toLinear(texture2D(map, vec2((mod(floor(value + 0.5), 256.0) + 0.5) / 256.0, 0.5)).rgb);
    float at = range.y > range.x ? clamp((value - range.x) / (range.y - range.x), 0.0, 1.0) : 0.5;
    return toLinear(texture2D(map, vec2((at * 255.0 + 0.5) / 256.0, 0.5)).rgb);
  }
  return toLinear(base);
}
vec3 lit(vec3 color, vec3 n) {
  float key = max(dot(n, normalize(vec3(-0.45, 0.6, 0.75))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.8, -0.1, 0.5))), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  float strength = mode == 0 ? 1.0 : 1.12;  // colors that mean something stay bright
  return strength * color * (0.2 + 0.66 * key + 0.16 * fill + 0.14 * sky)
      + (mode < 2 ? 0.045 : 0.008) * pow(max(dot(n, normalize(vec3(-0.3, 0.45, 1.1))), 0.0), 24.0);
}`;

const cutAway = `
uniform vec4 section;
bool isCut(vec3 p) { return dot(section.xyz, p) > section.w; }`;

const surfaceVertex = `
attribute vec3 rgb;
attribute float value;
varying vec3 vNormal, vView, vLocal, vColor, vDirection;
varying float vValue;
void main() {
  vLocal = position;
  vColor = rgb;
  vValue = value;
  vDirection = normal;
  vNormal = normalMatrix * normal;
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vView = view.xyz;
  gl_Position = projectionMatrix * view;
}`;

// Of a surface that is cut, the inside has one flat color: seen through the cut it is the cut face.
const surfaceFragment = `
uniform vec3 inside;
uniform int smooth_;
varying vec3 vNormal, vView, vLocal, vColor, vDirection;
varying float vValue;
${colors}
${cutAway}
void main() {
  if (isCut(vLocal)) discard;
  vec3 facet = normalize(cross(dFdx(vView), dFdy(vView)));
  vec3 n = smooth_ == 1 && dot(vNormal, vNormal) > 0.0 ? normalize(vNormal) : facet;
  if (dot(n, vView) > 0.0 && (!gl_FrontFacing || smooth_ == 0)) n = -n;
  vec3 color;
  if (gl_FrontFacing) color = lit(ownColor(vColor, vValue, vDirection), n);
  else if (dot(section.xyz, section.xyz) > 0.0) color = toLinear(inside) * (0.86 + 0.14 * max(n.z, 0.0));
  else color = lit(toLinear(inside), n);
  gl_FragColor = vec4(toScreen(color), 1.0);
}`;

const pointsVertex = `
attribute vec3 rgb;
attribute float value;
uniform float radius;
uniform float pixels;
varying vec3 vNormal, vLocal, vColor, vDirection;
varying float vValue;
void main() {
  vLocal = position;
  vColor = rgb;
  vValue = value;
  vDirection = normal;
  vNormal = normalMatrix * normal;
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * view;
  gl_PointSize = clamp(pixels * radius / max(-view.z, 1e-30), 1.5, 64.0);
}`;

const pointsFragment = `
varying vec3 vNormal, vLocal, vColor, vDirection;
varying float vValue;
${colors}
${cutAway}
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  if (isCut(vLocal) || dot(at, at) > 1.0) discard;
  vec3 n = vec3(at.x, -at.y, sqrt(1.0 - dot(at, at)));
  if (dot(vNormal, vNormal) > 0.0) n = normalize(vNormal + 0.35 * n);
  if (n.z < 0.0) n = -n;
  gl_FragColor = vec4(toScreen(lit(ownColor(vColor, vValue, vDirection), n)), 1.0);
}`;

const own = (base) => ({base: {value: new Vector3(...base)}, mode: {value: modes.plain}});

export function surfaceMaterial(base, inside) {
  const uniforms = {
    ...own(base),
    inside: {value: new Vector3(...inside)},
    range: shared.range,
    map: shared.map,
    labels: shared.labels,
    section: shared.section,
    smooth_: shared.smooth,
  };
  return new ShaderMaterial({
    uniforms,
    vertexShader: surfaceVertex,
    fragmentShader: surfaceFragment,
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

export function pointsMaterial(base, radius) {
  const uniforms = {
    ...own(base),
    radius: {value: radius},
    pixels: shared.pixels,
    range: shared.range,
    map: shared.map,
    labels: shared.labels,
    section: shared.section,
  };
  return new ShaderMaterial({uniforms, vertexShader: pointsVertex, fragmentShader: pointsFragment});
}

/** Lines over a surface; the section cuts them, too. */
export function edgesMaterial() {
  return new ShaderMaterial({
    uniforms: {section: shared.section},
    wireframe: true,
    transparent: true,
    vertexShader: `varying vec3 vLocal;
      void main() { vLocal = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `varying vec3 vLocal;
      ${cutAway}
      void main() { if (isCut(vLocal)) discard; gl_FragColor = vec4(0.05, 0.07, 0.1, 0.35); }`,
  });
}
