#include "soapfilm/grid/vertex_mask.h"

#include <algorithm>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// Dilates one row of bits: a vertex is set if the last set one before it, or the next one after, is close enough.
void dilate_row(uint8_t* bytes, int count, int radius) {
  if (std::all_of(bytes, bytes + count, [](uint8_t byte) { return byte == 0; })) return;
  const int n = count * brick_side;
  std::vector<uint8_t> out(static_cast<size_t>(count), 0);
  const auto is_set = [&](int x) { return bytes[x >> 3] >> (x & 7) & 1; };
  const auto mark = [&](int x) { out[static_cast<size_t>(x >> 3)] |= static_cast<uint8_t>(1u << (x & 7)); };
  for (int x = 0, last = -radius - 1; x < n; ++x) {
    if (is_set(x)) last = x;
    if (x - last <= radius) mark(x);
  }
  for (int x = n - 1, next = n + radius; x >= 0; --x) {
    if (is_set(x)) next = x;
    if (next - x <= radius) mark(x);
  }
  std::copy(out.begin(), out.end(), bytes);
}

}  // namespace

void VertexMask::dilate(int radius, const Context& context) {
  const size_t width = static_cast<size_t>(bricks_.x);
  const int ny = brick_side * bricks_.y, nz = brick_side * bricks_.z;
  parallel_for(context, static_cast<size_t>(ny) * static_cast<size_t>(nz), 64,
               [&](size_t r) { dilate_row(&rows_[r * width], bricks_.x, radius); });
  // Along y a line is `width` bytes in every row of a layer, along z it is a layer.
  const auto along = [&](size_t lines, size_t line_bytes, int count) {
    const std::vector<uint8_t> old = rows_;
    parallel_for(context, lines * static_cast<size_t>(count), 16, [&](size_t k) {
      const size_t first = k / static_cast<size_t>(count) * static_cast<size_t>(count);
      const int at = static_cast<int>(k - first);
      for (int other = std::max(0, at - radius); other <= std::min(count - 1, at + radius); ++other) {
        const uint8_t* from = &old[(first + static_cast<size_t>(other)) * line_bytes];
        uint8_t* to = &rows_[k * line_bytes];
        for (size_t i = 0; i < line_bytes; ++i) to[i] |= from[i];
      }
    });
  };
  along(static_cast<size_t>(nz), width, ny);
  along(1, width * static_cast<size_t>(ny), nz);
}

}  // namespace soapfilm
