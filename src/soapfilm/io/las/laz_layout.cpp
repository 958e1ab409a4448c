#include "soapfilm/io/las/laz_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io/las/laz_coder.h"

namespace soapfilm::io {

namespace {

/// A part of a point record that has a compressor of its own. Numbers as the standard gives them.
struct LazItem {
  uint16_t type = 0;
  uint16_t bytes = 0;
  uint16_t version = 0;
};
enum LazItemType : uint16_t {
  extra_bytes_item = 0,
  point_item = 6,
  time_item = 7,
  color_item = 8,
  wave_item = 9,
  new_point_item = 10,
  new_color_item = 11,
  color_infrared_item = 12,
  new_wave_item = 13,
  new_extra_bytes_item = 14
};

enum LazCompressor : uint16_t { pointwise = 1, pointwise_chunked = 2, layered_chunked = 3 };
constexpr uint32_t variable_chunks = 0xffffffff;
constexpr uint64_t table_at_end = ~uint64_t{0};

std::vector<LazItem> items_of(int point_format, size_t extra_bytes) {
  std::vector<LazItem> items;
  if (point_format < 6) {
    items.push_back({point_item, 20});
    if (point_format != 0 && point_format != 2) items.push_back({time_item, 8});
    if (point_format == 2 || point_format == 3 || point_format == 5) items.push_back({color_item, 6});
    if (point_format >= 4) items.push_back({wave_item, 29});
    if (extra_bytes > 0) items.push_back({extra_bytes_item, static_cast<uint16_t>(extra_bytes)});
    return items;
  }
  items.push_back({new_point_item, 30});
  if (point_format == 7) items.push_back({new_color_item, 6});
  if (point_format == 8 || point_format == 10) items.push_back({color_infrared_item, 8});
  if (point_format >= 9) items.push_back({new_wave_item, 29});
  if (extra_bytes > 0) items.push_back({new_extra_bytes_item, static_cast<uint16_t>(extra_bytes)});
  return items;
}

class LazLayoutReader {
 public:
  LazLayoutReader(ByteSource& source, const LasHeader& header) : source_(source), header_(header) {}

  LazLayout read(std::string_view record) {
    layout_.points_offset = header_.points_offset;
    layout_.point_format = header_.point_format;
    layout_.record_bytes = header_.record_bytes;
    layout_.extra_bytes = header_.record_bytes - standard_bytes(header_.point_format);
    read_record(record);
    if (compressor_ == pointwise)
      add_only_chunk();
    else
      read_chunks();
    return std::move(layout_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.path() + ": LAZ: " + what); }
  [[noreturn]] void fail_at(uint64_t offset, const std::string& what) const {
    throw InputError(fmt::format("{}: byte {}: LAZ: {}", source_.path(), offset, what));
  }

  void read_record(std::string_view record) {
    constexpr size_t head_bytes = 34, item_bytes = 6;
    const auto word = [&](size_t at) { return load_little<uint16_t>(record.data() + at); };
    if (record.empty()) fail("its points are marked as compressed, but no record of LASzip says how");
    if (record.size() < head_bytes)
      fail(fmt::format("its record of LASzip has {} bytes, must have at least {}", record.size(), head_bytes));
    compressor_ = word(0);
    chunk_points_ = load_little<uint32_t>(record.data() + 12);
    if (compressor_ < pointwise || compressor_ > layered_chunked)
      fail(fmt::format("compressor = {}, must be 1 to 3", compressor_));
    if (word(2) != 0) fail(fmt::format("coder = {}, must be 0 (arithmetic)", word(2)));
    const size_t count = word(32);
    if (record.size() < head_bytes + count * item_bytes)
      fail(fmt::format("its record of LASzip has {} bytes, must have {} for {} items", record.size(),
                       head_bytes + count * item_bytes, count));
    std::vector<LazItem> items;
    for (size_t at = head_bytes; items.size() < count; at += item_bytes)
      items.push_back({word(at), word(at + 2), word(at + 4)});
    check_items(items);
  }

