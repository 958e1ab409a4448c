#include "soapfilm/io/las/las_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t oldest_header_bytes = 227;  // of 1.0 to 1.2
constexpr size_t newest_header_bytes = 375;  // of 1.4
constexpr size_t waveform_header_bytes = 235;
constexpr std::array<size_t, 11> standard_record_bytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

class LasHeaderReader {
 public:
  LasHeaderReader(ByteSource& source, ReadReport& report) : source_(source), report_(report) {}

  LasHeader read() {
    if (!source_.begins_with("LASF")) fail(0, "first bytes", in_quotes(source_.bytes().substr(0, 4)), "must be 'LASF'");
    if (source_.bytes().size() < oldest_header_bytes)
      fail(0, "file size", source_.bytes().size(),
           fmt::format("must be at least {} (the header)", oldest_header_bytes));
    read_version();
    read_layout();
    read_count();
    read_frame();
    if (header_.header_bytes >= waveform_header_bytes && header_.minor_version >= 3)
      header_.waveform_offset = at<uint64_t>(227);
    if (is_long()) {
      header_.extended_offset = at<uint64_t>(235);
      header_.extended_records = at<uint32_t>(243);
    }
    if (!header_.compressed) warn_of_rest();
    return header_;
  }

 private:
  template <class T>
  T at(size_t offset) const {
    return ByteCursor(source_, offset).read<T>();
  }

  template <class T>
  [[noreturn]] void fail(size_t offset, std::string_view what, T value, std::string_view constraint) const {
    throw InputError(fmt::format("{}: byte {}: {} = {}, {}", source_.path(), offset, what, value, constraint));
  }
  void warn(const std::string& message) { report_.warnings.push_back(source_.path() + ": " + message); }

  /// Has it the fields of 1.4?
  bool is_long() const { return header_.minor_version >= 4 && header_.header_bytes >= newest_header_bytes; }

  void read_version() {
    const int major = at<uint8_t>(24);
    header_.minor_version = at<uint8_t>(25);
    if (major != 1) fail(24, "LAS version", fmt::format("{}.{}", major, header_.minor_version), "must be 1.0 to 1.4");
    if (header_.minor_version > 4) warn(fmt::format("LAS version 1.{} is read as 1.4", header_.minor_version));
    header_.adjusted_gps_time = header_.minor_version >= 2 && (at<uint16_t>(6) & 1) != 0;
  }

  void read_layout() {
    const size_t size = source_.bytes().size();
    header_.header_bytes = at<uint16_t>(94);
    if (header_.header_bytes < oldest_header_bytes || header_.header_bytes > size)
      fail(94, "header size", header_.header_bytes, fmt::format("must be from {} to {}", oldest_header_bytes, size));
    header_.points_offset = at<uint32_t>(96);
    if (header_.points_offset < header_.header_bytes || header_.points_offset > size)
      fail(96, "offset of the points", header_.points_offset,
           fmt::format("must be from {} (the header) to {} (the file)", header_.header_bytes, size));
    header_.variable_records = at<uint32_t>(100);
    constexpr int compressed = 0x80, marks = 0xc0;  // both marks are LASzip's
    int format = at<uint8_t>(104);
    header_.compressed = (format & compressed) != 0;
    if (header_.compressed) format &= ~marks;
    if (format >= static_cast<int>(standard_record_bytes.size()))
      fail(104, "point format", format, "must be from 0 to 10");
    header_.point_format = format;
    header_.record_bytes = at<uint16_t>(105);
    const size_t least = standard_bytes(format);
    if (header_.record_bytes < least)
      fail(105, "record length", header_.record_bytes,
           fmt::format("must be at least {} of point format {}", least, format));
  }

  void read_count() {
    size_t place = 107;
    const uint32_t old_count = at<uint32_t>(place);
    header_.count = old_count;
    if (is_long()) {
      const auto count = at<uint64_t>(247);
      if (count != 0) {
        header_.count = count;
        place = 247;
      }
      if (count != old_count && count != 0 && old_count != 0)
        warn(fmt::format("byte 107: number of points = {}, and {} by the 64-bit number, which is used", old_count,
                         count));
    }
    if (header_.count == 0) fail(place, "number of points", 0, "must be > 0");
    if (header_.compressed) return;
    const uint64_t most = (source_.bytes().size() - header_.points_offset) / header_.record_bytes;
    if (header_.count > most)
      fail(place, "number of points", header_.count,
           fmt::format("must be at most {}: the file is truncated ({} bytes, {} needed for each point)", most,
                       source_.bytes().size(), header_.record_bytes));
  }

  void read_frame() {
    constexpr std::array<char, 3> axes{'x', 'y', 'z'};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      header_.scale[axis] = at<double>(131 + 8 * k);
      header_.offset[axis] = at<double>(155 + 8 * k);
      if (!std::isfinite(header_.scale[axis]) || header_.scale[axis] == 0)
        fail(131 + 8 * k, fmt::format("scale of {}", axes[k]), header_.scale[axis], "must be finite and not 0");
      if (!std::isfinite(header_.offset[axis]))
        fail(155 + 8 * k, fmt::format("offset of {}", axes[k]), header_.offset[axis], "must be finite");
      header_.box.hi[axis] = at<double>(179 + 16 * k);
      header_.box.lo[axis] = at<double>(187 + 16 * k);
    }
  }

  /// Points that the count leaves out would be lost silently.
  void warn_of_rest() {
    uint64_t end = source_.bytes().size();
    for (const uint64_t block : {header_.waveform_offset, header_.extended_offset})
      if (block >= header_.end_of_points()) end = std::min(end, block);
    const uint64_t rest = end - header_.end_of_points();
    if (rest >= header_.record_bytes)
      warn(fmt::format("{} bytes after the last of {} points are not read: the header may count too few", rest,
                       header_.count));
  }

  ByteSource& source_;
  ReadReport& report_;
  LasHeader header_;
};

}  // namespace

size_t standard_bytes(int point_format) { return standard_record_bytes[static_cast<size_t>(point_format)]; }

LasHeader read_las_header(ByteSource& source, ReadReport& report) { return LasHeaderReader(source, report).read(); }

}  // namespace soapfilm::io
