// Standard input and output in the place of files: the name "-".
#pragma once

#include <string>
#include <vector>

#include "soapfilm/context.h"

namespace soapfilm::cli {

/// Readers map files and output is whole or not at all: what comes and goes by a pipe is a file in a temporary folder
/// meanwhile. The folder goes with the object.
class StandardStreams {
 public:
  /// `formats` names them by extensions: such as "xyz", or "xyz,ply" for input and output. The
  /// temporary folder is in the context's.
  StandardStreams(const std::string& formats, const Context& context);
  ~StandardStreams();
  StandardStreams(const StandardStreams&) = delete;
  StandardStreams& operator=(const StandardStreams&) = delete;

  /// Where a name is "-", reads standard input to its end; the file with it takes its place. Without a format it is
  /// recognized by how it begins, or is text. Throws ParameterError for a second "-", InputError where it is empty.
  void take_input(std::vector<std::string>& inputs);
  /// Replaces "-" by the file to write; without a format, PLY.
  void take_output(std::string& output);
  /// Whether the mesh goes to standard output.
  bool gives_output() const { return !output_.empty(); }
  /// Copies the file that was written to standard output. Throws OutputError.
  void give_output() const;

 private:
  std::string in_folder(const std::string& name);

  const Context& context_;
  std::string input_format_, output_format_, folder_, output_;
};

/// Text with the names of such files as people know them.
std::string with_known_names(std::string text);

}  // namespace soapfilm::cli
