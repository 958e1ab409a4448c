#include "tools/compare/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/version.h"
#include "tools/mesh/json.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

constexpr int compare_version = 1;

std::string percent(double share) { return fmt::format("{:.2f} %", 100 * share); }

std::string table_row(const char* name, const Deviations& d) {
  return fmt::format("{:<18}{:>11.3e}{:>11.3e}{:>11.3e}{:>11.3e}{:>11.3e}{:>11.3e}\n", name, d.mean, d.rms,
                     d.percentile95, d.percentile99, d.lowest, d.highest);
}

std::string shares(const char* name, const CompareSubject& subject, const Deviations& d) {
  const double t = subject.options.tolerance;
  return fmt::format("{:<18} {} within +-{:g}{}, {} above, {} below\n", name, percent(d.within), t,
                     subject.unit.empty() ? "" : " " + subject.unit, percent(d.above), percent(d.below));
}

std::string histogram(const Deviations& d) {
  constexpr double longest_bar = 50;
  const auto most = static_cast<double>(*std::max_element(d.histogram.begin(), d.histogram.end()));
  const double width = 2 * d.histogram_end / static_cast<double>(d.histogram.size());
  std::string text;
  for (size_t k = 0; k < d.histogram.size(); ++k) {
    const double low = -d.histogram_end + width * static_cast<double>(k);
    const bool first = k == 0, last = k + 1 == d.histogram.size();
    const std::string range = first  ? fmt::format("below {:+.3g}", low + width)
                              : last ? fmt::format("above {:+.3g}", low)
                                     : fmt::format("{:+.3g} to {:+.3g}", low, low + width);
    const double share = static_cast<double>(d.histogram[k]) / static_cast<double>(d.points);
    const auto bar = static_cast<size_t>(std::lround(longest_bar * static_cast<double>(d.histogram[k]) / most));
    text += fmt::format("{:>24} {:>8}  {}\n", range, percent(share), std::string(bar, '#'));
  }
  return text;
}

std::string alignment_lines(const CompareSubject& subject, const Alignment& a) {
  std::string text = fmt::format("{:<18} turned by {:.4g} degrees; median distance {:.3g} before, {:.3g} after\n",
                                 "aligned", a.motion.angle_deg(), a.median_before, a.median_after);
  if (a.free_directions > 0)
    text += fmt::format("{:<18} {} of 6 directions are free: {} slides on the model there, and stays as it was\n", "",
                        a.free_directions, subject.is_scan ? "the scan" : "the mesh");
  return text;
}

ordered_json deviations_json(const Deviations& d, bool tolerance) {
  ordered_json json = {{"points", d.points},
                       {"mean", d.mean},
                       {"rms", d.rms},
                       {"percentile95", d.percentile95},
                       {"percentile99", d.percentile99},
                       {"lowest", d.lowest},
                       {"highest", d.highest}};
  for (const auto& [name, share] : {std::pair("within", d.within), {"above", d.above}, {"below", d.below}})
    json[name] = tolerance ? ordered_json(share) : ordered_json(nullptr);
  json["histogram"] = {{"from", -d.histogram_end}, {"to", d.histogram_end}, {"counts", d.histogram}};
  return json;
}

ordered_json alignment_json(const Alignment& a) {
  ordered_json matrix = ordered_json::array();
  for (size_t row = 0; row < 3; ++row)
    matrix.push_back(
        {a.motion.rows[row].x, a.motion.rows[row].y, a.motion.rows[row].z, a.motion.shift[static_cast<int>(row)]});
  matrix.push_back({0, 0, 0, 1});
  return {{"matrix", matrix},
          {"angle_deg", a.motion.angle_deg()},
          {"iterations", a.iterations},
          {"converged", a.converged},
          {"free_directions", a.free_directions},
          {"median_before", a.median_before},
          {"median_after", a.median_after}};
}

}  // namespace

std::string compare_table(const CompareSubject& subject, const Comparison& c) {
  const char* there = subject.is_scan ? "scan to model" : "mesh to model";
  const char* back = "model to mesh";
  std::string text;
  if (c.alignment) text += alignment_lines(subject, *c.alignment);
  text += fmt::format("{:<18}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "signed distances", "mean", "rms", "95 %", "99 %",
                      "lowest", "highest");
  text += table_row(there, c.part_to_model);
  if (c.model_to_part) text += table_row(back, *c.model_to_part);
  text += fmt::format("{}, positive where there is more than in the model\n{}", there, histogram(c.part_to_model));
  if (!c.within_tolerance) return text;
  text += shares(there, subject, c.part_to_model);
  if (c.model_to_part) text += shares(back, subject, *c.model_to_part);
  text +=
      fmt::format("{:<18} {}: at least {} must be\n", "verdict",
                  *c.within_tolerance ? "within tolerance" : "NOT within tolerance", percent(subject.options.least));
  return text;
}

ordered_json compare_json(const CompareSubject& subject, const Comparison& c) {
  const bool tolerance = subject.options.tolerance > 0;
  return {{"format", "soapfilm comparison"},
          {"compare_version", compare_version},
          {"soapfilm", version},
          {"part", subject.part},
          {"model", subject.model},
          {"unit", subject.unit.empty() ? ordered_json(nullptr) : ordered_json(subject.unit)},
          {"tolerance", tolerance ? ordered_json(subject.options.tolerance) : ordered_json(nullptr)},
          {"least", tolerance ? ordered_json(subject.options.least) : ordered_json(nullptr)},
          {"within_tolerance", or_null(c.within_tolerance)},
          {"part_to_model", deviations_json(c.part_to_model, tolerance)},
          {"model_to_part", c.model_to_part ? deviations_json(*c.model_to_part, tolerance) : ordered_json(nullptr)},
          {"alignment", c.alignment ? alignment_json(*c.alignment) : ordered_json(nullptr)}};
}

}  // namespace soapfilm
