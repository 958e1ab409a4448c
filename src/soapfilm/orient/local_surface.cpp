#include "soapfilm/orient/local_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "soapfilm/core/exact_sum.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/rounded.h"
#include "soapfilm/core/share.h"
#include "soapfilm/orient/area_weights.h"
#include "soapfilm/orient/facet_plane.h"
#include "soapfilm/orient/sample_cells.h"

namespace soapfilm {

namespace {

constexpr int coarser_at_most = 3;  // depths above the first filled one at which a plane is searched
constexpr int coarsest = 4;         // depth: a sixteenth of the box
/// Cells around a sample with others in them; and how many depths above the first of these its surface appears at the
/// earliest, if the samples lie along lines: these are then at least eight times as far apart as samples on one of
/// them.
constexpr size_t company = 3;
constexpr int line_depths = 3;
/// Area of a sample over the mean one, above which it has to be confirmed at the next depth.
constexpr double large = 1.5;
/// State of a sample. One that would represent far more area than others must show the same plane at the next depth,
/// too: six outliers may lie in a plane, but not together with those around them.
enum class State : uint8_t { settled, open, found, to_confirm };

/// To about four digits, as the lengths are.
Vec3f rounded_unit(Vec3f unit) {
  constexpr float steps = 16384;
  return normalized(Vec3f{std::round(unit.x * steps), std::round(unit.y * steps), std::round(unit.z * steps)});
}

class Survey {
 public:
  Survey(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Box3d& box, const Context& context)
      : positions_(positions),
        directions_(directions),
        order_(positions, directions, box, context),
        context_(context),
        found_(positions.size()) {}

  LocalSurface run() {
    descend();
    LocalSurface surface;
    surface.sides = sides_;
    surface.area.resize(order_.size());
    surface.spacing.resize(order_.size());
    surface.normal.resize(order_.size());
    surface.line.resize(order_.size());
    for (size_t k = 0; k < order_.size(); ++k) {
      const uint32_t i = order_.sample(k);
      const Found& found = found_[k];
      const bool edge = found.normal == Vec3f{} && found.first_filled == coarsest;
      // Of some there are no coarser cells to confirm it.
      surface.spacing[i] = edge || found.state == State::to_confirm ? 0.0f : found.spacing;
      surface.area[i] = found.area;
      surface.normal[i] = found.normal;
      surface.planes += surface.is_plane(i);
      surface.line[i] = found.first_company - found.first_filled >= line_depths;
    }
    surface.coverage = cover_area(surface, order_);
    return surface;
  }

 private:
  /// Of a sample.
  struct Found {
    Vec3f normal;
    float area = 0, spacing = 0;
    uint8_t first_filled = 0;   ///< depth of its first filled cells; 0: none yet
    uint8_t first_company = 0;  ///< depth at which cells around it first hold others; 0: none yet
    State state = State::open;

    bool is_plane() const { return normal != Vec3f{} && spacing > 0; }
  };

  /// Finds what is around the samples, from fine to coarse cells.
  void descend() {
    int depth = first_depth();
    SampleCells cells(order_, positions_, directions_, depth, context_);
    while (true) {
      context_.check();
      const Settled settled = settle(cells, depth);
      context_.progress().advance(1 - static_cast<double>(settled.left) / static_cast<double>(positions_.size()),
                                  "surface around the samples");
      sides_ += settled.sides;
      size_t left = settled.left;
      left += doubt_large_ones();
      if (left == 0 || depth == coarsest) break;
      cells = std::move(cells).coarser(order_, directions_, context_);
      --depth;
    }
  }

  /// The finest depth where some cells hold several different samples. All depths in one pass, since the order may be
  /// on disk.
  int first_depth() const {
    constexpr double some = 0.02;
    constexpr uint64_t several = 4;
    constexpr int finest = SampleOrder::deepest - 2;
    struct Cells {
      size_t count = 0, crowded = 0;
      uint64_t distinct = 0;  ///< parts of the present one that hold samples
    };
    std::array<Cells, finest + 1> at_depth{};
    for (size_t k = 0; k < order_.size(); ++k) {
      // From this depth on the sample lies in another cell than the one before.
      const int apart = k == 0 ? 0 : depth_apart(order_.key(k), order_.key(k - 1));
      for (int depth = std::max(apart - 2, coarsest + 1); depth <= finest; ++depth) {
        Cells& cells = at_depth[static_cast<size_t>(depth)];
        if (depth >= apart) {
          ++cells.count;
          cells.distinct = 1;
        } else {
          cells.crowded += ++cells.distinct == several;
        }
      }
    }
    for (int depth = finest; depth > coarsest; --depth) {
      const Cells& cells = at_depth[static_cast<size_t>(depth)];
      if (static_cast<double>(cells.crowded) >= some * static_cast<double>(cells.count)) return depth;
    }
    return coarsest;
  }

  /// The coarsest depth whose cells tell two keys apart; deepest + 1: none does.
  static int depth_apart(uint64_t a, uint64_t b) {
    return SampleOrder::deepest + 1 - (static_cast<int>(std::bit_width(a ^ b)) + 2) / 3;
  }

