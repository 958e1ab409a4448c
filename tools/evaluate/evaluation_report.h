// An evaluation as a table for people and as JSON for programs (docs/reference/evaluate.md lists the keys).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/evaluate/evaluate.h"

namespace soapfilm {

/// The subject of an evaluation.
struct EvaluationSubject {
  std::string mesh;              ///< file
  nlohmann::ordered_json truth;  ///< facts of the shape or the mesh file
  std::string samples;           ///< file; empty: none
  double voxel = 0;              ///< input units; 0: none
  EvaluationOptions options;
};

std::string evaluation_table(const EvaluationSubject& subject, const Evaluation& evaluation);
nlohmann::ordered_json evaluation_json(const EvaluationSubject& subject, const Evaluation& evaluation);

}  // namespace soapfilm
