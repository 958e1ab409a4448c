#include "cli/reconstruct_options.h"

#include <fmt/format.h>

#include <string>

#include "cli/params_file.h"
#include "cli/parse.h"
#include "cli/read_cloud.h"
#include "cli/split.h"
#include "soapfilm/core/names.h"
#include "soapfilm/io/files.h"

namespace soapfilm::cli {

namespace {

void add_main_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;
  app.add_option(
         "input", o.inputs,
         fmt::format(
             "Point clouds or scan sets ({}); several are several scans, a folder is the scans in it, a pattern "
             "such as 'tiles/*.laz' the files that it matches, by their numbers; a file named twice is read once; - "
             "standard input",
             point_extensions()))
      ->required()
      ->option_text("FILE...");
  app.add_option_function<std::string>(
         "--params", [&o](const std::string& file) { o.params = read_params(file); },
         "Take all parameters from a report of an earlier run, or from its\n\"parameters\" alone; options beside it "
         "hold")
      ->trigger_on_parse()
      ->option_text("FILE.json");
  app.add_option("-o,--output", o.output,
                 "Mesh to write: " + mesh_output_extensions() +
                     "; - is standard output\n(default: the first input's NAME.mesh.ply, in the current folder)")
      ->option_text("FILE");
  app.add_option("--format", o.format,
                 "Of standard input and output, such as las, or xyz,ply for both\n(default: input by how it begins, or "
                 "text; output ply)")
      ->option_text("EXT[,EXT]");
  app.add_flag("--preview", o.preview,
               "A first look at a quarter of the resolution, to NAME.preview.ply unless\n-o says where; prints the "
               "command for the full run");

  add_read_options(app, o.read);

