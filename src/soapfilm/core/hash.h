// One number for many: runs on the same input have the same.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm {

/// Fowler, Noll and Vo's hash over words of eight bytes.
class Hash {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::as_bytes(std::span(values)));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(const T& value) { add(std::as_bytes(std::span(&value, 1))); }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  uint64_t value() const { return value_; }

 private:
  void add(std::span<const std::byte> bytes) {
    add_word(bytes.size());
    for (size_t k = 0; k < bytes.size(); k += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, bytes.data() + k, std::min(sizeof word, bytes.size() - k));
      add_word(word);
    }
  }
  void add_word(uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001b3u;
    value_ ^= value_ >> 29;  // so that high bits reach low ones
  }
  uint64_t value_ = 0xcbf29ce484222325u;
};

/// Of all that the surface follows from; colors and columns ride along.
inline uint64_t hash_of(const PointCloud& cloud) {
  Hash hash;
  hash.add(cloud.positions);
  hash.add(cloud.normals);
  hash.add(cloud.sensors);
  hash.add(cloud.weights);
  hash.add(cloud.is_survey);
  for (const Scan& scan : cloud.scans) {
    hash.add(scan.end);
    hash.add(scan.sensor.value_or(Vec3d{}));
    hash.add(scan.view_direction.value_or(Vec3d{}));
    if (scan.range_grid) hash.add(scan.range_grid->sample);
  }
  return hash.value();
}

}  // namespace soapfilm
