// One scan of an E57 file on its way into the file's cloud.
#pragma once

#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/io/cell_grid.h"
#include "soapfilm/io/e57/e57_layout.h"
#include "soapfilm/io/e57/e57_records.h"
#include "soapfilm/io/point_table.h"

namespace soapfilm::io {

/// Appends the samples of a scan to a cloud that has room for them. Columns of the cloud that the scan lacks get their
/// neutral values.
class E57ScanReader {
 public:
  /// `column_of`: for each of layout.further its column in the cloud.
  E57ScanReader(const E57Scan& scan, const E57Layout& layout, const std::vector<size_t>& column_of,
                const PointHeader& header, PointCloud& cloud);

  /// Throws InputError. Adds to `no_return` what has no position.
  void read(E57Records& records, const Context& context, size_t& no_return);
  /// After read(): moves the samples, and adds the scan if it has any. Returns why it has no range grid though it
  /// should have one. `trust_origin`: the origin of any scan is where its scanner stood.
  std::string finish(bool trust_origin);
  /// After finish(): the pose is a shift of coordinates by round numbers, and tells of no scanner.
  bool shifted() const { return shifted_; }
  /// After finish(): without a pose the scan seems to be one of a scanner, but the samples were not seen from the
  /// origin.
  bool unseen() const { return unseen_; }

 private:
  bool tells_of_scanner(const Scan& scan) const;
  bool contradicts_scanner(const Scan& scan) const;
  void append_block(const E57Records& records, size_t count);
  void append_positions(const E57Records& records);
  void append_colors(const E57Records& records);
  void append_further(const E57Records& records);
  void drop_origins();
  template <class T>
  void append(const E57Records& records, const Triple& fields, std::vector<Vec3<T>>& to);
  template <class Use>
  void for_kept(Use&& use) const;

  const E57Scan& scan_;
  const E57Layout& layout_;
  const std::vector<size_t>& column_of_;
  const PointHeader& header_;
  PointCloud& cloud_;
  size_t begin_;                ///< of the scan's samples in the cloud
  std::vector<uint16_t> kept_;  ///< records of the block that are samples
  bool all_kept_ = true;        ///< of the block
  CellGrid cells_;
  ColorNumbers colors_;  ///< if the file does not say from where to where they go
  std::optional<std::array<double, 2>> color_limits_;
  std::vector<double> first_time_;  ///< of each of layout.further
  size_t no_return_ = 0;
  size_t at_origin_ = 0;
  bool shifted_ = false;
  bool unseen_ = false;
};

}  // namespace soapfilm::io
