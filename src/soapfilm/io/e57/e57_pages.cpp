#include "soapfilm/io/e57/e57_pages.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/crc32c.h"

namespace soapfilm::io {

E57Pages::E57Pages(ByteSource& source) : source_(source) {
  constexpr size_t header_size = 48;
  if (!source.begins_with("ASTM-E57")) throw InputError(path() + ": byte 0: is not an E57: must begin with ASTM-E57");
  if (file_size() < page)
    throw InputError(fmt::format("{}: truncated: {} bytes, must be at least a page of {}", path(), file_size(), page));
  pages_ = 1;
  char header[header_size];
  read(0, header, header_size);
  const auto version = load_little<uint32_t>(header + 8);
  const auto length = load_little<uint64_t>(header + 16);
  const auto page_size = load_little<uint64_t>(header + 40);
  if (version != 1) throw InputError(fmt::format("{}: byte 8: version = {}, must be 1", path(), version));
  if (page_size != page)
    throw InputError(fmt::format("{}: byte 40: page size = {}, must be {}", path(), page_size, page));
  if (length > file_size() || length < page || length % page != 0)
    throw InputError(
        fmt::format("{}: byte 16: file length = {}, must be a multiple of {} up to the {} bytes that are "
                    "there{}",
                    path(), length, page, file_size(), length > file_size() ? " (truncated)" : ""));
  pages_ = length / page;
  xml_offset_ = logical(load_little<uint64_t>(header + 24), "byte 24: offset of the XML");
  xml_length_ = load_little<uint64_t>(header + 32);
  if (xml_length_ == 0 || xml_length_ > size() - xml_offset_)
    throw InputError(fmt::format("{}: byte 32: length of the XML = {}, must be from 1 to {}", path(), xml_length_,
                                 size() - xml_offset_));
}

uint64_t E57Pages::logical(uint64_t physical, std::string_view what) const {
  if (physical >= pages_ * page || physical % page >= payload)
    throw InputError(
        fmt::format("{}: {} = {}, must be below {} and not in a checksum", path(), what, physical, pages_ * page));
  return physical / page * payload + physical % page;
}

void E57Pages::read(uint64_t offset, char* to, size_t count) {
  while (count > 0) {
    const uint64_t index = offset / payload;
    const uint64_t within = offset % payload;
    if (index != checked_) check(index);
    const size_t here = std::min<size_t>(count, payload - within);
    std::memcpy(to, source_.bytes().data() + index * page + within, here);
    to += here;
    offset += here;
    count -= here;
  }
}

void E57Pages::check(uint64_t index) {
  const char* at = source_.bytes().data() + index * page;
  const auto stored = load<uint32_t>(at + payload, std::endian::native != std::endian::big);
  const uint32_t computed = crc32c(at, payload);
  if (stored != computed)
    throw InputError(fmt::format("{}: byte {}: checksum of page {} = {:08x}, must be {:08x}: the file is damaged",
                                 path(), index * page + payload, index, stored, computed));
  checked_ = index;
}

void E57Pages::release_before(uint64_t offset) {
  const uint64_t at = physical(offset);
  if (at <= released_) return;
  released_ = at;
  source_.release_before(at);
}

void E57Pages::fail(uint64_t logical_offset, const std::string& message) const {
  throw InputError(fmt::format("{}: byte {}: {}", path(), physical(logical_offset), message));
}

}  // namespace soapfilm::io
