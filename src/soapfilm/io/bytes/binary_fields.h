// Fields of fixed places in rows of bytes, and their way into a cloud: for binary formats that are tables of numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

/// In the order of LAS, which counts them from 1.
enum class NumberType : uint8_t { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };
constexpr size_t number_types = 10;

inline size_t size_of(NumberType type) {
  constexpr std::array<size_t, number_types> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<size_t>(type)];
}
inline bool is_integer(NumberType type) { return type < NumberType::float32; }

/// A number in each row: raw * scale + add.
struct BinaryField {
  std::string name;
  NumberType type = NumberType::float32;
  size_t offset = 0;  ///< of the first row's, in the bytes of the rows
  size_t stride = 0;  ///< from row to row
  bool swap = false;
  uint8_t shift = 0;  ///< raw = (byte >> shift) & mask, of uint8 alone
  uint8_t mask = 0xff;
  double scale = 1;
  double add = 0;
  std::optional<double> no_data{};  ///< this raw number means none: not-a-number
};

/// The numbers of rows [first, first + count), which must be in `bytes`.
void read_field(std::string_view bytes, const BinaryField& field, size_t first, size_t count, double* to);

/// Appends rows to a stream, some at a time.
class FieldReader {
 public:
  static constexpr size_t block_rows = 1024;

  /// `meaning` has indices into the fields; it has positions.
  FieldReader(const ByteSource& source, const std::vector<BinaryField>& fields, PointColumns meaning)
      : path_(source.path()), bytes_(source.bytes()), fields_(fields), meaning_(std::move(meaning)) {}

  /// From now on rows are in `bytes` instead of the file, from which their offsets and numbers count; the first of them
  /// is the file's row `first_row`.
  void read_from(std::string_view bytes, size_t first_row) {
    bytes_ = bytes;
    rows_before_ = first_row;
  }

  /// Columns, and colors, that are zero in all rows are left out: in a block that has only zeros of one it stays empty.
  void leave_out_zeros() { zeros_left_out_ = true; }

  /// What the stream begins with; `sensors`: also positions of the scanner that no field holds.
  PointHeader header(uint64_t rows, bool sensors = false) const;

  /// Rows [first, first + count) of at most block_rows to the end of the stream; of those only the ones in `kept`
  /// (counted from `first`) if that is given.
  void append(size_t first, size_t count, const std::vector<uint32_t>* kept, PointStream& stream);

  /// What its columns are, for the stream's end.
  PointTraits traits() const {
    return {.whole_colors = meaning_.color.present() && is_integer(fields_[meaning_.color[0]].type),
            .leave_out_zeros = zeros_left_out_};
  }

 private:
  using Block = std::array<double, block_rows>;

  size_t read(size_t field, Block& to) const;
  size_t read(const Triple& triple);
  template <class T>
  void append_triple(const Triple& triple, std::vector<Vec3<T>>& column);
  void append_colors(ColorNumbers& colors);
  void append_weights(PointCloud& cloud);
  void append_column(size_t field, Column& column, size_t rows_before);

  const std::string& path_;
  std::string_view bytes_;
  size_t rows_before_ = 0;  // of the file's
  const std::vector<BinaryField>& fields_;
  PointColumns meaning_;
  bool zeros_left_out_ = false;
  std::array<Block, 3> block_{};
  size_t first_ = 0;  // of the rows that append() is at
  size_t count_ = 0;
  const std::vector<uint32_t>* kept_ = nullptr;
};

}  // namespace soapfilm::io
