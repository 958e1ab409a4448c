// The same cloud, its samples in another order.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/random.h"

namespace soapfilm::test {

inline std::vector<uint32_t> random_order(size_t count, uint64_t seed) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  Random random(seed);
  for (size_t k = count; k > 1; --k) std::swap(order[k - 1], order[random.next() % k]);
  return order;
}

template <class T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<uint32_t>& order) {
  std::vector<T> taken;
  if (values.empty()) return taken;
  for (const uint32_t i : order) taken.push_back(values[i]);
  return taken;
}

/// Of clouds with one scan or none.
inline PointCloud shuffled(PointCloud cloud, uint64_t seed) {
  const std::vector<uint32_t> order = random_order(cloud.size(), seed);
  cloud.positions = in_order(cloud.positions, order);
  cloud.normals = in_order(cloud.normals, order);
  cloud.sensors = in_order(cloud.sensors, order);
  cloud.weights = in_order(cloud.weights, order);
  return cloud;
}

}  // namespace soapfilm::test
