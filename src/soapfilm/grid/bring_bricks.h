// Values on bricks that ranks found together.
#pragma once

#include "soapfilm/core/share.h"
#include "soapfilm/grid/field.h"

namespace soapfilm {

/// Each rank has found the values on its part of the bricks (even_parts): brings each those of all.
template <class T, int components>
void bring_bricks(Field<T, components>& field, const Context& context) {
  if (field.bricks() == 0) return;
  bring_items(field.bricks(), {field.brick(0), field.values_per_brick * sizeof(T)}, context,
              [](size_t b) { return b; });
}

}  // namespace soapfilm
