// E57: which places are those of scanners.
#include "e57_files.h"
#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

using test::E57TestOptions;
using test::E57TestScan;
using test::E57Writer;
using test::floats;
using test::integers;
using test::line_scan;
using test::pose_xml;
using test::read_e57_file;

TEST(E57, ScannerStandsAtTheOriginOnlyIfTheScanIsOneOfAScanner) {
  const std::string none = pose_xml("1 0 0 0", "0 0 0");
  ReadOptions trusting;
  trusting.trust_viewpoint = true;
  EXPECT_FALSE(read_e57_file({line_scan(2)}).scans[0].sensor);
  EXPECT_FALSE(read_e57_file({line_scan(2, {}, none)}).scans[0].sensor);
  EXPECT_TRUE(read_e57_file({line_scan(2, {}, "<sensorModel type=\"String\">P40</sensorModel>")}).scans[0].sensor);
  EXPECT_TRUE(read_e57_file({line_scan(2)}, nullptr, {}, trusting).scans[0].sensor);
  const E57TestScan grid = line_scan(2, {integers("rowIndex", {0, 1}, 0, 1), integers("columnIndex", {0, 1}, 0, 1)});
  EXPECT_TRUE(read_e57_file({grid}).scans[0].sensor);
  const E57TestScan list = line_scan(2, {integers("rowIndex", {0, 1}, 0, 1), integers("columnIndex", {0, 0}, 0, 1)});
  EXPECT_FALSE(read_e57_file({list}).scans[0].sensor);
}

TEST(E57, ANameAloneIsNoScannerFarAwayOrOfAConverter) {
  const auto sensor = [](const std::string& model, double x) {
    const E57TestScan scan{
        {floats("cartesianX", {x, x + 20}), floats("cartesianY", {2, 30}), floats("cartesianZ", {3, 4})},
        "<sensorModel type=\"String\">" + model + "</sensorModel>"};
    return read_e57_file({scan}).scans.at(0).sensor;
  };
  EXPECT_TRUE(sensor("P40", -10));
  EXPECT_FALSE(sensor("P40", 500000));
  for (const char* model : {"EXTRACTION", "MERGE", "PDAL", "LAStools (c) by rapidlasso GmbH"})
    EXPECT_FALSE(sensor(model, -10)) << model;
}

TEST(E57, AShiftOfCoordinatesByRoundNumbersIsNoScannersPlace) {
  const auto sensor = [](const char* rotation, const char* translation, const ReadOptions& options = {}) {
    ReadReport report;
    const PointCloud cloud = read_e57_file({line_scan(2, {}, pose_xml(rotation, translation))}, &report, {}, options);
    EXPECT_GT(norm(cloud.positions[1]), 100);  // moved in any case
    EXPECT_EQ(report.warnings.size(), cloud.scans[0].sensor ? 0 : 1);
    return cloud.scans[0].sensor;
  };
  ReadOptions trusting;
  trusting.trust_viewpoint = true;
  EXPECT_FALSE(sensor("1 0 0 0", "691000 5334000 0"));
  EXPECT_TRUE(sensor("1 0 0 0", "691000 5334000 0", trusting));
  EXPECT_TRUE(sensor("1 0 0 0", "691000 5334000 1.5"));
  EXPECT_TRUE(sensor("1 0 0 0", "120 40 0"));
  EXPECT_TRUE(sensor("0 0 0 1", "691000 5334000 0"));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
