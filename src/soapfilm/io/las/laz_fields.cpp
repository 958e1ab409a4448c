#include "soapfilm/io/las/laz_fields.h"

#include <algorithm>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

namespace {

// Codes of a step: the multiple of the last one up to 500, then 500 + the multiple of its opposite up to 10, and more.
constexpr uint32_t most_multiple = 500;
constexpr uint32_t most_negative = 10;
constexpr uint32_t after_multiples = most_multiple + most_negative + 1;
constexpr int most_odd_steps = 3;

uint32_t low_byte(uint32_t value) { return value & 0xff; }
uint32_t high_byte(uint32_t value) { return value >> 8; }

uint32_t clamped(int32_t value) { return static_cast<uint32_t>(std::clamp(value, 0, 255)); }

}  // namespace

LazTimes::LazTimes(uint64_t first, bool can_stay)
    : can_stay_(can_stay),
      multiples_(after_multiples + 4 + can_stay),
      without_step_(5 + can_stay),
      steps_(32, 9),
      time_{first} {}

uint64_t LazTimes::decode(LazDecoder& from) {
  // A writer changes to another sequence at most once; who made a file that does it for ever is refused.
  for (int changes = 0; switch_sequence(from); ++changes)
    if (changes > 0) {
      from.fail();
      break;
    }
  return time_[now_];
}

/// Reads a code; true if it names another sequence, so that another code follows.
bool LazTimes::switch_sequence(LazDecoder& from) {
  const uint32_t stay = can_stay_;
  const bool without = step() == 0;
  const uint32_t code = from.symbol(without ? without_step_ : multiples_);
  const uint32_t far = without ? 1 + stay : after_multiples + stay;
  if (code > far) {
    now_ = (now_ + code - far) & 3;
    return true;
  }
  if (code == far) {
    read_far(from);
  } else if (without) {
    if (code == stay) read_step(from);
  } else if (code < after_multiples) {
    read_multiple(from, code);
  }
  return false;
}

void LazTimes::read_step(LazDecoder& from) {
  step() = steps_.decode_signed(from, 0, 0);
  time_[now_] += static_cast<uint64_t>(int64_t{step()});
  odd_steps_[now_] = 0;
}

void LazTimes::read_multiple(LazDecoder& from, uint32_t code) {
  const auto multiple = static_cast<int32_t>(code);
  constexpr auto most = static_cast<int32_t>(most_multiple), negative = static_cast<int32_t>(most_negative);
  int32_t found = 0;
  bool odd = false;
  if (multiple == 1) {
    found = step_near(from, 1, 1);
    odd_steps_[now_] = 0;
  } else if (multiple == 0) {
    found = step_near(from, 0, 7);
    odd = true;
  } else if (multiple < most) {
    found = step_near(from, multiple, multiple < 10 ? 2 : 3);
  } else if (multiple == most) {
    found = step_near(from, most, 4);
    odd = true;
  } else if (multiple < most + negative) {
    found = step_near(from, most - multiple, 5);
  } else {
    found = step_near(from, -negative, 6);
    odd = true;
  }
  time_[now_] += static_cast<uint64_t>(int64_t{found});
  if (odd && ++odd_steps_[now_] > most_odd_steps) {
    step() = found;
    odd_steps_[now_] = 0;
  }
}

void LazTimes::read_far(LazDecoder& from) {
  const uint32_t high = steps_.decode(from, static_cast<uint32_t>(time_[now_] >> 32), 8);
  newest_ = (newest_ + 1) & 3;
  now_ = newest_;
  time_[now_] = uint64_t{high} << 32 | from.bits(32);
  step() = 0;
  odd_steps_[now_] = 0;
}

LazColors::LazColors()
    : changes_(128), bytes_{LazSymbols(256), LazSymbols(256), LazSymbols(256),
                            LazSymbols(256), LazSymbols(256), LazSymbols(256)} {}

LazColors::Color LazColors::decode(LazDecoder& from, const Color& last) {
  const uint32_t changes = from.symbol(changes_);
  const auto changed = [&](size_t byte, uint32_t before) {
    return (changes >> byte & 1) != 0 ? low_byte(from.symbol(bytes_[byte]) + before) : before;
  };
  const uint32_t red_low = changed(0, low_byte(last[0])), red_high = changed(1, high_byte(last[0]));
  const auto red = static_cast<uint16_t>(red_high << 8 | red_low);
  if ((changes & 64) == 0) return {red, red, red};

  // A byte of green is predicted by the change of red's, one of blue's by the mean of both changes.
  const auto predicted = [&](size_t byte, int32_t change, uint32_t before) {
    if ((changes >> byte & 1) == 0) return before;
    return low_byte(from.symbol(bytes_[byte]) + clamped(change + static_cast<int32_t>(before)));
  };
  const auto minus = [](uint32_t a, uint32_t b) { return static_cast<int32_t>(a) - static_cast<int32_t>(b); };
  int32_t change = minus(red_low, low_byte(last[0]));
  const uint32_t green_low = predicted(2, change, low_byte(last[1]));
  change = (change + minus(green_low, low_byte(last[1]))) / 2;
  const uint32_t blue_low = predicted(4, change, low_byte(last[2]));
  change = minus(red_high, high_byte(last[0]));
  const uint32_t green_high = predicted(3, change, high_byte(last[1]));
  change = (change + minus(green_high, high_byte(last[1]))) / 2;
  const uint32_t blue_high = predicted(5, change, high_byte(last[2]));
  return {red, static_cast<uint16_t>(green_high << 8 | green_low), static_cast<uint16_t>(blue_high << 8 | blue_low)};
}

LazInfrared::LazInfrared() : changes_(4), bytes_{LazSymbols(256), LazSymbols(256)} {}

uint16_t LazInfrared::decode(LazDecoder& from, uint16_t last) {
  const uint32_t changes = from.symbol(changes_);
  uint32_t low = low_byte(last), high = high_byte(last);
  if ((changes & 1) != 0) low = low_byte(low + from.symbol(bytes_[0]));
  if ((changes & 2) != 0) high = low_byte(high + from.symbol(bytes_[1]));
  return static_cast<uint16_t>(high << 8 | low);
}

LazWaves::LazWaves(const char* first)
    : index_(256),
      offset_kinds_{LazSymbols(4), LazSymbols(4), LazSymbols(4), LazSymbols(4)},
      offset_steps_(32, 1),
      sizes_(32, 1),
      places_(32, 1),
      directions_(32, 3),
      size_(load_little<uint32_t>(first + 9)),
      place_(load_little<uint32_t>(first + 13)) {
  for (size_t k = 0; k < 3; ++k) direction_[k] = load_little<uint32_t>(first + 17 + 4 * k);
}

void LazWaves::pass(LazDecoder& from) {
  from.symbol(index_);
  last_kind_ = from.symbol(offset_kinds_[last_kind_]);
  if (last_kind_ == 2) last_step_ = offset_steps_.decode_signed(from, last_step_);
  if (last_kind_ == 3) from.long_bits();
  size_ = sizes_.decode(from, size_);
  place_ = places_.decode(from, place_);
  for (unsigned k = 0; k < 3; ++k) direction_[k] = directions_.decode(from, direction_[k], k);
}

}  // namespace soapfilm::io
