#include "soapfilm/device/device.h"

namespace soapfilm {

bool Device::divergence(const GridSamples&, SupportField&, const Context&) const { return false; }
bool Device::restrict_data(const SupportField&, SupportField&, const Context&) const { return false; }
std::shared_ptr<LevelSolver> Device::on(Level&, const Context&) const { return nullptr; }
bool Device::prolong_state(const Level&, const Level*, Level&, const Context&) const { return false; }
std::shared_ptr<BandSolver> Device::on(const NarrowBand&, const AlignedArray<float>&, const Context&) const {
  return nullptr;
}

}  // namespace soapfilm
