#include "soapfilm/io/meshes/glb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr uint32_t glb_json = 0x4E4F534A, glb_binary = 0x004E4942;
size_t component_bytes(int component) {
  switch (component) {
    case GltfArray::int8:
    case GltfArray::uint8:
      return 1;
    case GltfArray::int16:
    case GltfArray::uint16:
      return 2;
    case GltfArray::uint32:
    case GltfArray::float32:
      return 4;
    default:
      return 0;
  }
}

size_t parts_of_type(std::string_view type) {
  constexpr std::array<std::string_view, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::find(types.begin(), types.end(), type);
  return found == types.end() ? 0 : static_cast<size_t>(found - types.begin()) + 1;
}

}  // namespace

double GltfArray::value(size_t element, size_t part) const {
  const char* from = at + element * stride + part * component_bytes(component);
  const auto scaled = [&](double number, double most) { return normalized ? std::max(number / most, -1.0) : number; };
  switch (component) {
    case int8:
      return scaled(load_little<int8_t>(from), 127);
    case uint8:
      return scaled(load_little<uint8_t>(from), 255);
    case int16:
      return scaled(load_little<int16_t>(from), 32767);
    case uint16:
      return scaled(load_little<uint16_t>(from), 65535);
    case uint32:
      return load_little<uint32_t>(from);
    default:
      return static_cast<double>(load_little<float>(from));
  }
}

GlbFile::GlbFile(ByteSource& source) : source_(source) {
  constexpr size_t most_json = size_t{64} << 20;
  ByteCursor cursor(source);
  cursor.skip(4);  // "glTF"
  if (const auto version = cursor.read<uint32_t>(); version != 2)
    fail(fmt::format("byte 4: glTF version {}, must be 2", version));
  const auto length = cursor.read<uint32_t>();
  if (length > source.bytes().size())
    fail(fmt::format("byte 8: length = {}, but the file is truncated: it has {} bytes", length, source.bytes().size()));
  std::string_view json;
  while (cursor.offset() + 8 <= length) {
    const size_t begin = cursor.offset();
    const auto bytes = cursor.read<uint32_t>();
    const auto kind = cursor.read<uint32_t>();
    if (bytes > length - cursor.offset())
      fail(fmt::format("byte {}: chunk of {} bytes, must be at most {}", begin, bytes, length - cursor.offset()));
    const std::string_view chunk(cursor.take(bytes), bytes);
    if (kind == glb_json && json.empty()) json = chunk;
    if (kind == glb_binary && binary_.empty()) binary_ = chunk;
  }
  if (json.size() > most_json) fail(fmt::format("JSON of {} bytes, must be at most {}", json.size(), most_json));
  head_ = nlohmann::json::parse(json, nullptr, false);
  if (!head_.is_object()) fail("its JSON part is broken, must be an object");
  refuse_extensions();
}

void GlbFile::fail(const std::string& what) const { throw InputError(source_.path() + ": " + what); }

/// What codes the arrays in a way that is not read here.
void GlbFile::refuse_extensions() const {
  constexpr std::string_view not_read[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                           "KHR_meshopt_compression", "EXT_mesh_gpu_instancing"};
  for (const char* list : {"extensionsRequired", "extensionsUsed"})
    for (size_t i = 0; i < count(list); ++i) {
      const nlohmann::json& name = head_[list][i];
      for (const std::string_view other : not_read)
        if (name == other)
          fail(fmt::format("extension {}, must be none that codes the arrays: save without compression",
                           in_quotes(other)));
    }
}

size_t GlbFile::count(const char* name) const {
  const auto found = head_.find(name);
  return found != head_.end() && found->is_array() ? found->size() : 0;
}

const nlohmann::json& GlbFile::element(const char* name, uint64_t index) const {
  if (index >= count(name)) fail(fmt::format("{}: index {}, must be below {}", name, index, count(name)));
  const nlohmann::json& one = head_[name][index];
  if (!one.is_object()) fail(fmt::format("{}[{}] must be an object", name, index));
  return one;
}

uint64_t GlbFile::number(const nlohmann::json& object, const char* name, uint64_t otherwise) const {
  constexpr uint64_t most = uint64_t{1} << 53;
  const auto found = object.find(name);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<uint64_t>() > most)
    fail(fmt::format(
        "{} = {}, must be a whole number >= 0", name,
        in_quotes(found->is_primitive() ? found->dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)
                                        : "...")));
  return found->get<uint64_t>();
}

/// The bytes of a buffer view, and how far its elements are apart.
std::string_view GlbFile::view(uint64_t index, size_t element_bytes, size_t& stride) const {
  const nlohmann::json& view = element("bufferViews", index);
  const uint64_t number_of_buffer = number(view, "buffer", 0);
  const nlohmann::json& buffer = element("buffers", number_of_buffer);
  if (number_of_buffer != 0 || buffer.contains("uri"))
    fail(fmt::format("bufferViews[{}]: a buffer in another file, must be in this one", index));
  const uint64_t offset = number(view, "byteOffset", 0), length = number(view, "byteLength", 0);
  if (offset > binary_.size() || length > binary_.size() - offset)
    fail(fmt::format("bufferViews[{}]: bytes {} to {}, but the binary part is truncated: it has {}", index, offset,
                     offset + length, binary_.size()));
  const uint64_t given = number(view, "byteStride", element_bytes);
  constexpr uint64_t most_stride = 252;
  if (given < element_bytes || (given > most_stride && given != element_bytes))
    fail(fmt::format("bufferViews[{}]: byteStride = {}, must be from {} to {}", index, given, element_bytes,
                     most_stride));
  stride = static_cast<size_t>(given);
  return binary_.substr(offset, length);
}

GltfArray GlbFile::accessor(uint64_t index) const {
  const nlohmann::json& accessor = element("accessors", index);
  const auto refuse = [&](const std::string& what) { fail(fmt::format("accessors[{}]: {}", index, what)); };
  if (accessor.contains("sparse")) refuse("sparse, must be a whole array");
  if (!accessor.contains("bufferView")) refuse("has no bufferView");
  GltfArray array;
  array.component = static_cast<int>(std::min<uint64_t>(number(accessor, "componentType", 0), 100000));
  const auto type = accessor.find("type");
  array.parts = type != accessor.end() && type->is_string() ? parts_of_type(type->get_ref<const std::string&>()) : 0;
  const size_t bytes = component_bytes(array.component) * array.parts;
  if (bytes == 0) refuse(fmt::format("componentType = {}, must be one of numbers, vectors of them", array.component));
  const auto normalized = accessor.find("normalized");
  array.normalized = normalized != accessor.end() && normalized->is_boolean() && normalized->get<bool>();
  const std::string_view view = this->view(number(accessor, "bufferView", 0), bytes, array.stride);
  const uint64_t offset = number(accessor, "byteOffset", 0), count = number(accessor, "count", 0);
  const bool fits = count == 0 || (offset <= view.size() && bytes <= view.size() - offset &&
                                   count - 1 <= (view.size() - offset - bytes) / array.stride);
  if (!fits) refuse(fmt::format("count = {}, but its bufferView of {} bytes holds fewer", count, view.size()));
  array.count = static_cast<size_t>(count);
  array.at = view.data() + (count == 0 ? 0 : offset);
  return array;
}

}  // namespace soapfilm::io
