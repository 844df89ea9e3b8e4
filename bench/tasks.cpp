// SPDX-License-Identifier: Apache-2.0
// What is measured, under the names of the peers' records.
#include <fmt/core.h>

#include "base/file/file.h"
#include "base/random.h"
#include "bench.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/probe/probe.h"
#include "filter/probe/resample.h"
#include "filter/scalar/contour/contour.h"
#include "filter/surface/surfels.h"
#include "index/cell_tree.h"
#include "inputs.h"
#include "io/io.h"
#include "render/raster/raster.h"
#include "render/render.h"

namespace sg::bench {

Camera peers_camera(double turn) {
  Camera c;
  const double a = turn * 3.14159265358979323846 / 180;
  c.position = {2.2 * std::cos(a) + 3.6 * std::sin(a), 2.6, 3.6 * std::cos(a) - 2.2 * std::sin(a)};
  c.target = {0, 0, 0};
  c.up = {0, 1, 0};
  c.view_angle = 40;
  Box3 box;
  box.add({-1, -1, -1});
  box.add({1, 1, 1});
  fit_planes(c, box);
  return c;
}

namespace {

// Reads the file and touches every value of every field.
double read_all(const std::string& path) {
  Context context;
  double points = 0;
  for_each_dataset(read_data(path, {}, context), [&](const std::string&, const DatasetPtr& d) {
    points += double(d->point_count());
    d->bounds();
    for (const Field& f : d->fields()) d->stats(f);
  });
  return points;
}

Task reading(const std::string& folder, const std::string& name) {
  return {"read_file", "file", "sightglass:" + name, "points", [=] {
            const std::string path = folder + "/" + name;
            MappedFile warm(path);
            return [=] { return read_all(path); };
          }};
}

Task gradients(const char* input, const char* size) {
  return {"gradient", size, "sightglass:gradient", "points", [=] {
            const DatasetPtr d = std::string_view(input) == "grid" ? field_grid(256) : tetrahedra(55);
            return [=] {
              Context context;
              return double(gradient(d, {}, context)->point_count());
            };
          }};
}

// Zlib at the writer's own level; the peer's task of the same name.
Task writing(const std::string& folder) {
  return {"write_file", "file", "sightglass:f256_zlib.vti", "points", [=] {
            const DatasetPtr grid = field_grid(256);
            return [=] {
              Context context;
              WriteOptions o;
              o.compression = Compression::zlib;
              write_data(folder + "/ours_zlib.vti", grid, o, context);
              return double(grid->point_count());
            };
          }};
}

Task resampling() {
  return {"resample_to_256^3", "tet1M", "sightglass:resample", "valid samples", [=] {
            const DatasetPtr d = tetrahedra(55);
            return [=] {
              Context context;
              ResampleParams p;
              p.dims = {256, 256, 256};
              const DatasetPtr r = resample(d, p, context);
              return double(r->point_count());
            };
          }};
}

Task probing() {
  return {"probe_1M_random_points", "tet1M", "sightglass:probe", "samples", [=] {
            const DatasetPtr d = tetrahedra(55);
            std::vector<float> xyz(3'000'000);
            for (size_t i = 0; i < xyz.size(); ++i) xyz[i] = float(2 * random_unit(7, i) - 1);
            PointCloud cloud;
            cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
            const DatasetPtr points = make_dataset(Mesh(cloud));
            return [=] {
              Context context;
              return double(probe(points, d, {}, context)->point_count());
            };
          }};
}

Task tree() {
  return {"cell_tree", "tet5M", "sightglass:CellTree", "cells", [=] {
            const DatasetPtr d = tetrahedra(94);
            return [=] {
              Context context;
              return double(CellTree(d, context).order().size());
            };
          }};
}

// A frame after the camera turned by two degrees; geometry is prepared before the clock, as the peers upload it.
Task surface(const char* name, size_t n) {
  return {"surface_render", fmt::format("mesh {}, 1920x1080", name), "sightglass:rasterize", "pixels covered", [=] {
            Scene scene;
            SurfaceItem item;
            item.data = surface_mesh(n);
            scene.items.emplace_back(item);
            auto turn = std::make_shared<double>(0);
            auto shared = std::make_shared<Scene>(std::move(scene));
            return [=] {
              Context context;
              *turn += 2;
              RenderOptions o;
              o.width = 1920, o.height = 1080, o.samples = 1;
              const Frame f = render(*shared, peers_camera(*turn), o, context);
              return double(std::count_if(f.ids.begin(), f.ids.end(), [](uint32_t id) { return id > 0; }));
            };
          }};
}

// From the field in memory to a frame of its isosurface: as triangles with normals, or as discs.
Task isosurface_picture(size_t n, bool discs) {
  return {"isosurface_picture", fmt::format("uniform{}, 1280x720", n), discs ? "sightglass:surfels" : "sightglass:contour",
          "pixels covered", [=] {
            const DatasetPtr kept = field_grid(n);
            return [=] {
              Context context;
              const DatasetPtr d = make_dataset(kept->parts());  // knows nothing from the run before
              Scene scene;
              if (discs) {
                PointsItem item;
                item.data = surfels(d, {.field = {}, .value = 0}, context);
                item.disc_normals = "Normals", item.disc_radius = "radius";
                item.color = SurfaceItem().color;
                scene.items.emplace_back(item);
              } else {
                ContourParams p;
                p.values = {0};
                SurfaceItem item;
                item.data = contour(d, p, context);
                scene.items.emplace_back(item);
              }
              RenderOptions o;
              o.width = 1280, o.height = 720, o.samples = 1;
              const Frame f = render(scene, peers_camera(0), o, context);
              return double(std::count_if(f.ids.begin(), f.ids.end(), [](uint32_t id) { return id > 0; }));
            };
          }};
}

}  // namespace

std::vector<Task> tasks(const std::string& folder, bool large) {
  std::vector<Task> t;
  for (const char* name : {"f256_raw.vti", "f256_zlib.vti", "f256_legacy.vtk", "tet1M_raw.vtu", "tet1M_zlib.vtu", "tet1M_legacy.vtk",
                           "mesh1M_binary.stl", "mesh1M_binary.ply", "mesh1M.obj", "mesh1M_raw.vtp"})
    t.push_back(reading(folder, name));
  add_contour_tasks(t);
  add_cut_tasks(t);
  add_index_tasks(t);
  add_volume_methods_tasks(t);
  add_volume_cells_tasks(t);
  add_lic_tasks(t);
  add_lic2d_tasks(t);
  add_smoke_tasks(t, large);
  add_trace_tasks(t, folder);
  t.push_back(gradients("grid", "uniform256"));
  t.push_back(gradients("tets", "tet1M"));
  t.push_back(writing(folder));
  t.push_back(resampling());
  t.push_back(probing());
  t.push_back(tree());
  t.push_back(surface("1M", 235));
  t.push_back(surface("5M", 526));
  t.push_back(surface("10M", 744));
  for (size_t n : {256, 400})
    for (bool discs : {false, true}) t.push_back(isosurface_picture(n, discs));
  add_unsteady_tasks(t);
  add_volume_tasks(t);
  add_light_map_tasks(t);
  add_flow_tasks(t);
  add_walk_tasks(t);
  add_particle_tasks(t);
  add_glyph_tasks(t);
  add_ftle_tasks(t);
  add_volume_error_tasks(t, folder);
  return t;
}

std::vector<ProcessTask> process_tasks(const std::string& folder, const std::string& program) {
  const std::string vti = folder + "/f256_raw.vti", png = folder + "/ours.png";
  const std::string camera = "position=2.2,2.6,3.6 target=0,0,0 up=0,1,0 view_angle=40";
  return {
      {"first_picture_startup_only", "-", "sightglass --version", {program, "--version"}, ""},
      {"info_with_ranges", "f256_raw.vti", "sightglass info", {program, "info", vti}, ""},
      {"first_picture_contour",
       "vti raw 256^3",
       "sightglass render, full picture 1280x720",
       {program, "render", vti, "-f", "contour values=0", "--camera", camera, "--size", "1280x720", "-q", "-o", png},
       png},
      {"first_picture_contour",
       "vti raw 256^3",
       "sightglass render, as the peer draws it",
       {program, "render", vti, "-f", "contour values=0", "--show", "surface color=white", "--camera", camera, "--size", "1024x1024", "-q",
        "--picture", "samples=1 axes=false triad=false legend=false", "-o", png},
       png},
  };
}

}  // namespace sg::bench
