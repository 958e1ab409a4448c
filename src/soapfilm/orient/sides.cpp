#include "soapfilm/orient/sides.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace soapfilm {

namespace {

constexpr double noise = 0.3;  // spacings: farther apart, the two kinds lie on different surfaces

/// Upper end of a bin.
double bin_end(size_t bin) { return std::ldexp(1 - 0.125 * static_cast<double>(bin % 4), -static_cast<int>(bin / 4)); }

size_t bin_of(double thickness, size_t bins) {
  int exponent = 0;
  const double mantissa = std::frexp(std::min(thickness, 1.0), &exponent);  // in [1/2, 1)
  const int bin = -4 * exponent + static_cast<int>((1 - mantissa) * 8);
  return static_cast<size_t>(std::clamp(bin, 0, static_cast<int>(bins) - 1));
}

}  // namespace

void LocalSidesBuilder::add(int cell, uint32_t count, double towards, double height) {
  constexpr double told = 0.3;  // cosine of direction and normal; below it the side is unknown
  if (std::abs(towards) <= told * count) return;
  const size_t side = towards > 0 ? 0 : 1;
  samples_[side] += count;
  height_[side] += count * height;
  cells_[side] |= 1u << cell;
}

LocalSides LocalSidesBuilder::result(double spacing) const {
  constexpr double fewest_mixed = 0.25;  // of the cells of the rarer kind, those that the other shares
  constexpr int fewest_alone = 3;        // cells with only one kind, at least so many of each at a seam
  constexpr double seam_share = 0.15;    // of the rarer kind's samples
  constexpr double seam_step = 0.1;      // cells
  LocalSides sides;
  const double all = samples_[0] + samples_[1], rarer = std::min(samples_[0], samples_[1]);
  if (rarer < 2) return sides;
  sides.pairs = 2 * samples_[0] * samples_[1] / (all * (all - 1));
  sides.thickness = height_[0] / samples_[0] - height_[1] / samples_[1];
  sides.apart = sides.thickness / spacing;
  const int mixed = std::popcount(cells_[0] & cells_[1]);
  const int alone = std::min(std::popcount(cells_[0] & ~cells_[1]), std::popcount(cells_[1] & ~cells_[0]));
  sides.seam = mixed < fewest_mixed * (mixed + alone) && alone >= fewest_alone && rarer > seam_share * all &&
               std::abs(sides.thickness) < seam_step;
  return sides;
}

void SideStatistics::add(const LocalSides& sides, size_t samples, double area, double cell) {
  const auto count = static_cast<double>(samples);
  samples_ += samples;
  area_ += count * area;
  if (!(sides.pairs > 0)) return;
  const double pairs = count * sides.pairs;
  if (sides.apart > noise) {
    sheet_ += pairs;
    sheet_area_[bin_of(sides.thickness * cell, bins)] += count * area;
  } else if (sides.seam) {
    seam_ += pairs;
  } else if (sides.apart >= -noise) {
    (sides.apart > 0 ? above_ : below_) += pairs;
  }
}

SideStatistics& SideStatistics::operator+=(const SideStatistics& other) {
  for (size_t bin = 0; bin < bins; ++bin) sheet_area_[bin] += other.sheet_area_[bin];
  area_ += other.area_;
  above_ += other.above_, below_ += other.below_, seam_ += other.seam_, sheet_ += other.sheet_;
  samples_ += other.samples_;
  return *this;
}

double SideStatistics::contradicting() const { return share(2 * std::min(above_, below_) + seam_); }

bool SideStatistics::contradicts() const {
  constexpr size_t fewest = 200;         // samples
  constexpr double most = 0.02;          // share of the pairs
  constexpr double most_at_seams = 0.2;  // times the root of the samples: a line of half the root of the area
  constexpr double few_at_seams = 0.0005;
  if (samples_ < fewest) return false;
  const double seams = at_seams();
  return contradicting() > most ||
         (seams > few_at_seams && seams * std::sqrt(static_cast<double>(samples_)) > most_at_seams);
}

SideStatistics::Thin SideStatistics::thinner_than(double limit) const {
  double below = 0;
  for (size_t bin = 0; bin < bins; ++bin)
    if (bin_end(bin) <= limit) below += sheet_area_[bin];
  if (!(below > 0)) return {};
  Thin thin{below / area_, 0};
  double thicker = 0;
  for (size_t bin = 0; bin < bins; ++bin) {
    if (bin_end(bin) > limit) continue;
    thin.thickness = bin_end(bin);
    if ((thicker += sheet_area_[bin]) >= below / 2) break;
  }
  return thin;
}

}  // namespace soapfilm
