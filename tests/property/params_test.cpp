#include "soapfilm/params.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

struct Refusal {
  std::string name;
  std::function<void(ReconstructParams&)> set;
  std::string value;
  std::string constraint;
};
void PrintTo(const Refusal& r, std::ostream* out) { *out << r.name << " = " << r.value; }

class Params : public testing::TestWithParam<Refusal> {};

/// Refused with its name, its value and its constraint, in one line.
TEST_P(Params, OutOfRangeIsRefused) {
  const Refusal& refusal = GetParam();
  ReconstructParams params;
  refusal.set(params);
  const std::string message = message_of([&] { validate(params); });
  EXPECT_EQ(message, refusal.name + " = " + refusal.value + ", must be " + refusal.constraint);
}

using P = ReconstructParams;
INSTANTIATE_TEST_SUITE_P(
    Values, Params,
    testing::Values(Refusal{"neighbors", [](P& p) { p.orient.neighbors = 2; }, "2", "in [3, 1000]"},
                    Refusal{"radius", [](P& p) { p.orient.radius = 0; }, "0", "> 0"},
                    Refusal{"voxel", [](P& p) { p.place.voxel = 0; }, "0", "> 0"},
                    Refusal{"voxel", [](P& p) { p.place.voxel = nan; }, "nan", "> 0"},
                    Refusal{"samples_per_voxel2", [](P& p) { p.place.samples_per_voxel2 = -2; }, "-2", "> 0"},
                    Refusal{"padding", [](P& p) { p.place.padding = 1; }, "1", ">= 2 and <= 4096"},
                    Refusal{"padding", [](P& p) { p.place.padding = 5000; }, "5000", ">= 2 and <= 4096"},
                    Refusal{"lambda", [](P& p) { p.energy.lambda = -0.01; }, "-0.01", "> 0 and <= 1e24"},
                    Refusal{"lambda", [](P& p) { p.energy.lambda = 1e30; }, "1e+30", "> 0 and <= 1e24"},
                    Refusal{"lambda_per_density", [](P& p) { p.energy.lambda_per_density = 0; }, "0",
                            "> 0 and <= 1e24"},
                    Refusal{"tolerance", [](P& p) { p.solve.tolerance = 0; }, "0", "> 0"},
                    Refusal{"max_iterations", [](P& p) { p.solve.max_iterations = 0; }, "0", ">= 1"},
                    Refusal{"check_every", [](P& p) { p.solve.check_every = -1; }, "-1", ">= 1 and <= 1000"},
                    Refusal{"step_balance", [](P& p) { p.solve.step_balance = nan; }, "nan", "> 0"},
                    Refusal{"min_support", [](P& p) { p.components.min_support = -1; }, "-1", ">= 0"},
                    Refusal{"threshold", [](P& p) { p.surface.threshold = 1; }, "1", "> 0 and < 1"},
                    Refusal{"threshold", [](P& p) { p.surface.threshold = 0; }, "0", "> 0 and < 1"},
                    Refusal{"isovalue", [](P& p) { p.surface.isovalue = 1.5; }, "1.5", "> 0 and < 1"}),
    [](const auto& r) { return r.param.name + std::to_string(r.index); });

TEST(ParamsJson, VoxelAndResolutionExcludeEachOther) {
  ReconstructParams params;
  params.place.voxel = 0.5;
  params.place.resolution = 100;
  EXPECT_NE(message_of([&] { validate(params); }).find("only one of them"), std::string::npos);
}

TEST(ParamsJson, DefaultsAreValid) { EXPECT_NO_THROW(validate(ReconstructParams{})); }

TEST(ParamsJson, JsonGivesThemBack) {
  ReconstructParams params;
  params.orient.source = DirectionSource::sensor;
  params.orient.sensor = Vec3d{1.25, -2, 3e6};
  params.place.resolution = 300;
  params.place.padding = 8;
  params.energy.lambda = 0.1;
  params.trim = {.on = true, .distance = 0.3, .holes = true};
  params.solve.tolerance = 1e-5;
  params.solve.max_iterations = 77;
  params.surface.isovalue = 0.45;
  params.surface.drop_components = true;
  params.components.few_samples = 9;
  params.components.sparse_support = 0.03;
  params.refine.sparse = 0.25;
  const std::string json = to_json(params);
  const ReconstructParams back = params_from_json(json);
  EXPECT_EQ(to_json(back), json);
  EXPECT_EQ(back.orient.source, DirectionSource::sensor);
  EXPECT_EQ(back.orient.sensor, params.orient.sensor);
  EXPECT_EQ(back.place.resolution, 300);
  EXPECT_FALSE(back.place.voxel.has_value());
  EXPECT_EQ(back.energy.lambda, 0.1);
  EXPECT_EQ(back.surface.drop_components, true);
  EXPECT_EQ(back.components.few_samples, 9);
  EXPECT_EQ(back.components.sparse_support, 0.03);
  EXPECT_EQ(back.refine.sparse, 0.25);
}

TEST(ParamsJson, AbsentKeysKeepTheirDefaults) {
  EXPECT_EQ(to_json(params_from_json("{}")), to_json(ReconstructParams{}));
  ReconstructParams params;
  params.solve.tolerance = 0.5;
  EXPECT_EQ(to_json(params_from_json(R"({"solve": {"tolerance": 0.5}})")), to_json(params));
}

/// It was a parameter once, and is in reports of that time.
TEST(ParamsJson, TheMemoryLimitOfAnEarlierReportIsPassedOver) {
  for (const char* text : {R"({"parameters": {"memory": {"limit": 5, "checked": true}}})",
                           R"({"memory": {"limit": null, "checked": true}})"})
    EXPECT_TRUE(params_from_json(text).checked) << text;
  EXPECT_EQ(to_json(ReconstructParams{}).find("limit"), std::string::npos);
}

TEST(ParamsJson, WrongJsonIsRefusedByName) {
  const auto message = [](const char* text) { return message_of([&] { params_from_json(text); }); };
  EXPECT_EQ(message(R"({"solver": {}})"), "parameters: unknown key 'solver'");
  EXPECT_EQ(message(R"({"solve": {"tolerence": 1}})"), "parameters: unknown key 'solve.tolerence'");
  EXPECT_EQ(message(R"({"solve": 3})"), "parameters: 'solve' must be an object");
  EXPECT_EQ(message("[]"), "parameters: must be a JSON object");
  EXPECT_NE(message("{").find("not JSON"), std::string::npos);
  EXPECT_EQ(message(R"({"solve": {"tolerance": "fast"}})"), "parameters: solve.tolerance = \"fast\": must be a number");
  EXPECT_EQ(message(R"({"solve": {"tolerance": true}})"), "parameters: solve.tolerance = true: must be a number");
  EXPECT_EQ(message(R"({"solve": {"max_iterations": 1.5}})"),
            "parameters: solve.max_iterations = 1.5: must be a whole number");
  EXPECT_EQ(message(R"({"solve": {"max_iterations": 5000000000}})"),
            "parameters: solve.max_iterations = 5000000000: must be a whole number");
  EXPECT_EQ(message(R"({"memory": {"limit": 5}})"),
            "parameters: memory.limit = 5: is no parameter, must be set on the context (--memory)");
  EXPECT_EQ(message(R"({"orient": {"sensor": [1, 2]}})"), "parameters: orient.sensor = [1,2]: must be three numbers");
  EXPECT_NE(message(R"({"orient": {"directions": "up"}})").find("must be one of auto, normals"), std::string::npos);
  EXPECT_EQ(message(R"({"solve": {"tolerance": -1}})"), "tolerance = -1, must be > 0");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
