// E57 files that are refused, and that no bytes make the reader fail otherwise.
#include "e57_writer.h"
#include "files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

using test::doubles;
using test::E57TestField;
using test::E57TestOptions;
using test::E57TestScan;
using test::E57Writer;
using test::floats;
using test::integers;
using test::line_scan;
using test::pose_xml;

/// Expects the file to be refused with a message that holds its name and the parts.
void expect_e57_refused(const std::string& bytes, std::initializer_list<std::string> parts) {
  const TemporaryFolder folder;
  const std::string path = folder.write("bad.e57", bytes);
  expect_refusal<InputError>([&] { read_points(path); }, parts);
  expect_refusal<InputError>([&] { read_points(path); }, {path});
}

TEST(E57, DamageIsRefusedByThePagesChecksum) {
  std::string file = E57Writer::file({line_scan(2000)});
  ASSERT_GT(file.size(), 20 * 1024u);
  file[9 * 1024 + 77] ^= 4;
  expect_e57_refused(file, {"byte 10236", "checksum of page 9", "damaged"});
  file = E57Writer::file({line_scan(3)});
  file[1020] ^= 1;
  expect_e57_refused(file, {"byte 1020", "checksum of page 0"});
}

TEST(E57, HeadersThatCannotBeAreRefused) {
  const std::string good = E57Writer::file({line_scan(300)});
  const auto with = [&](size_t at, const std::string& bytes) {
    std::string file = good;
    return E57Writer::repaired(file.replace(at, bytes.size(), bytes));
  };
  const auto u64 = [](uint64_t value) { return E57Writer::bytes_of(value); };
  expect_e57_refused(good.substr(0, 500), {"truncated", "500"});
  expect_e57_refused(good.substr(0, 1024), {"byte 16", "truncated"});
  expect_e57_refused(with(8, E57Writer::bytes_of(uint32_t{2})), {"byte 8", "version = 2"});
  expect_e57_refused(with(16, u64(1000)), {"byte 16", "1000"});
  expect_e57_refused(with(40, u64(512)), {"byte 40", "512"});
  expect_e57_refused(with(24, u64(1021)), {"offset of the XML = 1021", "checksum"});
  expect_e57_refused(with(24, u64(uint64_t{1} << 60)), {"offset of the XML"});
  expect_e57_refused(with(32, u64(0)), {"byte 32", "length of the XML = 0"});
  expect_e57_refused(with(32, u64(UINT64_MAX)), {"byte 32", "18446744073709551615"});
  ReadReport report;
  const TemporaryFolder folder;
  EXPECT_EQ(read_points(folder.write("long.e57", good + "tail"), &report).size(), 300u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("4 bytes ignored"), std::string::npos);
}

TEST(E57, SectionsAndPacketsThatCannotBeAreRefused) {
  const std::string good = E57Writer::file({line_scan(3)});  // section at 48, packet at 80: 6 + 3 * 2 + 3 * 12
  const auto with = [&](size_t at, const std::string& bytes) {
    std::string file = good;
    return E57Writer::repaired(file.replace(at, bytes.size(), bytes));
  };
  const auto u16 = [](uint16_t value) { return E57Writer::bytes_of(value); };
  const auto u64 = [](uint64_t value) { return E57Writer::bytes_of(value); };
  expect_e57_refused(with(48, "\2"), {"byte 48", "section id = 2"});
  expect_e57_refused(with(56, u64(31)), {"byte 48", "section length = 31"});
  expect_e57_refused(with(56, u64(UINT64_MAX)), {"byte 48", "section length = 18446744073709551615"});
  expect_e57_refused(with(56, u64(67)), {"recordCount = 3", "at most 2"});
  expect_e57_refused(with(64, u64(48)), {"offset of the data = 48", "from 80"});
  expect_e57_refused(with(64, u64(uint64_t{1} << 62)), {"offset of the data"});
  expect_e57_refused(with(80, "\3"), {"byte 80", "packet of type 3"});
  expect_e57_refused(with(80, std::string(1, '\0')), {"truncated: 0 records", "3"});
  expect_e57_refused(with(82, u16(0)), {"byte 82", "packet of 1 bytes", "multiple of 4"});
  expect_e57_refused(with(82, u16(3)), {"byte 84", "packet of 0 streams in 4 bytes"});
  expect_e57_refused(with(82, u16(65535)), {"byte 82", "packet of 65536 bytes"});
  expect_e57_refused(with(84, u16(2)), {"byte 84", "packet of 2 streams", "must be 3"});
  expect_e57_refused(with(88, u16(30)), {"byte 88", "stream of 30 bytes", "at most 24"});
  expect_e57_refused(with(86, u16(4)), {"truncated: 1 records", "must be 3"});
}

