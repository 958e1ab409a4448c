// The records of LAZ files, as the reader decodes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/io/las/las_records.h"
#include "soapfilm/io/las/laz_reader.h"

namespace soapfilm {

inline io::LazLayout laz_layout_of(io::ByteSource& source, const io::LasHeader& header) {
  ReadReport report;
  const size_t room = header.record_bytes - io::standard_bytes(header.point_format);
  return io::read_laz_layout(source, header, io::read_las_records(source, header, room, report).laszip);
}

inline std::vector<io::LazChunk> chunks_of(const std::string& laz) {
  io::ByteSource source("a.laz", laz);
  ReadReport report;
  return laz_layout_of(source, io::read_las_header(source, report)).chunks;
}

/// All records of a LAS or LAZ file, as they are.
inline std::string records_of(const std::string& bytes, const Context& context = Context(1),
                              size_t most_bytes = size_t{32} << 20) {
  io::ByteSource source("a.laz", bytes);
  ReadReport report;
  const io::LasHeader header = io::read_las_header(source, report);
  if (!header.compressed)
    return bytes.substr(header.points_offset, static_cast<size_t>(header.count) * header.record_bytes);
  io::LazReader reader(source, laz_layout_of(source, header), std::vector<bool>(header.record_bytes, true), context,
                       most_bytes);
  std::string all;
  reader.read([&](std::string_view some) { all += some; });
  return all;
}

}  // namespace soapfilm
