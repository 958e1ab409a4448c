// The samples of a case, with numbers that no cloud may hold.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::test {

/// Choices of a case.
class Chooser {
 public:
  explicit Chooser(uint64_t seed) : random_(seed) {}

  size_t below(size_t count) { return static_cast<size_t>(random_.next() % count); }
  bool one_in(size_t count) { return below(count) == 0; }
  double uniform(double low, double high) { return random_.uniform(low, high); }
  double normal() { return random_.normal(); }
  /// 10^x, x uniform.
  double power(double low, double high);
  Vec3d direction();
  template <class T, size_t count>
  T of(const T (&values)[count]) {
    return values[below(count)];
  }

 private:
  Random random_;
};

/// Rows of numbers by columns; columns are empty where the cloud has none.
struct NastyCloud {
  std::vector<Vec3d> positions, normals, sensors;
  std::vector<double> weights, values;
  std::vector<std::array<int, 3>> colors;
  std::vector<size_t> scans;  ///< samples of each; empty: one scan
  bool scan_sensor = false;   ///< each scan has a scanner's position: `sensor`
  Vec3d sensor;
  int columns = 0, rows = 0;  ///< of a range grid, which `grid` fills with sample or -1; 0: none
  std::vector<int> grid;
};

NastyCloud nasty_cloud(Chooser& choose);

}  // namespace soapfilm::test
