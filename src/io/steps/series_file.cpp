// SPDX-License-Identifier: Apache-2.0
#include "io/steps/series_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "data/trusted.h"
#include "io/formats.h"
#include "io/vtk/xml/vtk_xml_encode.h"

namespace sg {

namespace {

bool is_pvd(const std::string& path) { return extension_of(path) == "pvd"; }

SeriesIndex read_pvd_index(const std::string& path) {
  const MappedFile file(path);
  pugi::xml_document document;
  if (!document.load_buffer(file.data(), file.size())) fail_data("is not XML", path);
  SeriesIndex index;
  const pugi::xml_node list = document.child("VTKFile").child("Collection");
  index.recipe = list.attribute("recipe").value();
  for (const pugi::xml_node set : list.children("DataSet"))
    index.files.emplace_back(set.attribute("file").value(), set.attribute("timestep").as_double());
  return index;
}

// {"file-series-version": "1.0", "files": [{"name": "a_0.vtu", "time": 0.5}, ...]}; a bare name stands for one with its number as the time.
SeriesIndex read_json_index(const std::string& path) {
  const MappedFile file(path);
  const Json json = parse_json(file.text(), path);
  SeriesIndex index;
  index.recipe = json["recipe"].text();
  for (const Json& f : json["files"].items()) {
    const std::string& name = f.is_text() ? f.text() : f["name"].text();
    const double time = f["time"].is_number() ? f["time"].number() : double(index.files.size());
    if (name.empty() || !std::isfinite(time))
      fail_data(fmt::format("names no file, or no time, in its entry {}", index.files.size()), path,
                "{\"name\": \"a_0.vtu\", \"time\": 0.5}");
    index.files.emplace_back(name, time);
  }
  std::stable_sort(index.files.begin(), index.files.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (index.files.empty()) fail_data("names no files", path, "{\"file-series-version\": \"1.0\", \"files\": [...]}");
  return index;
}

}  // namespace

SeriesIndex read_series_index(const std::string& path) { return is_pvd(path) ? read_pvd_index(path) : read_json_index(path); }

void write_series_index(const std::string& path, const SeriesIndex& index) {
  std::string text;
  if (is_pvd(path)) {
    text = fmt::format("<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection recipe=\"{}\">\n",
                       index.recipe);
    for (const auto& [name, time] : index.files)
      text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", exact_number(time), vtk::escaped_xml(name));
    text += "  </Collection>\n</VTKFile>\n";
  } else {
    text = fmt::format("{{\n  \"file-series-version\": \"1.0\",\n  \"recipe\": {},\n  \"files\": [", json_string(index.recipe));
    for (const auto& [name, time] : index.files)
      text += fmt::format("{}\n    {{\"name\": {}, \"time\": {}}}", &name == &index.files[0].first ? "" : ",", json_string(name),
                          exact_number(time));
    text += "\n  ]\n}\n";
  }
  write_file(path, text);
}

bool sniff_file_series(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return text.find("\"file-series-version\"") != text.npos;
}
std::vector<double> times_of_file_series(const std::string& path, const ReadOptions&, Context&) {
  std::vector<double> times;
  for (const auto& [name, time] : read_json_index(path).files) times.push_back(time);
  return times;
}
Data read_file_series(const std::string& path, const ReadOptions& options, Context& context) {
  const size_t step = chosen_step(times_of_file_series(path, options, context), options, path);
  const auto [name, time] = read_json_index(path).files[step];
  if (extension_of(name) == "series") fail_data("names another index", path, "expected files of data");
  ReadOptions of_file = options;
  of_file.format.clear(), of_file.times.clear(), of_file.time.reset(), of_file.step = -1;
  return map_datasets(read_data(path_beside(path, name), of_file, context), [&](const DatasetPtr& d) {
    DatasetParts parts = d->parts();
    parts.time = time;
    parts.notes.emplace_back("file", file_name_of(name));
    return make_trusted_dataset(std::move(parts));
  });
}

}  // namespace sg
