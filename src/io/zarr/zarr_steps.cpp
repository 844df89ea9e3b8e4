// SPDX-License-Identifier: Apache-2.0
// A series of volumes in one OME-Zarr folder, step by step.
#include <fmt/core.h>
#include <sys/stat.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/steps/steps.h"
#include "io/zarr/zarr.h"

namespace sg {

namespace {

class ZarrSteps final : public StepsWriter {
 public:
  ZarrSteps(std::string path, StepsPlan plan, const WriteOptions& options, Context& context)
      : StepsWriter(std::move(plan)), path_(std::move(path)) {
    while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
    options_.chunk = size_t(options.chunk);
    if (options.compression) options_.compression = word_of(*options.compression);
    const auto& times = plan_.times;
    if (times.size() > 1) interval_ = (times.back() - times[0]) / double(times.size() - 1);
    for (size_t i = 0; i < times.size(); ++i)
      if (!(std::fabs(times[i] - (times[0] + interval_ * double(i))) <= 1e-9 * std::fabs(interval_)))
        fail_usage(fmt::format("the times {} and {} are not as far apart as the others", exact_number(times[i > 0 ? i - 1 : 0]),
                               exact_number(times[i])),
                   path_, "OME-Zarr has one length of step: write a .pvd or .vtkhdf");
    if (!file_exists(path_)) return;
    if (!is_folder(path_) || !sniff_zarr_folder(path_))
      fail_usage("exists already and is not a Zarr folder", path_, "remove it first, or choose another name");
    old_ = !plan_.resume;
    if (old_) return;
    const std::string attributes = path_ + "/.zattrs";
    const MappedFile file(attributes);
    const Json said = parse_json(file.text(), attributes);
    done_ = steps_there(times_of_zarr(path_, {}, context), said["sightglass"]["recipe"].text(), plan_, path_);
  }

 private:
  void write(size_t step, const Data& data, Context& context) override {
    const DatasetPtr d = single_dataset(data, "an OME-Zarr folder");
    const SlabSource source = slabs_of_dataset(d, path_, context);
    if (std::exchange(old_, false)) std::filesystem::remove_all(path_);
    if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST) fail_data(std::string("cannot be created: ") + std::strerror(errno), path_);
    if (shape_ && (*shape_ != source.grid.dims || type_ != source.type || components_ != source.components))
      fail_usage(fmt::format("step {} has another size or type than those before it", step), path_, "write numbered files or a .pvd");
    shape_ = source.grid.dims, type_ = source.type, components_ = source.components;
    zarr::write_step(path_, source, options_, {step, plan_.times[0], interval_, plan_.recipe}, context);
  }

  std::string path_;
  ZarrOptions options_;
  double interval_ = 1;
  bool old_ = false;  // what is there goes when the first step is known to be one
  std::optional<std::array<size_t, 3>> shape_;
  ElementType type_ = ElementType::f32;
  int components_ = 1;
};

}  // namespace

std::unique_ptr<StepsWriter> write_zarr_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context) {
  return std::make_unique<ZarrSteps>(path, std::move(plan), options, context);
}

}  // namespace sg
