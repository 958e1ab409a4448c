// Arrays of the page: compressed by meshoptimizer, as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/vec.h"
#include "tools/view/page.h"

namespace soapfilm::view_detail {

std::string base64(std::span<const unsigned char> bytes);

/// Unit vectors as two 16-bit numbers (octahedral map, Meyer et al. 2010): within 0.003 degrees. (0, 0, 0) and what is
/// not finite become {-32768, -32768}.
std::array<int16_t, 2> pack_normal(Vec3f normal);

/// Collects the arrays of a page. Each call returns what the page needs to read the array again.
class ArrayWriter {
 public:
  template <class T>
  nlohmann::ordered_json add(const std::vector<T>& values) {
    static_assert(sizeof(T) % 4 == 0);
    return add_vertices(values.data(), values.size(), sizeof(T));
  }
  nlohmann::ordered_json add_indices(const std::vector<uint32_t>& indices, size_t vertices);

  const Arrays& arrays() const { return arrays_; }
  size_t characters() const;

 private:
  nlohmann::ordered_json add_vertices(const void* data, size_t count, size_t stride);
  nlohmann::ordered_json keep(const std::vector<unsigned char>& coded, size_t count, size_t stride, const char* coding);
  Arrays arrays_;
};

}  // namespace soapfilm::view_detail
