// The fields of a LAS point record, by their places in the eleven point formats.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "soapfilm/io/bytes/binary_fields.h"
#include "soapfilm/io/las/las_header.h"
#include "soapfilm/io/las/las_records.h"

namespace soapfilm::io {

struct LasFields {
  std::vector<BinaryField> all;  ///< with names; they become the cloud's columns
  BinaryField withheld;          ///< 1: to be left out
  BinaryField classification;
  BinaryField source;                     ///< the flight line, or the scanner
  std::optional<BinaryField> gps_time{};  ///< as it is stored; in `all` it counts from the file's first
};

/// Places count from the beginning of a record. `first`: the file's first record.
LasFields las_fields(std::string_view first, const LasHeader& header, const LasRecords& records);

}  // namespace soapfilm::io
