// The arithmetic decoder of LAZ (Said 2004, "Introduction to arithmetic coding") and its adaptive models: each number
// of a point is decoded by a model of how often its values came before.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// How often a bit was 0, of what came before.
class LazBit {
 public:
  static constexpr unsigned precision = 13;  ///< bits of a probability

  uint32_t probability_of_zero() const { return probability_; }
  void count(uint32_t bit) {
    zeros_ += bit == 0;
    if (--until_update_ == 0) update();
  }

 private:
  void update();

  uint32_t zeros_ = 1;
  uint32_t bits_ = 2;
  uint32_t probability_ = 1u << (precision - 1);
  uint32_t cycle_ = 4;
  uint32_t until_update_ = 4;
};

/// How often each symbol came. Takes memory when the first one is decoded: most models of a file are never used.
class LazSymbols {
 public:
  static constexpr unsigned precision = 15;

  explicit LazSymbols(uint32_t symbols) : symbols_(symbols) {}

  uint32_t symbols() const { return symbols_; }
  /// Called before the others.
  void prepare() {
    if (!numbers_) begin();
  }
  /// The sum of the probabilities of all symbols before this one.
  uint32_t begin_of(uint32_t symbol) const { return numbers_[symbol]; }
  /// The symbol whose part of [0, 2^15) holds `at`.
  uint32_t find(uint32_t at) const {
    const uint16_t* const cell = &numbers_[2 * symbols_ + (at >> table_shift_)];
    uint32_t low = cell[0], high = cell[1] + 1u;
    while (high > low + 1) {
      const uint32_t middle = (low + high) / 2;
      (numbers_[middle] > at ? high : low) = middle;
    }
    return low;
  }
  void count(uint32_t symbol) {
    ++numbers_[symbols_ + symbol];
    if (--until_update_ == 0) update();
  }

 private:
  void begin();
  void update();

  uint32_t symbols_;
  uint32_t table_size_ = 0;  // cells of [0, 2^15), a power of two
  uint32_t table_shift_ = 0;
  uint32_t total_ = 0;  // of counts
  uint32_t cycle_ = 0;
  uint32_t until_update_ = 0;
  std::unique_ptr<uint16_t[]> numbers_;  // probabilities before each symbol; counts; the symbol at each cell's begin
};

/// Decodes one stream. Beyond its end it reads zeros, and says so: whoever decodes asks once in a while.
class LazDecoder {
 public:
  LazDecoder() = default;
  explicit LazDecoder(std::string_view bytes);

  /// Has a number been decoded that was not in the stream, or that no writer makes?
  bool failed() const { return failed_; }
  void fail() { failed_ = true; }

  uint32_t bit(LazBit& model) {
    const uint32_t zero = model.probability_of_zero() * (length_ >> LazBit::precision);
    const uint32_t found = value_ >= zero;
    if (found == 0)
      length_ = zero;
    else
      take(zero, length_ - zero);
    if (length_ < least_length) refill();
    model.count(found);
    return found;
  }

  uint32_t symbol(LazSymbols& model) {
    model.prepare();
    const uint32_t step = length_ >> LazSymbols::precision;
    constexpr uint32_t last = (1u << LazSymbols::precision) - 1;  // the division rounds
    const uint32_t found = model.find(std::min(value_ / step, last));
    const uint32_t begin = model.begin_of(found) * step;
    const uint32_t end = found + 1 < model.symbols() ? model.begin_of(found + 1) * step : length_;
    take(begin, end - begin);
    if (length_ < least_length) refill();
    model.count(found);
    return found;
  }

  /// `count` bits without a model, at most 32.
  uint32_t bits(unsigned count) {
    constexpr unsigned most = 19, half = 16;
    if (count <= most) return few_bits(count);
    const uint32_t low = few_bits(half);
    return few_bits(count - half) << half | low;
  }
  uint64_t long_bits() {
    const uint64_t low = bits(32);
    return uint64_t{bits(32)} << 32 | low;
  }

 private:
  static constexpr uint32_t least_length = uint32_t{1} << 24;

  void take(uint32_t begin, uint32_t length) {
    value_ -= begin;
    length_ = length;
  }
  uint32_t few_bits(unsigned count) {
    const uint32_t step = length_ >> count;
    const uint32_t found = value_ / step;
    take(found * step, step);
    if (length_ < least_length) refill();
    failed_ = failed_ || found >> count != 0;
    return found;
  }
  uint32_t next_byte() {
    if (at_ != end_) return static_cast<uint8_t>(*at_++);
    failed_ = true;
    return 0;
  }
  void refill() {
    do {
      value_ = value_ << 8 | next_byte();
      length_ <<= 8;
    } while (length_ < least_length);
  }

  const char* at_ = nullptr;
  const char* end_ = nullptr;
  uint32_t value_ = 0;  // always less than length_
  uint32_t length_ = 0xffffffff;
  bool failed_ = false;
};

/// Whole numbers near predicted ones: how many bits their difference has is a symbol, and so are its highest bits.
class LazIntegers {
 public:
  /// Numbers of `bits` (8, 16 or 32), modulo 2^bits.
  LazIntegers(unsigned bits, unsigned contexts);

  uint32_t decode(LazDecoder& from, uint32_t predicted, unsigned context = 0) {
    bits_of_last_ = from.symbol(sizes_[context]);
    return (predicted + difference(from, bits_of_last_)) & mask_;
  }
  int32_t decode_signed(LazDecoder& from, int32_t predicted, unsigned context = 0) {
    return static_cast<int32_t>(decode(from, static_cast<uint32_t>(predicted), context));
  }
  /// Of the last difference.
  uint32_t bits_of_last() const { return bits_of_last_; }

 private:
  static constexpr unsigned modeled_bits = 8;

  uint32_t difference(LazDecoder& from, uint32_t bits) {
    if (bits == 0) return from.bit(zero_or_one_);
    if (bits == 32) return 0x80000000;
    uint32_t found = from.symbol(differences_[bits - 1]);
    if (bits > modeled_bits) {
      const uint32_t rest = from.bits(bits - modeled_bits);
      found = (found << (bits - modeled_bits)) | rest;
    }
    // Of a difference of so many bits the lower half of the codes is negative.
    const uint32_t half = uint32_t{1} << (bits - 1);
    return found >= half ? found + 1 : found - (2 * half - 1);
  }

  uint32_t mask_;
  uint32_t bits_of_last_ = 0;
  std::vector<LazSymbols> sizes_;  // of each context
  LazBit zero_or_one_;
  std::vector<LazSymbols> differences_;  // of each size from 1
};

/// The median of the last five numbers, in the way of LAZ: of each two that come one pushes out the largest, one the
/// smallest.
class LazMedian {
 public:
  int32_t get() const { return sorted_[2]; }
  void add(int32_t value);

 private:
  std::array<int32_t, 5> sorted_{};
  bool drops_largest_ = true;
};

}  // namespace soapfilm::io
