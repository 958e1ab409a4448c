// The page made by viewer/build.mjs, and how it is filled.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::view_detail {

/// Of the build; empty if it has no viewer.
std::string_view built_page();

/// Arrays as base64, each in an element of its own with the id "data0", "data1", ...
using Arrays = std::vector<std::string>;

/// The page with title, scene and arrays in their places. Whatever names and reports contain, it stays data: no text
/// can end its element. Throws std::logic_error if the page lacks a place.
std::string fill_page(std::string_view page, const std::string& title, const nlohmann::ordered_json& scene,
                      const Arrays& arrays);

/// With the replacement character for bytes that are not UTF-8, and '?' for control characters.
std::string clean_text(const std::string& text);

}  // namespace soapfilm::view_detail
