#include "cli/help_page.h"

namespace soapfilm::cli {

namespace {

constexpr size_t name_columns = 30;
constexpr size_t page_columns = 100;

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

HelpPage::HelpPage() { column_width(name_columns); }

std::string HelpPage::make_option_desc(const CLI::Option* option) const {
  std::string text = CLI::Formatter::make_option_desc(option);
  size_t line = 0;  // where the current line begins
  for (size_t at = 0, space = 0; at < text.size(); ++at) {
    if (text[at] == '\n') line = space = at + 1;
    if (text[at] == ' ') space = at;
    if (at - line < page_columns - name_columns || space <= line) continue;
    text[space] = '\n';
    line = space + 1;
  }
  return text;
}

}  // namespace soapfilm::cli
