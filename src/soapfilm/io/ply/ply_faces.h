// Faces and triangle strips of a PLY, for meshes and for the normals of samples.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/io/ply/ply_rows.h"

namespace soapfilm::io {

/// The list of vertex indices, by either of its two names; `absent` if the element is neither faces nor strips.
inline size_t index_list(const PlyElement& element) {
  if (element.name != "face" && element.name != "tristrips") return PlyElement::absent;
  const size_t plural = element.find_list("vertex_indices");
  return plural != PlyElement::absent ? plural : element.find_list("vertex_index");
}

inline uint32_t vertex_index(const PlyRows& rows, double value, uint64_t vertices) {
  if (!(value >= 0) || value >= static_cast<double>(vertices) || value != std::floor(value))
    rows.fail(fmt::format("vertex index = {}, must be an integer from 0 to {}", value, vertices - 1));
  return static_cast<uint32_t>(value);
}

/// Calls put(corners) for each triangle of the strip that next() read, as in Stanford's volumetric merges: -1 begins a
/// new strip, every second triangle has the opposite orientation.
template <class Put>
void read_strip(const PlyRows& rows, std::span<const double> strip, uint64_t vertices, const Put& put) {
  std::array<uint32_t, 3> last{};
  size_t length = 0;
  for (const double value : strip) {
    if (value == -1) {
      length = 0;
      continue;
    }
    last = {last[1], last[2], vertex_index(rows, value, vertices)};
    ++length;
    if (length < 3) continue;
    const std::array<uint32_t, 3> turned{last[1], last[0], last[2]};
    put(std::span<const uint32_t>(length % 2 == 1 ? last : turned));
  }
}

/// Reads the rows of `element`, of which `list` are the indices: calls put(corners) for each face, of any number of
/// corners.
template <class Put>
void read_ply_faces(PlyRows& rows, const PlyElement& element, size_t list, uint64_t vertices, const Put& put) {
  rows.begin(element);
  std::vector<uint32_t> corners;
  for (uint64_t i = 0; i < element.count; ++i) {
    rows.next();
    if (element.name == "tristrips") {
      read_strip(rows, rows.list(list), vertices, put);
      continue;
    }
    corners.clear();
    for (const double value : rows.list(list)) corners.push_back(vertex_index(rows, value, vertices));
    put(std::span<const uint32_t>(corners));
  }
}

}  // namespace soapfilm::io
