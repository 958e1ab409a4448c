// Small clouds of every nasty kind, as files, and options for the program: each case follows from its number alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace soapfilm::test {

struct DegenerateCase {
  uint64_t number = 0;
  std::string input;                 ///< name of the file of samples
  std::string bytes;                 ///< what is in it
  std::string output;                ///< name of the mesh
  std::vector<std::string> options;  ///< of soapfilm reconstruct, without files
  bool may_end = false;              ///< the surface may have a border
  bool ascii = false;
};

DegenerateCase degenerate_case(uint64_t number);

}  // namespace soapfilm::test
