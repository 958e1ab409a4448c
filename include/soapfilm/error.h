// Errors are for bad input; a run that only did not converge returns a report instead.
#pragma once

#include <stdexcept>
#include <string>

#include "soapfilm/export.h"

namespace SOAPFILM_API soapfilm {

/// A value that the caller gave is refused. The message is one line: what, its value, its constraint.
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The samples that the caller gave are refused: too few, not finite, without volume or direction, too large or small.
struct SamplesError : ParameterError {
  using ParameterError::ParameterError;
};
/// An input file or its contents are refused. The message is one line: file, place (line or byte), value, constraint.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// An output could not be written.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The run would not fit into memory; nothing was allocated. The message names the resolution that fits.
struct MemoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The optimum is the empty surface: a result, not a fault of the input. The message names lambda and the largest
/// lambda that keeps a surface.
struct EmptyResult : std::runtime_error {
  EmptyResult(const std::string& message, double largest) : std::runtime_error(message), largest_lambda(largest) {}
  double largest_lambda;  ///< that keeps a surface; 0 when there is none
};
/// Progress::cancel() was called.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace soapfilm
