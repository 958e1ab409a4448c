// Everything that a reconstruction can be told, one struct per stage; every default is written here or beside the stage
// it belongs to, and nowhere else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "soapfilm/border/border.h"
#include "soapfilm/extract/bend.h"
#include "soapfilm/finish/islands.h"
#include "soapfilm/finish/trim.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/lambda/choose.h"
#include "soapfilm/lambda/cross_validation.h"
#include "soapfilm/method.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/place/place.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/norm.h"
#include "soapfilm/solve/poisson.h"
#include "soapfilm/solve/primal_dual.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

/// From the relaxed indicator to the surface (section 4.4).
struct SurfaceParams {
  double threshold = 0.5;            ///< mu, in (0, 1)
  std::optional<bool> refine;        ///< move the level set onto the samples; without it: by Method::tv alone
  std::optional<bool> drop_islands;  ///< drop parts that few samples support; without it: where the surface is refined
  std::optional<double>
      isovalue;           ///< unrefined: of the smoothed indicator, in (0, 1); without it: its mean at the samples
  BendParams bend;        ///< refined, noise under 0.1 voxel: where edges are split
  bool distance = false;  ///< the mesh's vertices get the attribute "distance": to the nearest sample, input units
};

struct ReconstructParams {
  Method method = Method::tv;
  OrientParams orient;
  PlaceParams place;
  EnergyParams energy;
  BorderParams border;  ///< open: Method::tv alone; automatic: others take air
  CrossValidationParams select;
  PrimalDualParams solve;    ///< Method::tv
  SorParams sor;             ///< Method::tv_sor
  PoissonParams poisson;     ///< Method::poisson
  GraphCutParams graph_cut;  ///< Method::graph_cut_6 and _26, which set its neighbours; norm is energy.norm
  VripParams vrip;           ///< Method::vrip
  SurfaceParams surface;
  IslandParams islands;  ///< where drops_islands()
  RefineParams refine;
  TrimParams trim;                     ///< all but Method::vrip, whose surface ends where nothing was seen
  std::optional<size_t> memory_limit;  ///< bytes; without it: what the machine has free
  bool checked = false;                ///< check_result() follows: the plan has its memory, too
};

/// Is the surface moved onto the samples (refine/refine.h), or is it the paper's?
inline bool refines(const ReconstructParams& params) {
  return params.surface.refine.value_or(params.method == Method::tv && !params.surface.isovalue);
}

/// Are parts that few samples support dropped (finish/islands.h)? The paper's surface keeps them.
inline bool drops_islands(const ReconstructParams& params) {
  return params.surface.drop_islands.value_or(refines(params));
}

/// Is surface taken away that no sample is near (finish/trim.h)? `border` is the one that was chosen.
inline bool trims(const ReconstructParams& params, Border border) {
  return params.method != Method::vrip && params.trim.on.value_or(params.trim.distance || border == Border::open);
}

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const ReconstructParams& params);

/// All parameters by name, but for refine.robust, which measurement fixed, refine.vanish, which drops_islands()
/// decides, and orient.from_within, which border.outside says; absent ones as null.
std::string to_json(const ReconstructParams& params);
/// The inverse, also of a whole report (to_json() of report.h); a key that is absent keeps its default. Throws
/// ParameterError for text that is not JSON, an unknown key, a value of the wrong type or out of range.
ReconstructParams params_from_json(const std::string& text);

}  // namespace soapfilm