  const auto grid = [&](auto* option) { return option->group("Grid"); };
  CLI::Option* voxel =
      grid(app.add_option("--voxel", p.place.voxel, "Edge of a grid cell, in the input's units"))->option_text("SIZE");
  grid(app.add_option(
           "--resolution", p.place.resolution,
           "Grid vertices along the longest axis, padding included\n(default: one sample per voxel^2 of surface)"))
      ->excludes(voxel)
      ->option_text("N");
  grid(app.add_option("--padding", p.place.padding, "Cells between the samples and the border"))
      ->option_text(fmt::format("N [{}]", p.place.padding));
  grid(app.add_option("--anchor", o.anchor,
                      "Where tiles of the grid meet: with the same --voxel, a run with further\nscans has its grid at "
                      "the same place"))
      ->delimiter(',')
      ->expected(3)
      ->needs(voxel)
      ->option_text("X,Y,Z");
  grid(app.add_option("--adapt", p.place.adapt,
                      "Smaller voxels where samples are dense, larger ones where they are sparse:\nfor scans of very "
                      "uneven density. --voxel is then the smallest"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off [off]");
  grid(app.add_option("--memory", o.memory,
                      "Refuse a run that needs more, such as 2G\n(default: what the machine has free)"))
      ->option_text("LIMIT");
  grid(
      app.add_option("--scratch", o.scratch,
                     "Hold large arrays in files of this folder where a run needs more memory:\nit is slower, the mesh "
                     "the same; nothing stays there"))
      ->option_text("DIR");
  grid(app.add_flag(
      "--resume", o.resume,
      "Keep finished stages in the folder of --scratch until the mesh is written;\nthe same command after a "
      "crash goes on from them"));

  const auto directions = [&](auto* option) { return option->group("Directions"); };
  directions(
      app.add_option(
          "--directions", p.orient.source,
          "Where each sample's outward direction comes from:\nauto (normals that contradict each other lose their "
          "signs), normals (as\ngiven), sensor, scan or estimate"))
      ->transform(named<DirectionSource>())
      ->option_text("SOURCE [auto]");
  directions(app.add_option("--sensor", o.sensor, "Scanner position for scans that do not say it"))
      ->delimiter(',')
      ->expected(3)
      ->option_text("X,Y,Z");
  directions(app.add_option("--up", p.orient.up,
                            "From where sheets without any known direction were seen: x, y, z,\n-x, -y or -z "
                            "(default: z, as terrain from the air)"))
      ->transform(named<Axis>())
      ->option_text("AXIS");
  directions(app.add_option("--neighbors", p.orient.neighbors,
                            "Of estimated directions: nearest samples whose plane it is, 3 to 1000"))
      ->option_text(fmt::format("N [{}]", p.orient.neighbors));
  directions(app.add_option("--radius", p.orient.radius,
                            "Of estimated directions: all samples as near as this count too, in the\ninput's units"))
      ->option_text("R");

  grid(app.add_option(
           "--outside", p.border.outside,
           "What lies beyond the samples' box: air, around an object; solid, around a\nroom seen from inside; "
           "open: neither, the surface is a sheet that ends"))
      ->transform(named<Border>())
      ->option_text("WHAT [auto]");

  const auto energy = [&](auto* option) { return option->group("Energy"); };
  energy(app.add_option("--lambda", o.lambda,
                        fmt::format("Weight of area, in the paper's meaning (0.005 to 0.01 there); larger\n"
                                    "is smoother (default: {:g} x samples per voxel^2);\nauto: by cross-validation",
                                    p.energy.lambda_per_density)))
      ->check(also({"auto"}))
      ->option_text("V|auto");
  energy(app.add_option("--weights", p.energy.by_area,
                        "What a sample counts for: area, the surface that it stands for, or samples,\nall alike"))
      ->transform(named<bool>({{"area", true}, {"samples", false}}))
      ->option_text("area|samples [area]");
  energy(app.add_option("--norm", p.energy.norm,
                        "How area is measured: isotropic, as it is, or anisotropic, along the\ngrid's axes"))
      ->transform(named<Norm>())
      ->option_text("NORM [isotropic]");
  energy(app.add_option("--tolerance", p.solve.tolerance,
                        "Relative gap at which the finest level is solved; the next one: twice\nthat, coarser ones: at "
                        "most 0.0003 (0.01 where they only tell where to\nstart)"))
      ->option_text(fmt::format("V [{:g}]", p.solve.tolerance));
  energy(app.add_option("--max-iterations", p.solve.max_iterations, "Limit per level"))
      ->option_text(fmt::format("N [{}]", p.solve.max_iterations));
  energy(app.add_option("--settle", p.solve.settle,
                        "End a level when no label changes any more, though its gap may still\nfall: on or off"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off [on]");
}

void add_method_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;
  const auto method = [&](auto* option) { return option->group("Method"); };
  method(app.add_option("--method", p.method,
                        fmt::format("One of {}\n(docs/reference/methods.md)", fmt::join(names_of<Method>, ", "))))
      ->transform(named<Method>())
      ->option_text("NAME [tv]");
  method(app.add_option("--link-weights", p.graph_cut.weights,
                        "Of graph-cut-26: edge-length, or cauchy-crofton (less dependent on direction)"))
      ->transform(named<LinkWeights>())
      ->option_text("W [edge-length]");
  method(app.add_option("--front", p.vrip.front, "Of vrip: reach of a scan before its surface, voxels"))
      ->option_text(fmt::format("V [{:g}]", p.vrip.front));
  method(app.add_option("--behind", p.vrip.behind, "Of vrip: reach behind it, voxels"))
      ->option_text(fmt::format("V [{:g}]", p.vrip.behind));
  method(
      app.add_option("--folds", p.cross_validation.folds, "Of --lambda auto: parts of the samples, each held out once"))
      ->option_text(fmt::format("N [{}]", p.cross_validation.folds));
  method(app.add_option("--fold-source", p.cross_validation.source, "Of --lambda auto: auto, samples, or whole scans"))
      ->transform(named<FoldSource>())
      ->option_text("SOURCE [auto]");
}

void add_surface_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;

  const auto surface = [&](auto* option) { return option->group("Surface"); };
  surface(app.add_option("--threshold", p.surface.threshold, "Threshold mu of the relaxed indicator, in (0, 1)"))
      ->option_text(fmt::format("MU [{:g}]", p.surface.threshold));
  surface(
      app.add_option("--isovalue", o.isovalue, "Of the unrefined surface, in (0, 1); auto: the mean at the samples"))
      ->check(also({"auto"}))
      ->option_text("V [auto]");

  surface(app.add_option("--refine", p.surface.refine,
                         "Move the surface onto the samples, or leave the paper's: on or off\n(default: on for tv, and "
                         "with --adapt on)"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off");
  surface(app.add_option("--drop-components", p.surface.drop_components,
                         "Remove components and cavities that too few samples support, or that\nrefining shrinks to "
                         "nothing: on or off\n(default: on where the surface is refined)"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off");
  surface(app.add_option("--min-support", p.components.min_support,
                         "Of --drop-components: samples on a component over those that its area\nhas on average"))
      ->option_text(fmt::format("V [{:g}]", p.components.min_support));
  surface(app.add_option("--smoothing", p.refine.smoothing,
                         "Of the refined surface: weight of curvature against one sample\n(default: chosen by held-out "
                         "samples)"))
      ->option_text("V");
  surface(app.add_option("--holes", p.refine.holes,
                         "Of the refined surface, where no sample covers it: smooth, bent as the\nsurface around, or "
                         "flat, of least area; unseen bases are flat"))
      ->transform(named<HoleFill>())
      ->option_text("smooth|flat [smooth]");
  surface(app.add_option("--split-tolerance", p.surface.relax.split_tolerance,
                         "Of the refined surface: split edges whose middle lies further from it,\nvoxels; 0: leave the "
                         "triangles of marching cubes"))
      ->option_text(fmt::format("V [{:g}]", p.surface.relax.split_tolerance));

  surface(app.add_option("--trim", o.trim,
                         "Take away surface farther than this from all samples, in the input's\nunits; auto: 3 voxels, "
                         "or 3 times the samples' spacing; off\n(default: auto where the surface is open, else off)"))
      ->check(also({"auto", "off"}))
      ->option_text("DIST|auto|off");
  surface(app.add_option("--simplify", o.simplify,
                         "Fewer triangles, proved to lie within this distance of the full mesh, and\nit of them: in "
                         "the input's units, in voxels as 0.05vox, auto or off"))
      ->check(also({"auto", "off"}))
      ->option_text("TOL|auto|off [off]");
  surface(app.add_option("--triangles", p.simplify.triangles,
                         "Instead: at most so many triangles, by the smallest distance that does"))
      ->option_text("N");
  surface(app.add_flag("--trim-holes", p.trim.holes, "Of --trim: also holes that would stay filled"));
  surface(app.add_option("--fill-holes", p.trim.fill_holes,
                         "Of --trim, which this turns on: gaps in the samples at most so wide stay\nfilled, in the "
                         "input's units; wider ones are cut away"))
      ->option_text("WIDTH");

  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("--report", o.report, "Write what was done and proved, as JSON"))->option_text("FILE.json");
  output(app.add_option("--write-levels", o.levels_folder,
                        "Also write the unsmoothed surface of each level of the pyramid as\nDIR/level_0.ply (the "
                        "grid's), level_1.ply "
                        "(coarser), ...; with --adapt on\nthose of finer levels as level_-1.ply, ..."))
      ->option_text("DIR");
  output(add_lod(app, o.lod));
  output(add_split(app, o.split));
  output(app.add_option("--attributes", o.attributes,
                        "What the samples have and the mesh's vertices get: all, none, or names\nsuch as "
                        "color,intensity"))
      ->delimiter(',')
      ->check(also({"all", "none", "color"}))
      ->option_text("NAMES [color]");
  output(app.add_flag("--distance", p.surface.distance,
                      "Each vertex' distance to the nearest sample, in the input's units, as the\nPLY's attribute "
                      "'distance' (soapfilm render --color-by distance)"));
  output(app.add_flag("--support", p.surface.support,
                      "The samples per voxel^2 of surface at each vertex, as the attribute 'support'"));
  output(app.add_flag("--gap", p.surface.gap,
                      "Where the certificate's gap is: at each vertex, over the price of its area,\nas the attribute "
                      "'gap'"));
  output(app.add_option("--volume-interval", p.surface.volume_interval,
                        "For experts, of tv: between which volumes all segmentations lie that are within\n5 voxels of "
                        "this one and whose energy is at most EPS above the optimum, as a\nshare of it. No statement "
                        "of accuracy: the scanned object's is some .01 above"))
      ->option_text("EPS");
  output(app.add_flag("--check", o.check, "Check the mesh's topology and its distance to the samples"));
  output(app.add_flag(
      "--strict", o.strict,
      "Exit code 4, with all written, when more than 1 % of the samples are\nfarther than 3 voxels from the mesh"));
  output(app.add_flag("--ascii", o.ascii, "PLY and STL as text"));
}

}  // namespace

void add_reconstruct_options(CLI::App& app, ReconstructOptions& o) {
  add_main_options(app, o);
  add_method_options(app, o);
  add_surface_options(app, o);
}

}  // namespace soapfilm::cli
