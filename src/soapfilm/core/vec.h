// Small fixed-size vectors: the only geometry types in public headers.
#pragma once

#include <cmath>
#include <cstdint>

namespace soapfilm {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr const T& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr bool operator==(const Vec3&) const = default;

  template <class U>
  constexpr explicit operator Vec3<U>() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }
};

/// The axes' values moved along by `turn` places: axis k has the value of axis (k + turn) % 3. `turn` in [0, 3].
template <class T>
constexpr Vec3<T> turned(Vec3<T> v, int turn) {
  return turn == 1 ? Vec3<T>{v.y, v.z, v.x} : turn == 2 ? Vec3<T>{v.z, v.x, v.y} : v;
}

using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;
using Vec3i = Vec3<int32_t>;

template <class T>
constexpr Vec3<T> operator+(Vec3<T> a, Vec3<T> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
constexpr Vec3<T> operator-(Vec3<T> a, Vec3<T> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
constexpr Vec3<T> operator-(Vec3<T> a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
constexpr Vec3<T> operator*(Vec3<T> a, T s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T>
constexpr Vec3<T> operator*(T s, Vec3<T> a) {
  return a * s;
}
template <class T>
constexpr Vec3<T> operator/(Vec3<T> a, T s) {
  return {a.x / s, a.y / s, a.z / s};
}
template <class T>
constexpr Vec3<T>& operator+=(Vec3<T>& a, Vec3<T> b) {
  return a = a + b;
}

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T norm(Vec3<T> a) {
  return std::sqrt(dot(a, a));
}

/// Unit vector along `a`; the zero vector stays zero.
template <class T>
Vec3<T> normalized(Vec3<T> a) {
  const T n = norm(a);
  return n > T(0) ? a / n : Vec3<T>{};
}

template <class T>
bool is_finite(Vec3<T> a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace soapfilm
