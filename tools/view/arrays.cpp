#include "tools/view/arrays.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"

namespace soapfilm::view_detail {

namespace {

// Browsers hold a text of at most 2^29 characters.
constexpr size_t most_characters = size_t{500} << 20;

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t left = std::min<size_t>(bytes.size() - i, 3);
    const uint32_t group =
        bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | static_cast<uint32_t>(left > 2 ? bytes[i + 2] : 0);
    text += digits[group >> 18];
    text += digits[group >> 12 & 63];
    text += left > 1 ? digits[group >> 6 & 63] : '=';
    text += left > 2 ? digits[group & 63] : '=';
  }
  return text;
}

std::array<int16_t, 2> pack_normal(Vec3f normal) {
  const double sum = std::abs(double{normal.x}) + std::abs(double{normal.y}) + std::abs(double{normal.z});
  if (!(sum > 0) || !std::isfinite(sum)) return {INT16_MIN, INT16_MIN};
  double x = normal.x / sum;
  double y = normal.y / sum;
  if (normal.z < 0) {
    const double fold = x;
    x = (1 - std::abs(y)) * (x >= 0 ? 1 : -1);
    y = (1 - std::abs(fold)) * (y >= 0 ? 1 : -1);
  }
  return {static_cast<int16_t>(std::lround(32767 * x)), static_cast<int16_t>(std::lround(32767 * y))};
}

nlohmann::ordered_json ArrayWriter::add_vertices(const void* data, size_t count, size_t stride) {
  std::vector<unsigned char> coded(meshopt_encodeVertexBufferBound(count, stride));
  coded.resize(meshopt_encodeVertexBuffer(coded.data(), coded.size(), data, count, stride));
  return keep(coded, count, stride, "vertices");
}

nlohmann::ordered_json ArrayWriter::add_indices(const std::vector<uint32_t>& indices, size_t vertices) {
  std::vector<unsigned char> coded(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  coded.resize(meshopt_encodeIndexBuffer(coded.data(), coded.size(), indices.data(), indices.size()));
  return keep(coded, indices.size(), sizeof(uint32_t), "triangles");
}

nlohmann::ordered_json ArrayWriter::keep(const std::vector<unsigned char>& coded, size_t count, size_t stride,
                                         const char* coding) {
  if (coded.size() / 3 * 4 > most_characters) {
    throw ParameterError(
        fmt::format("an array of the page has {} MiB, must be at most {} MiB: browsers read no more; show fewer "
                    "triangles or samples",
                    coded.size() / 3 * 4 >> 20, most_characters >> 20));
  }
  arrays_.push_back(base64(coded));
  return {{"id", arrays_.size() - 1}, {"count", count}, {"stride", stride}, {"coding", coding}};
}

size_t ArrayWriter::characters() const {
  size_t sum = 0;
  for (const std::string& array : arrays_) sum += array.size();
  return sum;
}

}  // namespace soapfilm::view_detail
