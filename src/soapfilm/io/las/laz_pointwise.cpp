// Points of formats 0 to 5: their fields one after the other in one stream, items of version 2.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>

#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/las/laz_fields.h"
#include "soapfilm/io/las/laz_points.h"

namespace soapfilm::io {

namespace {

// Places in a record.
constexpr size_t x_at = 0, y_at = 4, z_at = 8, intensity_at = 12, returns_at = 14, class_at = 15, angle_at = 16,
                 user_at = 17, source_at = 18, old_point_bytes = 20;

/// Which earlier points a point is like, by its number of returns and which of them it is. (Numbers of files that
/// count from 0, or mix up the two, have groups, too.)
constexpr uint8_t return_groups[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

/// A byte that is decoded by what it was before.
class LazByteByLast {
 public:
  LazByteByLast() {
    for (int k = 0; k < 256; ++k) models_.emplace_back(256);
  }
  char decode(LazDecoder& from, char last) {
    return static_cast<char>(from.symbol(models_[static_cast<uint8_t>(last)]));
  }

 private:
  std::vector<LazSymbols> models_;
};

class LazOldPoint {
 public:
  /// `record` holds the point before; becomes the next one.
  void decode(LazDecoder& from, char* record) {
    const uint32_t changes = from.symbol(changes_);
    if ((changes & 32) != 0) record[returns_at] = returns_.decode(from, record[returns_at]);
    const unsigned returns = static_cast<uint8_t>(record[returns_at]);
    const unsigned number = returns & 7, of = returns >> 3 & 7;
    const size_t group = return_groups[of][number];
    if (changes != 0) decode_changes(from, changes, group, record);
    decode_position(from, group, of, of > number ? of - number : number - of, record);
  }

 private:
  void decode_changes(LazDecoder& from, uint32_t changes, size_t group, char* record) {
    uint16_t& intensity = intensity_of_[group];
    if ((changes & 16) != 0)
      intensity = static_cast<uint16_t>(
          intensities_.decode(from, intensity, std::min<unsigned>(static_cast<unsigned>(group), 3)));
    put_binary(record + intensity_at, intensity);
    if ((changes & 8) != 0) record[class_at] = classes_.decode(from, record[class_at]);
    if ((changes & 4) != 0) {
      const size_t direction = static_cast<uint8_t>(record[returns_at]) >> 6 & 1;
      record[angle_at] = static_cast<char>(from.symbol(angles_[direction]) + static_cast<uint8_t>(record[angle_at]));
    }
    if ((changes & 2) != 0) record[user_at] = users_.decode(from, record[user_at]);
    if ((changes & 1) != 0)
      put_binary(record + source_at,
                 static_cast<uint16_t>(sources_.decode(from, load_little<uint16_t>(record + source_at))));
  }

  void decode_position(LazDecoder& from, size_t group, unsigned returns, unsigned level, char* record) {
    const unsigned single = returns == 1;
    const auto even = [](unsigned bits, unsigned most) { return std::min(bits & ~1u, most); };
    const int32_t dx = x_steps_.decode_signed(from, x_medians_[group].get(), single);
    x_medians_[group].add(dx);
    const unsigned x_bits = x_steps_.bits_of_last();
    const int32_t dy = y_steps_.decode_signed(from, y_medians_[group].get(), single + even(x_bits, 20));
    y_medians_[group].add(dy);
    const unsigned bits = (x_bits + y_steps_.bits_of_last()) / 2;
    height_of_[level] = heights_.decode_signed(from, height_of_[level], single + even(bits, 18));
    put_binary(record + x_at, load_little<uint32_t>(record + x_at) + static_cast<uint32_t>(dx));
    put_binary(record + y_at, load_little<uint32_t>(record + y_at) + static_cast<uint32_t>(dy));
    put_binary(record + z_at, height_of_[level]);
  }

  LazSymbols changes_{64};
  LazByteByLast returns_, classes_, users_;
  std::array<LazSymbols, 2> angles_{LazSymbols(256), LazSymbols(256)};
  LazIntegers intensities_{16, 4}, sources_{16, 1};
  LazIntegers x_steps_{32, 2}, y_steps_{32, 22}, heights_{32, 20};
  std::array<uint16_t, 16> intensity_of_{};  // of each group
  std::array<LazMedian, 16> x_medians_, y_medians_;
  std::array<int32_t, 8> height_of_{};  // of each level: returns before or after this one
};

class LazPointwise : public LazPoints {
 public:
  LazPointwise(const LazLayout& layout, std::string_view bytes)
      : record_(bytes.data(), bytes.data() + layout.record_bytes), rest_(bytes.substr(layout.record_bytes)) {
    const int format = layout.point_format;
    size_t at = old_point_bytes;
    if (format != 0 && format != 2) {
      time_at_ = at;
      times_.emplace(load_little<uint64_t>(bytes.data() + at), true);
      at += sizeof(uint64_t);
    }
    if (format == 2 || format == 3 || format == 5) {
      color_at_ = at;
      colors_.emplace();
      at += sizeof(LazColors::Color);
    }
    if (format >= 4) {
      waves_.emplace(bytes.data() + at);
      at += LazWaves::bytes;
    }
    extra_at_ = at;
    for (; at < layout.record_bytes; ++at) extras_.emplace_back(256);
  }

  bool read(size_t count, char* to) override {
    const size_t bytes = record_.size();
    for (size_t i = 0; i < count; ++i, to += bytes) {
      if (!is_first_) next();
      if (from_.failed()) return false;
      std::memcpy(to, record_.data(), bytes);
      if (is_first_) put_binary(record_.data() + intensity_at, uint16_t{0});  // as the points before it count as dark
      is_first_ = false;
    }
    return true;
  }

 private:
  void next() {
    if (!begun_) from_ = LazDecoder(rest_);  // a chunk of one point may end here
    begun_ = true;
    char* const record = record_.data();
    point_.decode(from_, record);
    if (times_) put_binary(record + time_at_, times_->decode(from_));
    if (colors_) {
      LazColors::Color color{};
      for (size_t k = 0; k < 3; ++k) color[k] = load_little<uint16_t>(record + color_at_ + 2 * k);
      color = colors_->decode(from_, color);
      for (size_t k = 0; k < 3; ++k) put_binary(record + color_at_ + 2 * k, color[k]);
    }
    if (waves_) waves_->pass(from_);
    for (size_t k = 0; k < extras_.size(); ++k) {
      char& byte = record[extra_at_ + k];
      byte = static_cast<char>(from_.symbol(extras_[k]) + static_cast<uint8_t>(byte));
    }
  }

  std::vector<char> record_;  // the last one
  std::string_view rest_;
  LazDecoder from_;
  bool is_first_ = true;
  bool begun_ = false;
  LazOldPoint point_;
  std::optional<LazTimes> times_;
  std::optional<LazColors> colors_;
  std::optional<LazWaves> waves_;
  std::vector<LazSymbols> extras_;
  size_t time_at_ = 0, color_at_ = 0, extra_at_ = 0;
};

}  // namespace

std::unique_ptr<LazPoints> laz_pointwise(const LazLayout& layout, std::string_view bytes) {
  return bytes.size() < layout.record_bytes ? nullptr : std::make_unique<LazPointwise>(layout, bytes);
}

std::unique_ptr<LazPoints> laz_points(const LazLayout& layout, uint64_t points, std::string_view bytes,
                                      const std::vector<bool>& wanted) {
  if (layout.layered) return laz_layers(layout, points, bytes, wanted);
  return layout.version == 1 ? laz_version1(layout, bytes) : laz_pointwise(layout, bytes);
}

}  // namespace soapfilm::io
