// A COPC file that tests make.
#pragma once

#include <string>
#include <vector>

#include "laz_files.h"
#include "laz_reading.h"

namespace soapfilm {

namespace copc {

struct Node {
  int level;
  uint32_t points;
};

/// Chunks in the file's order; the levels' points are told apart by z.
inline const std::vector<Node> nodes{{1, 30}, {0, 20}, {2, 60}, {1, 25}, {3, 100}};
constexpr double root_spacing = 8;

/// Where the content of its record of COPC begins.
inline size_t info_of(const std::string& file) { return file.find("copc") + 52; }

}  // namespace copc

/// `pages`: the list of nodes is in two pages, of which the first one names the second.
inline std::string copc_file(int pages = 1) {
  LasFile las;
  las.minor = 4;
  las.format = 6;
  las.records = {LasFile::record("copc", 1, std::string(160, '\0'))};
  LazWriting writing;
  for (const copc::Node& node : copc::nodes) {
    writing.chunks.push_back(node.points);
    for (uint32_t i = 0; i < node.points; ++i) {
      LasPoint point;
      point.xyz = {static_cast<int32_t>(i), static_cast<int32_t>(i * i % 97), node.level * 1000};
      las.points.push_back(point);
    }
  }
  std::string file = LazFile(las.bytes(), writing).bytes();

  const std::vector<io::LazChunk> chunks = chunks_of(file);
  const auto entry = [](int level, uint64_t begin, uint64_t bytes, int points) {
    return bytes_of<int32_t>({level, 0, 0, 0}) + bytes_of<uint64_t>({begin}) +
           bytes_of<int32_t>({static_cast<int32_t>(bytes), points});
  };
  std::string second, first;
  for (size_t k = 0; k < copc::nodes.size(); ++k)
    (k > 2 && pages > 1 ? second : first) +=
        entry(copc::nodes[k].level, chunks[k].begin, chunks[k].bytes, static_cast<int>(copc::nodes[k].points));
  first += entry(4, 0, 0, 0);  // a node without points
  const uint64_t second_begin = file.size();
  if (pages > 1) first += entry(1, second_begin, second.size(), -1);
  file += second;
  const size_t info = copc::info_of(file);
  put(file, info + 32, copc::root_spacing);
  put(file, info + 40, uint64_t{file.size()});
  put(file, info + 48, uint64_t{first.size()});
  return file + first;
}

}  // namespace soapfilm
