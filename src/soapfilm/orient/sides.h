// Which side of their plane samples look to: all to the same, to the two sides of a thin sheet, or at random.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace soapfilm {

/// At one place, the cells around a sample that lies on a plane: the samples in them that look to one side of the
/// plane, and those that look to the other.
struct LocalSides {
  double pairs = 0;      ///< share of its pairs of samples that look to opposite sides, [0, slightly above 0.5]
  double apart = 0;      ///< mean height of those that look up above the others, spacings; < 0: below them
  double thickness = 0;  ///< the same, cells
  bool seam = false;     ///< each of the two has cells of its own: a line separates them
};

/// Computes them for the samples in 27 cells.
class LocalSidesBuilder {
 public:
  /// Adds samples of one cell with similar directions: the sum of their directions along the plane's normal, and their
  /// mean height above the plane, cells.
  void add(int cell, uint32_t count, double towards, double height);
  /// `spacing` of the samples, cells.
  LocalSides result(double spacing) const;

 private:
  std::array<double, 2> samples_{}, height_{};  ///< of those that look up, and down
  std::array<uint32_t, 2> cells_{};             ///< bits
};

/// Sums over samples on planes. Shares are of the pairs of neighboring samples on one plane, [0, 1].
class SideStatistics {
 public:
  /// `area`: represented by such a sample, `cell`: side of a cell; in units of the samples' box's longest side.
  void add(const LocalSides& sides, size_t samples, double area, double cell);
  SideStatistics& operator+=(const SideStatistics& other);

  /// Pairs that look to opposite sides (n . n' < 0, usually near -1) though neither lies above the other. The samples
  /// of the two sides of a sheet always lie on the side to which they look, those of a gap on the other; wrong signs
  /// are independent of that. So of pairs that are no farther apart than the noise, twice the smaller of the two
  /// numbers counts.
  double contradicting() const;
  /// Those of them where a line separates the two kinds, as along the edge of a part whose signs were flipped.
  double at_seams() const { return share(seam_); }
  /// Are the signs useless? Yes if more than 2 % of the pairs contradict; or if seams are so long that they could
  /// surround a fiftieth of the surface: their pairs grow only with the root of the samples, so the threshold falls
  /// with it.
  bool contradicts() const;

  /// Pairs on the two sides of a thin sheet.
  double on_sheets() const { return share(sheet_); }
  /// Share of the area that lies on sheets thinner than `limit`, same units; and the thickness below which half of that
  /// lies.
  struct Thin {
    double share = 0;
    double thickness = 0;
  };
  Thin thinner_than(double limit) const;

  size_t samples() const { return samples_; }

 private:
  double share(double pairs) const { return samples_ > 0 ? pairs / static_cast<double>(samples_) : 0; }

  /// Thickness of sheets, four bins for each factor of two, from 1 downwards.
  static constexpr size_t bins = 80;
  std::array<double, bins> sheet_area_{};
  double area_ = 0;
  double above_ = 0, below_ = 0, seam_ = 0, sheet_ = 0;  ///< pairs
  size_t samples_ = 0;
};

}  // namespace soapfilm
