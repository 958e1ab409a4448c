// Parameters that the chosen method does not have are refused; those of all methods survive JSON.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Contradiction {
  std::string name;
  Method method;
  void (*set)(ReconstructParams&);
  std::string message;
};
void PrintTo(const Contradiction& c, std::ostream* out) { *out << c.message; }

class Contradictory : public testing::TestWithParam<Contradiction> {};

TEST_P(Contradictory, ParametersAreRefusedInOneLine) {
  ReconstructParams params;
  params.method = GetParam().method;
  GetParam().set(params);
  std::string message;
  try {
    reconstruct(sampled("sphere", 40, 0.5), params, Context(1));
  } catch (const ParameterError& error) {
    message = error.what();
  }
  EXPECT_EQ(message, GetParam().message);
}

using P = ReconstructParams;
void choose_lambda_automatically(P& p) { p.energy.cross_validate = true; }
void measure_along_the_axes(P& p) { p.energy.norm = Norm::anisotropic; }
void set_isovalue(P& p) { p.surface.isovalue = 0.4; }
void set_threshold(P& p) { p.surface.threshold = 0.25; }

INSTANTIATE_TEST_SUITE_P(
    Methods, Contradictory,
    testing::Values(
        Contradiction{"lambda_twice", Method::tv,
                      [](P& p) {
                        p.energy.cross_validate = true;
                        p.energy.lambda = 0.01;
                      },
                      "lambda = 0.01 and cross_validate: only one of them may be given"},
        Contradiction{"auto_poisson", Method::poisson, choose_lambda_automatically,
                      "lambda = auto: the surface of method poisson does not depend on lambda"},
        Contradiction{"auto_vrip", Method::vrip, choose_lambda_automatically,
                      "lambda = auto: the surface of method vrip does not depend on lambda"},
        Contradiction{"norm_sor", Method::tv_sor, measure_along_the_axes, "norm = anisotropic: method tv-sor has none"},
        Contradiction{"norm_poisson", Method::poisson, measure_along_the_axes,
                      "norm = anisotropic: method poisson has none"},
        Contradiction{"norm_vrip", Method::vrip, measure_along_the_axes, "norm = anisotropic: method vrip has none"},
        Contradiction{"isovalue_poisson", Method::poisson, set_isovalue,
                      "isovalue = 0.4: method poisson finds its own"},
        Contradiction{"isovalue_vrip", Method::vrip, set_isovalue, "isovalue = 0.4: method vrip finds its own"},
        Contradiction{"refine_poisson", Method::poisson, [](P& p) { p.surface.refine = true; },
                      "refine = on: method poisson finds its own surface"},
        Contradiction{"refine_isovalue", Method::tv,
                      [](P& p) {
                        p.surface.refine = true;
                        p.surface.isovalue = 0.4;
                      },
                      "isovalue = 0.4 and refine = on: only one of them may be given"},
        Contradiction{"smoothing_unrefined", Method::tv_sor, [](P& p) { p.refine.smoothing = 0.1; },
                      "smoothing = 0.1: the surface is not refined"},
        Contradiction{"components_poisson", Method::poisson, [](P& p) { p.surface.drop_components = true; },
                      "drop_components = on: method poisson finds its own surface"},
        Contradiction{"support_kept", Method::tv,
                      [](P& p) {
                        p.surface.drop_components = false;
                        p.components.min_support = 0.5;
                      },
                      "min_support = 0.5: components are kept (drop_components = off)"},
        Contradiction{"threshold_cut", Method::graph_cut_6, set_threshold,
                      "threshold = 0.25: method graph-cut-6 has none"},
        Contradiction{"threshold_poisson", Method::poisson, set_threshold,
                      "threshold = 0.25: method poisson has none"}),
    [](const auto& c) { return c.param.name; });

TEST(MethodParams, SurviveJson) {
  ReconstructParams params;
  params.method = Method::tv_sor;
  params.sor.order = SorOrder::red_black;
  params.sor.gradient = SorGradient::forward;
  params.sor.levels = 2;
  params.poisson.max_iterations = 9;
  params.graph_cut.weights = LinkWeights::cauchy_crofton;
  params.vrip.front = 3.5;
  params.vrip.surface.taper = 2;
  params.cross_validation.source = FoldSource::scans;
  params.cross_validation.candidates = {0.5, 1};
  const std::string text = to_json(params);
  const ReconstructParams back = params_from_json(text);
  EXPECT_EQ(to_json(back), text);
  EXPECT_EQ(back.method, Method::tv_sor);
  EXPECT_EQ(back.sor.order, SorOrder::red_black);
  EXPECT_EQ(back.sor.gradient, SorGradient::forward);
  EXPECT_EQ(back.graph_cut.weights, LinkWeights::cauchy_crofton);
  EXPECT_EQ(back.vrip.front, 3.5);
  EXPECT_EQ(back.cross_validation.source, FoldSource::scans);
  EXPECT_EQ(back.cross_validation.candidates, (std::vector<double>{0.5, 1}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
