#include "soapfilm/io/las/las_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t record_head_bytes = 54;
constexpr size_t extended_head_bytes = 60;  // its length has 64 bits
constexpr size_t extra_description_bytes = 192;
constexpr size_t most_wkt_bytes = size_t{1} << 20;
constexpr size_t most_extra_fields = 256;

constexpr uint16_t wkt_record = 2112;
constexpr uint16_t geotiff_keys_record = 34735;
constexpr uint16_t extra_bytes_record = 4;
constexpr uint16_t laszip_record = 22204;
constexpr uint16_t copc_record = 1;

constexpr uint16_t projected_system_key = 3072;
constexpr uint16_t geographic_system_key = 2048;
constexpr uint16_t user_defined_system = 32767;

/// Up to the first zero byte.
std::string_view until_zero(std::string_view text) { return text.substr(0, text.find('\0')); }

/// On one line, without unprintable bytes.
std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : until_zero(text)) {
    const bool printable = static_cast<unsigned char>(c) > ' ' && c != '\x7f';
    if (printable || (!line.empty() && line.back() != ' ')) line += printable ? c : ' ';
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

class LasRecordsReader {
 public:
  LasRecordsReader(ByteSource& source, const LasHeader& header, size_t room, ReadReport& report)
      : source_(source), header_(header), room_(room), report_(report) {}

  LasRecords read() {
    read_list(header_.header_bytes, header_.points_offset, header_.variable_records, record_head_bytes);
    if (header_.extended_records > 0 && header_.extended_offset >= header_.end_of_points())
      read_list(header_.extended_offset, source_.bytes().size(), header_.extended_records, extended_head_bytes);
    else if (header_.extended_records > 0)
      warn(fmt::format("byte 235: extended records at {}, must be after the points: ignored", header_.extended_offset));
    if (overflow_) warn(fmt::format("its records describe more than the {} extra bytes that its points have", room_));
    records_.undescribed_bytes += room_ - records_.extra_bytes;
    if (records_.coordinate_system.empty()) use_geotiff_keys();
    return std::move(records_);
  }

 private:
  void warn(const std::string& message) { report_.warnings.push_back(source_.path() + ": " + message); }

  void read_list(uint64_t begin, uint64_t end, uint32_t count, size_t head_bytes) {
    for (uint32_t k = 0; k < count; ++k) {
      const uint64_t left = end - std::min(begin, end);
      uint64_t length = 0;
      if (left >= head_bytes) {
        ByteCursor cursor(source_, static_cast<size_t>(begin) + 20);
        length = head_bytes == record_head_bytes ? cursor.read<uint16_t>() : cursor.read<uint64_t>();
      }
      if (left < head_bytes || length > left - head_bytes)
        return warn(fmt::format("byte {}: record {} of {} does not end before byte {}: ignored, and those after it",
                                begin, k + 1, count, end));
      const std::string_view bytes = source_.bytes();
      const std::string_view user = until_zero(bytes.substr(static_cast<size_t>(begin) + 2, 16));
      const auto id = ByteCursor(source_, static_cast<size_t>(begin) + 18).read<uint16_t>();
      use(user, id, bytes.substr(static_cast<size_t>(begin) + head_bytes, static_cast<size_t>(length)));
      begin += head_bytes + length;
    }
  }

  /// Others say nothing of the points' meaning, or are for one vendor's programs.
  void use(std::string_view user, uint16_t id, std::string_view content) {
    if (user == "LASF_Projection" && id == wkt_record && records_.coordinate_system.empty())
      use_wkt(content);
    else if (user == "LASF_Projection" && id == geotiff_keys_record)
      geotiff_keys_ = content;
    else if (user == "LASF_Spec" && id == extra_bytes_record)
      use_extra_bytes(content);
    else if (user == "laszip encoded" && id == laszip_record)
      records_.laszip = content;
    else if (user == "copc" && id == copc_record)
      records_.copc = content;
  }

  void use_wkt(std::string_view content) {
    if (until_zero(content).size() > most_wkt_bytes)
      return warn(fmt::format("coordinate system of {} bytes, must be at most {}: ignored", until_zero(content).size(),
                              most_wkt_bytes));
    records_.coordinate_system = one_line(content);
  }

  void use_geotiff_keys() {
    constexpr size_t key_bytes = 8;
    const auto word = [&](size_t at) { return load<uint16_t>(geotiff_keys_.data() + at, ByteCursor(source_).swaps()); };
    uint16_t projected = 0, geographic = 0;
    for (size_t at = key_bytes; at + key_bytes <= geotiff_keys_.size(); at += key_bytes) {  // the first is a head
      const bool is_value = word(at + 2) == 0;
      if (is_value && word(at) == projected_system_key) projected = word(at + 6);
      if (is_value && word(at) == geographic_system_key) geographic = word(at + 6);
    }
    const uint16_t code = projected != 0 ? projected : geographic;
    if (code == user_defined_system)
      warn("its coordinate system is defined by GeoTIFF keys without an EPSG number: not carried on");
    else if (code != 0)
      records_.coordinate_system = fmt::format("EPSG:{}", code);
  }

  void use_extra_bytes(std::string_view content) {
    for (size_t at = 0; at + extra_description_bytes <= content.size() && !overflow_; at += extra_description_bytes)
      add_extra(content.substr(at, extra_description_bytes));
  }

  /// One description: of a number, of an array of two or three (which 1.4 R14 abolished), or of bytes without meaning.
  void add_extra(std::string_view description) {
    const bool swap = ByteCursor(source_).swaps();
    const size_t type = static_cast<uint8_t>(description[2]);
    const unsigned options = static_cast<uint8_t>(description[3]);
    const bool is_number = type >= 1 && type <= 3 * number_types;
    const auto number = static_cast<NumberType>(is_number ? (type - 1) % number_types : 0);
    const size_t parts = is_number ? 1 + (type - 1) / number_types : 1;
    const size_t bytes = is_number ? parts * size_of(number) : options;
    overflow_ = bytes > room_ - records_.extra_bytes;
    if (overflow_) return;
    std::string name = one_line(description.substr(4, 32));
    if (name.empty()) name = fmt::format("extra {}", records_.extra.size() + 1);
    if (is_number && records_.extra.size() + parts > most_extra_fields) {
      records_.extra_bytes += bytes;
      records_.undescribed_bytes += bytes;
      return;
    }
    for (size_t k = 0; k < parts && is_number; ++k) {
      BinaryField field{.name = parts > 1 ? fmt::format("{}_{}", name, k + 1) : name, .type = number};
      field.offset = records_.extra_bytes + k * size_of(number);
      field.swap = swap;
      if ((options & 1) != 0) field.no_data = no_data(number, description.data() + 40 + 8 * k, swap);
      if ((options & 8) != 0) field.scale = load<double>(description.data() + 112 + 8 * k, swap);
      if ((options & 16) != 0) field.add = load<double>(description.data() + 136 + 8 * k, swap);
      records_.extra.push_back(std::move(field));
    }
    records_.extra_bytes += bytes;
    if (!is_number) records_.undescribed_bytes += bytes;
  }

  /// Stored as the widest number of its kind.
  static double no_data(NumberType type, const char* at, bool swap) {
    if (!is_integer(type)) return load<double>(at, swap);
    const bool is_signed = static_cast<int>(type) % 2 == 1;
    return is_signed ? static_cast<double>(load<int64_t>(at, swap)) : static_cast<double>(load<uint64_t>(at, swap));
  }

  ByteSource& source_;
  const LasHeader& header_;
  size_t room_;
  ReadReport& report_;
  LasRecords records_;
  std::string_view geotiff_keys_;
  bool overflow_ = false;
};

}  // namespace

LasRecords read_las_records(ByteSource& source, const LasHeader& header, size_t room, ReadReport& report) {
  return LasRecordsReader(source, header, room, report).read();
}

}  // namespace soapfilm::io
