// Samples on their way from a file to who wants them, a block at a time: a cloud, or only what is counted of them.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"
#include "soapfilm/io/point_end.h"
#include "soapfilm/io/point_table.h"

namespace soapfilm::io {

/// Consecutive samples of a file, in its order. All blocks of a file have the same columns.
struct PointBlock {
  PointCloud samples{};   ///< without scans; a further column without values holds zeros
  ColorNumbers colors{};  ///< instead of samples.colors while only all of them tell their range

  size_t size() const { return samples.size(); }
};

/// Who wants the samples of files, one file after the other. An error of the reader comes between two calls.
class PointSink {
 public:
  virtual ~PointSink() = default;
  /// A block has at most so many samples, > 0.
  virtual size_t block_samples() const { return size_t{1} << 16; }
  /// A file begins. May refuse it.
  virtual void begin(const PointHeader& /*header*/, const std::string& /*path*/) {}
  virtual void take(PointBlock&& block) = 0;
  virtual void end(PointEnd&& end) = 0;
};

/// The reader's side: samples are added to a block, which is handed over when it is full.
class PointStream {
 public:
  explicit PointStream(PointSink& sink) : sink_(sink) {}

  /// The file is one block, whatever the sink asks for, as its end changes what all its samples are. To be said before
  /// begin().
  void keep_whole() { most_ = std::numeric_limits<size_t>::max(); }

  /// Throws InputError, and MemoryError, where so many samples cannot be kept and must be; nothing large is allocated
  /// then.
  void begin(const PointHeader& header, const std::string& path);

  /// To which samples and the values of all their columns are added.
  PointCloud& samples() { return block_.samples; }
  const PointCloud& samples() const { return block_.samples; }
  ColorNumbers& colors() { return block_.colors; }
  /// Of the file so far.
  size_t size() const { return passed_ + block_.size(); }
  /// Of the file, before the first one in samples().
  size_t passed() const { return passed_; }
  bool is_whole() const { return most_ == std::numeric_limits<size_t>::max(); }

  /// Samples have been added, complete: full blocks are handed over.
  void pass();

  /// After the last sample: judges and reports them. `end` has the scans and what the file's head says. What is in
  /// samples() is all of the file if is_whole(), as it will be; it may still be changed.
  void finish(PointEnd end, FileReport file, const PointTraits& traits, ReadReport& report);
  /// Hands over what is left.
  void close();

  /// Of all finite positions so far.
  Box3d box() {
    tally_up();
    return tally_.box();
  }

 private:
  void tally_up();
  void hand_over(bool all);

  PointSink& sink_;
  size_t most_ = 0;
  PointHeader header_;
  PointBlock block_;
  PointTally tally_;
  size_t passed_ = 0;
  size_t tallied_ = 0;            // of the block
  std::vector<bool> has_values_;  // of each further column
  float largest_color_ = 0;
  PointEnd end_;
};

/// All samples of all files, appended as PointCloud::append() does.
class CloudSink : public PointSink {
 public:
  explicit CloudSink(size_t block_samples = std::numeric_limits<size_t>::max()) : block_samples_(block_samples) {}

  size_t block_samples() const override { return block_samples_; }
  void begin(const PointHeader& header, const std::string& path) override { check_cloud_fits(header, path); }
  void take(PointBlock&& block) override;
  void end(PointEnd&& end) override;

  PointCloud& cloud() { return cloud_; }

 private:
  size_t block_samples_;
  PointBlock file_;
  PointCloud cloud_;
};

/// A whole cloud, as the samples of a file.
void hand_over(PointCloud&& cloud, const std::string& path, PointSink& sink);
void hand_over(const PointCloud& cloud, const std::string& path, PointSink& sink);

}  // namespace soapfilm::io
