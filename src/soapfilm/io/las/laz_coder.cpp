#include "soapfilm/io/las/laz_coder.h"

#include <algorithm>

namespace soapfilm::io {

namespace {

constexpr uint32_t longest_bit_cycle = 64;
constexpr uint32_t most_bits = uint32_t{1} << LazBit::precision;
constexpr uint32_t most_symbols = uint32_t{1} << LazSymbols::precision;
constexpr uint32_t least_table_bits = 6;

}  // namespace

void LazBit::update() {
  bits_ += cycle_;
  if (bits_ > most_bits) {
    bits_ = (bits_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == bits_) ++bits_;
  }
  const uint32_t scale = 0x80000000u / bits_;
  probability_ = (zeros_ * scale) >> (31 - precision);
  cycle_ = std::min(5 * cycle_ / 4, longest_bit_cycle);
  until_update_ = cycle_;
}

void LazSymbols::begin() {
  uint32_t bits = least_table_bits;
  while (2 * symbols_ > uint32_t{1} << bits) ++bits;
  table_size_ = uint32_t{1} << bits;
  table_shift_ = precision - bits;
  numbers_ = std::make_unique<uint16_t[]>(2 * symbols_ + table_size_ + 1);
  std::fill_n(&numbers_[symbols_], symbols_, uint16_t{1});
  cycle_ = symbols_;
  update();
  cycle_ = until_update_ = (symbols_ + 6) / 2;
}

void LazSymbols::update() {
  uint16_t* const counts = &numbers_[symbols_];
  total_ += cycle_;
  if (total_ > most_symbols) {
    total_ = 0;
    for (uint32_t k = 0; k < symbols_; ++k) {
      counts[k] = static_cast<uint16_t>((counts[k] + 1) / 2);
      total_ += counts[k];
    }
  }
  const uint32_t scale = 0x80000000u / total_;
  uint16_t* const table = counts + symbols_;
  uint32_t sum = 0, cell = 0;
  for (uint32_t k = 0; k < symbols_; ++k) {
    numbers_[k] = static_cast<uint16_t>((scale * sum) >> (31 - precision));
    sum += counts[k];
    const uint32_t own = numbers_[k] >> table_shift_;
    while (cell < own) table[++cell] = static_cast<uint16_t>(k - 1);
  }
  while (cell < table_size_) table[++cell] = static_cast<uint16_t>(symbols_ - 1);
  cycle_ = std::min(5 * cycle_ / 4, (symbols_ + 6) * 8);
  until_update_ = cycle_;
}

LazDecoder::LazDecoder(std::string_view bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {
  for (int k = 0; k < 4; ++k) value_ = value_ << 8 | next_byte();
  if (value_ == length_) {  // no writer makes this number, and all that follows relies on that
    failed_ = true;
    --value_;
  }
}

LazIntegers::LazIntegers(unsigned bits, unsigned contexts) : mask_(bits < 32 ? (uint32_t{1} << bits) - 1 : 0xffffffff) {
  for (unsigned k = 0; k < contexts; ++k) sizes_.emplace_back(bits + 1);
  for (unsigned k = 1; k <= std::min(bits, 31u); ++k)
    differences_.emplace_back(uint32_t{1} << std::min(k, modeled_bits));
}

void LazMedian::add(int32_t value) {
  auto& v = sorted_;
  if (drops_largest_) {
    drops_largest_ = value < v[2];
    v[4] = value;
    for (size_t k = 4; k > 0 && v[k] < v[k - 1]; --k) std::swap(v[k], v[k - 1]);
  } else {
    drops_largest_ = value <= v[2];
    v[0] = value;
    for (size_t k = 0; k < 4 && v[k] > v[k + 1]; ++k) std::swap(v[k], v[k + 1]);
  }
}

}  // namespace soapfilm::io
