// Values as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "soapfilm/core/vec.h"

namespace soapfilm {

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json json_of(const Vec3d& v) { return {v.x, v.y, v.z}; }
inline nlohmann::ordered_json json_of(const Box3d& box) { return {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}}; }

}  // namespace soapfilm
