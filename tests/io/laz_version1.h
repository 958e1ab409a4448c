// LAZ of version 1, from before 2011: one stream of all points, for files that tests make.
#pragma once

#include <map>

#include "laz_chunks.h"

namespace soapfilm::laz {

class Version1Encoder {
 public:
  Version1Encoder(int format, const std::string& first)
      : places_(places_of(format)),
        last_(first),
        time_(places_.time != 0 ? at<int64_t>(first, places_.time) : 0),
        extra_(8, std::max<size_t>(first.size() - places_.extra, 1)) {}

  void encode(Encoder& to, const std::string& now) {
    encode_point(to, now);
    if (places_.time != 0) encode_time(to, at<int64_t>(now, places_.time));
    if (places_.color != 0) {
      uint32_t changes = 0;
      for (size_t k = 0; k < 6; ++k) changes |= (last_[places_.color + k] != now[places_.color + k] ? 1u : 0u) << k;
      to.symbol(color_changes_, changes);
      for (size_t k = 0; k < 6; ++k)
        if ((changes >> k & 1) != 0) encode_byte(to, colors_, now, places_.color + k, k);
    }
    if (places_.waves != 0) waves_.encode(to, last_, now, places_.waves);
    for (size_t place = places_.extra; place < now.size(); ++place)
      encode_byte(to, extra_, now, place, place - places_.extra);
    last_ = now;
  }

 private:
  void encode_byte(Encoder& to, IntegerEncoder& bytes, const std::string& now, size_t place, size_t context) {
    bytes.encode(to, byte_of(last_, place), byte_of(now, place), context);
  }

  void encode_point(Encoder& to, const std::string& now) {
    const auto step = [&](size_t place) {
      return static_cast<int32_t>(at<uint32_t>(now, place) - at<uint32_t>(last_, place));
    };
    const auto median = [&](size_t k) {
      std::array<int32_t, 3> sorted = steps_[k];
      std::sort(sorted.begin(), sorted.end());
      return sorted[1];
    };
    x_.encode(to, median(0), step(0));
    y_.encode(to, median(1), step(4), std::min(x_.last_size, 19u));
    const unsigned size = (x_.last_size + y_.last_size) / 2;
    z_.encode(to, at<int32_t>(last_, 8), at<int32_t>(now, 8), std::min(size, 19u));
    for (size_t k = 0; k < 2; ++k) steps_[k][count_ % 3] = step(4 * k);
    ++count_;

    const auto differs = [&](size_t place, size_t bytes) {
      return last_.compare(place, bytes, now, place, bytes) != 0;
    };
    const uint32_t changes = (differs(12, 2) ? 32u : 0u) | (differs(14, 1) ? 16u : 0u) | (differs(15, 1) ? 8u : 0u) |
                             (differs(16, 1) ? 4u : 0u) | (differs(17, 1) ? 2u : 0u) | (differs(18, 2) ? 1u : 0u);
    to.symbol(changes_, changes);
    const auto byte = [&](size_t place) {
      if (differs(place, 1))
        to.symbol(bytes_[place].try_emplace(byte_of(last_, place), 256).first->second, byte_of(now, place));
    };
    if (differs(12, 2)) intensity_.encode(to, at<uint16_t>(last_, 12), at<uint16_t>(now, 12));
    byte(14);
    byte(15);
    if (differs(16, 1)) encode_byte(to, angle_, now, 16, size < 3);
    byte(17);
    if (differs(18, 2)) source_.encode(to, at<uint16_t>(last_, 18), at<uint16_t>(now, 18));
  }

  void encode_time(Encoder& to, int64_t time) {
    const auto step = static_cast<int64_t>(static_cast<uint64_t>(time) - static_cast<uint64_t>(time_));
    const bool fits = step == static_cast<int32_t>(step);
    const auto far = [&](SymbolCounts& codes, uint32_t code) {
      to.symbol(codes, code);
      to.bits(32, static_cast<uint32_t>(time));
      to.bits(32, static_cast<uint32_t>(static_cast<uint64_t>(time) >> 32));
    };
    time_ = time;
    if (time_step_ == 0) {
      if (step == 0) return to.symbol(time_zeros_, 0);
      if (!fits) return far(time_zeros_, 2);
      to.symbol(time_zeros_, 1);
      times_.encode(to, 0, step, 0);
      time_step_ = static_cast<int32_t>(step);
      return;
    }
    if (step == 0) return to.symbol(time_multiples_, 511);
    if (!fits) return far(time_multiples_, 510);
    const double ratio = std::clamp(static_cast<double>(step) / time_step_, 0.0, 509.0);
    const auto multiple = static_cast<uint32_t>(std::lround(ratio));
    to.symbol(time_multiples_, multiple);
    const size_t context = multiple == 0 ? 2 : multiple == 1 ? 1 : multiple < 10 ? 3 : multiple < 50 ? 4 : 5;
    const auto expected = static_cast<int32_t>(multiple * static_cast<uint32_t>(time_step_));
    times_.encode(to, multiple == 0 ? time_step_ / 4 : expected, step, context);
    if (multiple == 0 || multiple == 509) ++odd_;
    if (multiple != 1 && odd_ <= 3) return;
    time_step_ = static_cast<int32_t>(step);
    odd_ = 0;
  }

  Places places_;
  std::string last_;
  IntegerEncoder x_{32}, y_{32, 20}, z_{32, 20}, intensity_{16}, angle_{8, 2}, source_{16};
  std::array<std::array<int32_t, 3>, 2> steps_{};
  size_t count_ = 0;
  SymbolCounts changes_{64}, color_changes_{64};
  std::map<size_t, std::map<uint32_t, SymbolCounts>> bytes_;
  IntegerEncoder colors_{8, 6};
  WaveEncoder waves_;
  SymbolCounts time_multiples_{512}, time_zeros_{3};
  IntegerEncoder times_{32, 6};
  int64_t time_;
  int32_t time_step_ = 0;
  int odd_ = 0;
  IntegerEncoder extra_;
};

}  // namespace soapfilm::laz
