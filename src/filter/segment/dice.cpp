// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/dice.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <unordered_map>

#include "base/parallel.h"
#include "base/text/text.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, DiceParams& p) {
  s("field", p.field, "Label field to assess.").takes(fields::scalars);
  s("truth", p.truth, "Reference label field.").takes(fields::scalars);
}

namespace {

struct Counts {
  double own = 0, truth = 0, both = 0;
};
using CountMap = std::unordered_map<int64_t, Counts>;

const Field& label_field(const Dataset& in, const FieldName& name, const char* which) {
  if (name.empty()) fail_usage(fmt::format("no {} given", which), "dice", fmt::format("name the label field: {}=NAME", which));
  const Field& f = with_context("dice", [&]() -> const Field& { return in.fields().require(name.name); });
  if (f.association == Association::whole || f.components() != 1)
    fail_usage(fmt::format("'{}' is not a label field on points or cells", f.name), "dice");
  return f;
}

// A whole number, or nothing for NaN; throws for others.
bool whole_number(double x, const Field& f, size_t i, int64_t& label) {
  if (std::isnan(x)) return false;
  if (x != std::floor(x) || std::abs(x) >= 9007199254740992.0)
    fail_usage(fmt::format("field '{}' is not a label field: sample {} is {}", f.name, i, short_number(x)), "dice",
               "labels must be whole numbers");
  label = int64_t(x);
  return true;
}

}  // namespace

TablePtr dice(const DatasetPtr& in, const DiceParams& p, Context& context) {
  const Field &own = label_field(*in, p.field, "field"), &truth = label_field(*in, p.truth, "truth");
  if (own.association != truth.association)
    fail_usage(fmt::format("'{}' is a {} field but '{}' a {} field", own.name, association_name(own.association), truth.name,
                           association_name(truth.association)),
               "dice", "use point_to_cell or cell_to_point first");
  const std::vector<uint8_t> states = sample_states(*in, own.association);
  // Runs of one pair of labels are counted together, so that maps are touched at borders only.
  const CountMap counts = parallel_reduce(
      own.array.count(), 1 << 16, CountMap{},
      [&](size_t begin, size_t end) {
        CountMap m;
        int64_t a = 0, b = 0, last_a = 0, last_b = 0;
        double run = 0;
        const auto flush = [&] {
          if (run == 0) return;
          m[last_a].own += run, m[last_b].truth += run;
          if (last_a == last_b) m[last_a].both += run;
          run = 0;
        };
        for (size_t i = begin; i < end; ++i) {
          if (!states.empty() && states[i] != sample_seen) continue;
          if (!whole_number(own.array.get(i), own, i, a) || !whole_number(truth.array.get(i), truth, i, b)) continue;
          if (run > 0 && (a != last_a || b != last_b)) flush();
          last_a = a, last_b = b, ++run;
        }
        flush();
        return m;
      },
      [](CountMap x, const CountMap& y) {
        for (const auto& [label, c] : y) {
          Counts& t = x[label];
          t.own += c.own, t.truth += c.truth, t.both += c.both;
        }
        return x;
      },
      &context);
  const std::map<int64_t, Counts> sorted(counts.begin(), counts.end());
  std::vector<int64_t> label;
  std::vector<double> count, known, both, share, jaccard;
  for (const auto& [l, c] : sorted) {
    label.push_back(l), count.push_back(c.own), known.push_back(c.truth), both.push_back(c.both);
    share.push_back(2 * c.both / (c.own + c.truth)), jaccard.push_back(c.both / (c.own + c.truth - c.both));
    if (sorted.size() <= 16)
      context.info(fmt::format("dice: label {}: {} ({} samples, {} in truth)", l, short_number(share.back(), 4), c.own, c.truth));
  }
  auto table = std::make_shared<Table>();
  const auto column = [&](const char* name, Array a) {
    table->columns.push_back({name, Association::whole, std::move(a), "", Role::none});
  };
  column("label", Array::from_vector(std::move(label)));
  column("count", Array::from_vector(std::move(count)));
  column("truth", Array::from_vector(std::move(known)));
  column("both", Array::from_vector(std::move(both)));
  column("dice", Array::from_vector(std::move(share)));
  column("jaccard", Array::from_vector(std::move(jaccard)));
  return table;
}

}  // namespace sg
