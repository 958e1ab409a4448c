#include "soapfilm/io/las/laz_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/hash.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/io/sets/error_message.h"

namespace soapfilm::io {

namespace {

constexpr size_t parts_of_large = 16;  // of as many points as may be decoded at once, for the chunks that have more
constexpr size_t chunks_per_thread = 2;

/// The exception of call(), null if there is none; Cancelled goes on.
template <class Call>
std::exception_ptr error_of(Call&& call) {
  try {
    call();
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

LazReader::LazReader(ByteSource& source, LazLayout layout, std::vector<bool> wanted, const Context& context,
                     size_t most_bytes)
    : source_(source),
      layout_(std::move(layout)),
      wanted_(std::move(wanted)),
      context_(context),
      most_points_(std::max<size_t>(most_bytes / layout_.record_bytes, 1)) {}

void LazReader::read(const std::function<void(std::string_view)>& take) {
  agree();
  std::vector<char> records, spare;
  for (std::string_view ready;;) {
    context_.check();
    const Batch batch = next_batch();
    if (batch.points == 0 && ready.empty()) return;
    spare.resize(std::max(spare.size(), batch.points * layout_.record_bytes));
    const auto take_ready = [&] {
      if (!ready.empty()) take(ready);
    };
    Errors errors(1 + batch.own.size());
    parallel_for(context_, errors.size(), 1, [&](size_t k) {
      errors[k] =
          k == 0 ? error_of(take_ready) : error_of([&] { decode(batch, batch.own.begin + k - 1, spare.data()); });
    });
    const size_t first = bring(batch, errors, spare.data());
    records.swap(spare);
    ready = {records.data(), first == 0 ? 0 : points_before(batch, first - 1) * layout_.record_bytes};
    if (first > batch.chunks) continue;
    // What take() throws for a record before a damaged chunk comes first, however many are decoded at once.
    if (first > 0) errors[0] = error_of(take_ready);
    throw_first_of(batch, errors);
  }
}

/// Ranks decode chunks for each other, so they must have the same file. The header, the records after it, and place,
/// size and number of points of each chunk are compared. What is in the chunks is not, as each rank reads its own
/// alone: if that differs in spite of the same sizes, all ranks still get the same records, of each chunk those of one
/// rank.
void LazReader::agree() {
  size_t threads = static_cast<size_t>(context_.threads());
  if (Ranks* const ranks = ranks_of(context_)) {
    Hash hash;
    hash.add(source_.bytes().substr(0, layout_.points_offset));
    hash.add(layout_.chunks);
    for (const bool wanted : wanted_) hash.add(wanted);
    hash.add(most_points_);
    require_same(*ranks, "input files", hash.value());
    const std::vector<size_t> of_ranks = of_all(*ranks, threads);
    threads = std::accumulate(of_ranks.begin(), of_ranks.end(), size_t{0});
  }
  most_chunks_ = chunks_per_thread * threads;
}

LazReader::Batch LazReader::next_batch() {
  const std::vector<LazChunk>& chunks = layout_.chunks;
  Batch batch;
  batch.first_chunk = left_ > 0 ? next_chunk_ - 1 : next_chunk_;
  if (batch.first_chunk < chunks.size()) source_.release_before(static_cast<size_t>(chunks[batch.first_chunk].begin));
  while (left_ == 0 && next_chunk_ < chunks.size() && batch.chunks < most_chunks_ &&
         chunks[next_chunk_].points <= most_points_ - batch.points) {
    batch.points += static_cast<size_t>(chunks[next_chunk_++].points);
    ++batch.chunks;
  }
  if (batch.chunks == 0) {
    if (left_ == 0 && next_chunk_ < chunks.size()) left_ = static_cast<size_t>(chunks[next_chunk_++].points);
    batch.is_part = left_ > 0;
    batch.points = std::min(left_, std::max<size_t>(most_points_ / parts_of_large, 1));
    batch.chunks = batch.is_part ? 1 : 0;
    left_ -= batch.points;
  }
  share(batch);
  return batch;
}

/// A large chunk each rank decodes by itself: parts of it follow from those before, so to wait for another rank that
/// does it would take as long. So it is with a single chunk.
void LazReader::share(Batch& batch) const {
  const Ranks* const ranks = ranks_of(context_);
  batch.own = {0, batch.chunks};
  if (!ranks || ranks->count() == 1 || batch.chunks < 2) return;
  std::vector<size_t> points;
  for (size_t k = 0; k < batch.chunks; ++k)
    points.push_back(static_cast<size_t>(layout_.chunks[batch.first_chunk + k].points));
  const std::vector<size_t> cut = ranks->cut(points);
  for (size_t r = 0; r + 1 < cut.size(); ++r) batch.parts.push_back({cut[r], cut[r + 1]});
  batch.own = batch.parts[static_cast<size_t>(ranks->rank())];
}

/// Of its points, those of chunks before the k-th.
size_t LazReader::points_before(const Batch& batch, size_t k) const {
  if (k == batch.chunks) return batch.points;
  return static_cast<size_t>(layout_.chunks[batch.first_chunk + k].first - layout_.chunks[batch.first_chunk].first);
}

/// The batch's k-th chunk, to its place in the batch's records.
void LazReader::decode(const Batch& batch, size_t k, char* to) {
  const LazChunk& chunk = layout_.chunks[batch.first_chunk + k];
  if (batch.is_part) {
    if (!large_) large_ = open(chunk);
    if (!large_->read(batch.points, to)) fail(chunk);
    if (left_ == 0) large_.reset();
    return;
  }
  to += points_before(batch, k) * layout_.record_bytes;
  if (!open(chunk)->read(static_cast<size_t>(chunk.points), to)) fail(chunk);
}

/// The number of the first error: 0 of take(), 1 of the batch's first chunk; if there is none one above all chunks.
size_t LazReader::number_of_first(const Batch& batch, const Errors& errors) {
  const auto first = std::find_if(errors.begin(), errors.end(), [](const auto& error) { return error != nullptr; });
  if (first == errors.end()) return batch.chunks + 1;
  return first == errors.begin() ? 0 : batch.own.begin + static_cast<size_t>(first - errors.begin());
}

/// Brings each rank the records of others. Returns the number of the first error of all ranks.
size_t LazReader::bring(const Batch& batch, const Errors& errors, char* records) const {
  const size_t own_first = number_of_first(batch, errors);
  Ranks* const ranks = ranks_of(context_);
  if (!ranks) return own_first;
  const std::vector<size_t> of_ranks = of_all(*ranks, own_first);
  std::vector<ItemRange> points;
  for (const ItemRange& part : batch.parts)
    points.push_back({points_before(batch, part.begin), points_before(batch, part.end)});
  if (!points.empty()) bring_all(*ranks, points, {{records, layout_.record_bytes}});
  return *std::min_element(of_ranks.begin(), of_ranks.end());
}

/// On all ranks, also where another one has it.
void LazReader::throw_first_of(const Batch& batch, const Errors& errors) const {
  const auto first = std::find_if(errors.begin(), errors.end(), [](const auto& error) { return error != nullptr; });
  Ranks* const ranks = ranks_of(context_);
  if (!ranks) std::rethrow_exception(*first);
  throw_first(*ranks, first == errors.end() ? ErrorMessage{} : message_of(*first, number_of_first(batch, errors)));
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
