// How LAZ writes the parts of a point record, for files that tests make: times, colors, extra bytes and wave packets.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "laz_encoder.h"

namespace soapfilm::laz {

template <class T>
T at(const std::string& record, size_t place) {
  T value;
  std::memcpy(&value, record.data() + place, sizeof(T));
  return value;
}

inline std::vector<SymbolCounts> many(size_t count, size_t symbols) {
  return std::vector<SymbolCounts>(count, SymbolCounts(symbols));
}

/// The median of the last five numbers as LAZ has it.
class Median {
 public:
  int32_t get() const { return sorted_[2]; }
  void add(int32_t v) {
    const bool high = high_;
    high_ = high ? v < sorted_[2] : !(sorted_[2] < v);
    sorted_[high ? 4 : 0] = v;
    std::sort(sorted_.begin(), sorted_.end());
  }

 private:
  std::array<int32_t, 5> sorted_{};
  bool high_ = true;
};

class TimeEncoder {
 public:
  /// `old`: of format 1 to 5, where a time may stay as it is.
  TimeEncoder(int64_t first, bool old) : old_(old), multiples_(515 + old), zeros_(5 + old), times_{first} {}

  void encode(Encoder& to, int64_t time) {
    const uint32_t far = steps_[now_] == 0 ? 1 + old_ : 511 + old_;
    SymbolCounts& codes = steps_[now_] == 0 ? zeros_ : multiples_;
    if (old_ && time == times_[now_]) return to.symbol(codes, far == 2 ? 0 : 511);
    if (fits(time, now_)) return encode_step(to, static_cast<int32_t>(time - times_[now_]));
    for (uint32_t k = 1; k < 4; ++k) {
      if (!fits(time, (now_ + k) & 3)) continue;
      to.symbol(codes, far + k);
      now_ = (now_ + k) & 3;
      return encode(to, time);
    }
    to.symbol(codes, far);
    integers_.encode(to, times_[now_] >> 32, time >> 32, 8);
    to.bits(32, static_cast<uint32_t>(time));
    now_ = newest_ = (newest_ + 1) & 3;
    times_[now_] = time;
    steps_[now_] = 0;
    odd_[now_] = 0;
  }

 private:
  bool fits(int64_t time, uint32_t sequence) const {
    const auto step = static_cast<int64_t>(static_cast<uint64_t>(time) - static_cast<uint64_t>(times_[sequence]));
    return step == static_cast<int32_t>(step);
  }

  void encode_step(Encoder& to, int32_t step) {
    times_[now_] += step;
    if (steps_[now_] == 0) {
      to.symbol(zeros_, old_);
      integers_.encode(to, 0, step, 0);
      steps_[now_] = step;
      odd_[now_] = 0;
      return;
    }
    const double ratio = double{1} * step / steps_[now_];
    const auto multiple = static_cast<int32_t>(std::lround(std::clamp(ratio, -1000.0, 1000.0)));
    const auto write = [&](uint32_t code, int32_t times, size_t context, bool odd) {
      to.symbol(multiples_, code);
      integers_.encode(to, static_cast<int32_t>(static_cast<uint32_t>(times) * static_cast<uint32_t>(steps_[now_])),
                       step, context);
      if (odd && ++odd_[now_] > 3) {
        steps_[now_] = step;
        odd_[now_] = 0;
      }
    };
    if (multiple == 1) {
      write(1, 1, 1, false);
      odd_[now_] = 0;
    } else if (multiple == 0) {
      write(0, 0, 7, true);
    } else if (multiple >= 500) {
      write(500, 500, 4, true);
    } else if (multiple > 0) {
      write(static_cast<uint32_t>(multiple), multiple, multiple < 10 ? 2 : 3, false);
    } else if (multiple > -10) {
      write(static_cast<uint32_t>(500 - multiple), multiple, 5, false);
    } else {
      write(510, -10, 6, true);
    }
  }