TEST(E57, CountsLargerThanTheFileAreRefusedBeforeMemoryIsTaken) {
  E57TestScan scan = line_scan(3);
  scan.record_count = INT64_MAX;
  expect_e57_refused(E57Writer::file({scan}), {"recordCount = 9223372036854775807", "at most"});
  const auto constant = [](const char* name) { return integers(name, {1}, 1, 1); };
  scan = {{constant("cartesianX"), constant("cartesianY"), constant("cartesianZ")}};
  for (const int64_t count : {int64_t{10} << 20, int64_t{1} << 31, INT64_MAX}) {
    scan.record_count = count;
    expect_e57_refused(E57Writer::file({scan}), {"recordCount = " + std::to_string(count), "at most"});
    expect_e57_refused(E57Writer::file({scan, scan}), {"recordCount = ", "at most"});
  }
  scan.record_count = -1;
  expect_e57_refused(E57Writer::file({scan}), {"recordCount = -1", ">= 0"});
}

TEST(E57, ScansMustNotShareASection) {
  std::string file = E57Writer::file({line_scan(3), line_scan(3)});  // 32 + 48 bytes each
  const size_t at = file.find("fileOffset=\"128\"");
  ASSERT_NE(at, std::string::npos);
  file.replace(at, 16, "fileOffset=\"48\" ");
  expect_e57_refused(E57Writer::repaired(file), {"byte 48", "'scan 2'", "'scan 1'", "of their own"});
}

TEST(E57, XmlThatCannotBeIsRefused) {
  const auto refused = [](const E57TestScan& scan, std::initializer_list<std::string> parts) {
    expect_e57_refused(E57Writer::file({scan}), parts);
  };
  refused(line_scan(1, {}, "<pose><rotation/></pose>"), {"byte ", "rotation = (0, 0, 0, 0)"});
  refused(line_scan(1, {}, pose_xml("1 0 nan 0", "")), {"y = nan", "finite"});
  refused(line_scan(1, {}, pose_xml("", "1 b 0")), {"y = 'b'", "number"});
  refused(line_scan(1, {}, "<open>"), {"byte ", "XML"});
  refused({{floats("cartesianX", {1}), floats("cartesianY", {1})}}, {"'scan 1'", "no position", "cartesianZ"});
  refused({{{"cartesianX", "Blob", {1}, {}, {}, {}, {}}}}, {"'cartesianX'", "'Blob'", "Float"});
  refused({{floats("cartesianX", {1}, "precision2=\"\""), integers("a", {1}, 5, 4)}}, {"'a'", "minimum = 5"});
  refused(line_scan(1, {integers("a", {1}, 0, 5, "scale=\"0\"")}), {"'a'", "scale = 0"});
  refused(line_scan(1, {floats("a", {1}, "minimum=\"x\"")}), {"minimum = 'x'", "number"});
  refused(line_scan(1, {integers("a", {1}, 0, std::nullopt, "maximum=\"99999999999999999999\"")}),
          {"maximum = '99999999999999999999'", "64 bits"});
  std::vector<E57TestField> many(260, floats("a", {1}));
  refused(line_scan(1, many), {"more than 256 fields"});
  expect_e57_refused(E57Writer::file({}), {"no samples"});
  expect_e57_refused(E57Writer::paged(std::string(48, ' ') + "<other/>", 8), {"'other'", "e57Root"});
}

TEST(E57, WeightsThatCannotBeAreRefused) {
  expect_e57_refused(E57Writer::file({line_scan(2, {floats("a:weight", {1, -2})})}),
                     {"byte ", "'scan 1'", "weight = -2", ">= 0"});
}

TEST(E57, XmlOfTooManyElementsIsRefused) {
  std::string xml = "<e57Root>";
  for (int i = 0; i < 600000; ++i) xml += "<a/>";
  xml += "</e57Root>";
  expect_e57_refused(E57Writer::paged(std::string(48, ' ') + xml, xml.size()), {"XML of", "at most"});
}

TEST(E57, NoChangedBytesCrashTheReader) {
  E57TestOptions options;
  options.other_packets = true;
  options.split = [](size_t packet, size_t) { return packet % 7 + 1; };
  const E57TestScan scan = line_scan(
      30,
      {integers("rowIndex", std::vector<int64_t>(30, 1), 0, 5),
       integers("columnIndex", std::vector<int64_t>(30, 2), 0, 40), doubles("timeStamp", std::vector<double>(30, 1e9))},
      pose_xml("1 0 0 0", "1 2 3"));
  const std::string good = E57Writer::file({scan, scan}, options);
  const TemporaryFolder folder;
  Random random(17);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = good;
    for (int change = 0; change < 1 + round % 3; ++change)
      bytes[static_cast<size_t>(random.uniform() * static_cast<double>(bytes.size()))] ^=
          static_cast<char>(1 << static_cast<int>(random.uniform() * 8));
    try {
      read_points(folder.write("changed.e57", E57Writer::repaired(bytes)));
    } catch (const InputError&) {
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
