// The point records of a LAZ file in order, their chunks decoded on the threads of the context, and by ranks
// (core/ranks.h) together: each decodes some of them and sends their records to the others.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/las/laz_layout.h"
#include "soapfilm/io/las/laz_points.h"

namespace soapfilm::io {

class LazReader {
 public:
  /// `wanted`: of each byte of a record, is it needed? The others may be anything. `most_bytes`: of records that are
  /// decoded at once.
  LazReader(ByteSource& source, LazLayout layout, std::vector<bool> wanted, const Context& context,
            size_t most_bytes = size_t{32} << 20);

  /// take(records) for all records, in order, on each rank: of some chunks or of a part of a large one. It is called by
  /// one thread at a time, while others decode what comes next. Throws InputError for a chunk that does not hold its
  /// points, once take() has had all records before it, and ParameterError where ranks have other files. Of errors,
  /// also those of take(), all ranks throw the first.
  void read(const std::function<void(std::string_view)>& take);

 private:
  /// What is decoded at once, by all ranks together: whole chunks, or a part of a large one.
  struct Batch {
    size_t first_chunk = 0;
    size_t chunks = 0;
    size_t points = 0;
    bool is_part = false;
    ItemRange own{};                 ///< of its chunks, what this rank decodes
    std::vector<ItemRange> parts{};  ///< what each rank does; none: each decodes all of it
  };
  using Errors = std::vector<std::exception_ptr>;  ///< of take(), then of each own chunk

  void agree();
  Batch next_batch();
  void share(Batch& batch) const;
  size_t points_before(const Batch& batch, size_t k) const;
  void decode(const Batch& batch, size_t k, char* to);
  static size_t number_of_first(const Batch& batch, const Errors& errors);
  size_t bring(const Batch& batch, const Errors& errors, char* records) const;
  void throw_first_of(const Batch& batch, const Errors& errors) const;
  std::unique_ptr<LazPoints> open(const LazChunk& chunk) const;
  [[noreturn]] void fail(const LazChunk& chunk) const;

  ByteSource& source_;
  LazLayout layout_;
  std::vector<bool> wanted_;
  const Context& context_;
  size_t most_points_;      // at once
  size_t most_chunks_ = 0;  // at once
  size_t next_chunk_ = 0;
  size_t left_ = 0;                   // points of the large chunk before next_chunk_ that are to be read
  std::unique_ptr<LazPoints> large_;  // that chunk, once its first part was read
};

}  // namespace soapfilm::io
