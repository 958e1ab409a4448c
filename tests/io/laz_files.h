// LAZ files that tests make of LAS files.
#pragma once

#include "binary_bytes.h"
#include "las_files.h"
#include "laz_chunks.h"

namespace soapfilm {

struct LazWriting {
  uint32_t chunk_points = 50000;
  std::vector<uint32_t> chunks{};  ///< points of each, of different numbers; instead of chunk_points
  uint16_t version = 0;            ///< of the items; 0: 2, or 3 of formats 6 to 10
  bool streamed = false;           ///< the place of the table of chunks is at the file's end
};

namespace laz {

inline std::string item(uint16_t type, uint16_t bytes, uint16_t version) {
  return bytes_of<uint16_t>({type, bytes, version});
}

inline std::string items(int format, uint16_t extra, uint16_t version) {
  const bool is_new = format >= 6;
  const Places places = places_of(format);
  std::string all = is_new ? item(10, 30, version) : item(6, 20, version);
  if (!is_new && places.time != 0) all += item(7, 8, version);
  if (places.infrared != 0)
    all += item(12, 8, version);
  else if (places.color != 0)
    all += item(is_new ? 11 : 8, 6, version);
  if (places.waves != 0) all += item(is_new ? 13 : 9, 29, is_new ? version : 1);
  if (extra > 0) all += item(is_new ? 14 : 0, extra, version);
  return all;
}

inline std::string chunk(int format, int version, const std::vector<std::string>& records) {
  if (format >= 6) {
    LayeredEncoder encoder(format, version, records[0]);
    for (size_t i = 1; i < records.size(); ++i) encoder.encode(records[i]);
    return records[0] + encoder.done();
  }
  Encoder to;
  PointwiseEncoder encoder(format, records[0]);
  for (size_t i = 1; i < records.size(); ++i) encoder.encode(to, records[i]);
  return records[0] + to.done();
}

inline std::string table(const std::vector<uint32_t>& points, const std::vector<uint32_t>& bytes) {
  Encoder to;
  IntegerEncoder numbers(32, 2);
  for (size_t k = 0; k < bytes.size(); ++k) {
    if (!points.empty()) numbers.encode(to, k > 0 ? points[k - 1] : 0, points[k], 0);
    numbers.encode(to, k > 0 ? bytes[k - 1] : 0, bytes[k], 1);
  }
  return bytes_of<uint32_t>({0, static_cast<uint32_t>(bytes.size())}) + to.done();
}

}  // namespace laz

/// The LAZ file of the bytes of a LAS file without extended records.
inline std::string laz_of(const std::string& las, const LazWriting& writing = {}) {
  const auto header_bytes = laz::at<uint16_t>(las, 94), record_bytes = laz::at<uint16_t>(las, 105);
  const auto points_offset = laz::at<uint32_t>(las, 96);
  const int format = las[104];
  const uint64_t count = las[25] >= 4 ? laz::at<uint64_t>(las, 247) : laz::at<uint32_t>(las, 107);
  const uint16_t version = writing.version != 0 ? writing.version : format >= 6 ? 3 : 2;
  const auto extra = static_cast<uint16_t>(record_bytes - LasFile::lengths[static_cast<size_t>(format)]);
  const std::string items = laz::items(format, extra, version);

  const bool variable = !writing.chunks.empty();
  const std::string record = LasFile::record(
      "laszip encoded", 22204,
      bytes_of<uint16_t>({static_cast<uint16_t>(format >= 6 ? 3 : 2), 0}) + bytes_of<uint8_t>({3, 4}) +
          bytes_of(uint16_t{3}) + bytes_of(uint32_t{0}) + bytes_of(variable ? ~uint32_t{0} : writing.chunk_points) +
          bytes_of<int64_t>({-1, -1}) + bytes_of(static_cast<uint16_t>(items.size() / 6)) + items);
  std::string file = las.substr(0, header_bytes) + record + las.substr(header_bytes, points_offset - header_bytes);
  put(file, 96, static_cast<uint32_t>(points_offset + record.size()));
  put(file, 100, laz::at<uint32_t>(las, 100) + 1);
  file[104] = static_cast<char>(format | 0x80);
  const size_t table_place = file.size();
  file += bytes_of(~uint64_t{0});

  std::vector<uint32_t> sizes;
  for (uint64_t first = 0; first < count;) {
    const uint64_t own =
        std::min<uint64_t>(variable ? writing.chunks[sizes.size()] : writing.chunk_points, count - first);
    std::vector<std::string> records;
    for (uint64_t i = first; i < first + own; ++i)
      records.push_back(las.substr(points_offset + i * record_bytes, record_bytes));
    const std::string chunk = own > 0 ? laz::chunk(format, version, records) : std::string();
    sizes.push_back(static_cast<uint32_t>(chunk.size()));
    file += chunk;
    first += own;
  }
  const uint64_t table = file.size();
  file += laz::table(writing.chunks, sizes);
  if (writing.streamed)
    file += bytes_of(table);
  else
    put(file, table_place, table);
  return file;
}

}  // namespace soapfilm
