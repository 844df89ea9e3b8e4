// SPDX-License-Identifier: Apache-2.0
#include "scene/show/other_names.h"

#include <map>

#include "base/text/text.h"
#include "pipeline/operation/operation.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("other names: each leads to something that exists, and none leads to two") {
  std::map<std::string, std::string> seen;
  for (const OtherName& n : other_names()) {
    INFO(n.here);
    const auto parts = words(n.here);
    const std::string flag(parts[0]);
    std::string what(parts.size() > 1 ? parts[1] : "");
    std::erase(what, '\'');
    std::vector<std::string> params;
    for (size_t i = 2; i < parts.size(); ++i) {
      std::string p(parts[i]);
      std::erase(p, '\'');
      if (!p.ends_with("...")) params.push_back(p);
    }
    if (flag == "-f") CHECK_NOTHROW(make_params(find_operation(what), params));
    else if (flag == "--show") CHECK_NOTHROW(find_show(what));
    else CHECK((flag == "--map" || flag == "--legend" || flag == "--picture" || flag == "--camera" || flag == "--note"));
    for (const std::string_view word : words(n.words)) {
      const auto [it, fresh] = seen.emplace(std::string(word), std::string(n.here));
      INFO(word);
      CHECK(fresh);
      CHECK(word == to_lower(word));
    }
  }
  for (const MissingName& n : missing_names())
    for (const std::string_view word : words(n.words)) {
      CAPTURE(word);
      CHECK(seen.emplace(std::string(word), std::string(n.what)).second);
      CHECK(word == to_lower(word));
    }
}

TEST_CASE("other names: what is nearest to a missing operation exists") {
  for (const MissingName& n : missing_names()) {
    CAPTURE(n.what);
    const std::string text(n.nearest);
    for (const std::string flag : {"-f ", "--show "})
      for (size_t at = text.find(flag); at != text.npos; at = text.find(flag, at + 1)) {
        size_t from = at + flag.size(), to = 0;
        const bool quoted = text[from] == '\'';
        if (quoted) to = text.find('\'', ++from);
        else to = std::min(text.find_first_of(" ;,", from), text.size());
        const auto parts = words(std::string_view(text).substr(from, to - from));
        std::vector<std::string> params;
        for (size_t i = 1; i < parts.size(); ++i)
          if (!parts[i].ends_with("...") && !parts[i].starts_with("with=")) params.emplace_back(parts[i]);
        if (flag == "-f ") CHECK_NOTHROW(make_params(find_operation(parts[0]), params));
        else CHECK_NOTHROW(find_show(std::string(parts[0])));
      }
  }
}

TEST_CASE("other names: filters of VTK and PyVista lead to an operation or to an honest word") {
  for (const char* name : {"decimate",
                           "decimate_pro",
                           "vtkQuadricDecimation",
                           "subdivide",
                           "delaunay_2d",
                           "vtkDelaunay3D",
                           "triangulate",
                           "vtkTriangleFilter",
                           "smooth_taubin",
                           "vtkWindowedSincPolyDataFilter",
                           "cell_centers",
                           "connectivity",
                           "extract_surface",
                           "vtkGeometryFilter",
                           "extract_all_edges",
                           "extract_feature_edges",
                           "vtkImageGaussianSmooth",
                           "sample",
                           "sample_over_line",
                           "integrate_data",
                           "reflect",
                           "texture_map_to_plane",
                           "vtkStreamTracer",
                           "tube",
                           "vtkRibbonFilter",
                           "compute_normals",
                           "outline",
                           "vtkOutlineFilter",
                           "shrink",
                           "explode",
                           "voxelize",
                           "clip_box",
                           "clip_surface",
                           "slice_orthogonal",
                           "boolean_difference",
                           "boolean_union",
                           "fill_holes",
                           "warp_by_vector",
                           "contour_banded",
                           "vtkMarchingCubes",
                           "glyph",
                           "compute_cell_sizes",
                           "compute_derivative",
                           "ptc",
                           "ctp",
                           "select_enclosed_points",
                           "threshold_percent",
                           "split_bodies",
                           "extract_largest",
                           "reconstruct_surface",
                           "interpolate",
                           "compute_implicit_distance",
                           "geodesic",
                           "median_smooth",
                           "fft",
                           "flip_normals",
                           "rotate_x",
                           "extract_cells",
                           "extract_subset",
                           "resample_to_image",
                           "vtkMassProperties",
                           "streamlines_evenly_spaced_2D",
                           "extrude_rotate",
                           "strip",
                           "compute_arc_length",
                           "vtkTableToPolyData",
                           "merge",
                           "vtkBandedPolyDataContourFilter",
                           "contour_labels",
                           "image_dilate_erode"}) {
    CAPTURE(name);
    CHECK_FALSE(known_elsewhere(name).empty());
  }
  CHECK(known_elsewhere("decimate").find("there is no operation that makes a surface of fewer triangles") == 0);
  CHECK(known_elsewhere("vtkContourFilter") == "here it is said -f 'contour values=...'");
  const std::vector<std::string> ours = {"append", "gaussian_smooth"};
  CHECK(said_here("vtkAppendFilter", ours) == "here it is called append");
  CHECK(said_here("GaussianSmooth", ours) == "here it is called gaussian_smooth");
  CHECK(known_elsewhere("vtk").empty());
  CHECK(known_elsewhere("filter").empty());
  CHECK(known_elsewhere("contuor").empty());
}
