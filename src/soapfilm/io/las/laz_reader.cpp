#include "soapfilm/io/las/laz_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

constexpr size_t parts = 16;  // of as many points as may be decoded at once, for the chunks that have more
constexpr size_t chunks_per_thread = 2;

}  // namespace

LazReader::LazReader(ByteSource& source, LazLayout layout, std::vector<bool> wanted, const Context& context,
                     size_t most_bytes)
    : source_(source),
      layout_(std::move(layout)),
      wanted_(std::move(wanted)),
      context_(context),
      most_points_(std::max<size_t>(most_bytes / layout_.record_bytes, 1)) {}

void LazReader::read(const std::function<void(std::string_view)>& take) {
  std::vector<char> records, spare;
  for (std::string_view ready;;) {
    context_.check();
    const Batch batch = next_batch();
    if (batch.points == 0 && ready.empty()) return;
    spare.resize(std::max(spare.size(), batch.points * layout_.record_bytes));
    const size_t taken = ready.empty() ? 0 : 1;
    parallel_for(context_, taken + batch.chunks, 1, [&](size_t k) {
      if (k < taken)
        take(ready);
      else
        decode(batch, k - taken, spare.data());
    });
    records.swap(spare);
    ready = {records.data(), batch.points * layout_.record_bytes};
  }
}

LazReader::Batch LazReader::next_batch() {
  const std::vector<LazChunk>& chunks = layout_.chunks;
  const size_t part = std::max<size_t>(most_points_ / parts, 1);
  Batch batch;
  batch.first_chunk = left_ > 0 ? next_chunk_ - 1 : next_chunk_;
  if (batch.first_chunk < chunks.size()) source_.release_before(static_cast<size_t>(chunks[batch.first_chunk].begin));
  const size_t most_chunks = chunks_per_thread * static_cast<size_t>(context_.threads());
  while (left_ == 0 && next_chunk_ < chunks.size() && batch.chunks < most_chunks &&
         chunks[next_chunk_].points <= most_points_ - batch.points) {
    batch.points += static_cast<size_t>(chunks[next_chunk_++].points);
    ++batch.chunks;
  }
  if (batch.chunks > 0) return batch;
  if (left_ == 0 && next_chunk_ < chunks.size()) {
    large_ = open(chunks[next_chunk_]);
    left_ = static_cast<size_t>(chunks[next_chunk_++].points);
  }
  batch.points = std::min(left_, part);
  batch.chunks = batch.points > 0 ? 1 : 0;
  left_ -= batch.points;
  return batch;
}

/// The batch's k-th chunk.
void LazReader::decode(const Batch& batch, size_t k, char* to) {
  const LazChunk& chunk = layout_.chunks[batch.first_chunk + k];
  if (large_) {
    if (!large_->read(batch.points, to)) fail(chunk);
    if (left_ == 0) large_.reset();
    return;
  }
  to += static_cast<size_t>(chunk.first - layout_.chunks[batch.first_chunk].first) * layout_.record_bytes;
  if (!open(chunk)->read(static_cast<size_t>(chunk.points), to)) fail(chunk);
}

std::unique_ptr<LazPoints> LazReader::open(const LazChunk& chunk) const {
  const std::string_view bytes =
      source_.bytes().substr(static_cast<size_t>(chunk.begin), static_cast<size_t>(chunk.bytes));
  std::unique_ptr<LazPoints> points = laz_points(layout_, chunk.points, bytes, wanted_);
  if (!points) fail(chunk);
  return points;
}

void LazReader::fail(const LazChunk& chunk) const {
  throw InputError(
      fmt::format("{}: byte {}: LAZ: a chunk of {} bytes does not hold its {} points (from {} on): the file "
                  "is damaged",
                  source_.path(), chunk.begin, chunk.bytes, chunk.points, chunk.first));
}

}  // namespace soapfilm::io
