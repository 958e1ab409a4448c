// The records of a scan in an E57 file: streams of bits, one for each field, in packets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "soapfilm/io/e57/e57_head.h"
#include "soapfilm/io/e57/e57_pages.h"

namespace soapfilm::io {

/// Where the packets of a scan are; logical offsets.
struct E57Section {
  uint64_t begin = 0;  ///< the section's header
  uint64_t data = 0;   ///< the first packet
  uint64_t end = 0;
};

/// Reads the section's header. Throws InputError for a section that cannot hold the records.
E57Section read_e57_section(E57Pages& pages, const E57Scan& scan);

/// Decodes records in order, a block at a time. Only fields that are `used` are decoded.
class E57Records {
 public:
  static constexpr size_t block = 1024;

  E57Records(E57Pages& pages, const E57Scan& scan, const E57Section& section, const std::vector<bool>& used);

  /// The number of records of the next block; 0 when all have been read. Throws InputError.
  size_t next();
  /// The field's values in the block.
  const double* values(size_t field) const { return values_.data() + slot_[field] * block; }

  /// After the last record: has the last packet brought more of them?
  bool more_left() const;

  /// Throws InputError that names the scan and its last packet.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  /// What packets have brought of a field and no block has taken.
  struct Stream {
    size_t field = 0;
    std::vector<char> bytes;  ///< always `slack` more than are used: values are loaded 8 bytes at a time
    size_t end = 0;           ///< of the bytes used
    uint64_t bit = 0;         ///< first one not taken

    uint64_t left() const { return 8 * static_cast<uint64_t>(end) - bit; }
  };
  static constexpr size_t slack = 16;

  uint64_t available() const;
  bool read_packet();
  void read_data_packet(uint64_t at, uint64_t end);
  void append(Stream& stream, uint64_t at, size_t count);
  void decode(Stream& stream, size_t count);

  E57Pages& pages_;
  const E57Scan& scan_;
  E57Section section_;
  uint64_t packet_;  ///< the next one
  uint64_t done_ = 0;
  std::vector<Stream> streams_;    ///< of the used fields that are not constant
  std::vector<size_t> stream_of_;  ///< of each field; `none` for the others
  std::vector<size_t> slot_;       ///< of each field, in values_
  std::vector<double> values_;
  std::vector<char> lengths_;  ///< of the streams in a packet
  static constexpr size_t none = static_cast<size_t>(-1);
};

}  // namespace soapfilm::io
