// A LAS file's samples get the scanner's position from a trajectory, by their GPS times.
#include "files.h"
#include "las_files.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

LasFile file_of_times(const std::vector<double>& times) {
  LasFile file;
  file.format = 1;
  for (const double time : times) {
    file.points.push_back({});
    file.points.back().time = time;
    file.points.back().xyz[0] = static_cast<int32_t>(file.points.size());
  }
  return file;
}

std::vector<Vec3d> sensors_of(const TemporaryFolder& folder, const std::vector<double>& times, const std::string& text,
                              ReadReport* report = nullptr) {
  ReadOptions options;
  options.trajectory = folder.write("way.txt", text);
  return read_points(folder.write("t.las", file_of_times(times).bytes()), report, Context(1), options).sensors;
}

TEST(Trajectory, IsInterpolatedAtEachSamplesTime) {
  const TemporaryFolder folder;
  const std::vector<double> times{100, 100.25, 103, 102, 101, 100.5};
  const std::vector<Vec3d> expected{{0, 10, 5}, {1, 10, 5}, {8, 20, 5}, {6, 15, 5}, {4, 10, 5}, {2, 10, 5}};
  for (const char* text :
       {"100 0 10 5\n101 4 10 5\n103 8 20 5\n", "time,x,y,z\r\n103,8,20,5\r\n100,0,10,5\r\n101,4,10,5",
        "# x y z GPSTime[s]\n0 10 5 100\n4 10 5 101\n8 20 5 103\n",
        "\"Easting\";\"Northing\";\"Height\";\"Time\"\n\n0;10;5;100 # start\n4;10;5;101\n8;20;5;103",
        "made by a program\nof two lines\n100 0 10 5\n101 4 10 5\n103 8 20 5\n"}) {
    ReadReport report;
    EXPECT_EQ(sensors_of(folder, times, text, &report), expected) << text;
    EXPECT_TRUE(report.warnings.empty()) << text;
  }
}

TEST(Trajectory, KeepsTheDigitsOfLargeTimesAndCoordinates) {
  const TemporaryFolder folder;
  const std::vector<Vec3d> sensors = sensors_of(
      folder, {345678901.5, 345678901.25}, "345678901 5000000.5 4649000.25 900\n345678902 5000001.5 4649000.25 900\n");
  EXPECT_EQ(sensors, std::vector<Vec3d>({{5000001, 4649000.25, 900}, {5000000.75, 4649000.25, 900}}));
}

TEST(Trajectory, SamplesOutsideItsTimesHaveNoSensorAndAreCounted) {
  const TemporaryFolder folder;
  ReadReport report;
  const std::vector<Vec3d> sensors = sensors_of(folder, {99, 100, 101, 102}, "100 1 2 3\n101 2 2 3\n", &report);
  ASSERT_EQ(sensors.size(), 4u);
  EXPECT_TRUE(std::isnan(sensors[0].x) && std::isnan(sensors[3].z));
  EXPECT_EQ(sensors[1], (Vec3d{1, 2, 3}));
  EXPECT_EQ(sensors[2], (Vec3d{2, 2, 3}));
  ASSERT_EQ(report.warnings.size(), 1u);
  for (const char* part : {"2 of 4", "from 99 to 102", "from 100 to 101"})
    EXPECT_NE(report.warnings[0].find(part), std::string::npos) << report.warnings[0];
}

TEST(Trajectory, OtherClockIsNamedAsTheLikelyReason) {
  const TemporaryFolder folder;
  const auto warning = [&](double time, const std::string& text) {
    ReadReport report;
    EXPECT_TRUE(sensors_of(folder, {time, time + 1}, text, &report).empty());
    EXPECT_EQ(report.warnings.size(), 1u);
    return report.warnings.empty() ? std::string() : report.warnings[0];
  };
  const std::string of_week = warning(345678901, "400000 1 2 3\n400100 1 2 3\n");
  EXPECT_NE(of_week.find("points have adjusted standard GPS time"), std::string::npos) << of_week;
  EXPECT_NE(of_week.find("the trajectory seconds of the GPS week"), std::string::npos) << of_week;
  EXPECT_NE(warning(400000, "1345678901 1 2 3\n1345679901 1 2 3\n").find("since 1980"), std::string::npos);
  EXPECT_EQ(warning(400000, "500000 1 2 3\n").find("clocks"), std::string::npos);
}

TEST(Trajectory, IsOfNoUseForPointsWithoutTime) {
  const TemporaryFolder folder;
  LasFile file = file_of_times({1, 2});
  file.format = 0;
  ReadOptions options;
  options.trajectory = folder.write("way.txt", "1 2 3 4\n");
  ReadReport report;
  EXPECT_TRUE(read_points(folder.write("t.las", file.bytes()), &report, Context(1), options).sensors.empty());
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("no GPS time"), std::string::npos);
}

TEST(Trajectory, WithheldSamplesAreLeftOutOfItsSensors) {
  const TemporaryFolder folder;
  LasFile file = file_of_times({1, 2, 3});
  file.points[0].withheld = true;
  ReadOptions options;
  options.trajectory = folder.write("way.txt", "2 20 0 0\n3 30 0 0\n");
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("t.las", file.bytes()), &report, Context(1), options);
  EXPECT_EQ(cloud.sensors, std::vector<Vec3d>({{20, 0, 0}, {30, 0, 0}}));
}

TEST(Trajectory, RefusalsNameTheLine) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    expect_refusal<InputError>([&] { sensors_of(folder, {1}, text); }, parts);
  };
  refused("only words\n", {"way.txt", "no rows", "time x y z"});
  refused("1 2 3\n", {"way.txt:1:", "3 columns", "at least 4"});
  refused("1 2 3 4\n1 2 3\n", {"way.txt:2:", "3 columns", "4 as before"});
  refused("1 2 3 4\n1 2 x 4\n", {"way.txt:2:", "y = 'x'", "finite"});
  refused("time x y z\n1 2 3 nan\n", {"way.txt:2:", "z = 'nan'", "finite"});
  ReadOptions options;
  options.trajectory = folder / "none.txt";
  const std::string las = folder.write("t.las", file_of_times({1}).bytes());
  expect_refusal<InputError>([&] { read_points(las, nullptr, Context(1), options); }, {"none.txt", "No such file"});
}

TEST(Trajectory, FurtherColumnsAreTold) {
  const TemporaryFolder folder;
  ReadReport report;
  EXPECT_EQ(sensors_of(folder, {1}, "1 2 3 4 0.1 0.2 90\n", &report), std::vector<Vec3d>({{2, 3, 4}}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("7 columns"), std::string::npos);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
