// A warning names the cause of a bad mesh, and the option that helps.
#include "soapfilm/run/announce.h"

#include <gtest/gtest.h>

#include <string>

namespace soapfilm {
namespace TEST_FILE {

/// A run whose self-check found nothing; samples with normals, noise unknown, voxel 0.1.
ReconstructReport sound() {
  ReconstructReport report;
  report.input.samples = 1000;
  report.input.directions.from_normals = 1000;
  report.grid.voxel = 0.1;
  report.self_check.samples = 1000;
  return report;
}

ReconstructReport with_lost_samples() {
  ReconstructReport report = sound();
  report.self_check.lost = 0.05;
  return report;
}

ReconstructReport with_made_up_surface() {
  ReconstructReport report = sound();
  report.self_check.invented = 0.4;
  return report;
}

ReconstructReport with_estimated_directions(ReconstructReport report) {
  report.input.directions.from_normals = 0;
  report.input.directions.estimated = report.input.samples;
  return report;
}

/// All warnings, one after the other.
std::string warnings_of(const ReconstructReport& report) {
  const Context context(1);
  Trace trace(context);
  announce_self_check(report, trace);
  std::string all;
  for (const std::string& warning : trace.warnings()) all += warning + "\n";
  return all;
}

bool says(const ReconstructReport& report, const std::string& part) {
  return warnings_of(report).find(part) != std::string::npos;
}

TEST(Announce, ASoundRunGivesNoWarning) {
  EXPECT_EQ(warnings_of(sound()), "");
  EXPECT_NE(warnings_of(with_lost_samples()), "");
  EXPECT_NE(warnings_of(with_made_up_surface()), "");
}

TEST(Announce, OutliersAreThoseThatAreFarFromAllOthers) {
  ReconstructReport report = with_lost_samples();
  report.self_check.outliers = report.self_check.alone = 0.9;
  EXPECT_TRUE(says(report, "mostly outliers (90 % of these), far from all others")) << warnings_of(report);
  // Leaves of a tree have others around them.
  report.self_check.alone = 0.1;
  EXPECT_FALSE(says(report, "outliers")) << warnings_of(report);
  EXPECT_TRUE(says(report, "90 % of these lie where samples show no surface")) << warnings_of(report);
  report.self_check.outliers = 0.1;
  EXPECT_TRUE(says(report, "too thin or too sparsely sampled")) << warnings_of(report);
}

/// Whether the lost samples show it, or all samples before the grid was placed.
TEST(Announce, NoiseAsksForTheVoxelThatItWouldHaveSet) {
  ReconstructReport lost = with_lost_samples(), known = with_lost_samples();
  lost.self_check.noise = 2;  // voxels
  known.input.noise = 0.2;    // input units
  for (const ReconstructReport& report : {lost, known}) {
    EXPECT_TRUE(says(report, "their noise, about 0.2,")) << warnings_of(report);
    EXPECT_TRUE(says(report, "larger --voxel, such as 0.35")) << warnings_of(report);
  }
}

TEST(Announce, AVoxelThatNoiseHasSetIsNotToBeMadeLarger) {
  ReconstructReport report = with_lost_samples();
  report.input.noise = report.grid.voxel / default_voxel_over_noise;
  EXPECT_FALSE(says(report, "--voxel, such as")) << warnings_of(report);
  report.self_check.noise = 1.3;
  EXPECT_TRUE(says(report, "larger --voxel, such as 0.23")) << "lost samples have more noise than half of the area has";
}

/// What is alone is no noise, however much of it the others have.
TEST(Announce, OutliersAmongNoiseAreOutliers) {
  ReconstructReport report = with_lost_samples();
  report.input.noise = 0.2;
  report.self_check.outliers = report.self_check.alone = 0.9;
  EXPECT_TRUE(says(report, "mostly outliers")) << warnings_of(report);
}

TEST(Announce, MadeUpSurfaceNamesTheOptionThatHelps) {
  const ReconstructReport known = with_made_up_surface();
  EXPECT_TRUE(says(known, "--outside open")) << warnings_of(known);
  EXPECT_FALSE(says(known, "--sensor")) << warnings_of(known);
  ReconstructReport guessed = with_estimated_directions(known);
  EXPECT_TRUE(says(guessed, "--sensor")) << warnings_of(guessed);
  EXPECT_FALSE(says(guessed, "--outside")) << warnings_of(guessed);
  // Only the border can be wrong where a scanner is known for some, where the scene was taken as seen from above, or
  // where someone has asked for the border.
  ReconstructReport scanned = guessed, from_above = guessed, asked = guessed;
  scanned.input.directions.from_sensor = 10;
  from_above.input.directions.assumed = "taken as seen from above";
  asked.params.border.outside = Border::air;
  for (const ReconstructReport& report : {scanned, from_above, asked}) {
    EXPECT_TRUE(says(report, "--outside open")) << warnings_of(report);
    EXPECT_FALSE(says(report, "--sensor")) << warnings_of(report);
  }
}

TEST(Announce, OnlyTheDefaultMethodCanBeOpen) {
  ReconstructReport report = with_made_up_surface();
  report.params.method = Method::poisson;
  EXPECT_FALSE(says(report, "--outside open")) << warnings_of(report);
  EXPECT_TRUE(says(report, "--trim auto")) << warnings_of(report);
}

/// All lines about a trimmed mesh.
std::string lines_of(const TrimReport& trim) {
  struct Lines : Progress {
    std::string all;
    void info(const std::string& line) override { all += line + "\n"; }
  } lines;
  const Context context(1, lines);
  Trace trace(context);
  announce_trim(trim, TrimParams{}, trace);
  return lines.all;
}

TEST(Announce, TrimmingSaysWhatWent) {
  TrimReport trim;
  trim.distance = 0.3;
  EXPECT_EQ(lines_of(trim), "");
  trim.removed = 2, trim.removed_area = 0.1;
  EXPECT_EQ(lines_of(trim), "trimmed: 10 % of the area, farther than 0.3 from any sample\n");
  trim.unfaced = 1, trim.filled = 1;
  EXPECT_EQ(lines_of(trim),
            "trimmed: 10 % of the area, farther than 0.3 from any sample or facing none; 1 hole stays filled "
            "(--trim-holes)\n");
  trim.shells = 2;
  EXPECT_EQ(lines_of(trim).find("2 closed parts inside out dropped\n"), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
