// SPDX-License-Identifier: Apache-2.0
// Grids of data as pictures on surfaces.
#include "pipeline/picture/scene/grid_textures.h"

#include <cmath>
#include <filesystem>

#include "image/codec.h"
#include "image/image.h"
#include "io/io.h"
#include "scene/show/show.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

/// A grid of dims points with `field`, in a file that goes with it.
struct GridFile {
  std::string path;
  GridFile(std::array<size_t, 3> dims, Field field, const char* name = "sg_grid_texture.vti")
      : path((std::filesystem::temp_directory_path() / name).string()) {
    UniformGrid g;
    g.dims = dims;
    FieldSet fields;
    fields.add(std::move(field));
    Context context;
    write_data(path, make_dataset(Mesh(g), std::move(fields)), {}, context);
  }
  ~GridFile() { std::filesystem::remove(path); }
};

Field heights() { return {"height", Association::point, Array::from_vector(std::vector<float>{0, 1, 2, 3, 4, NAN}), "", Role::scalars}; }

}  // namespace

TEST_CASE("grid textures: values are coloured as the grid itself would be, points from the lower left") {
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  const GridFile file({3, 2, 1}, heights());
  SurfaceShow show;
  show.picture.picture = file.path;
  read_grid_textures(show.picture, show.varying, context);
  REQUIRE(show.picture.grids.size() == 1);
  const Texture& t = *show.picture.grids.at({file.path, TexelEncoding::srgb});
  CHECK(t.width() == 3);
  CHECK(t.height() == 2);
  // The ends of the map and its middle differ, as light.
  const auto light = [&](int x, int y) { return t.levels()[0].at(x, y); };
  CHECK(light(0, 0) != light(2, 0));
  CHECK(light(2, 0) != light(1, 1));
  CHECK(light(0, 0).w == 1);
  CHECK(light(2, 1) != light(1, 1));
  CHECK(test::contains(said, "height"));
  // The parts of a collection have it, too.
  const ShowKind& kind = show_kind<SurfaceShow>();
  const ParamSet stated = show_params(kind, {"picture=" + file.path, "opacity=0.5"});
  read_grid_textures(stated.as<SurfaceShow>().picture, stated.as<SurfaceShow>().varying, context);
  const ParamSet copy = kind.copy(stated);
  CHECK(copy.as<SurfaceShow>().picture.grids.size() == 1);
  CHECK(copy.as<SurfaceShow>().opacity == 0.5);
  CHECK(copy.schema.stated("opacity"));
  CHECK_FALSE(copy.schema.stated("edges"));
}

TEST_CASE("grid textures: colours are those of the grid, numbers what they are, of whichever layer") {
  Context context;
  const GridFile rgb({2, 1, 2}, {"rgb", Association::point,
                                 Array::from_vector(std::vector<uint8_t>{255, 0, 0, 0, 128, 0, 0, 0, 255, 9, 9, 9}, 3), "", Role::colors});
  SurfaceShow show;
  show.picture.picture = rgb.path;
  show.varying.pictures[size_t(MaterialFactor::coat)] = rgb.path;
  read_grid_textures(show.picture, show.varying, context);
  const Texture& colors = *show.picture.grids.at({rgb.path, TexelEncoding::srgb});
  CHECK(colors.levels()[0].at(0, 0).x == 1);
  CHECK(colors.levels()[0].at(1, 0).y == Approx(srgb_decode(128 / 255.f)));
  CHECK(colors.levels()[0].at(0, 1).z == 1);
  CHECK(show.picture.grids.at({rgb.path, TexelEncoding::linear})->levels()[0].at(1, 0).y == Approx(128 / 255.0));
}

TEST_CASE("grid textures: pictures stay pictures, and what is neither says what would be right") {
  Context context;
  const std::string png = (std::filesystem::temp_directory_path() / "sg_grid_texture.png").string();
  write_image(png, Image(2, 2, 3));
  SurfaceShow show;
  show.picture.picture = png;
  read_grid_textures(show.picture, show.varying, context);
  CHECK(show.picture.grids.empty());
  std::filesystem::remove(png);
  const GridFile cube({2, 2, 2}, {"v", Association::point, Array::from_vector(std::vector<float>(8, 1.f)), "", Role::scalars},
                      "sg_grid_cube.vti");
  show.picture.picture = cube.path;
  CHECK(test::contains(test::error_of([&] { read_grid_textures(show.picture, show.varying, context); }), "one layer"));
  show.picture.picture = "/no/such/picture.vti";
  CHECK(test::contains(test::error_of([&] { read_grid_textures(show.picture, show.varying, context); }), "picture.vti"));
}
