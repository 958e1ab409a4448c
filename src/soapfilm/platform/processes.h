// Processes that are started together, and programs that go on as others.
#pragma once

#include <string>

namespace soapfilm {

/// How many processes Open MPI's mpirun has started as one run; 1 where it has not started this one.
int processes_of_mpirun();

/// Goes on as the program of this name beside this one, with these arguments, a null at their end. Returns only where
/// there is none.
void become_program(const std::string& name, char** arguments);

}  // namespace soapfilm
