#include "cli/program.h"

int main(int argc, char** argv) { return soapfilm::cli::program(argc, argv); }
