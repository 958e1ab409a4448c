// The plane of the samples of a cell and of the 26 cells around it, with their area and sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/orient/sample_cells.h"
#include "soapfilm/orient/sides.h"

namespace soapfilm {

/// For the samples of one facet.
struct FacetPlane {
  Vec3f normal{};
  float area = 0;     ///< cells^2 for each sample
  float spacing = 0;  ///< cells
  bool filled = false;
  bool found = false;
  bool found_far = false;  ///< flat enough for cells larger than the first filled ones, too
  double thick = 1;        ///< thickness: least over middle variance
  double agreement = 0;    ///< length of the mean direction around: small for outliers, whose directions differ
  double outward = 0;  ///< mean cosine between directions and the way from the middle: 0 for outliers, about 1 around a
                       ///< rod or an edge
  bool one_sided = false;  ///< directions around are on one side of the plane, however much they differ
  LocalSides sides;

  bool agrees() const;
  /// Whether it confirms what was found in cells half as large: at least as flat and with directions as equal as for
  /// two faces of a box that meet, its normal at most halfway between theirs.
  bool confirms(Vec3f normal_before) const;
  bool confirms_edge() const;
};

/// The facets around one, relative to the center of its cell.
struct FacetsAround {
  std::array<Vec3f, 54> mean;
  std::array<const Facet*, 54> facet;
  std::array<int8_t, 54> slot;
  size_t count = 0;
};

FacetsAround measure_surroundings(const SampleCells& cells, size_t cell);

/// `own`: a facet of the cell in the middle.
FacetPlane plane_of(const FacetsAround& around, const Facet& own);

}  // namespace soapfilm
