#include "soapfilm/io/e57/xml.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// At most what the document of this text takes: a node for each tag and for the text after it, and the attributes.
size_t xml_document_bytes(const std::vector<char>& text) {
  const auto tags = static_cast<size_t>(std::count(text.begin(), text.end(), '<'));
  const auto attributes = static_cast<size_t>(std::count(text.begin(), text.end(), '='));
  return text.size() + 2 * tags * 64 + attributes * 40;
}

std::string_view xml_trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

Xml::Xml(std::vector<char> text, size_t budget, std::function<std::string(size_t)> place)
    : text_(std::move(text)), place_(std::move(place)) {
  if (const size_t bytes = xml_document_bytes(text_); bytes > budget)
    throw InputError(fmt::format("{}: XML of {} bytes would take {} bytes, must be at most {} for a file of this size",
                                 place_(0), text_.size(), bytes, budget));
  const size_t size = text_.size();
  const pugi::xml_parse_result parsed =
      document_.load_buffer_inplace(text_.data(), size, pugi::parse_default, pugi::encoding_utf8);
  if (!parsed)
    throw InputError(fmt::format("{}: XML: {}", place_(std::min<size_t>(static_cast<size_t>(parsed.offset), size)),
                                 parsed.description()));
}

void Xml::fail(const pugi::xml_node& node, const std::string& message) const {
  throw InputError(place_(static_cast<size_t>(std::max<ptrdiff_t>(node.offset_debug(), 0))) + ": " + message);
}

double Xml::number(const pugi::xml_node& node) const {
  const std::string_view text = xml_trimmed(node.child_value());
  double value = 0;
  if (!text.empty() && !parse_number(text, value))
    fail(node, fmt::format("{} = {}, must be a number", local_name(node), in_quotes(text)));
  if (std::string_view(node.attribute("type").value()) == "ScaledInteger")
    value = value * number(node, "scale").value_or(1) + number(node, "offset").value_or(0);
  return value;
}

std::optional<double> Xml::number(const pugi::xml_node& node, const char* attribute) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  if (!found) return std::nullopt;
  double value = 0;
  if (!parse_number(xml_trimmed(found.value()), value))
    fail(node, fmt::format("{}: {} = {}, must be a number", local_name(node), attribute, in_quotes(found.value())));
  return value;
}

std::optional<int64_t> Xml::integer(const pugi::xml_node& node, const char* attribute) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  if (!found) return std::nullopt;
  int64_t value = 0;
  if (!parse_integer(xml_trimmed(found.value()), value))
    fail(node, fmt::format("{}: {} = {}, must be an integer of 64 bits", local_name(node), attribute,
                           in_quotes(found.value())));
  return value;
}

std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child_of(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& child : node.children())
    if (child.type() == pugi::node_element && local_name(child) == name) return child;
  return {};
}

std::string plain_text(const pugi::xml_node& node) {
  std::string text(xml_trimmed(node.child_value()));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

}  // namespace soapfilm::io
