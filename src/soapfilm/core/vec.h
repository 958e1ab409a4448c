// Arithmetic of vectors.
#pragma once

#include <cmath>

#include "soapfilm/vec.h"

namespace soapfilm {

/// The values permuted cyclically: axis k has the value of axis (k + shift) % 3. `shift` in [0, 3].
template <class T>
constexpr Vec3<T> permuted(Vec3<T> v, int shift) {
  return shift == 1 ? Vec3<T>{v.y, v.z, v.x} : shift == 2 ? Vec3<T>{v.z, v.x, v.y} : v;
}

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
