// LAZ files that tests make of LAS files.
#pragma once

#include "binary_bytes.h"
#include "las_files.h"
#include "laz_chunks.h"
#include "laz_version1.h"

namespace soapfilm {

struct LazWriting {
  uint32_t chunk_points = 50000;
  std::vector<uint32_t> chunks{};  ///< points of each, of different numbers; instead of chunk_points
  uint16_t version = 0;            ///< of the items; 0: 2, or 3 of formats 6 to 10; of 1 there are no chunks
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
  if (version == 1) {
    Version1Encoder encoder(format, records[0]);
    for (size_t i = 1; i < records.size(); ++i) encoder.encode(to, records[i]);
    return records[0] + to.done();
  }
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
class LazFile {
 public:
  LazFile(const std::string& las, const LazWriting& writing)
      : las_(las),
        writing_(writing),
        format_(las[104]),
        record_bytes_(laz::at<uint16_t>(las, 105)),
        count_(las[25] >= 4 ? laz::at<uint64_t>(las, 247) : laz::at<uint32_t>(las, 107)),
        version_(writing.version != 0 ? writing.version
                 : format_ >= 6       ? 3
                                      : 2) {}

  std::string bytes() const {
    const auto points_offset = laz::at<uint32_t>(las_, 96);
    const auto header_bytes = laz::at<uint16_t>(las_, 94);
    const std::string record = laszip_record();
    std::string file = las_.substr(0, header_bytes) + record + las_.substr(header_bytes, points_offset - header_bytes);
    put(file, 96, static_cast<uint32_t>(points_offset + record.size()));
    put(file, 100, laz::at<uint32_t>(las_, 100) + 1);
    file[104] = static_cast<char>(format_ | 0x80);
    if (version_ == 1) return file + chunk(0, count_);

    const size_t table_place = file.size();
    file += bytes_of(~uint64_t{0});
    std::vector<uint32_t> sizes;
    for (uint64_t first = 0; first < count_;) {
      const uint32_t most = writing_.chunks.empty() ? writing_.chunk_points : writing_.chunks[sizes.size()];
      const uint64_t own = std::min<uint64_t>(most, count_ - first);
      const std::string bytes = own > 0 ? chunk(first, own) : std::string();
      sizes.push_back(static_cast<uint32_t>(bytes.size()));
      file += bytes;
      first += own;
    }
    const uint64_t table = file.size();
    file += laz::table(writing_.chunks, sizes);
    if (writing_.streamed)
      file += bytes_of(table);
    else
      put(file, table_place, table);
    return file;
  }

 private:
  std::string laszip_record() const {
    const auto extra = static_cast<uint16_t>(record_bytes_ - LasFile::lengths[static_cast<size_t>(format_)]);
    const std::string items = laz::items(format_, extra, version_);
    const auto compressor = static_cast<uint16_t>(format_ >= 6 ? 3 : version_);
    const uint32_t chunk_points = writing_.chunks.empty() ? writing_.chunk_points : ~uint32_t{0};
    return LasFile::record("laszip encoded", 22204,
                           bytes_of<uint16_t>({compressor, 0}) + bytes_of<uint8_t>({3, 4}) + bytes_of(uint16_t{3}) +
                               bytes_of(uint32_t{0}) + bytes_of(chunk_points) + bytes_of<int64_t>({-1, -1}) +
                               bytes_of(static_cast<uint16_t>(items.size() / 6)) + items);
  }

  std::string chunk(uint64_t first, uint64_t count) const {
    std::vector<std::string> records;
    for (uint64_t i = first; i < first + count; ++i)
      records.push_back(las_.substr(laz::at<uint32_t>(las_, 96) + i * record_bytes_, record_bytes_));
    return laz::chunk(format_, version_, records);
  }

  const std::string& las_;
  const LazWriting& writing_;
  int format_;
  uint16_t record_bytes_;
  uint64_t count_;
  uint16_t version_;
};

inline std::string laz_of(const std::string& las, const LazWriting& writing = {}) {
  return LazFile(las, writing).bytes();
}

}  // namespace soapfilm
