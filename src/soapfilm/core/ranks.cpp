#include "soapfilm/core/ranks.h"

#include <fmt/format.h>

#include <chrono>
#include <numeric>

#include "soapfilm/core/cpu_time.h"
#include "soapfilm/error.h"

namespace soapfilm {

void Ranks::exchange(const std::vector<Message>& out, const std::vector<Message>& in) {
  if (out.empty() && in.empty()) return;
  const auto begin = std::chrono::steady_clock::now();
  const auto cpu_begin = thread_cpu_time();
  pass(out, in);
  for (const Message& message : out) traffic_.bytes += message.bytes;
  traffic_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  traffic_.cpu_seconds += 1e-9 * static_cast<double>(thread_cpu_time() - cpu_begin);
}

std::vector<size_t> Ranks::cut(const std::vector<size_t>& bricks_of_layer) const {
  const double all = std::accumulate(bricks_of_layer.begin(), bricks_of_layer.end(), 0.0);
  std::vector<size_t> cut{0};
  size_t layer = 0;
  double below = 0;
  for (int r = 1; r < count_; ++r) {
    // The border that leaves the bricks below nearest to their share.
    while (layer < bricks_of_layer.size() &&
           below + 0.5 * static_cast<double>(bricks_of_layer[layer]) < all * r / count_)
      below += static_cast<double>(bricks_of_layer[layer++]);
    cut.push_back(layer);
  }
  cut.push_back(bricks_of_layer.size());
  return cut;
}

void bring(Ranks& ranks, const std::vector<ItemRange>& owned, const std::vector<ItemRange>& wanted,
           std::initializer_list<SharedArray> arrays) {
  const auto own = static_cast<size_t>(ranks.rank());
  std::vector<Ranks::Message> out, in;
  const auto add = [](std::vector<Ranks::Message>& to, size_t rank, ItemRange part, const SharedArray& array) {
    if (part.size() == 0) return;
    to.push_back({static_cast<int>(rank), static_cast<std::byte*>(array.data) + part.begin * array.item_bytes,
                  part.size() * array.item_bytes});
  };
  for (const SharedArray& array : arrays)
    for (size_t r = 0; r < owned.size(); ++r) {
      if (r == own) continue;
      add(out, r, owned[own].common(wanted[r]), array);
      add(in, r, owned[r].common(wanted[own]), array);
    }
  ranks.exchange(out, in);
}

void bring_all(Ranks& ranks, const std::vector<ItemRange>& owned, std::initializer_list<SharedArray> arrays) {
  ItemRange all;
  for (const ItemRange& part : owned) all.end = std::max(all.end, part.end);
  bring(ranks, owned, std::vector<ItemRange>(owned.size(), all), arrays);
}

void require_same(Ranks& ranks, const char* what, uint64_t own) {
  const std::vector<uint64_t> all = of_all(ranks, own);
  const auto other = std::find_if(all.begin(), all.end(), [&](uint64_t hash) { return hash != all[0]; });
  if (other != all.end())
    throw ParameterError(fmt::format("rank {} has other {} than rank 0: each needs the same command and the same files",
                                     other - all.begin(), what));
}

}  // namespace soapfilm
