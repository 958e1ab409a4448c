// The body of a PLY file, row by row, whatever its format and types.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/ply/ply_header.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

/// Reads the elements in the header's order: begin() an element, then next() for each of its rows. All values are
/// returned as double, which holds every PLY type exactly.
class PlyRows {
 public:
  /// Text is read on all threads of `context`, if given, as long as each row is a line that contains only numbers.
  PlyRows(ByteSource& source, const PlyHeader& header, const Context* context = nullptr);

  /// Moves to `element`, the next of the header. Throws InputError when the file is too short for its count, so that
  /// the caller may allocate for it.
  void begin(const PlyElement& element);

  /// Reads a row. Throws InputError when the file ends or a value is no number.
  void next();

  /// Whether rows consist only of float32 in this machine's byte order: take_floats() may be called instead of next().
  bool plain_floats() const { return plain_floats_; }
  /// The next `count` rows, value after value, not aligned.
  const char* take_floats(size_t count);

  double scalar(size_t property) const { return values_[property]; }
  std::span<const double> list(size_t property) const {
    return {items_.data() + lists_[property].begin, lists_[property].size};
  }

  /// Skips all rows of `element`, the next of the header.
  void skip(const PlyElement& element);

  /// Throws InputError when text follows the last element: then some row had too many values. Bytes after the last
  /// element of a binary file are warned of.
  void finish(const PlyElement& vertex, ReadReport& report);

  /// Throws InputError "place: element row: message" for the row that next() read.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  struct List {
    size_t begin = 0;
    size_t size = 0;
  };

  /// Rows of text that were read before next() asks for them.
  struct RowsAhead {
    std::vector<double> values;  ///< row after row
    size_t rows = 0;
    size_t taken = 0;
    size_t first_line = 0;  ///< one line for each row
  };

  void read_ahead();
  double read_value(const PlyProperty& property, PlyType type);
  void read_list(size_t index);

  ByteSource& source_;
  const PlyHeader& header_;
  const Context* context_;
  std::optional<TextCursor> text_;
  std::optional<ByteCursor> binary_;
  const PlyElement* element_ = nullptr;
  size_t row_bytes_ = 0;  // at least, and exact in a binary file without lists
  bool has_lists_ = false;
  bool plain_floats_ = false;  // only float32 in this machine's byte order
  bool reads_ahead_ = false;   // until a row is not a line of numbers
  RowsAhead ahead_;
  uint64_t rows_read_ = 0;
  uint64_t row_ = 0;            // index of the row that next() read or is reading
  std::vector<double> values_;  // one per property of the element
  std::vector<List> lists_;     // one per property: its part of items_
  std::vector<double> items_;
};

}  // namespace soapfilm::io
