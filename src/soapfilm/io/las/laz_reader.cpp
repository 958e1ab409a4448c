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

std::string_view LazReader::next() {
  context_.check();
  if (left_ > 0) return read_part();
  const std::vector<LazChunk>& chunks = layout_.chunks;
  if (next_chunk_ == chunks.size()) return {};
  source_.release_before(chunks[next_chunk_].begin);
  const size_t first = next_chunk_;
  const size_t most_chunks = chunks_per_thread * static_cast<size_t>(context_.threads());
  uint64_t points = 0;
  while (next_chunk_ < chunks.size() && next_chunk_ - first < most_chunks &&
         chunks[next_chunk_].points <= most_points_ - points)
    points += chunks[next_chunk_++].points;
  if (points == 0) {
    large_ = open(chunks[next_chunk_]);
    left_ = static_cast<size_t>(chunks[next_chunk_++].points);
    return read_part();
  }
  records_.resize(std::max(records_.size(), static_cast<size_t>(points) * layout_.record_bytes));
  parallel_for(context_, next_chunk_ - first, 1, [&](size_t k) {
    const LazChunk& chunk = chunks[first + k];
    char* const to = records_.data() + static_cast<size_t>(chunk.first - chunks[first].first) * layout_.record_bytes;
    read(*open(chunk), chunk, static_cast<size_t>(chunk.points), to);
  });
  return {records_.data(), static_cast<size_t>(points) * layout_.record_bytes};
}

std::string_view LazReader::read_part() {
  const size_t count = std::min(left_, std::max<size_t>(most_points_ / parts, 1));
  records_.resize(std::max(records_.size(), count * layout_.record_bytes));
  read(*large_, layout_.chunks[next_chunk_ - 1], count, records_.data());
  left_ -= count;
  if (left_ == 0) large_.reset();
  return {records_.data(), count * layout_.record_bytes};
}

std::unique_ptr<LazPoints> LazReader::open(const LazChunk& chunk) const {
  const std::string_view bytes =
      source_.bytes().substr(static_cast<size_t>(chunk.begin), static_cast<size_t>(chunk.bytes));
  std::unique_ptr<LazPoints> points = laz_points(layout_, chunk.points, bytes, wanted_);
  if (!points) fail(chunk);
  return points;
}

void LazReader::read(LazPoints& points, const LazChunk& chunk, size_t count, char* to) const {
  if (!points.read(count, to)) fail(chunk);
}

void LazReader::fail(const LazChunk& chunk) const {
  throw InputError(
      fmt::format("{}: byte {}: LAZ: a chunk of {} bytes does not hold its {} points (from {} on): the file "
                  "is damaged",
                  source_.path(), chunk.begin, chunk.bytes, chunk.points, chunk.first));
}

}  // namespace soapfilm::io