  bool old_;
  SymbolCounts multiples_, zeros_;
  IntegerEncoder integers_{32, 9};
  uint32_t now_ = 0, newest_ = 0;
  std::array<int64_t, 4> times_;
  std::array<int32_t, 4> steps_{};
  std::array<int, 4> odd_{};
};

using Color = std::array<uint16_t, 3>;

class ColorEncoder {
 public:
  void encode(Encoder& to, const Color& last, const Color& now) {
    const auto low = [](const Color& c, size_t k) { return c[k] & 255; };
    const auto high = [](const Color& c, size_t k) { return c[k] >> 8; };
    uint32_t changes = now[0] != now[1] || now[0] != now[2] ? 64 : 0;
    for (size_t k = 0; k < 3; ++k) {
      if (low(last, k) != low(now, k)) changes |= 1u << (2 * k);
      if (high(last, k) != high(now, k)) changes |= 2u << (2 * k);
    }
    to.symbol(changes_, changes);
    const auto byte = [&](size_t k, int predicted, int value) {
      if ((changes >> k & 1) != 0) to.symbol(bytes_[k], static_cast<uint32_t>(value - predicted) & 255);
    };
    byte(0, low(last, 0), low(now, 0));
    byte(1, high(last, 0), high(now, 0));
    if ((changes & 64) == 0) return;
    const auto clamp = [](int v) { return std::clamp(v, 0, 255); };
    const auto rest = [&](size_t first_byte, auto&& part) {
      const int red = part(now, 0) - part(last, 0);
      const int green = part(now, 1) - part(last, 1);
      byte(first_byte, clamp(red + part(last, 1)), part(now, 1));
      byte(first_byte + 2, clamp((red + green) / 2 + part(last, 2)), part(now, 2));
    };
    rest(2, low);
    rest(3, high);
  }

 private:
  SymbolCounts changes_{128};
  std::vector<SymbolCounts> bytes_ = many(6, 256);
};

class InfraredEncoder {
 public:
  void encode(Encoder& to, uint16_t last, uint16_t now) {
    const uint32_t changes = ((last & 255) != (now & 255) ? 1u : 0u) | (last >> 8 != now >> 8 ? 2u : 0u);
    to.symbol(changes_, changes);
    if ((changes & 1) != 0) to.symbol(bytes_[0], static_cast<uint32_t>(now - last) & 255);
    if ((changes & 2) != 0) to.symbol(bytes_[1], static_cast<uint32_t>((now >> 8) - (last >> 8)) & 255);
  }

 private:
  SymbolCounts changes_{4};
  std::vector<SymbolCounts> bytes_ = many(2, 256);
};

/// Wave packets of formats 4 and 5; both are whole records from `place` on.
class WaveEncoder {
 public:
  void encode(Encoder& to, const std::string& last, const std::string& now, size_t place) {
    to.symbol(index_, static_cast<uint8_t>(now[place]));
    const auto step = static_cast<int64_t>(at<uint64_t>(now, place + 1) - at<uint64_t>(last, place + 1));
    const uint32_t kind = step == 0                               ? 0
                          : step == at<uint32_t>(last, place + 9) ? 1
                          : step == static_cast<int32_t>(step)    ? 2
                                                                  : 3;
    to.symbol(kinds_[last_kind_], kind);
    last_kind_ = kind;
    if (kind == 2) {
      steps_.encode(to, last_step_, step);
      last_step_ = step;
    }
    if (kind == 3) {
      to.bits(32, at<uint32_t>(now, place + 1));
      to.bits(32, at<uint32_t>(now, place + 5));
    }
    sizes_.encode(to, at<int32_t>(last, place + 9), at<int32_t>(now, place + 9));
    places_.encode(to, at<int32_t>(last, place + 13), at<int32_t>(now, place + 13));
    for (size_t k = 0; k < 3; ++k)
      directions_.encode(to, at<int32_t>(last, place + 17 + 4 * k), at<int32_t>(now, place + 17 + 4 * k), k);
  }

 private:
  SymbolCounts index_{256};
  std::vector<SymbolCounts> kinds_ = many(4, 4);
  IntegerEncoder steps_{32}, sizes_{32}, places_{32}, directions_{32, 3};
  uint32_t last_kind_ = 0;
  int64_t last_step_ = 0;
};

}  // namespace soapfilm::laz