  /// Of the planes found at this depth, marks those that represent far more area than others for confirmation; returns
  /// how many.
  size_t doubt_large_ones() {
    constexpr size_t at_once = size_t{1} << 15;
    struct Sum {
      size_t planes = 0;
      ExactSum area;
      void operator+=(const Sum& other) { planes += other.planes, area += other.area; }
    };
    const auto sum = sum_chunks<Sum>(positions_.size(), at_once, context_, [&](size_t begin, size_t end) {
      Sum part;
      for (size_t k = begin; k < end; ++k)
        if (found_[k].is_plane()) {
          ++part.planes;
          part.area.add(found_[k].area);
        }
      return part;
    });
    const double per_area = sum.planes > 0 ? static_cast<double>(sum.planes) / sum.area.value() : 0;
    return sum_chunks<size_t>(positions_.size(), at_once, context_, [&](size_t begin, size_t end) {
      size_t doubted = 0;
      for (size_t k = begin; k < end; ++k) {
        Found& found = found_[k];
        if (found.state != State::found) continue;
        const bool doubt = found.is_plane() && found.area * per_area > large;
        found.state = doubt ? State::to_confirm : State::settled;
        doubted += doubt;
      }
      return doubted;
    });
  }

  struct Settled {
    size_t left = 0;       ///< samples that are not settled
    SideStatistics sides;  ///< of those settled in this pass
    void operator+=(const Settled& other) { left += other.left, sides += other.sides; }
  };

  /// Settles the samples whose surface is found at this depth. Ranks share the cells.
  Settled settle(const SampleCells& cells, int depth) {
    constexpr size_t at_once = 512;
    std::vector<Settled> parts((cells.size() + at_once - 1) / at_once);
    const auto first_cell = [&](size_t part) { return std::min(part * at_once, cells.size()); };
    share_values(parts, 1, context_, [&](size_t part) {
      for (size_t c = first_cell(part); c < first_cell(part + 1); ++c)
        parts[part].left += settle_cell(cells, c, depth, parts[part].sides);
    });
    bring_items(parts.size(), {found_.data(), sizeof(Found)}, context_,
                [&](size_t part) { return size_t{cells[first_cell(part)].begin}; });
    Settled settled;
    for (const Settled& part : parts) settled += part;
    return settled;
  }

  /// Returns how many samples of the cell are left.
  size_t settle_cell(const SampleCells& cells, size_t c, int depth, SideStatistics& sides) {
    const uint32_t first = cells[c].begin, last = cells[c + 1].begin;
    if (std::all_of(found_.begin() + first, found_.begin() + last,
                    [](const Found& found) { return found.state == State::settled; }))
      return 0;
    const FacetsAround around = measure_surroundings(cells, c);
    std::array<std::optional<FacetPlane>, 2> planes;
    std::array<size_t, 2> found_now{};
    size_t left = 0;
    for (uint32_t k = first; k < last; ++k) {
      Found& own = found_[k];
      if (own.state == State::settled) continue;
      if (own.first_company == 0 && around.count >= company) own.first_company = static_cast<uint8_t>(depth);
      const size_t side = cells.side_of(k);
      if (!planes[side]) planes[side] = plane_of(around, cells.facets(c)[side]);
      found_now[side] += settle_sample(*planes[side], cells.side(), depth, own);
      left += own.state == State::open;
    }
    const double cell = cells.side() / order_.longest();
    for (size_t side = 0; side < 2; ++side)
      if (found_now[side] > 0) sides.add(planes[side]->sides, found_now[side], planes[side]->area * cell * cell, cell);
    return left;
  }

  /// Takes what its plane says, cells of side `cell`. Whether a plane was found now whose samples agree on its side.
  static bool settle_sample(const FacetPlane& plane, double cell, int depth, Found& own) {
    if (own.state == State::to_confirm) {
      own.state = State::settled;
      if (!plane.confirms(own.normal)) own.spacing = 0;
      return false;
    }
    const bool is_first = own.first_filled == 0;
    if (own.first_filled == depth + 1 && !plane.confirms_edge()) own.spacing = 0;
    const bool found = is_first ? plane.found : plane.found_far;
    if (plane.filled && (found || is_first)) {
      own.area = static_cast<float>(rounded(plane.area * cell * cell));
      own.spacing = plane.agrees() ? static_cast<float>(rounded(plane.spacing * cell)) : 0.0f;
    }
    if (plane.filled && is_first) own.first_filled = static_cast<uint8_t>(depth);
    if (found) {
      own.normal = rounded_unit(plane.normal);
      own.state = State::found;
      return plane.agrees();
    }
    if (own.first_filled >= depth + coarser_at_most) own.state = State::settled;  // an edge, or no surface
    return false;
  }

  std::span<const Vec3d> positions_;
  std::span<const Vec3f> directions_;
  SampleOrder order_;
  const Context& context_;
  std::vector<Found> found_;  ///< of each sample, in the order
  SideStatistics sides_;
};

}  // namespace

LocalSurface measure_local_surface(std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                                   const Box3d& box, const Context& context) {
  return Survey(positions, directions, box, context).run();
}

}  // namespace soapfilm
