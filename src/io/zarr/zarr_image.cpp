// SPDX-License-Identifier: Apache-2.0
// The description of an image: axes, levels, channels.
#include "io/zarr/zarr_image.h"

#include <fmt/core.h>

#include <cmath>

#include "base/file/file.h"
#include "io/zarr/zarr_json.h"

namespace sg::zarr {

namespace {

constexpr size_t most_levels = 64;

// Names of axes, in the order of the shape.
struct Axes {
  std::vector<std::string> names, types, units;
};

Axes axes_of(const Json& multiscale, size_t n, const std::string& where) {
  Axes axes;
  const Json* list = list_of(multiscale, "axes");
  if (!list) {  // before NGFF 0.3: always these
    constexpr const char* usual[] = {"t", "c", "z", "y", "x"};
    if (n > 5) fail_data(fmt::format("has {} axes without names", n), where);
    for (size_t i = 5 - n; i < 5; ++i) axes.names.push_back(usual[i]), axes.types.emplace_back(), axes.units.emplace_back();
    return axes;
  }
  if (list->size() != n) fail_data(fmt::format("names {} axes of an array with {} axes", list->size(), n), where);
  for (const Json& a : list->items()) {
    axes.names.push_back(a.is_text() ? a.text() : text_of(a, "name", ""));
    axes.types.push_back(text_of(a, "type", ""));
    axes.units.push_back(text_of(a, "unit", ""));
  }
  return axes;
}

void place_axes(Image& image, const Axes& axes, const std::string& where) {
  const std::vector<size_t>& shape = image.levels[0].array.shape;
  for (size_t i = 0; i < shape.size(); ++i) {
    const std::string& n = axes.names[i];
    int* slot = n == "x"                                 ? &image.axis[0]
                : n == "y"                               ? &image.axis[1]
                : n == "z"                               ? &image.axis[2]
                : n == "t" || axes.types[i] == "time"    ? &image.time_axis
                : n == "c" || axes.types[i] == "channel" ? &image.channel_axis
                                                         : nullptr;
    if (slot && *slot < 0) *slot = int(i);
    else if (shape[i] > 1) fail_data(fmt::format("axis '{}' of {} is not one of t, c, z, y, x", n.substr(0, 40), shape[i]), where);
  }
  if (image.axis[0] < 0) fail_data("has no axis x", where);
  constexpr std::pair<const char*, const char*> units[] = {{"meter", "m"},          {"millimeter", "mm"}, {"micrometer", "um"},
                                                           {"nanometer", "nm"},     {"centimeter", "cm"}, {"kilometer", "km"},
                                                           {"angstrom", "angstrom"}};
  const std::string said = axes.units[size_t(image.axis[0])];
  image.length_unit = said;
  for (const auto& [name, ours] : units)
    if (said == name) image.length_unit = ours;
}

// scale and translation, one number per axis, on top of what is there: x -> s * x + t.
void apply_transformations(const Json& object, size_t n, std::vector<double>& scale, std::vector<double>& shift, const std::string& where) {
  const Json* list = list_of(object, "coordinateTransformations");
  if (!list) return;
  for (const Json& t : list->items()) {
    const std::string type = text_of(t, "type", "");
    if (type == "identity") continue;
    const Json* v = list_of(t, type.c_str());
    if ((type != "scale" && type != "translation") || !v)
      fail_data(fmt::format("a coordinate transformation of type '{}' is not supported", type.substr(0, 40)), where,
                "scale and translation are supported");
    if (v->size() != n) fail_data(fmt::format("a {} has {} numbers for {} axes", type, v->size(), n), where);
    for (size_t a = 0; a < n; ++a) {
      if (!(*v)[a].is_number()) fail_data(fmt::format("a {} contains something that is not a number", type), where);
      const double x = (*v)[a].number();
      if (!std::isfinite(x) || (type == "scale" && !(x > 0)))
        fail_data(fmt::format("a {} of {}", type, x), where, "numbers must be finite, and scales above 0");
      if (type == "scale") scale[a] *= x, shift[a] *= x;
      else shift[a] += x;
    }
  }
}

void read_levels(Image& image, const Json& multiscale, const std::string& where) {
  const Json* datasets = list_of(multiscale, "datasets");
  if (!datasets || datasets->empty() || datasets->size() > most_levels)
    fail_data("'multiscales' has no list of datasets", where, fmt::format("1 to {} levels", most_levels));
  std::vector<std::array<std::vector<double>, 2>> places;
  for (const Json& d : datasets->items()) {
    const std::string path = text_of(d, "path", "");
    if (path.empty() || path[0] == '/' || ("/" + path + "/").find("/../") != std::string::npos)
      fail_data(fmt::format("a level is at '{}'", path.substr(0, 80)), where, "it must be a folder below this one");
    auto array = open_array(image.path + path + "/");
    if (!array) fail_data("this level has no array", image.path + path, "expected .zarray or zarr.json");
    const size_t n = array->shape.size();
    if (!image.levels.empty() && n != image.levels[0].array.shape.size())
      fail_data(fmt::format("has {} axes, level 0 has {}", n, image.levels[0].array.shape.size()), image.path + path);
    if (!image.levels.empty() && array->type != image.levels[0].array.type)
      fail_data("has a different type from level 0", image.path + path);
    std::vector<double> scale(n, 1), shift(n, 0);
    apply_transformations(d, n, scale, shift, where);
    apply_transformations(multiscale, n, scale, shift, where);
    image.levels.push_back({std::move(*array), {}, {}});
    places.push_back({scale, shift});
  }
  place_axes(image, axes_of(multiscale, image.levels[0].array.shape.size(), where), where);
  for (size_t l = 0; l < image.levels.size(); ++l)
    for (int a = 0; a < 3; ++a)
      if (const int at = image.axis[a]; at >= 0)
        image.levels[l].spacing[a] = places[l][0][size_t(at)], image.levels[l].origin[a] = places[l][1][size_t(at)];
  if (image.time_axis >= 0)
    image.time_step = places[0][0][size_t(image.time_axis)], image.first_time = places[0][1][size_t(image.time_axis)];
}

// `own`: what this program wrote besides the attributes of the standard.
void read_extras(Image& image, const Json& attributes, const Json& own) {
  if (const Json* omero = object_of(attributes, "omero"))
    if (const Json* channels = list_of(*omero, "channels"))
      for (const Json& c : channels->items()) image.channels.push_back(text_of(c, "label", ""));
  image.unit = text_of(own, "unit", "");
  image.vector = own["vector"].boolean();
  image.labels = own["labels"].boolean();
  if (const std::string m = text_of(own, "minmax", ""); !m.empty() && m.find('/') == std::string::npos && m[0] != '.')
    image.minmax = image.path + m + "/";
  if (const Json* d = list_of(own, "direction"); d && d->size() == 9) {
    Mat3 m;
    bool good = true;
    for (size_t i = 0; i < 9; ++i) good = good && (*d)[i].is_number(), m.m[i / 3][i % 3] = good ? (*d)[i].number() : 0;
    const Mat3 square = [&] {
      Mat3 s;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) s.m[r][c] = dot(m.column(r), m.column(c)) - (r == c);
      return s;
    }();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) good = good && std::abs(square.m[r][c]) < 1e-6;
    if (good) image.direction = m;
  }
}

