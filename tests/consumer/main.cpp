// Uses the installed library; every include below must be found through the package alone.
#include <cstdio>
#include <vector>

#include "soapfilm/core/mesh.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/version.h"

int main() {
  soapfilm::Mesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

  const soapfilm::Context context(2);
  std::vector<double> volumes(64);
  parallel_for(context, volumes.size(), 4, [&](size_t i) { volumes[i] = tetrahedron.volume(); });
  for (double volume : volumes)
    if (volume < 1.0 / 6.0 - 1e-12 || volume > 1.0 / 6.0 + 1e-12) return 1;
  std::printf("soapfilm %s\n", soapfilm::version.data());
}
