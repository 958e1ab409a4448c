// A cloud on its way from rank to rank: its arrays as they lie, and all else packed into bytes.
#pragma once

#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// Values go into bytes, one after the other, as they are in memory: the same program takes them out.
struct Packer {
  std::vector<std::byte> bytes;

  void pass(void* data, size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  }
};

/// Takes them out in the same order.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : left_(bytes) {}

  void pass(void* data, size_t size) {
    if (size > left_.size()) throw std::logic_error("a message that is too short");
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_ = left_.subspan(size);
  }

 private:
  std::span<const std::byte> left_;
};

/// pack() puts a value into a packer or takes it out of an unpacker: the order is written once.
template <class Way, class T>
requires std::is_trivially_copyable_v<T>
void pack(Way& way, T& value) { way.pass(&value, sizeof value); }

/// The number of items alone.
template <class Way, class Items>
void pack_size(Way& way, Items& items) {
  size_t size = items.size();
  pack(way, size);
  items.resize(size);  // which it has, on its way into bytes
}

template <class Way>
void pack(Way& way, std::string& text) {
  pack_size(way, text);
  way.pass(text.data(), text.size());
}

template <class Way>
void pack(Way& way, std::vector<std::string>& texts) {
  pack_size(way, texts);
  for (std::string& text : texts) pack(way, text);
}

/// Without the values of its arrays.
void pack(Packer& way, PointCloud& cloud);
void pack(Unpacker& way, PointCloud& cloud);
void pack(Packer& way, ReadReport& report);
void pack(Unpacker& way, ReadReport& report);

/// Those that are not empty, in a fixed order.
std::vector<std::span<std::byte>> arrays_of(PointCloud& cloud);

}  // namespace soapfilm::io
