// PCD files that the tests write: every coding, and an LZF compressor.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <string>
#include <vector>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm {

enum class PcdCoding { ascii, binary, compressed, stored };

/// LZF of any bytes: the tests' own compressor, greedy, with all kinds of copies.
inline std::string lzf_of(const std::string& bytes) {
  std::string out, literals;
  std::map<std::string, size_t> seen;
  const auto flush = [&] {
    for (size_t i = 0; i < literals.size(); i += 32) {
      const std::string part = literals.substr(i, 32);
      out += static_cast<char>(part.size() - 1);
      out += part;
    }
    literals.clear();
  };
  for (size_t i = 0; i < bytes.size();) {
    const std::string three = bytes.substr(i, 3);
    const auto found = seen.find(three);
    size_t length = 0;
    if (three.size() == 3 && found != seen.end() && i - found->second <= 8192)
      while (length < 264 && i + length < bytes.size() && bytes[found->second + length] == bytes[i + length]) ++length;
    if (length >= 3) {
      flush();
      const size_t distance = i - found->second - 1, extra = length - 2;
      out += static_cast<char>(std::min<size_t>(extra, 7) << 5 | distance >> 8);
      if (extra >= 7) out += static_cast<char>(extra - 7);
      out += static_cast<char>(distance & 255);
    } else {
      length = 1;
      literals += bytes[i];
    }
    seen[three] = i;
    i += length;
  }
  flush();
  return out;
}

struct PcdColumn {
  std::string name;
  std::string type = "F";
  int size = 4;
  int count = 1;
};

template <class T>
std::string little_endian_bytes(T value) {
  if constexpr (std::endian::native == std::endian::big) value = io::swap_bytes(value);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

inline std::string encode_pcd(const PcdColumn& field, double v) {
  if (field.type == "F") return field.size == 4 ? little_endian_bytes(static_cast<float>(v)) : little_endian_bytes(v);
  if (field.type == "I") {
    const auto i = static_cast<int64_t>(v);
    return little_endian_bytes(i).substr(0, static_cast<size_t>(field.size));
  }
  return little_endian_bytes(static_cast<uint64_t>(v)).substr(0, static_cast<size_t>(field.size));
}

inline std::string lzf_sizes(uint64_t packed, uint64_t full) {
  return little_endian_bytes(static_cast<uint32_t>(packed)) + little_endian_bytes(static_cast<uint32_t>(full));
}

/// A file of these fields and rows, of which each has all values of all fields.
class PcdFile {
 public:
  std::vector<PcdColumn> fields{{"x"}, {"y"}, {"z"}};
  std::vector<std::vector<double>> rows;
  size_t width = 0, height = 1;  // 0: as many as there are rows
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";

  std::string header(PcdCoding coding) const {
    std::string names, sizes, types, counts;
    for (const PcdColumn& field : fields) {
      names += " " + field.name;
      sizes += fmt::format(" {}", field.size);
      types += " " + field.type;
      counts += fmt::format(" {}", field.count);
    }
    const char* data = coding == PcdCoding::ascii    ? "ascii"
                       : coding == PcdCoding::binary ? "binary"
                                                     : "binary_compressed";
    return fmt::format(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\n"
        "WIDTH {}\nHEIGHT {}\n{}POINTS {}\nDATA {}\n",
        names, sizes, types, counts, width > 0 ? width : rows.size(), height, viewpoint, rows.size(), data);
  }
  std::string text(PcdCoding coding) const { return header(coding) + body(coding); }

  std::string body(PcdCoding coding) const {
    std::string text, planes;
    if (coding == PcdCoding::ascii) {
      for (const auto& row : rows) text += fmt::format("{}\n", fmt::join(row, " "));
      return text;
    }
    if (coding == PcdCoding::binary) {
      for (const auto& row : rows) {
        size_t at = 0;
        for (const PcdColumn& field : fields)
          for (int k = 0; k < field.count; ++k) text += encode_pcd(field, row[at++]);
      }
      return text;
    }
    size_t first = 0;
    for (const PcdColumn& field : fields) {
      for (const auto& row : rows)
        for (int k = 0; k < field.count; ++k) planes += encode_pcd(field, row[first + static_cast<size_t>(k)]);
      first += static_cast<size_t>(field.count);
    }
    const std::string packed = coding == PcdCoding::stored ? planes : lzf_of(planes);
    return lzf_sizes(packed.size(), planes.size()) + packed;
  }
};

}  // namespace soapfilm
