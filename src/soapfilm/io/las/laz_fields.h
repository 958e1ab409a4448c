// Decoders of LAZ that the pointwise and the layered compression share: GPS times, colors, and what a point's returns
// say of its neighbors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "soapfilm/io/las/laz_coder.h"

namespace soapfilm::io {

/// GPS times, as the bits of doubles: up to four sequences at once, each of nearly equal steps.
class LazTimes {
 public:
  /// `can_stay`: there is a code for a time that does not change (version 2).
  LazTimes(uint64_t first, bool can_stay);

  uint64_t decode(LazDecoder& from);

 private:
  void read_step(LazDecoder& from);
  void read_multiple(LazDecoder& from, uint32_t code);
  void read_far(LazDecoder& from);
  bool switch_sequence(LazDecoder& from);
  int32_t step_near(LazDecoder& from, int32_t multiple, unsigned context) {
    return static_cast<int32_t>(
        steps_.decode(from, static_cast<uint32_t>(multiple) * static_cast<uint32_t>(step()), context));
  }

  int32_t& step() { return step_[now_]; }

  bool can_stay_;
  LazSymbols multiples_;
  LazSymbols without_step_;
  LazIntegers steps_;
  uint32_t now_ = 0;
  uint32_t newest_ = 0;
  std::array<uint64_t, 4> time_{};
  std::array<int32_t, 4> step_{};
  std::array<int, 4> odd_steps_{};  // that came one after the other
};

/// Three 16-bit numbers, whose bytes change alike.
class LazColors {
 public:
  using Color = std::array<uint16_t, 3>;

  LazColors();
  Color decode(LazDecoder& from, const Color& last);

 private:
  LazSymbols changes_;
  std::array<LazSymbols, 6> bytes_;
};

/// One 16-bit number beside the colors.
class LazInfrared {
 public:
  LazInfrared();
  uint16_t decode(LazDecoder& from, uint16_t last);

 private:
  LazSymbols changes_;
  std::array<LazSymbols, 2> bytes_;
};

/// Wave packets of version 1, which are only passed over: what follows them is in the same stream.
class LazWaves {
 public:
  static constexpr size_t bytes = 29;

  explicit LazWaves(const char* first);
  void pass(LazDecoder& from);

 private:
  LazSymbols index_;
  std::array<LazSymbols, 4> offset_kinds_;
  LazIntegers offset_steps_, sizes_, places_, directions_;
  uint32_t last_kind_ = 0;
  int32_t last_step_ = 0;
  uint32_t size_ = 0;
  uint32_t place_ = 0;
  std::array<uint32_t, 3> direction_{};
};

}  // namespace soapfilm::io
