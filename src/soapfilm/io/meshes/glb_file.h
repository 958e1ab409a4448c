// The parts of a GLB file and its arrays, checked before they are used.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// An accessor: `count` elements of `parts` numbers, `stride` bytes apart.
struct GltfArray {
  enum Component { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

  const char* at = nullptr;
  size_t stride = 0;
  size_t count = 0;
  int component = float32;
  size_t parts = 1;
  bool normalized = false;  ///< whole numbers are from 0 or -1 to 1

  double value(size_t element, size_t part) const;
  uint32_t index(size_t element) const { return static_cast<uint32_t>(value(element, 0)); }
};

/// Throws InputError "file: what: value, constraint".
class GlbFile {
 public:
  explicit GlbFile(ByteSource& source);

  const nlohmann::json& head() const { return head_; }
  size_t size() const { return source_.bytes().size(); }

  /// Elements of an array in the head, such as "nodes"; none if there is no array.
  size_t count(const char* name) const;
  const nlohmann::json& element(const char* name, uint64_t index) const;
  GltfArray accessor(uint64_t index) const;

  /// A whole number of an object of the head; `otherwise` if it is not there.
  uint64_t number(const nlohmann::json& object, const char* name, uint64_t otherwise) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void refuse_extensions() const;
  std::string_view view(uint64_t index, size_t element_bytes, size_t& stride) const;

  ByteSource& source_;
  nlohmann::json head_;
  std::string_view binary_;
};

}  // namespace soapfilm::io
