#include "tools/view/page.h"

#include <fmt/format.h>

#include <stdexcept>

#include "soapfilm/core/printable.h"

namespace soapfilm::view_detail {

namespace {

using nlohmann::ordered_json;

std::string dump(const ordered_json& json) { return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace); }

std::string html_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else
      escaped += c;
  }
  return escaped;
}

/// JSON in which no "<" is left: neither "</script>" nor "<!--" can mean anything to the browser.
std::string script_json(const ordered_json& json) {
  std::string escaped;
  const std::string text = dump(json);
  escaped.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      escaped += "\\u003c";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace

#ifndef SOAPFILM_VIEWER
std::string_view built_page() { return {}; }
#endif

std::string clean_text(const std::string& text) {
  return ordered_json::parse(dump(printable(text))).get<std::string>();
}

std::string fill_page(std::string_view page, const std::string& title, const ordered_json& scene,
                      const Arrays& arrays) {
  const std::string heading = html_text(title);
  const std::string json = script_json(scene);
  size_t size = page.size() + heading.size() + json.size();
  for (const std::string& array : arrays) size += array.size() + 64;
  std::string out;
  out.reserve(size);

  const auto copy_until = [&](std::string_view place) {
    const size_t at = page.find(place);
    if (at == std::string_view::npos) throw std::logic_error(fmt::format("the viewer's page lacks {}", place));
    out += page.substr(0, at);
    page.remove_prefix(at + place.size());
  };
  copy_until("<!--soapfilm:title-->");
  out += heading;
  copy_until("<!--soapfilm:scene-->");
  out += json;
  copy_until("<!--soapfilm:data-->");
  for (size_t i = 0; i < arrays.size(); ++i) {
    out += fmt::format("<script type=\"text/plain\" id=\"data{}\">", i);
    out += arrays[i];
    out += "</script>\n";
  }
  out += page;
  return out;
}

}  // namespace soapfilm::view_detail
