#include "tools/render/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soapfilm::render_detail {

namespace {

// Camera frame: x to the right, y up, z towards the viewer.
const Vec3f key_direction = normalized(Vec3f{-0.62f, 0.62f, 0.48f});  // grazing: steps and pits throw shadows
const Vec3f fill_direction = normalized(Vec3f{0.7f, 0.1f, 0.7f});
constexpr Vec3f key_light{0.84f, 0.80f, 0.74f};   // warm
constexpr Vec3f fill_light{0.11f, 0.12f, 0.13f};  // cool
constexpr Vec3f sky_above{0.42f, 0.46f, 0.50f};
constexpr Vec3f sky_below{0.16f, 0.16f, 0.16f};
constexpr float sheen_strength = 0.08f;
constexpr float sheen_exponent = 30;
constexpr int key_rays = 3;
constexpr float key_spread = 0.12f;  // tangent of the light's angular radius: how soft shadows are
constexpr float key_reach = 4;       // scene units: beyond everything
constexpr float sky_reach = 0.7f;    // occluders farther away than a quarter of the object do not darken

/// A bijection whose output bits all depend on all input bits (Wellons' lowbias32).
uint32_t hash(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

float frac(double x) { return static_cast<float>(x - std::floor(x)); }

/// Two unit vectors at right angles to `n` and to each other (Duff et al. 2017).
void tangents(Vec3f n, Vec3f& a, Vec3f& b) {
  const float sign = std::copysign(1.f, n.z);
  const float s = -1 / (sign + n.z);
  const float t = n.x * n.y * s;
  a = {1 + sign * n.x * n.x * s, sign * t, -sign * n.x};
  b = {t, sign + n.y * n.y * s, -n.y};
}

Vec3f around(Vec3f axis, float u, float v, float radius, float height) {
  Vec3f a, b;
  tangents(axis, a, b);
  const float angle = 2 * std::numbers::pi_v<float> * u;
  const float r = radius * std::sqrt(v);
  return a * (r * std::cos(angle)) + b * (r * std::sin(angle)) + axis * height;
}

/// Cosine-weighted around the shading normal, mirrored to stay above the surface.
Vec3f sky_ray(const SurfacePoint& point, float u, float v) {
  const Vec3f d = around(point.normal, u, v, 1, std::sqrt(1 - v));
  const float below = dot(d, point.geometric_normal);
  return below >= 0 ? d : d - point.geometric_normal * (2 * below);
}

/// What part of the key light and of the sky a point sees, each in [0, 1].
struct Visibility {
  float key = 1;
  float sky = 1;
};

Visibility measure_surroundings(const Scene& scene, const SurfacePoint& point, const PixelPattern& pattern, int sample,
                                int sky_rays) {
  const int total = key_rays + sky_rays;
  float key = 0;
  float sky = 0;
  for (int first = 0; first < total; first += packet) {
    OcclusionRays rays;
    rays.count = std::min(packet, total - first);
    for (int i = 0; i < rays.count; ++i) {
      const int k = first + i;
      float u, v;
      // The two kinds use different parts of one sequence.
      pattern.point(k < key_rays ? -1 - (sample * key_rays + k) : sample * sky_rays + k - key_rays, u, v);
      const Vec3f d = k < key_rays ? normalized(around(key_direction, u, v, key_spread, 1)) : sky_ray(point, u, v);
      rays.x[i] = d.x;
      rays.y[i] = d.y;
      rays.z[i] = d.z;
      rays.reach[i] = k < key_rays ? key_reach : sky_reach;
    }
    scene.test_occlusion(point, rays);
    for (int i = 0; i < rays.count; ++i) (first + i < key_rays ? key : sky) += rays.visible[i];
  }
  return {key / key_rays, sky_rays > 0 ? sky / static_cast<float>(sky_rays) : 1.f};
}

}  // namespace

PixelPattern::PixelPattern(int x, int y) {
  const uint32_t h = hash(static_cast<uint32_t>(x) + hash(static_cast<uint32_t>(y)));
  shift_u_ = h * 0x1.0p-32;
  shift_v_ = hash(h) * 0x1.0p-32;
}

void PixelPattern::point(int k, float& u, float& v) const {
  u = std::min(frac(shift_u_ + k * 0.7548776662466927), 0x1.fffffep-1f);
  v = std::min(frac(shift_v_ + k * 0.5698402909980532), 0x1.fffffep-1f);
}

Vec3f shade(const Scene& scene, const SurfacePoint& point, const PixelPattern& pattern, int sample,
            int occlusion_rays) {
  const Vec3f n = point.normal;
  const Visibility open = measure_surroundings(scene, point, pattern, sample, occlusion_rays);
  // A triangle that faces away from the light must not get any through its interpolated normal.
  const float key =
      dot(point.geometric_normal, key_direction) > 0 ? std::max(0.f, dot(n, key_direction)) * open.key : 0.f;
  const float fill = std::max(0.f, dot(n, fill_direction)) * open.sky;
  const float above = 0.5f + 0.5f * n.y;
  const Vec3f sky = (sky_above * above + sky_below * (1 - above)) * open.sky;
  const Vec3f light = key_light * key + fill_light * fill + sky;
  const Vec3f halfway = normalized(key_direction + Vec3f{0, 0, 1});
  const float sheen =
      key > 0 ? sheen_strength * open.key * std::pow(std::max(0.f, dot(n, halfway)), sheen_exponent) : 0.f;
  return Vec3f{point.color.x * light.x, point.color.y * light.y, point.color.z * light.z} + key_light * sheen;
}

}  // namespace soapfilm::render_detail
