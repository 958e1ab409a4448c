// How far a remeshed surface and the original are from each other: a bound that is proved, both ways.
#pragma once

#include <memory>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/remesh/working_mesh.h"

namespace soapfilm {

struct ProvedDistance {
  double distance = 0;           ///< input units, rounding of coordinates included; infinite: none was found
  std::vector<uint32_t> beyond;  ///< vertices of the new mesh, where more than the tolerance is needed; ascending
};

class DistanceProof {
 public:
  /// `tolerance`: input units. Distances up to a few times it are looked for.
  DistanceProof(const Mesh& original, double tolerance);
  ~DistanceProof();

  ProvedDistance of(const WorkingMesh& now, const Context& context) const;

 private:
  struct Surface;

  const Mesh& given_;
  double tolerance_;
  std::unique_ptr<Surface> original_;
};

}  // namespace soapfilm
