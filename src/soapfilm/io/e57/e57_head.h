// What the XML of an E57 file says of its scans.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/core/placement.h"
#include "soapfilm/io.h"
#include "soapfilm/io/e57/e57_pages.h"

namespace soapfilm::io {

/// One field of a record: its value is (raw + minimum) * scale + offset, or a float.
struct E57Field {
  enum class Kind : uint8_t { float32, float64, integer, text };

  std::string name;  ///< without a namespace's prefix
  Kind kind = Kind::float64;
  int bits = 64;  ///< of each record, in the field's own stream; 0 for a constant and, as not used, for text
  int64_t minimum = 0;
  double scale = 1;
  double offset = 0;
  std::optional<std::array<double, 2>> range{};  ///< smallest and largest value, where the file gives both

  double value(uint64_t raw) const {
    return static_cast<double>(static_cast<int64_t>(raw + static_cast<uint64_t>(minimum))) * scale + offset;
  }
};

/// One child of data3D.
struct E57Scan {
  std::string name;
  uint64_t records = 0;
  uint64_t section = 0;  ///< logical offset
  std::vector<E57Field> fields;
  std::optional<Placement> pose;
  bool names_scanner = false;                           ///< its model or serial number
  std::optional<std::array<double, 2>> color_limits{};  ///< of all three channels

  uint64_t bits() const;  ///< of a record
};

struct E57Head {
  std::vector<E57Scan> scans;  ///< those with records
  std::string coordinate_system;
};

/// Throws InputError for what no scan can be read from. What is not used is named in one warning.
E57Head read_e57_head(E57Pages& pages, ReadReport& report);

}  // namespace soapfilm::io
