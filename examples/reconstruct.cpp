// From samples to a watertight mesh with a proof, in a page. The samples come from a virtual scanner here;
// read_points() of soapfilm/io/io.h reads them from files instead.
#include <cstdio>
#include <exception>

#include "soapfilm/io/io.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/scanner/shape.h"
#include "soapfilm/scanner/virtual_scan.h"

int main() try {
  soapfilm::Progress progress;                   // derive from it to be told, call cancel() to stop
  const soapfilm::Context context(0, progress);  // all threads that the process may use

  soapfilm::ScannerParams scanner;
  scanner.columns = scanner.rows = 80;
  const soapfilm::ScanSet scans = virtual_scan(*soapfilm::make_part(), scanner, context);

  soapfilm::ReconstructParams params;
  params.place.resolution = 64;

  soapfilm::Reconstruction result = reconstruct(scans.cloud, params, context);
  check_result(result, scans.cloud, context);

  std::printf("%zu samples, %zu triangles\n", scans.cloud.size(), result.mesh.triangles.size());
  std::printf("proved within %.3g of the global optimum\n", result.report.certificate.relative_gap_binary());
  soapfilm::write_mesh("part.ply", result.mesh);
  return result.report.topology->watertight() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
