// The state of a run between stages as bytes of a file, for the same program only: values as they are in memory.
#pragma once

#include <cstdint>
#include <istream>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/orient/find_directions.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/run/surface.h"

namespace soapfilm {

template <class T>
void put(std::ostream& to, const T* values, size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  to.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}
template <class T>
void put(std::ostream& to, const T& value) {
  put(to, &value, 1);
}
template <class T>
void put(std::ostream& to, const std::vector<T>& values) {
  put(to, uint64_t{values.size()});
  put(to, values.data(), values.size());
}

template <class T>
void get(std::istream& from, T* values, size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  from.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}
template <class T>
void get(std::istream& from, T& value) {
  get(from, &value, 1);
}
template <class T>
void get(std::istream& from, std::vector<T>& values) {
  uint64_t count = 0;
  get(from, count);
  values.resize(static_cast<size_t>(count));
  get(from, values.data(), values.size());
}

void put_directions(std::ostream& to, const Orientation& found);
Orientation get_directions(std::istream& from);

/// A level of the pyramid without its data, and its report. Of a level in slabs what this rank has.
void put_level(std::ostream& to, const Level& level, const LevelReport& report);
Level get_level(std::istream& from, const MakeLevel& make, LevelReport& report, const Context& context);

void put_surface(std::ostream& to, const Surface& surface);
Surface get_surface(std::istream& from, const Context& context);

}  // namespace soapfilm
