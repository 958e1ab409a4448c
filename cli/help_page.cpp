#include "cli/help_page.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "soapfilm/platform/terminal.h"

namespace soapfilm::cli {

namespace {

/// Of the terminal, or what the shell says of it; as a page in a file, 100.
size_t columns_of_page() {
  constexpr size_t of_file = 100, least = 40, most = 120;
  if (is_terminal(stdout)) return std::clamp(terminal_columns(stdout), least, most);
  const char* given = std::getenv("COLUMNS");
  const long columns = given ? std::strtol(given, nullptr, 10) : 0;
  return columns > 0 ? std::clamp(static_cast<size_t>(columns), least, most) : of_file;
}

/// What lines of their own are in a description begins with a parenthesis; other ends of lines are the source's.
std::string joined(const std::string& text) {
  std::string line;
  for (size_t i = 0; i < text.size(); ++i)
    line += text[i] == '\n' && i + 1 < text.size() && text[i + 1] != '(' ? ' ' : text[i];
  return line;
}

/// Ends lines of more than `columns` at a space; `between` stands between their parts.
std::string wrapped(const std::string& text, size_t columns, const std::string& between) {
  std::string out;
  size_t line = 0;  // where the current one begins in `out`
  size_t space = std::string::npos;
  const size_t margin = between.find('\n');  // of a mark at the end of the line
  for (const char c : text) {
    out += c;
    if (c == '\n') line = out.size(), space = std::string::npos;
    if (c == ' ' && out.find_first_not_of(' ', line) < out.size()) space = out.size() - 1;
    if (out.size() - line + margin <= columns || space == std::string::npos) continue;
    out.replace(space, 1, between);
    line = space + margin + 1;
    space = std::string::npos;
  }
  return out;
}

/// Where the text of a line begins: behind its indentation or, in a table, its first column.
size_t text_begins(const std::string& line) {
  constexpr size_t widest = 12;
  const size_t first = std::min(line.find_first_not_of(' '), line.size());
  const size_t gap = line.find("  ", first);
  const size_t second = gap < widest ? line.find_first_not_of(' ', gap) : std::string::npos;
  return second != std::string::npos ? second : first;
}

}  // namespace

const char* const examples_and_exit_codes =
    R"(EXAMPLES
  A Stanford scan set becomes a watertight mesh, 512 grid vertices along its longest side:
      soapfilm reconstruct bun.conf -o bunny.ply --resolution 512
  What is in a file:
      soapfilm info scan.ply
  Scans of a built-in shape, with the truth beside them:
      soapfilm scan part -o scans
  How far a mesh is from the truth:
      soapfilm evaluate mesh.ply --truth part
  A picture of two meshes side by side:
      soapfilm render truth.ply mesh.ply -o both.png
  A page for the browser: turn, cut, measure:
      soapfilm view bun.conf bunny.ply

EXIT CODES
  0    success
  1    internal error
  2    refused: input, parameter, output or memory; the message names it, nothing is half-written
  3    the optimal surface is empty; the message names the largest lambda that keeps one
  4    with reconstruct --strict: written, but over 1 % of the samples are far from the mesh
  130  cancelled (Ctrl-C); nothing was written
)";

const char* const global_options_note = "Global options (--threads, --quiet, --verbose): soapfilm --help";

const char* const first_page =
    R"(soapfilm turns raw 3D scans into a watertight mesh, and proves how good it is.

With your own scans (PLY, E57, PTX, PCD, LAS, LAZ, text and more), say scan.ply:
  soapfilm info scan.ply                   what is in the file
  soapfilm reconstruct scan.ply --preview  a coarse mesh in a moment
  soapfilm reconstruct scan.ply            the mesh: scan.mesh.ply
  soapfilm render scan.mesh.ply -o scan.png

Without scans, of a shape that is built in:
  soapfilm scan knot -o knot               virtual scans, the truth beside them
  soapfilm reconstruct knot/scans.conf     the mesh: scans.mesh.ply
  soapfilm evaluate scans.mesh.ply --truth knot
  soapfilm render scans.mesh.ply -o knot.png

More:
  soapfilm reconstruct --help              all options of a command
  soapfilm --help                          all commands
)";

HelpPage::HelpPage() : columns_(columns_of_page()) { column_width(std::min<size_t>(30, columns_ * 3 / 10)); }

std::string HelpPage::make_option_desc(const CLI::Option* option) const {
  return wrapped(joined(CLI::Formatter::make_option_desc(option)), columns_ - column_width_, "\n");
}

std::string HelpPage::make_subcommand(const CLI::App* command) const {
  std::ostringstream out;
  CLI::detail::format_help(out, command->get_name(),
                           wrapped(joined(command->get_description()), columns_ - column_width_, "\n"), column_width_);
  return out.str();
}

std::string HelpPage::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::istringstream page(CLI::Formatter::make_help(app, std::move(name), mode));
  std::string text;
  bool was_empty = false;
  for (std::string line; std::getline(page, line);) {
    if (line.empty() && was_empty) continue;
    was_empty = line.empty();
    const size_t begin = text_begins(line);
    const bool is_command = line.compare(begin, 9, "soapfilm ") == 0;
    text +=
        wrapped(line, columns_, (is_command ? " \\\n" : "\n") + std::string(begin + (is_command ? 4 : 0), ' ')) + "\n";
  }
  return text;
}

}  // namespace soapfilm::cli