  void check_items(const std::vector<LazItem>& items) {
    const std::vector<LazItem> expected = items_of(layout_.point_format, layout_.extra_bytes);
    if (items.size() != expected.size())
      fail(fmt::format("{} items, must be {} of point format {} with {} extra bytes", items.size(), expected.size(),
                       layout_.point_format, layout_.extra_bytes));
    for (size_t k = 0; k < items.size(); ++k)
      if (items[k].type != expected[k].type || items[k].bytes != expected[k].bytes)
        fail(fmt::format("item {} is of type {} and {} bytes, must be of type {} and {} bytes in point format {}",
                         k + 1, items[k].type, items[k].bytes, expected[k].type, expected[k].bytes,
                         layout_.point_format));
    layout_.layered = layout_.point_format >= 6;
    layout_.version = items.front().version;
    if (layout_.layered != (compressor_ == layered_chunked))
      fail(fmt::format("compressor = {}, must be {} of point format {}", compressor_, layout_.layered ? "3" : "1 or 2",
                       layout_.point_format));
    const int oldest = layout_.layered ? 3 : 1;
    for (const LazItem& item : items) {
      const bool fits = item.version == layout_.version || (item.type == wave_item && item.version == 1);
      if (!fits || item.version < oldest || item.version > oldest + 1)
        fail(fmt::format("version of an item = {}, must be {} or {}, the same for all items", item.version, oldest,
                         oldest + 1));
    }
  }

  /// Of the oldest compressor: it ends where the file ends.
  void add_only_chunk() {
    const uint64_t begin = header_.points_offset;
    const uint64_t size = source_.bytes().size();
    if (size - begin < layout_.record_bytes)
      fail_at(begin, fmt::format("its points begin {} bytes before its end, must have {} for the first one",
                                 size - begin, layout_.record_bytes));
    layout_.chunks.push_back({begin, size - begin, 0, header_.count});
  }

  void read_chunks() {
    uint64_t at = header_.points_offset;
    const uint64_t first_chunk = at + 8, size = source_.bytes().size();
    if (chunk_points_ == 0) fail("points in a chunk = 0, must be > 0");
    auto table = ByteCursor(source_, static_cast<size_t>(at)).read<uint64_t>();
    if (table == table_at_end) {  // a writer that could not go back
      at = size - 8;
      table = ByteCursor(source_, static_cast<size_t>(at)).read<uint64_t>();
    }
    if (table < first_chunk || table > size - 8)
      fail_at(at,
              fmt::format("offset of the table of chunks = {}, must be from {} to {}: the file is truncated, or was "
                          "never finished",
                          table, first_chunk, size - 8));
    read_table(first_chunk, table);
  }

  void read_table(uint64_t first_chunk, uint64_t at) {
    ByteCursor cursor(source_, static_cast<size_t>(at));
    if (const auto version = cursor.read<uint32_t>(); version != 0)
      fail_at(at, fmt::format("version of the table of chunks = {}, must be 0", version));
    const auto count = cursor.read<uint32_t>();
    const uint64_t most = (at - first_chunk) / layout_.record_bytes;
    if (count > most)
      fail_at(at + 4, fmt::format("number of chunks = {}, must be at most {}: their first points fill {} bytes each",
                                  count, most, layout_.record_bytes));
    LazDecoder decoder(source_.bytes().substr(cursor.offset()));
    LazIntegers numbers(32, 2);
    uint32_t points = 0, bytes = 0;
    uint64_t begin = first_chunk, sum = 0;
    for (uint32_t k = 0; k < count && sum < header_.count; ++k) {
      if (chunk_points_ == variable_chunks) points = numbers.decode(decoder, points, 0);
      bytes = numbers.decode(decoder, bytes, 1);
      const uint64_t rest = header_.count - sum;
      const uint64_t own = chunk_points_ == variable_chunks ? points : std::min<uint64_t>(chunk_points_, rest);
      if (decoder.failed()) fail_at(at, fmt::format("the table of chunks ends before chunk {} of {}", k + 1, count));
      if (bytes > at - begin || own > rest || (own > 0 && bytes < layout_.record_bytes))
        fail_at(at, fmt::format("chunk {} of {}: {} bytes from {} and {} points, must be before byte {} and of at most "
                                "{} points",
                                k + 1, count, bytes, begin, own, at, rest));
      if (own > 0) layout_.chunks.push_back({begin, bytes, sum, own});
      begin += bytes;
      sum += own;
    }
    if (sum < header_.count)
      fail_at(at, fmt::format("{} chunks hold {} points, must be the {} of the header", count, sum, header_.count));
  }

  ByteSource& source_;
  const LasHeader& header_;
  LazLayout layout_;
  uint16_t compressor_ = 0;
  uint32_t chunk_points_ = 0;
};

}  // namespace

LazLayout read_laz_layout(ByteSource& source, const LasHeader& header, std::string_view record) {
  return LazLayoutReader(source, header).read(record);
}

}  // namespace soapfilm::io
