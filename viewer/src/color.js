// Color maps that look evenly spaced: made in Oklab (Ottosson 2020), as tools/render/colormap.cpp makes them.

const sequential = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 144, 141],
  [93, 201, 99],
  [253, 231, 37],
];
const diverging = [
  [33, 82, 156],
  [109, 158, 211],
  [231, 231, 228],
  [226, 138, 96],
  [158, 46, 38],
];

const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
const gamma = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

function oklab(color) {
  const [r, g, b] = color.map((v) => linear(v / 255));
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function fromOklab([lightness, a, b]) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const rgb = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return rgb.map((v) => Math.round(255 * gamma(Math.min(1, Math.max(0, v)))));
}

/** 256 colors between the stops, RGBA. */
function table(stops) {
  const lab = stops.map(oklab);
  const colors = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (lab.length - 1);
    const k = Math.min(Math.floor(at), lab.length - 2);
    const mixed = lab[k].map((v, c) => v + (lab[k + 1][c] - v) * (at - k));
    colors.set([...fromOklab(mixed), 255], 4 * i);
  }
  return colors;
}

/** Well-separated colors of like lightness: hues by the golden angle. */
export function labelColor(index) {
  const hue = 0.7 + 2.399963229728653 * (index % 12);
  return fromOklab([0.74, 0.1 * Math.cos(hue), 0.1 * Math.sin(hue)]);
}

function labelTable() {
  const colors = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) colors.set([...labelColor(i), 255], 4 * i);
  return colors;
}

export const maps = {sequential: table(sequential), diverging: table(diverging), labels: labelTable()};

const css = (colors, i) => `rgb(${colors[4 * i]} ${colors[4 * i + 1]} ${colors[4 * i + 2]})`;

/** [share, color] of a map, near enough together. */
export function gradientStops(map) {
  const stops = [];
  for (let i = 0; i < 256; i += 15) stops.push([i / 255, css(maps[map], i)]);
  return stops;
}

/** A map as CSS, from left to right. */
export const gradient = (map) =>
  `linear-gradient(to right, ${gradientStops(map)
    .map(([, color]) => color)
    .join(',')})`;

export const labelCss = (index) => css(maps.labels, index % 256);
