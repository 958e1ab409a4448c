#include "soapfilm/solve/sor.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/solve/sor_pass.h"

namespace soapfilm {

namespace {

using Clock = std::chrono::steady_clock;

void require(bool holds, const char* name, double value, const char* constraint) {
  if (!holds) throw ParameterError(fmt::format("{} = {:g}, must be {}", name, value, constraint));
}

/// Whether each of the last pass's iterations changed E by no more than rounding does.
bool settled(const std::vector<double>& energy, size_t pass_begin, double tolerance) {
  if (pass_begin == 0) return false;  // E(0) = 0 shows nothing
  for (size_t k = pass_begin; k < energy.size(); ++k)
    if (std::abs(energy[k] - energy[k - 1]) > tolerance * std::abs(energy[k])) return false;
  return true;
}

}  // namespace

void validate(const SorParams& params) {
  require(params.epsilon > 0, "epsilon", params.epsilon, "> 0");
  require(params.omega > 0 && params.omega < 2, "omega", params.omega, "> 0 and < 2");
  require(params.renew_every >= 1, "renew_every", params.renew_every, ">= 1");
  require(params.levels >= 1, "levels", params.levels, ">= 1");
  require(params.tolerance >= 0, "tolerance", params.tolerance, ">= 0");
  require(params.max_iterations >= 1, "max_iterations", params.max_iterations, ">= 1");
  require(params.snap >= 0 && params.snap < 0.5, "snap", params.snap, ">= 0 and < 0.5");
}

SorLevelReport relax_sor(DenseField<float>& u, const LevelBox& box, double lambda, const SupportField& support,
                         const SorParams& params, const Context& context, const SorObserver& observe) {
  validate(params);
  SorPass pass(u, lambda, support, params, context);
  SorLevelReport report;
  report.level = box.level;
  report.bytes = pass.bytes();
  double elapsed = 0;
  while (report.iterations < params.max_iterations && !report.converged) {
    const auto start = Clock::now();
    const int iterations = std::min(params.renew_every, params.max_iterations - report.iterations);
    const size_t pass_begin = report.energy.size();
    pass.run(iterations, report.energy);
    report.iterations += iterations;
    report.converged = settled(report.energy, pass_begin, params.tolerance);
    elapsed += std::chrono::duration<double>(Clock::now() - start).count();
    report.seconds.resize(report.energy.size(), elapsed);
    if (observe) observe({box, lambda, support, u, report.iterations, elapsed});
    context.progress().advance(
        static_cast<double>(report.iterations) / params.max_iterations,
        fmt::format("level {}, {} iterations, energy {:.6g}", box.level, report.iterations, report.energy.back()));
  }
  report.energy.push_back(pass.energy());
  report.seconds.push_back(elapsed);
  return report;
}

}  // namespace soapfilm
