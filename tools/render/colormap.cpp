#include "tools/render/colormap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace soapfilm {

namespace {

constexpr Rgb8 map_stops[] = {{68, 1, 84}, {59, 82, 139}, {33, 144, 141}, {93, 201, 99}, {253, 231, 37}};
constexpr Rgb8 no_value{150, 150, 150};

// Oklab (Ottosson 2020): a space in which equal steps look about equally large.
Vec3d oklab(Rgb8 color) {
  const Vec3d c(to_linear(color));
  const double l = std::cbrt(0.4122214708 * c.x + 0.5363325363 * c.y + 0.0514459929 * c.z);
  const double m = std::cbrt(0.2119034982 * c.x + 0.6806995451 * c.y + 0.1073969566 * c.z);
  const double s = std::cbrt(0.0883024619 * c.x + 0.2817188376 * c.y + 0.6299787005 * c.z);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb8 from_oklab(Vec3d lab) {
  const double l = std::pow(lab.x + 0.3963377774 * lab.y + 0.2158037573 * lab.z, 3);
  const double m = std::pow(lab.x - 0.1055613458 * lab.y - 0.0638541728 * lab.z, 3);
  const double s = std::pow(lab.x - 0.0894841775 * lab.y - 1.2914855480 * lab.z, 3);
  return to_srgb(Vec3f(Vec3d{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                             -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                             -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s}));
}

}  // namespace

Vec3f to_linear(Rgb8 color) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t;
    for (int i = 0; i < 256; ++i) {
      const double v = i / 255.0;
      t[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return {table[color[0]], table[color[1]], table[color[2]]};
}

Rgb8 to_srgb(Vec3f linear) {
  Rgb8 out;
  for (int k = 0; k < 3; ++k) {
    const double v = std::clamp(static_cast<double>(linear[k]), 0.0, 1.0);
    out[k] =
        static_cast<uint8_t>(std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
  }
  return out;
}

Rgb8 map_color(double t) {
  if (std::isnan(t)) return no_value;
  constexpr int pieces = static_cast<int>(std::size(map_stops)) - 1;
  const double at = std::clamp(t, 0.0, 1.0) * pieces;
  const int piece = std::min(static_cast<int>(at), pieces - 1);
  const double share = at - piece;
  return from_oklab(oklab(map_stops[piece]) * (1 - share) + oklab(map_stops[piece + 1]) * share);
}

Rgb8 palette_color(size_t index) {
  // Hues by the golden angle at constant lightness and chroma.
  const double hue = 0.7 + 2.399963229728653 * static_cast<double>(index % 12);
  return from_oklab({0.74, 0.1 * std::cos(hue), 0.1 * std::sin(hue)});
}

}  // namespace soapfilm
