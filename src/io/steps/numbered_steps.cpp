// SPDX-License-Identifier: Apache-2.0
#include "io/steps/numbered_steps.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "base/error.h"
#include "base/file/file.h"
#include "io/formats.h"
#include "io/steps/series_file.h"
#include "io/vtk/xml/vtk_xml_encode.h"

namespace sg {

namespace {

constexpr std::string_view mark = "{n}";

/// Files that bear numbers. `name(step, data)` is where a step goes, relative to the index.
class NumberedSteps final : public StepsWriter {
 public:
  using Name = std::function<std::string(size_t step, const Data& data)>;
  NumberedSteps(std::string index, Name name, StepsPlan plan, const WriteOptions& options)
      : StepsWriter(std::move(plan)), index_(std::move(index)), name_(std::move(name)), options_(options) {
    if (!plan_.resume || !file_exists(index_)) return;
    there_ = read_series_index(index_);
    std::vector<double> times;
    for (const auto& [file, time] : there_.files) times.push_back(time);
    done_ = steps_there(times, there_.recipe, plan_, index_);
  }

 private:
  void write(size_t step, const Data& data, Context& context) override {
    const std::string name = name_(step, data), path = path_beside(index_, name);
    std::error_code ignored;
    std::filesystem::create_directories(folder_of(path).empty() ? "." : folder_of(path), ignored);  // what fails tells at writing
    write_data(path, data, options_, context);
    there_.files.resize(step), there_.recipe = plan_.recipe;
    there_.files.emplace_back(name, plan_.times[step]);
    write_series_index(index_, there_);
  }

  std::string index_;
  Name name_;
  WriteOptions options_;
  SeriesIndex there_;
};

size_t digits_of(size_t count) { return std::max<size_t>(3, count > 0 ? std::to_string(count - 1).size() : 0); }

}  // namespace

bool is_numbered(const std::string& path) { return file_name_of(path).find(mark) != std::string::npos; }

std::string index_of_numbered(const std::string& path) {
  std::string name = file_name_of(path);
  const size_t at = name.find(mark);
  // "flow_{n}.vtu" is "flow.vtu.series"
  std::string before = name.substr(0, at);
  while (!before.empty() && std::string_view("_-. ").find(before.back()) != std::string_view::npos) before.pop_back();
  return folder_of(path) + (before.empty() ? "series" : before) + name.substr(at + mark.size()) + ".series";
}

std::unique_ptr<StepsWriter> write_numbered_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context&) {
  const std::string name = file_name_of(path);
  const size_t at = name.find(mark), digits = digits_of(plan.times.size());
  format_to_write(path);
  return std::make_unique<NumberedSteps>(
      index_of_numbered(path),
      [=](size_t step, const Data&) { return name.substr(0, at) + fmt::format("{:0{}}", step, digits) + name.substr(at + mark.size()); },
      std::move(plan), options);
}

std::unique_ptr<StepsWriter> write_pvd_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context&) {
  const std::string name = file_name_of(path), stem = name.substr(0, name.rfind('.'));
  const size_t digits = digits_of(plan.times.size());
  return std::make_unique<NumberedSteps>(
      path,
      [=](size_t step, const Data& data) {
        const auto* d = std::get_if<DatasetPtr>(&data);
        if (std::holds_alternative<TablePtr>(data)) fail_usage("a table is no part of a .pvd", path, "write tables to numbered .csv files");
        const std::string_view extension = !d || !*d ? "vtm" : (*d)->as<AmrGrid>() ? "vthb" : vtk::extension_for((*d)->mesh());
        return fmt::format("{}/{}_{:0{}}.{}", stem, stem, step, digits, extension);
      },
      std::move(plan), options);
}

void write_pvd(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  double time = 0;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { time = d->time().value_or(time); });
  write_pvd_steps(path, {{time}, {}, false}, options, context)->add(data, context);
}

}  // namespace sg
