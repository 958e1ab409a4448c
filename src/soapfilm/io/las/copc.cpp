#include "soapfilm/io/las/copc.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace soapfilm::io {

namespace {

constexpr size_t info_bytes = 160, entry_bytes = 32;
constexpr int32_t another_page = -1, deepest = 62;

/// The level of each chunk, by where it begins in the file.
using Levels = std::unordered_map<uint64_t, int>;

/// A part of the list of nodes.
struct Page {
  uint64_t begin, bytes;
};

/// Follows the pages from the first one; nothing if they are not in the file, lead back to each other, or name a chunk
/// twice.
std::optional<Levels> read_levels(std::string_view file, Page root) {
  Levels levels;
  std::vector<Page> pages{root};
  uint64_t read = 0;
  while (!pages.empty()) {
    const Page page = pages.back();
    pages.pop_back();
    read += std::max<uint64_t>(page.bytes, 1);
    if (page.begin > file.size() || page.bytes > file.size() - page.begin || read > file.size()) return {};
    for (uint64_t at = page.begin; at + entry_bytes <= page.begin + page.bytes; at += entry_bytes) {
      const char* const entry = file.data() + at;
      const auto level = load_little<int32_t>(entry), bytes = load_little<int32_t>(entry + 24),
                 points = load_little<int32_t>(entry + 28);
      const auto begin = load_little<uint64_t>(entry + 16);
      if (level < 0 || level > deepest || bytes < 0 || points < another_page) return {};
      if (points == another_page)
        pages.push_back({begin, static_cast<uint64_t>(bytes)});
      else if (points > 0 && !levels.emplace(begin, level).second)
        return {};
    }
  }
  return levels;
}

}  // namespace

std::optional<CopcLevels> keep_copc_levels(const ByteSource& source, std::string_view record, double spacing,
                                           LazLayout& layout) {
  if (record.size() < info_bytes) return {};
  const auto of_root = load_little<double>(record.data() + 32);
  const Page root{load_little<uint64_t>(record.data() + 40), load_little<uint64_t>(record.data() + 48)};
  if (!(of_root > 0 && std::isfinite(of_root))) return {};
  const std::optional<Levels> levels = read_levels(source.bytes(), root);
  if (!levels) return {};
  CopcLevels found;
  found.spacing = of_root;
  for (found.kept = 1; found.spacing > spacing && found.kept <= deepest; ++found.kept) found.spacing /= 2;
  std::vector<LazChunk> chunks;
  for (LazChunk chunk : layout.chunks) {
    const auto level = levels->find(chunk.begin);
    if (level == levels->end()) return {};
    found.all = std::max(found.all, level->second + 1);
    if (level->second >= found.kept) continue;
    chunk.first = found.points;
    found.points += chunk.points;
    chunks.push_back(chunk);
  }
  if (chunks.empty()) return {};
  layout.chunks = std::move(chunks);
  return found;
}

}  // namespace soapfilm::io