void name_channels(Image& image) {
  const size_t n = image.channel_axis < 0 ? 1 : image.levels[0].array.shape[size_t(image.channel_axis)];
  if (n > 4096) fail_data(fmt::format("has {} channels", n), image.path, "at most 4096 are supported");
  image.channels.resize(n);
  for (size_t i = 0; i < n; ++i) {
    if (image.channels[i].empty()) image.channels[i] = n == 1 ? "values" : fmt::format("channel {}", i);
    for (size_t k = 0; k < i; ++k)
      if (!image.vector && image.channels[k] == image.channels[i]) image.channels[i] = fmt::format("{} {}", image.channels[i], i);
  }
}

// Coarser levels have the same steps and channels, and no axis on which they are longer.
void check_levels(const Image& image) {
  const auto& first = image.levels[0].array;
  for (const Image::Level& level : image.levels)
    for (size_t a = 0; a < first.shape.size(); ++a) {
      const bool space = int(a) == image.axis[0] || int(a) == image.axis[1] || int(a) == image.axis[2];
      if (space ? level.array.shape[a] > first.shape[a] : level.array.shape[a] != first.shape[a])
        fail_data(fmt::format("axis {} has {}, in level 0 {}", a, level.array.shape[a], first.shape[a]), level.array.folder);
    }
}

}  // namespace

std::array<size_t, 3> Image::dims(size_t level) const {
  std::array<size_t, 3> n{1, 1, 1};
  for (size_t a = 0; a < 3; ++a)
    if (axis[a] >= 0) n[a] = levels[level].array.shape[size_t(axis[a])];
  return n;
}

UniformGrid Image::grid(size_t level) const {
  UniformGrid g;
  g.dims = dims(level);
  g.spacing = levels[level].spacing;
  g.direction = direction;
  g.origin = direction * levels[level].origin;
  return g;
}

Image open_image(const std::string& given) {
  Image image;
  image.path = given;
  if (image.path.empty() || image.path.back() != '/') image.path += '/';
  if (auto array = open_array(image.path)) {  // a lone array: axes by their names, else the last three
    const size_t n = array->shape.size();
    const std::vector<std::string> names = array->names;
    image.levels.push_back({std::move(*array), {1, 1, 1}, {0, 0, 0}});
    std::vector<Json> axes;
    constexpr const char* usual[] = {"t", "c", "z", "y", "x"};
    bool named = !names.empty();
    for (const std::string& s : names) named = named && (s == "t" || s == "c" || s == "z" || s == "y" || s == "x");
    if (n > 5 && !named) fail_data(fmt::format("has {} axes", n), given, "up to 5 are supported: t, c, z, y, x");
    for (size_t i = 0; i < n; ++i) axes.emplace_back(named ? names[i] : std::string(usual[5 - n + i]));
    place_axes(image, axes_of(Json(Json::Members{{"axes", Json(std::move(axes))}}), n, given), given);
    name_channels(image);
    return image;
  }
  std::string where = image.path + ".zattrs";
  auto attributes = read_json(where);
  Json own = attributes ? (*attributes)["sightglass"] : Json();
  if (!attributes) {
    where = image.path + "zarr.json";
    const auto group = read_json(where);
    if (!group) fail_data("has neither .zattrs nor zarr.json", given, "a Zarr folder has one of them at its top level");
    const Json& all = (*group)["attributes"];
    attributes = object_of(all, "ome") ? all["ome"] : all;
    own = object_of(all, "sightglass") ? all["sightglass"] : (*attributes)["sightglass"];
  }
  const Json* multiscales = list_of(*attributes, "multiscales");
  if (!multiscales || multiscales->empty() || !(*multiscales)[0].is_object())
    fail_data("is a group without an image ('multiscales')", where, "give the folder of one array or image inside it");
  read_levels(image, (*multiscales)[0], where);
  image.name = text_of((*multiscales)[0], "name", "");
  read_extras(image, *attributes, own);
  check_levels(image);
  name_channels(image);
  return image;
}

}  // namespace sg::zarr
