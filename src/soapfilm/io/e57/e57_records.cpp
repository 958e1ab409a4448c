#include "soapfilm/io/e57/e57_records.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// The raw integer of `bits` in 1 to 64 that begins at `bit`; up to 9 bytes are loaded.
uint64_t bits_at(const char* bytes, uint64_t bit, int bits) {
  const char* at = bytes + bit / 8;
  const int shift = static_cast<int>(bit % 8);
  uint64_t raw = load_little<uint64_t>(at) >> shift;
  if (shift + bits > 64) raw |= static_cast<uint64_t>(static_cast<uint8_t>(at[8])) << (64 - shift);
  return bits == 64 ? raw : raw & ((uint64_t{1} << bits) - 1);
}

template <class Raw>
void decode_whole(const char* at, const E57Field& field, size_t count, double* to) {
  for (size_t i = 0; i < count; ++i) to[i] = field.value(load_little<Raw>(at + i * sizeof(Raw)));
}

template <class Float>
void decode_floats(const char* at, size_t count, double* to) {
  for (size_t i = 0; i < count; ++i) to[i] = static_cast<double>(load_little<Float>(at + i * sizeof(Float)));
}

/// From a byte's first bit.
void decode_e57_field(const char* bytes, uint64_t bit, const E57Field& field, size_t count, double* to) {
  const char* at = bytes + bit / 8;
  const bool integer = field.kind == E57Field::Kind::integer;
  if (field.kind == E57Field::Kind::float32) return decode_floats<float>(at, count, to);
  if (field.kind == E57Field::Kind::float64) return decode_floats<double>(at, count, to);
  if (integer && field.bits == 8) return decode_whole<uint8_t>(at, field, count, to);
  if (integer && field.bits == 16) return decode_whole<uint16_t>(at, field, count, to);
  if (integer && field.bits == 32) return decode_whole<uint32_t>(at, field, count, to);
  for (size_t i = 0; i < count; ++i, bit += static_cast<uint64_t>(field.bits))
    to[i] = field.value(bits_at(bytes, bit, field.bits));
}

}  // namespace

E57Section read_e57_section(E57Pages& pages, const E57Scan& scan) {
  constexpr uint64_t header_size = 32;
  const std::string what = "points of " + in_quotes(scan.name);
  const auto refuse = [&](const std::string& message) { pages.fail(scan.section, what + ": " + message); };
  if (pages.size() - scan.section < header_size) refuse("truncated: the file ends in the section's header");
  if (const auto id = pages.read<uint8_t>(scan.section); id != 1)
    refuse(fmt::format("section id = {}, must be 1 (a compressed vector)", id));
  const auto length = pages.read<uint64_t>(scan.section + 8);
  if (length < header_size || length > pages.size() - scan.section)
    refuse(fmt::format("section length = {}, must be from {} to the {} bytes that are left", length, header_size,
                       pages.size() - scan.section));
  const uint64_t end = scan.section + length;
  const uint64_t room = length - header_size, bits = scan.bits();
  if (bits > 0 && scan.records > 8 * room / bits)
    refuse(fmt::format("recordCount = {}, must be at most {}: {} bytes cannot hold more of {} bits each", scan.records,
                       8 * room / bits, room, bits));
  if (bits == 0) return {scan.section, end, end};  // all is constant: there may be no packets
  const uint64_t data =
      pages.logical(pages.read<uint64_t>(scan.section + 16),
                    fmt::format("byte {}: {}: offset of the data", pages.physical(scan.section + 16), what));
  if (data < scan.section + header_size || data >= end)
    refuse(fmt::format("offset of the data = {}, must be from {} to {}", pages.physical(data),
                       pages.physical(scan.section + header_size), pages.physical(end - 1)));
  return {scan.section, data, end};
}

E57Records::E57Records(E57Pages& pages, const E57Scan& scan, const E57Section& section, const std::vector<bool>& used)
    : pages_(pages),
      scan_(scan),
      section_(section),
      packet_(section.data),
      stream_of_(scan.fields.size(), none),
      slot_(scan.fields.size(), 0) {
  size_t slots = 0;
  for (size_t k = 0; k < scan.fields.size(); ++k) {
    const E57Field& field = scan.fields[k];
    if (!used[k] || field.kind == E57Field::Kind::text) continue;
    slot_[k] = slots++;
    values_.resize(slots * block, field.bits == 0 ? field.value(0) : 0.0);
    if (field.bits == 0) continue;
    stream_of_[k] = streams_.size();
    streams_.push_back({k, std::vector<char>(slack), 0, 0});
  }
}

