// XML as the readers of E57 files and MeshLab projects need it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// A parsed document. Elements are compared by their names without a namespace's prefix.
class Xml {
 public:
  /// `place` says where an offset into the text is, such as "file.mlp:3"; it begins the messages. `budget`: bytes that
  /// the document may take. Throws InputError for text that is not well-formed, or would take more.
  Xml(std::vector<char> text, size_t budget, std::function<std::string(size_t offset)> place);

  pugi::xml_node root() const { return document_.document_element(); }
  /// Throws InputError "place: message".
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const;

  /// The number in the element: 0 if it is empty, scaled where the element is a ScaledInteger. Throws InputError.
  double number(const pugi::xml_node& node) const;
  /// Null if the attribute is missing. Throws InputError for one that is not a number or integer.
  std::optional<double> number(const pugi::xml_node& node, const char* attribute) const;
  std::optional<int64_t> integer(const pugi::xml_node& node, const char* attribute) const;

 private:
  std::vector<char> text_;
  std::function<std::string(size_t)> place_;
  pugi::xml_document document_;
};

std::string_view local_name(const pugi::xml_node& node);
/// The first child of this name; null if there is none.
pugi::xml_node child_of(const pugi::xml_node& node, std::string_view name);
/// The text in the element, without blanks around it and without control characters.
std::string plain_text(const pugi::xml_node& node);

}  // namespace soapfilm::io
