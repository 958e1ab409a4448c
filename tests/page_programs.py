"""page_programs.py OUT.cpp PAGE...: the pieces of C++ and C on pages that are no programs of their own, as one.

Each becomes a function; what a piece takes as given is declared here. The program runs all of them, in a folder with
the files that they name. Programs after <!-- file: NAME --> are not among them. pages.py runs both.
"""
import sys
from pathlib import Path

from pages import BLOCK

GIVEN = """#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/soapfilm.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace {

const soapfilm::Context context;
const std::string report_json = "{}";
soapfilm::PointCloud scan = soapfilm::sample_surface(*soapfilm::make_shape("torus"), 5000, 1);
const soapfilm::ReconstructParams coarse;

}  // namespace
"""


def main():
    includes, functions = [], []
    for page in sys.argv[2:]:
        for order, _, language, text in BLOCK.findall(Path(page).read_text(encoding="utf-8")):
            if order or language not in ("cpp", "c"):
                continue
            lines = text.splitlines()
            includes += [line for line in lines if line.startswith("#include")]
            body = "\n".join(line for line in lines if not line.startswith("#include"))
            name = f"piece_{len(functions)}"
            whole = "int main()" in body
            functions.append((name, page, body.replace("int main()", f"void {name}()") if whole else
                              f"void {name}() {{\n{body}\n}}"))
    code = [GIVEN, *dict.fromkeys(includes)]
    code += [f"\n// {page}\n{body}" for _, page, body in functions]
    calls = "\n".join(f'  std::puts("{page}");\n  {name}();' for name, page, _ in functions)
    code.append(f"\nint main() {{\n{calls}\n}}\n")
    Path(sys.argv[1]).write_text("\n".join(code), encoding="utf-8")


main()