uint64_t E57Records::available() const {
  uint64_t least = scan_.records - done_;
  for (const Stream& stream : streams_)
    least = std::min(least, stream.left() / static_cast<uint64_t>(scan_.fields[stream.field].bits));
  return least;
}

size_t E57Records::next() {
  if (done_ == scan_.records) return 0;
  uint64_t count = available();
  for (; count == 0; count = available())
    if (!read_packet())
      fail(fmt::format("truncated: {} records, must be {} as recordCount says", done_, scan_.records));
  count = std::min<uint64_t>(count, block);
  for (Stream& stream : streams_) decode(stream, count);
  done_ += count;
  return static_cast<size_t>(count);
}

void E57Records::decode(Stream& stream, size_t count) {
  const E57Field& field = scan_.fields[stream.field];
  decode_e57_field(stream.bytes.data(), stream.bit, field, count, values_.data() + slot_[stream.field] * block);
  stream.bit += static_cast<uint64_t>(field.bits) * count;
}

/// False at the end of the section.
bool E57Records::read_packet() {
  constexpr uint8_t index_packet = 0, data_packet = 1, empty_packet = 2;
  if (section_.end - packet_ < 4) return false;
  pages_.release_before(packet_);
  const auto type = pages_.read<uint8_t>(packet_);
  const uint64_t length = uint64_t{pages_.read<uint16_t>(packet_ + 2)} + 1;
  if (length % 4 != 0 || length > section_.end - packet_)
    pages_.fail(packet_ + 2, fmt::format("packet of {} bytes, must be a multiple of 4 up to the {} bytes that are left",
                                         length, section_.end - packet_));
  if (type == data_packet)
    read_data_packet(packet_, packet_ + length);
  else if (type != index_packet && type != empty_packet)
    pages_.fail(packet_, fmt::format("packet of type {}, must be 0 (index), 1 (data) or 2 (empty)", type));
  packet_ += length;
  return true;
}

void E57Records::read_data_packet(uint64_t at, uint64_t end) {
  constexpr uint64_t header_size = 6;
  const uint64_t fields = scan_.fields.size();
  const uint64_t count = end - at < header_size ? 0 : pages_.read<uint16_t>(at + 4);
  if (count != fields || end - at < header_size + 2 * fields)
    pages_.fail(at + 4, fmt::format("packet of {} streams in {} bytes, must be {}, one for each field of the prototype",
                                    count, end - at, fields));
  lengths_.resize(2 * fields);
  pages_.read(at + header_size, lengths_.data(), lengths_.size());
  uint64_t stream_at = at + header_size + 2 * fields;
  for (size_t k = 0; k < fields; ++k) {
    const auto length = load_little<uint16_t>(lengths_.data() + 2 * k);
    if (length > end - stream_at)
      pages_.fail(
          at + header_size + 2 * k,
          fmt::format("stream of {} bytes, must be at most {}, the rest of its packet", length, end - stream_at));
    if (stream_of_[k] != none) append(streams_[stream_of_[k]], stream_at, length);
    stream_at += length;
  }
}

void E57Records::append(Stream& stream, uint64_t at, size_t count) {
  const size_t taken = static_cast<size_t>(stream.bit / 8);
  const size_t left = stream.end - taken;
  if (taken > 0 && taken >= left) {  // then moving costs no more than what has been read
    std::memmove(stream.bytes.data(), stream.bytes.data() + taken, left);
    stream.end = left;
    stream.bit %= 8;
  }
  const size_t needed = stream.end + count + slack;
  if (stream.bytes.size() < needed) stream.bytes.resize(std::max(needed, 2 * stream.end));
  pages_.read(at, stream.bytes.data() + stream.end, count);
  stream.end += count;
}

void E57Records::fail(const std::string& message) const {
  pages_.fail(std::min(packet_, section_.end - 1), fmt::format("points of {}: {}", in_quotes(scan_.name), message));
}

bool E57Records::more_left() const {
  constexpr uint64_t padding = 64;  // writers may fill up their last word
  return std::any_of(streams_.begin(), streams_.end(), [&](const Stream& stream) {
    return stream.left() >= padding + static_cast<uint64_t>(scan_.fields[stream.field].bits);
  });
}

}  // namespace soapfilm::io
