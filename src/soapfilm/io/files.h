// File functions of the program besides reading and writing clouds and meshes (include/soapfilm/io.h).
#pragma once

#include <string>

namespace soapfilm {

/// How `soapfilm info` treats a file.
enum class FileKind { points, mesh };

/// By content or extension; a PLY or an OBJ is a mesh when it has faces; a folder is the points in it. Throws
/// InputError for an unknown extension.
FileKind file_kind(const std::string& path);

/// Extensions of what can be read as a cloud, read as a mesh, written as a mesh: ".ply, .obj or .stl".
std::string point_extensions();
std::string mesh_extensions();
std::string mesh_output_extensions();

/// Writes text, whole or not at all. Throws OutputError.
void write_text_file(const std::string& path, const std::string& text);

/// Refuses before a long run an output that could not be written after it: an unwritable place; for meshes an unknown
/// extension too. Throws OutputError; leaves no file.
void check_output(const std::string& path);
void check_mesh_output(const std::string& path);

/// Unlinks the temporary files of writes in progress, in any thread. Async-signal-safe; called when the process dies.
void remove_temporary_files() noexcept;

}  // namespace soapfilm
