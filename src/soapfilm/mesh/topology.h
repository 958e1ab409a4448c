// The report of include/soapfilm/mesh.h as text.
#pragma once

#include <string>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// One line for people: "closed, manifold, 1 component, genus 0", or what is wrong with it.
std::string summary(const TopologyReport& report);

}  // namespace soapfilm
