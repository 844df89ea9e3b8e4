// SPDX-License-Identifier: Apache-2.0
#include "io/lent_series.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <mutex>

#include "base/text/text.h"
#include "data/trusted.h"

namespace sg {

namespace {

constexpr std::string_view scheme = "series:";

struct Lent {
  std::vector<double> times;
  LoadStep load;
};

std::mutex mutex;
std::map<std::string, std::shared_ptr<const Lent>>& all_lent() {
  static auto* all = new std::map<std::string, std::shared_ptr<const Lent>>();  // outlives what is destroyed at the end
  return *all;
}

std::shared_ptr<const Lent> find_lent(const std::string& path) {
  const std::lock_guard lock(mutex);
  const auto at = all_lent().find(path);
  if (at == all_lent().end()) fail_usage("this series of a program is gone", path, "keep the data that hold it");
  return at->second;
}

}  // namespace

LentSeries::LentSeries(std::vector<double> times, LoadStep load) {
  if (times.empty()) fail_usage("a series needs times", "series");
  for (size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1]))
      fail_usage(fmt::format("time {} of the series is {}{}", i, exact_number(times[i]),
                             i > 0 ? fmt::format(", the one before is {}", exact_number(times[i - 1])) : ""),
                 "series", "finite times, each after the one before");
  static uint64_t count = 0;
  const std::lock_guard lock(mutex);
  path_ = fmt::format("{}{}", scheme, ++count);
  all_lent()[path_] = std::make_shared<const Lent>(Lent{std::move(times), std::move(load)});
}

LentSeries::~LentSeries() {
  std::shared_ptr<const Lent> last;  // ends after the lock: what the program bound to its function may hold series itself
  const std::lock_guard lock(mutex);
  const auto at = all_lent().find(path_);
  last = std::move(at->second);
  all_lent().erase(at);
}

bool is_lent(const std::string& path) { return path.starts_with(scheme) && parse_int(std::string_view(path).substr(scheme.size())); }

std::vector<double> lent_times(const std::string& path) { return find_lent(path)->times; }

Data read_lent(const std::string& path, const ReadOptions& options, Context& context) {
  const auto lent = find_lent(path);
  const size_t step = chosen_step(lent->times, options, path);
  return map_datasets(lent->load(step, context), [&](const DatasetPtr& d) {
    if (d->time()) return d;
    DatasetParts parts = d->parts();
    parts.time = lent->times[step];
    return make_trusted_dataset(std::move(parts));
  });
}

}  // namespace sg
