// Errors are for bad input; a run that merely did not converge returns a report instead.
#pragma once

#include <stdexcept>
#include <string>

namespace soapfilm {

/// A value that the caller gave is refused. The message is one line: what, its value, its constraint.
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The samples that the caller gave are refused: too few of them, not finite, without a volume or a direction, too
/// large or small for double.
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

/// Progress::cancel() was called.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace soapfilm
