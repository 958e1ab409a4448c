// What --write-levels writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/pyramid/coarse_to_fine.h"

namespace soapfilm::cli {

/// The surfaces of the pyramid's levels in a folder, each written as soon as it is solved; removed again, but not the
/// folder, when the run fails.
class LevelFiles {
 public:
  LevelFiles() = default;
  LevelFiles(const LevelFiles&) = delete;
  LevelFiles& operator=(const LevelFiles&) = delete;
  ~LevelFiles();

  /// Writes nothing without a folder, which is made when there is a first level.
  PyramidObserver writer(const std::filesystem::path& folder, double threshold, const Context& context);
  static std::string name(int level);
  /// Call when the run succeeded.
  void keep() { written_.clear(); }

 private:
  std::vector<std::filesystem::path> written_;
};

}  // namespace soapfilm::cli
