// Points of formats 0 to 5 with items of version 1, of LASzip before 2011.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/las/laz_fields.h"
#include "soapfilm/io/las/laz_points.h"

namespace soapfilm::io {

namespace {

template <class T>
T get_version1(const char* at) {
  return load_little<T>(at);
}

/// Of the last three numbers.
class LazMedianOfThree {
 public:
  int32_t get() const {
    const auto [a, b, c] = last_;
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  }
  void add(int32_t value) {
    last_[oldest_] = value;
    oldest_ = (oldest_ + 1) % last_.size();
  }

 private:
  std::array<int32_t, 3> last_{};
  size_t oldest_ = 0;
};

class LazVersion1Point {
 public:
  LazVersion1Point() {
    for (auto& models : bytes_)
      for (int k = 0; k < 256; ++k) models.emplace_back(256);
  }

  /// `record` holds the point before; becomes the next one.
  void decode(LazDecoder& from, char* record) {
    constexpr unsigned most = 19;
    const int32_t dx = x_steps_.decode_signed(from, x_median_.get());
    x_median_.add(dx);
    const unsigned x_bits = x_steps_.bits_of_last();
    const int32_t dy = y_steps_.decode_signed(from, y_median_.get(), std::min(x_bits, most));
    y_median_.add(dy);
    const unsigned bits = (x_bits + y_steps_.bits_of_last()) / 2;
    const int32_t z = heights_.decode_signed(from, get_version1<int32_t>(record + 8), std::min(bits, most));
    put_binary(record, get_version1<uint32_t>(record) + static_cast<uint32_t>(dx));
    put_binary(record + 4, get_version1<uint32_t>(record + 4) + static_cast<uint32_t>(dy));
    put_binary(record + 8, z);

    const uint32_t changes = from.symbol(changes_);
    const auto byte = [&](uint32_t change, size_t which, size_t place) {
      if ((changes & change) == 0) return;
      LazSymbols& model = bytes_[which][static_cast<uint8_t>(record[place])];
      record[place] = static_cast<char>(from.symbol(model));
    };
    const auto word = [&](uint32_t change, LazIntegers& numbers, size_t place) {
      if ((changes & change) == 0) return;
      put_binary(record + place, static_cast<uint16_t>(numbers.decode(from, get_version1<uint16_t>(record + place))));
    };
    word(32, intensities_, 12);
    byte(16, 0, 14);
    byte(8, 1, 15);
    if ((changes & 4) != 0)
      record[16] = static_cast<char>(angles_.decode(from, static_cast<uint8_t>(record[16]), bits < 3));
    byte(2, 2, 17);
    word(1, sources_, 18);
  }

 private:
  LazIntegers x_steps_{32, 1}, y_steps_{32, 20}, heights_{32, 20};
  LazIntegers intensities_{16, 1}, angles_{8, 2}, sources_{16, 1};
  LazSymbols changes_{64};
  std::array<std::vector<LazSymbols>, 3> bytes_;
  LazMedianOfThree x_median_, y_median_;
};

class LazVersion1Time {
 public:
  explicit LazVersion1Time(uint64_t first) : time_(first) {}

  uint64_t decode(LazDecoder& from) {
    constexpr uint32_t most_multiple = 509, far = 510;  // one more: it stays
    if (step_ == 0) {
      const uint32_t code = from.symbol(without_step_);
      if (code == 1) add(step_ = steps_.decode_signed(from, 0, 0));
      if (code == 2) time_ = from.long_bits();
      return time_;
    }
    const uint32_t code = from.symbol(multiples_);
    if (code == far) time_ = from.long_bits();
    if (code >= far) return time_;
    const int32_t expected = code == 0 ? step_ / 4 : static_cast<int32_t>(code * static_cast<uint32_t>(step_));
    const unsigned context = code == 0 ? 2 : code == 1 ? 1 : code < 10 ? 3 : code < 50 ? 4 : 5;
    const int32_t found = steps_.decode_signed(from, expected, context);
    add(found);
    const bool odd = code == 0 || code == most_multiple;
    if (odd) ++odd_steps_;
    if (code == 1 || odd_steps_ > 3) {
      step_ = found;
      odd_steps_ = 0;
    }
    return time_;
  }

 private:
  void add(int32_t step) { time_ += static_cast<uint64_t>(int64_t{step}); }

  uint64_t time_;
  int32_t step_ = 0;
  int odd_steps_ = 0;
  LazSymbols multiples_{512}, without_step_{3};
  LazIntegers steps_{32, 6};
};

/// Bytes of 16-bit numbers, those that change.
class LazVersion1Color {
 public:
  void decode(LazDecoder& from, char* at) {
    const uint32_t changes = from.symbol(changes_);
    for (unsigned k = 0; k < 6; ++k) {
      if ((changes >> k & 1) != 0) at[k] = static_cast<char>(bytes_.decode(from, static_cast<uint8_t>(at[k]), k));
    }
  }

 private:
  LazSymbols changes_{64};
  LazIntegers bytes_{8, 6};
};

class LazVersion1 : public LazPoints {
 public:
  LazVersion1(const LazLayout& layout, std::string_view bytes)
      : record_(bytes.data(), bytes.data() + layout.record_bytes), rest_(bytes.substr(layout.record_bytes)) {
    const int format = layout.point_format;
    size_t at = 20;
    if (format != 0 && format != 2) {
      times_.emplace(get_version1<uint64_t>(bytes.data() + at));
      at += 8;
    }
    if (format == 2 || format == 3 || format == 5) {
      colors_.emplace();
      at += 6;
    }
    if (format >= 4) waves_.emplace(bytes.data() + at);
    if (layout.extra_bytes > 0) extra_.emplace(8, static_cast<unsigned>(layout.extra_bytes));
    extra_at_ = layout.record_bytes - layout.extra_bytes;
  }

  bool read(size_t count, char* to) override {
    for (size_t i = 0; i < count; ++i, to += record_.size()) {
      if (!is_first_) next();
      if (from_.failed()) return false;
      is_first_ = false;
      std::memcpy(to, record_.data(), record_.size());
    }
    return true;
  }

 private:
  void next() {
    if (!begun_) from_ = LazDecoder(rest_);
    begun_ = true;
    char* at = record_.data();
    point_.decode(from_, at);
    at += 20;
    if (times_) at = put_binary(at, times_->decode(from_));
    if (colors_) colors_->decode(from_, at);
    if (waves_) waves_->pass(from_);
    for (size_t k = extra_at_; k < record_.size(); ++k)
      record_[k] = static_cast<char>(
          extra_->decode(from_, static_cast<uint8_t>(record_[k]), static_cast<unsigned>(k - extra_at_)));
  }

  std::vector<char> record_;  // the last one
  std::string_view rest_;
  LazDecoder from_;
  bool is_first_ = true;
  bool begun_ = false;
  LazVersion1Point point_;
  std::optional<LazVersion1Time> times_;
  std::optional<LazVersion1Color> colors_;
  std::optional<LazWaves> waves_;
  std::optional<LazIntegers> extra_;
  size_t extra_at_ = 0;
};

}  // namespace

std::unique_ptr<LazPoints> laz_version1(const LazLayout& layout, std::string_view bytes) {
  return bytes.size() < layout.record_bytes ? nullptr : std::make_unique<LazVersion1>(layout, bytes);
}

}  // namespace soapfilm::io
