// The arithmetic encoder of LAZ, for files that tests make: plain code, written from the format's side of the writer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace soapfilm::laz {

struct BitCounts {
  uint32_t zeros = 1, all = 2, probability = 4096, cycle = 4, left = 4;

  void count(bool bit) {
    zeros += !bit;
    if (--left > 0) return;
    all += cycle;
    if (all > 8192) {
      all = (all + 1) / 2;
      zeros = (zeros + 1) / 2;
      if (zeros == all) ++all;
    }
    probability = zeros * (0x80000000u / all) >> 18;
    cycle = std::min(cycle * 5 / 4, 64u);
    left = cycle;
  }
};

struct SymbolCounts {
  explicit SymbolCounts(size_t symbols) : counts(symbols, 1), begins(symbols) {
    refresh(static_cast<uint32_t>(symbols));
    cycle = left = (static_cast<uint32_t>(symbols) + 6) / 2;
  }

  void count(uint32_t symbol) {
    ++counts[symbol];
    if (--left > 0) return;
    refresh(cycle);
    cycle = std::min(cycle * 5 / 4, (static_cast<uint32_t>(counts.size()) + 6) * 8);
    left = cycle;
  }
  void refresh(uint32_t more) {
    total += more;
    if (total > 32768) {
      total = 0;
      for (uint32_t& c : counts) total += c = (c + 1) / 2;
    }
    uint32_t sum = 0;
    for (size_t k = 0; k < counts.size(); ++k) {
      begins[k] = (0x80000000u / total * sum) >> 16;
      sum += counts[k];
    }
  }

  std::vector<uint32_t> counts, begins;
  uint32_t total = 0, cycle = 0, left = 0;
};

class Encoder {
 public:
  void bit(BitCounts& model, bool value) {
    const uint32_t zero = model.probability * (length_ >> 13);
    if (value)
      advance(zero, length_ - zero);
    else
      advance(0, zero);
    model.count(value);
  }

  void symbol(SymbolCounts& model, uint32_t value) {
    const uint32_t step = length_ >> 15;
    const uint32_t begin = model.begins[value] * step;
    const bool is_last = value + 1 == model.counts.size();
    advance(begin, (is_last ? length_ : model.begins[value + 1] * step) - begin);
    model.count(value);
  }

  void bits(unsigned count, uint32_t value) {
    if (count > 19) {
      bits(16, value & 0xffff);
      value >>= 16;
      count -= 16;
    }
    const uint32_t step = length_ >> count;
    advance(value * step, step);
  }

  /// The stream; nothing may follow.
  std::string done() {
    const bool one_byte = length_ > 2u << 24;
    advance(one_byte ? 1u << 24 : 1u << 23, one_byte ? 1u << 23 : 1u << 15);
    bytes_.append(one_byte ? 3 : 2, '\0');  // the decoder is ahead
    return std::move(bytes_);
  }

 private:
  void advance(uint32_t by, uint32_t length) {
    const uint32_t before = base_;
    base_ += by;
    length_ = length;
    if (base_ < before)
      for (size_t k = bytes_.size(); k-- > 0 && ++bytes_[k] == 0;) {
      }
    for (; length_ < 1u << 24; length_ <<= 8, base_ <<= 8) bytes_ += static_cast<char>(base_ >> 24);
  }

  std::string bytes_;
  uint32_t base_ = 0, length_ = 0xffffffff;
};

/// Integers of `bits` by how they differ from predicted ones.
class IntegerEncoder {
 public:
  explicit IntegerEncoder(unsigned bits, size_t contexts = 1) : bits_(bits), sizes_(contexts, SymbolCounts(bits + 1)) {
    for (unsigned k = 1; k <= std::min(bits, 31u); ++k) codes_.emplace_back(size_t{1} << std::min(k, 8u));
  }

  void encode(Encoder& to, int64_t predicted, int64_t value, size_t context = 0) {
    const int64_t range = int64_t{1} << bits_;
    int64_t difference = (value - predicted) % range;
    if (difference >= range / 2) difference -= range;
    if (difference < -range / 2) difference += range;
    last_size = 0;
    for (int64_t rest = difference <= 0 ? -difference : difference - 1; rest > 0; rest >>= 1) ++last_size;
    to.symbol(sizes_[context], last_size);
    if (last_size == 0) return to.bit(zero_or_one_, difference == 1);
    if (last_size == 32) return;
    const int64_t code = difference < 0 ? difference + (int64_t{1} << last_size) - 1 : difference - 1;
    const unsigned low = last_size > 8 ? last_size - 8 : 0;
    to.symbol(codes_[last_size - 1], static_cast<uint32_t>(code >> low));
    if (low > 0) to.bits(low, static_cast<uint32_t>(code & ((int64_t{1} << low) - 1)));
  }

  unsigned last_size = 0;  // in bits

 private:
  unsigned bits_;
  std::vector<SymbolCounts> sizes_, codes_;
  BitCounts zero_or_one_;
};

}  // namespace soapfilm::laz
